//! Arguments of `terrain`.

use std::path::PathBuf;

use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Terrain {
    /// Print extent, posts, voids, heights and datum of elevation files
    Info(TerrainInfo),
    /// Fetch the tiles that a spec needs into its terrain folder, over http
    Fetch(TerrainFetch),
    /// Write the ground of a spec as ArduPilot's terrain database (.DAT)
    Export(TerrainExport),
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct TerrainInfo {
    /// Elevation files (.hgt, .hgt.gz, .hgt.zip, .tif, .asc, .png), or folders of them
    #[arg(required = true, value_name = "FILES")]
    pub(in crate::cli) files: Vec<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct TerrainFetch {
    /// The mission spec (YAML), with `terrain: {folder: ...}`
    pub(in crate::cli) spec: PathBuf,
    /// Address of the tiles, such as http://host/{ns}{lat}/{tile}.hgt.gz: {tile} is N36W085,
    /// {ns} {lat} {ew} {lon} its parts N 36 W 085
    #[arg(long, value_name = "TEMPLATE")]
    pub(in crate::cli) url: String,
}

#[derive(Debug, clap::Args)]
pub(in crate::cli) struct TerrainExport {
    /// The mission spec (YAML)
    pub(in crate::cli) spec: PathBuf,
    /// Output folder; an existing one is replaced as a whole [default: out/<name>.terrain]
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Metres between heights: the TERRAIN_SPACING of the vehicle
    #[arg(long, value_name = "M", default_value_t = 100, value_parser = clap::value_parser!(u16).range(10..=1000))]
    pub(in crate::cli) spacing: u16,
}
