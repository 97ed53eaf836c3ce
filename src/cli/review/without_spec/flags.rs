//! The flags of a review as the keys of a spec, and back.

use crate::cli::print::failure::Failure;
use crate::spec::SpecError;

/// The last part of a key, and the flag that gives it.
const FLAGS: [(&str, &str); 14] = [
    ("min_agl_m", "--min-agl"),
    ("max_amsl_m", "--max-amsl"),
    ("distance_m", "--separation"),
    ("vertical_m", "--vertical-separation"),
    ("time_slack_s", "--time-slack"),
    ("speed_mps", "--speed"),
    ("accel_mps2", "--accel"),
    ("climb_mps", "--climb"),
    ("descent_mps", "--descent"),
    ("max_climb_deg", "--max-climb"),
    ("max_descent_deg", "--max-descent"),
    ("max_load_factor", "--load-factor"),
    ("return_amsl_m", "--return-amsl"),
    ("takeoff_heading_deg", "--takeoff-heading"),
];

/// The problems of keys that come from flags, named as those.
pub(super) fn refused(error: &SpecError) -> Failure {
    let lines = error.issues.iter().map(|issue| {
        let key = issue.path.rsplit('.').next().unwrap_or_default();
        let flag = FLAGS.iter().find(|(name, _)| *name == key);
        let flag = flag.map_or(issue.path.as_str(), |(_, flag)| flag);
        match issue.allowed.is_empty() {
            true => format!("{flag}: {}", issue.found),
            false => format!("{flag}: {} (allowed: {})", issue.found, issue.allowed),
        }
    });
    Failure::all(Failure::USAGE, lines)
}
