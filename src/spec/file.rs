//! A spec file: read, parsed and checked, with its text for messages and copies.

pub(super) mod partial;
pub(super) mod structure;

use std::io::Read;
use std::path::{Path, PathBuf};

use super::airspace::{self, AirspaceImport, AttachedFile};
use super::builder::Builder;
use super::check;
use super::keys::{self, schema};
use super::positions::Positions;
use super::table::{Table, TableFile};
use super::value_sources::{ValueSources, in_order};
use super::{Issue, MissionSpec, SpecError, TerrainSource};
use crate::numeric::text::{open_regular, timestamp};
use partial::{Incomplete, Known};
use structure::{KeysRead, Unknown};

/// Largest spec file. A thousand vehicles need half of one MiB.
const MAX_BYTES: u64 = 8 << 20;

/// A checked spec and the text it came from.
#[derive(Clone, Debug)]
pub struct SpecFile {
    /// The mission.
    pub spec: MissionSpec,
    /// The file, byte for byte.
    pub text: String,
    /// Its path, as given.
    pub path: PathBuf,
    /// The table of vehicles that it names, if any.
    pub table: Option<TableFile>,
    /// The files of airspace and obstacles that it names.
    pub attached: Vec<AttachedFile>,
    /// What became of the shapes of each of them.
    pub imports: Vec<AirspaceImport>,
    /// Its `t0`, milliseconds since 1970.
    pub t0_unix_ms: Option<u64>,
    sources: ValueSources,
}

impl SpecFile {
    /// The keys as the file has them, to change some and check them again.
    ///
    /// # Errors
    /// As for [`Self::parse`]; none where this was read or built.
    pub fn to_builder(&self) -> Result<Builder, SpecError> {
        let yaml = self.text.strip_prefix('\u{feff}').unwrap_or(&self.text);
        let keys = serde_yaml::from_str::<keys::Spec>(yaml);
        let keys =
            keys.map_err(|error| self.error(vec![structure::problem(&error, schema::of_spec())]))?;
        Ok(keys.into())
    }

    /// Reads and checks a spec, as far as that needs no ground. Loading the world checks the rest.
    ///
    /// # Errors
    /// A file that cannot be read or is not text, and all that [`Self::parse`] finds.
    pub fn read(path: &Path) -> Result<Self, SpecError> {
        Self::parse(path, read_text(path)?)
    }

    /// Checks a spec that is already in memory; `path` is where it would be, and in that folder
    /// the table of vehicles that it may name is read.
    ///
    /// # Errors
    /// Broken YAML, or else every problem, in file order: of keys and types, of files that cannot be
    /// read, and all semantic ones that can be known beside them.
    pub fn parse(path: &Path, text: String) -> Result<Self, SpecError> {
        Ok(Self::parse_known(path, text)?)
    }

    /// [`Self::read`], with what is known of a spec in spite of its problems.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn read_known(path: &Path) -> Result<Self, Box<Incomplete>> {
        Self::parse_known(path, read_text(path).map_err(nothing_known)?)
    }

    /// [`Self::parse`], with what is known of a spec in spite of its problems.
    ///
    /// # Errors
    /// As for [`Self::parse`].
    pub fn parse_known(path: &Path, text: String) -> Result<Self, Box<Incomplete>> {
        let all = |issues: Vec<Issue>| {
            nothing_known(SpecError {
                file: path.display().to_string(),
                issues,
            })
        };
        let one = |issue: Issue| all(vec![issue]);
        // Editors on Windows begin a file with a byte order mark.
        let yaml = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let positions = Positions::read(yaml).map_err(one)?;
        if positions.has("frame") {
            return Err(one(Issue {
                path: "frame".to_owned(),
                table: None,
                position: positions.find("frame"),
                found: "a scenario of the study, in Cartesian coordinates without a place on earth"
                    .to_owned(),
                allowed: "a mission in latitude and longitude, without this key".to_owned(),
            }));
        }
        let read = structure::read(yaml, &positions).map_err(|issues| all(in_order(issues)))?;
        Self::check(path, text, read, positions)
    }

    /// Checks the keys of a file, and the files that they name.
    pub(super) fn check(
        path: &Path,
        text: String,
        read: KeysRead,
        positions: Positions,
    ) -> Result<Self, Box<Incomplete>> {
        let KeysRead {
            keys,
            mut issues,
            mut unknown,
        } = read;
        let csv = keys.fleet.as_ref().and_then(|fleet| fleet.csv.as_deref());
        let table = csv.map(|name| read_table(path, name, &positions));
        let (file, table) = match table.transpose() {
            Ok(table) => table.unzip(),
            Err(problems) => {
                issues.extend(problems);
                let without = ["fleet", "vehicles", "tasks"].map(str::to_owned);
                unknown.extend(without.map(Unknown::Within));
                (None, None)
            }
        };
        let (attached, unread) = airspace::read(path, &keys, &positions);
        unknown.extend(
            unread
                .iter()
                .map(|issue| Unknown::Within(issue.path.clone())),
        );
        issues.extend(unread);
        // Whether it is one is checked below.
        let t0: Option<jiff::Timestamp> = keys.t0.as_deref().and_then(timestamp);
        let checked = check::check(keys, positions, table.unwrap_or_default(), &attached);
        let is_known = |issue: &Issue| !structure::is_unknown(issue, &unknown);
        issues.extend(checked.issues.into_iter().filter(is_known));
        let file = checked.spec.map(|(spec, imports)| Self {
            spec,
            text,
            path: path.to_owned(),
            table: file,
            attached,
            imports,
            t0_unix_ms: t0.and_then(|t0| u64::try_from(t0.as_millisecond()).ok()),
            sources: checked.sources,
        });
        match file {
            Some(file) if issues.is_empty() => Ok(file),
            file => {
                let known = file.map(|file| Known {
                    file,
                    vehicles: checked.vehicles,
                    sites: checked.sites,
                    unknown,
                });
                Err(partial::incomplete(path, issues, known))
            }
        }
    }

    /// The text of a spec of version 1 with 2 in place of its version; all else stays.
    ///
    /// # Errors
    /// A version that is not written as the digit 1 where it stands, such as an alias.
    pub fn in_version_2(&self) -> Result<String, SpecError> {
        let unclear = || {
            let found = "a version that is not written as 1 here".to_owned();
            self.error(vec![self.issue("sortie", found, "sortie: 1".to_owned())])
        };
        let place = self.issue("sortie", String::new(), String::new());
        let at = place.position.and_then(|(line, column)| {
            // Positions are those of the text after a byte order mark.
            let yaml = self.text.strip_prefix('\u{feff}').unwrap_or(&self.text);
            let mark = self.text.len() - yaml.len();
            let before = yaml
                .split_inclusive('\n')
                .take(line - 1)
                .map(str::len)
                .sum::<usize>();
            let (within, _) = yaml.get(before..)?.char_indices().nth(column - 1)?;
            Some(mark + before + within)
        });
        let at = at.ok_or_else(unclear)?;
        let (head, tail) = self.text.split_at_checked(at).ok_or_else(unclear)?;
        let rest = tail.strip_prefix('1').ok_or_else(unclear)?;
        let ends = |next: char| next.is_whitespace() || ",}#".contains(next);
        match rest.chars().next().is_none_or(ends) {
            true => Ok(format!("{head}2{rest}")),
            false => Err(unclear()),
        }
    }

    /// Whether `fleet` made a vehicle.
    pub(super) fn is_made(&self, vehicle: &str) -> bool {
        self.sources.is_made(vehicle)
    }

    /// A problem at a path of this file, with its line and column.
    #[must_use]
    pub fn issue(&self, path: &str, found: String, allowed: String) -> Issue {
        self.sources.issue(path, found, allowed)
    }

    /// An error of these issues, put in file order.
    #[must_use]
    pub fn error(&self, issues: Vec<Issue>) -> SpecError {
        SpecError {
            file: self.path.display().to_string(),
            issues: in_order(issues),
        }
    }

    /// Where the elevation file or folder is, if the spec names one.
    #[must_use]
    pub fn terrain_path(&self) -> Option<PathBuf> {
        match &self.spec.terrain {
            TerrainSource::File(name) | TerrainSource::Folder(name) => {
                let folder = self.path.parent().unwrap_or(Path::new(""));
                Some(folder.join(name))
            }
            TerrainSource::Flat(_) | TerrainSource::Analytic { .. } => None,
        }
    }
}

/// An error beside which nothing is known.
pub(super) fn nothing_known(error: SpecError) -> Box<Incomplete> {
    Box::new(Incomplete { error, known: None })
}

/// The table that a spec names, in its folder.
fn read_table(
    spec: &Path,
    name: &str,
    positions: &Positions,
) -> Result<(TableFile, Table), Vec<Issue>> {
    let issue = |found: String, allowed: &str| {
        vec![Issue {
            path: "fleet.csv".to_owned(),
            table: None,
            position: positions.find("fleet.csv"),
            found,
            allowed: allowed.to_owned(),
        }]
    };
    let path = check::relative(name).filter(|_| name.to_ascii_lowercase().ends_with(".csv"));
    let Some(path) = path else {
        let allowed =
            "a path relative to the spec that ends in .csv, with /, without .. and drive letters";
        return Err(issue(format!("`{}`", name.escape_debug()), allowed));
    };
    let file = spec.parent().unwrap_or(Path::new("")).join(&path);
    let text = read_text(&file).map_err(|error| {
        let first = error.issues.into_iter().next();
        let (found, allowed) = first.map_or_else(Default::default, |it| (it.found, it.allowed));
        issue(format!("{}: {found}", file.display()), &allowed)
    })?;
    let table = Table::read(file.display().to_string(), &text)?;
    Ok((TableFile { name: path, text }, table))
}

/// The text of a spec or of its table.
///
/// # Errors
/// A file that cannot be read, is too large, or is not text.
pub(super) fn read_text(path: &Path) -> Result<String, SpecError> {
    let whole = |found: String, allowed: &str| SpecError {
        file: path.display().to_string(),
        issues: vec![Issue {
            path: String::new(),
            table: None,
            position: None,
            found,
            allowed: allowed.to_owned(),
        }],
    };
    if path.is_dir() {
        let own = path.join("spec.yaml");
        let own = match own.is_file() {
            true => format!(", such as {}", own.display()),
            false => String::new(),
        };
        let allowed = format!("a mission spec, which is a YAML file{own}");
        return Err(whole("cannot be read: it is a folder".to_owned(), &allowed));
    }
    let mut bytes = Vec::new();
    open_regular(path)
        .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| whole(format!("cannot be read: {error}"), ""))?;
    if u64::try_from(bytes.len()).is_ok_and(|length| length > MAX_BYTES) {
        let allowed = format!("at most {} MiB", MAX_BYTES >> 20);
        return Err(whole(
            "too large for a mission spec or table".to_owned(),
            &allowed,
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        whole(format!("not text: byte {good} is not UTF-8"), "UTF-8")
    })
}

/// The JSON Schema (draft 2020-12) of a mission spec, for editors.
#[must_use]
pub fn json_schema() -> String {
    let schema = schemars::schema_for!(keys::Spec);
    let mut text = format!("{:#}", schema.as_value());
    text.push('\n');
    text
}
