//! Versions of autopilot firmware, as far as they change what a mission may hold.

use std::fmt;
use std::str::FromStr;

/// Major and minor version: patch releases accept the same items.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// First number.
    pub major: u8,
    /// Second number.
    pub minor: u8,
}

/// Shorthand for tables.
pub(super) const fn version(major: u8, minor: u8) -> Version {
    Version { major, minor }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

impl Version {
    /// That of `AUTOPILOT_VERSION.flight_sw_version`; none for 0, which names no version.
    #[must_use]
    pub fn of_flight_software(flight_software: u32) -> Option<Self> {
        let [major, minor, ..] = flight_software.to_be_bytes();
        (flight_software != 0).then_some(Self { major, minor })
    }
}

/// The text is not two numbers with a dot between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a version such as 4.7")]
pub struct InvalidVersion;

impl FromStr for Version {
    type Err = InvalidVersion;

    fn from_str(text: &str) -> Result<Self, InvalidVersion> {
        let (major, minor) = text.split_once('.').ok_or(InvalidVersion)?;
        let number = |digits: &str| digits.parse().map_err(|_| InvalidVersion);
        Ok(Self {
            major: number(major)?,
            minor: number(minor)?,
        })
    }
}

/// Versions from one on, up to but without another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VersionRange {
    /// The first; absent: every earlier one.
    pub since: Option<Version>,
    /// The first that is no longer in the range; absent: every later one.
    pub before: Option<Version>,
}

impl VersionRange {
    /// Every version.
    pub const ALL: Self = Self {
        since: None,
        before: None,
    };

    /// A version and all later ones.
    #[must_use]
    pub const fn since(version: Version) -> Self {
        Self {
            since: Some(version),
            before: None,
        }
    }

    /// All versions before one.
    #[must_use]
    pub const fn before(version: Version) -> Self {
        Self {
            since: None,
            before: Some(version),
        }
    }

    /// Whether it holds a version.
    #[must_use]
    pub fn contains(self, version: Version) -> bool {
        self.since.is_none_or(|since| since <= version)
            && self.before.is_none_or(|before| version < before)
    }
}

impl fmt::Display for VersionRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.since, self.before) {
            (None, None) => f.write_str("every version"),
            (Some(since), None) => write!(f, "{since} and later"),
            (None, Some(before)) => write!(f, "before {before}"),
            (Some(since), Some(before)) => write!(f, "{since} until before {before}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_read_written_and_ordered() {
        let read = |text: &str| text.parse::<Version>();
        assert_eq!(read("4.7"), Ok(version(4, 7)));
        assert_eq!(version(1, 18).to_string(), "1.18");
        for bad in ["4", "4.7.1", "v4.7", "", "4.x"] {
            assert_eq!(read(bad), Err(InvalidVersion), "{bad}");
        }
        let range = VersionRange::since(version(1, 18));
        assert!(range.contains(version(1, 19)) && !range.contains(version(1, 9)));
        assert!(!VersionRange::before(version(4, 7)).contains(version(4, 7)));
    }
}
