//! The paper's experiment (Shi, Zhang, Xia 2020, section 4): seven algorithms on three maps,
//! every choice on record, all paths judged at 2001 samples.

mod claims;
mod config;
mod contestants;
mod convergence;
mod figures;
mod published;
mod record;
mod report;
mod results;
mod runner;

use std::fs;
use std::path::Path;

use super::setting::Setting;
use super::store::{StoreError, io_at, write_whole};

pub use config::{Config, ConfigError, Job, MapText};
pub(super) use config::{read_text, sha256, unreadable};
pub use contestants::{Contestant, Method, Protocol, Role, ablations, contestants, readings};
pub use record::{Record, VehicleRecord};
pub use results::Results;
pub use runner::run;

/// The shipped maps: file name and text.
#[must_use]
pub fn shipped_maps() -> [(&'static str, &'static str); 3] {
    [
        ("s1.yaml", include_str!("../../../missions/paper/s1.yaml")),
        ("s2.yaml", include_str!("../../../missions/paper/s2.yaml")),
        ("s3.yaml", include_str!("../../../missions/paper/s3.yaml")),
    ]
}

/// The shipped maps with eight free control points.
pub(super) const MAPS_8: [(&str, &str); 3] = [
    (
        "s1-8.yaml",
        include_str!("../../../missions/paper/s1-8.yaml"),
    ),
    (
        "s2-8.yaml",
        include_str!("../../../missions/paper/s2-8.yaml"),
    ),
    (
        "s3-8.yaml",
        include_str!("../../../missions/paper/s3-8.yaml"),
    ),
];

/// The document `RESULTS.md`. It depends only on the runs.
#[must_use]
pub fn results_md(results: &Results<'_>) -> String {
    report::document(results).markdown()
}

/// Writes tables, document, figures and page into a folder: the same bytes for the same runs.
///
/// # Errors
/// Files that cannot be written.
pub fn write_results(
    folder: &Path,
    results: &Results<'_>,
    settings: &[Setting],
) -> Result<(), StoreError> {
    fs::create_dir_all(folder).map_err(io_at(folder))?;
    let document = report::document(results);
    let figures = figures::figures(results, settings);
    for (name, text) in [
        ("table2.csv", results.table_2()),
        ("table3.csv", results.table_3()),
        ("RESULTS.md", document.markdown()),
        ("study.html", document.page(&figures)),
    ] {
        write_whole(&folder.join(name), &text)?;
    }
    for (name, _, svg) in &figures {
        write_whole(&folder.join(name), svg)?;
    }
    Ok(())
}
