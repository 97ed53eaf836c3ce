//! The coordinate system of a grid from the `.prj` next to it.
//!
//! Source: OGC 01-009 and 18-010 (well-known text 1 and 2), and the names of Esri's projection engine,
//! which writes no codes. A bare `EPSG:2056` is read too, so that it can be written by hand.

use std::path::{Path, PathBuf};

use super::TerrainError;
use crate::geodesy::Projection;
use crate::numeric::text::read_regular;

/// Deepest nesting of well-known text.
const MAX_DEPTH: usize = 12;

/// The `.prj` of a grid.
pub(super) fn path_of(grid: &Path) -> PathBuf {
    let upper = grid.with_extension("PRJ");
    match upper.exists() {
        true => upper,
        false => grid.with_extension("prj"),
    }
}

/// The system of a grid's coordinates; none for degrees of WGS84.
///
/// # Errors
/// No `.prj`, or one that does not name a system that can be used.
pub(super) fn read(grid: &Path) -> Result<Option<Projection>, TerrainError> {
    let path = path_of(grid);
    let text = match read_regular(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Err(TerrainError::NoPrj(super::name_of(&path)));
        }
        text => text?,
    };
    let unknown = || TerrainError::Crs(format!("`{}`", start(&text)));
    let code = match text.trim().strip_prefix("EPSG:") {
        Some(code) => code.parse().map_err(|_| unknown())?,
        None => code(&text)?.ok_or_else(unknown)?,
    };
    super::above_the_sea(code)?;
    match code {
        4326 => Ok(None),
        code => match Projection::of_epsg(code) {
            Some(projection) => Ok(Some(projection)),
            None => Err(TerrainError::Crs(format!("EPSG:{code}"))),
        },
    }
}

/// The beginning of a text, to name it by.
fn start(text: &str) -> String {
    let text = text.trim();
    let short: String = text.chars().take(40).collect();
    match short.len() < text.len() {
        true => format!("{short}..."),
        false => short,
    }
}

/// The code of EPSG of the horizontal system of a well-known text, if its heights are metres.
fn code(text: &str) -> Result<Option<u16>, TerrainError> {
    let mut rest = text.trim().trim_start_matches('\u{feff}');
    let mut horizontal = None;
    // Esri writes a vertical system after the horizontal one, others put both into one.
    while let Some((node, after)) = Node::parse(rest, 0) {
        for node in node.parts() {
            if node.is_one_of(&["PROJCS", "PROJCRS", "GEOGCS", "GEOGCRS", "GEODCRS"]) {
                horizontal = horizontal.or_else(|| node.code());
            } else if node.is_one_of(&["VERTCS", "VERT_CS", "VERTCRS"]) {
                node.check_heights()?;
            }
        }
        rest = after.trim_start().trim_start_matches(',').trim_start();
    }
    Ok(horizontal.filter(|_| rest.is_empty()))
}

/// A keyword of well-known text with what stands within its brackets.
struct Node<'a> {
    keyword: &'a str,
    /// Quoted texts and numbers.
    values: Vec<&'a str>,
    children: Vec<Node<'a>>,
}

impl<'a> Node<'a> {
    /// A node and the text after it.
    fn parse(text: &'a str, depth: usize) -> Option<(Self, &'a str)> {
        let open = text.find(['[', '('])?;
        let keyword = text[..open].trim();
        let is_word = |sign: char| sign.is_ascii_alphanumeric() || sign == '_';
        if depth > MAX_DEPTH || keyword.is_empty() || !keyword.chars().all(is_word) {
            return None;
        }
        let (mut values, mut children) = (Vec::new(), Vec::new());
        let mut rest = text[open + 1..].trim_start();
        loop {
            if let Some(quoted) = rest.strip_prefix('"') {
                let end = quoted.find('"')?;
                values.push(&quoted[..end]);
                rest = &quoted[end + 1..];
            } else {
                let end = rest.find(['[', '(', ',', ']', ')'])?;
                if rest[end..].starts_with(['[', '(']) {
                    let (child, after) = Self::parse(rest, depth + 1)?;
                    children.push(child);
                    rest = after;
                } else {
                    values.push(rest[..end].trim());
                    rest = &rest[end..];
                }
            }
            rest = rest.trim_start();
            match rest.chars().next()? {
                ',' => rest = rest[1..].trim_start(),
                ']' | ')' => break,
                _ => return None,
            }
        }
        let node = Self {
            keyword,
            values,
            children,
        };
        Some((node, &rest[1..]))
    }

    fn is_one_of(&self, keywords: &[&str]) -> bool {
        let mut keywords = keywords.iter();
        keywords.any(|keyword| keyword.eq_ignore_ascii_case(self.keyword))
    }

    /// The systems that a compound one is made of; itself if it is none.
    fn parts(&self) -> Vec<&Self> {
        match self.is_one_of(&["COMPD_CS", "COMPOUNDCRS"]) {
            true => self.children.iter().collect(),
            false => vec![self],
        }
    }

    fn child(&self, keywords: &[&str]) -> Option<&Self> {
        self.children.iter().find(|node| node.is_one_of(keywords))
    }

    fn code(&self) -> Option<u16> {
        let stated = match self.child(&["AUTHORITY", "ID"]).map(|id| &id.values[..]) {
            Some([authority, code, ..]) if authority.eq_ignore_ascii_case("EPSG") => {
                code.parse().ok()
            }
            _ => None,
        };
        stated.or_else(|| esri_code(self.values.first()?))
    }

    /// Refuses a vertical system of feet, depths or heights above an ellipsoid.
    fn check_heights(&self) -> Result<(), TerrainError> {
        let name = self.values.first().copied().unwrap_or_default();
        let other = |what: &str| Err(TerrainError::Heights(format!("`{name}`, {what}")));
        let unit = |node: &Self| node.values.get(1)?.parse::<f64>().ok();
        let units = self.child(&["UNIT", "LENGTHUNIT"]).and_then(unit);
        if units.is_some_and(|metres| (metres - 1.0).abs() > 1e-9) {
            return other("which are not in metres");
        }
        // Esri names the datum of an ellipsoid where heights have a vertical one; in others its kind is 2002
        // (OGC 01-009, CS_VD_Ellipsoidal).
        let datum = self.child(&["VERT_DATUM", "VERTDATUM"]);
        let kind = datum.and_then(|datum| datum.values.get(1));
        if self.child(&["DATUM"]).is_some() || kind.is_some_and(|kind| *kind == "2002") {
            return other("which are metres above an ellipsoid");
        }
        let is_shift = |node: &&Self| {
            let [name, value] = node.values[..] else {
                return false;
            };
            let value: f64 = value.parse().unwrap_or(f64::NAN);
            name.eq_ignore_ascii_case("vertical_shift") && value.abs().total_cmp(&0.0).is_ne()
        };
        if self.children.iter().any(|node| is_shift(&node)) {
            return other("which are shifted");
        }
        let is_down = |node: &&Self| {
            let direction = ["direction", "down"];
            let named = (node.values.first())
                .is_some_and(|name| direction.iter().any(|word| word.eq_ignore_ascii_case(name)));
            named
                && node
                    .values
                    .get(1)
                    .is_some_and(|value| value.starts_with('-'))
                || node.is_one_of(&["AXIS"])
                    && node
                        .values
                        .get(1)
                        .is_some_and(|way| way.eq_ignore_ascii_case("down"))
        };
        match self.children.iter().find(is_down) {
            Some(_) => other("which are depths"),
            None => Ok(()),
        }
    }
}

/// The code of a system by the name that Esri gives it.
fn esri_code(name: &str) -> Option<u16> {
    let name = name.replace([' ', '/'], "_").to_ascii_uppercase();
    let known = match name.as_str() {
        "GCS_WGS_1984" | "WGS_84" => 4326,
        "GCS_ETRS_1989" => 4258,
        "GCS_NORTH_AMERICAN_1983" => 4269,
        "WGS_1984_WEB_MERCATOR_AUXILIARY_SPHERE" => 3857,
        "ETRS_1989_LAEA" => 3035,
        "CH1903+_LV95" => 2056,
        "CH1903_LV03" => 21781,
        "RGF_1993_LAMBERT_93" => 2154,
        "MGI_AUSTRIA_LAMBERT" => 31287,
        "S-JTSK_KROVAK_EAST_NORTH" => 5514,
        "NZGD_2000_NEW_ZEALAND_TRANSVERSE_MERCATOR" => 2193,
        _ => 0,
    };
    if known != 0 {
        return Some(known);
    }
    let zone = |start: &str, letter: char| {
        let zone = name.strip_prefix(start)?.strip_suffix(letter)?;
        zone.parse::<u16>().ok()
    };
    let within = |zone: Option<u16>, zones: std::ops::RangeInclusive<u16>, base: u16| {
        zone.filter(|zone| zones.contains(zone))
            .map(|zone| base + zone)
    };
    within(zone("WGS_1984_UTM_ZONE_", 'N'), 1..=60, 32600)
        .or_else(|| within(zone("WGS_1984_UTM_ZONE_", 'S'), 1..=60, 32700))
        .or_else(|| within(zone("ETRS_1989_UTM_ZONE_", 'N'), 28..=38, 25800))
        .or_else(|| within(zone("NAD_1983_UTM_ZONE_", 'N'), 1..=23, 26900))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UTM: &str = r#"PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",
        SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],
        UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],
        PARAMETER["False_Easting",500000.0],UNIT["Meter",1.0]]"#;

    #[test]
    fn a_system_is_known_by_its_code_or_by_the_name_that_esri_gives_it() {
        for (text, expected) in [
            (UTM, Some(32632)),
            (
                r#"GEOGCS["WGS 84",DATUM["x"],AUTHORITY["EPSG","4326"]]"#,
                Some(4326),
            ),
            (
                r#"PROJCRS["CH1903+ / LV95",BASEGEOGCRS["CH1903+",ID["EPSG",4150]],ID["EPSG",2056]]"#,
                Some(2056),
            ),
            (r#"GEOGCS["GCS_WGS_1984",UNIT["Degree",0.01]]"#, Some(4326)),
            (
                r#"COMPD_CS["both",PROJCS["x",AUTHORITY["EPSG","25832"]],VERT_CS["y",UNIT["metre",1]]]"#,
                Some(25832),
            ),
            (r#"PROJCS["My_Own_Zone",UNIT["Meter",1.0]]"#, None),
            (r#"PROJCS["WGS_1984_UTM_Zone_61N",UNIT["Meter",1.0]]"#, None),
            ("Projection UTM", None),
            (r#"PROJCS["WGS_1984_UTM_Zone_32N""#, None),
        ] {
            assert_eq!(code(text).expect("metres"), expected, "{text}");
        }
    }

    #[test]
    fn heights_that_are_not_metres_above_the_sea_are_refused() {
        for (vertical, why) in [
            (
                r#"VERTCS["NAVD88_foot_US",VDATUM["x"],UNIT["Foot_US",0.3048006096012192]]"#,
                "not in metres",
            ),
            (
                r#"VERTCS["WGS_1984",DATUM["D_WGS_1984"],UNIT["Meter",1.0]]"#,
                "ellipsoid",
            ),
            (
                r#"COMPD_CS["both",PROJCS["x",AUTHORITY["EPSG","25832"]],VERT_CS["Ellipsoid (metre)",VERT_DATUM["Ellipsoid",2002],UNIT["metre",1],AXIS["Up",UP]]]"#,
                "ellipsoid",
            ),
            (
                r#"VERTCS["x",VDATUM["x"],PARAMETER["Vertical_Shift",100.0],PARAMETER["Direction",1.0],UNIT["Meter",1.0]]"#,
                "shifted",
            ),
            (
                r#"VERTCS["Depth",VDATUM["x"],PARAMETER["Direction",-1.0],UNIT["Meter",1.0]]"#,
                "depths",
            ),
        ] {
            let error = code(&format!("{UTM},{vertical}")).expect_err(why);
            assert!(error.to_string().contains(why), "{error}");
        }
    }

    #[test]
    fn deep_or_cut_text_is_no_system() {
        let deep = "A[".repeat(100_000);
        assert_eq!(code(&deep).expect("no heights"), None);
        for end in 0..UTM.len() {
            assert_eq!(code(&UTM[..end]).expect("no heights"), None);
        }
    }
}
