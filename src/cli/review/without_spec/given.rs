//! The margins of a review that were judged against a given limit.

use crate::cli::args::Limits;
use crate::spec::MissionSpec;
use crate::verify::{Margin, Review};

/// A limit that is judged only if it was given: names of its margins, its name, its flag.
struct Optional {
    margins: &'static [&'static str],
    called: &'static str,
    flag: &'static str,
    given: fn(&Limits) -> bool,
}

const OPTIONAL: &[Optional] = &[
    Optional {
        margins: &[
            "terrain clearance",
            "ground contact",
            "home altitude",
            "rally",
        ],
        called: "terrain clearance",
        flag: "--terrain",
        given: |limits| limits.terrain.is_some(),
    },
    Optional {
        margins: &["ceiling"],
        called: "ceiling",
        flag: "--max-amsl",
        given: |limits| limits.max_amsl.is_some(),
    },
    Optional {
        margins: &["separation"],
        called: "separation",
        flag: "--separation",
        given: |limits| limits.separation.is_some(),
    },
    Optional {
        margins: &["climb angle"],
        called: "climb angle",
        flag: "--max-climb",
        given: |limits| limits.max_climb.is_some(),
    },
    Optional {
        margins: &["descent angle"],
        called: "descent angle",
        flag: "--max-descent",
        given: |limits| limits.max_descent.is_some(),
    },
    Optional {
        margins: &["climb speed"],
        called: "climb speed",
        flag: "--climb",
        given: |limits| limits.climb.is_some(),
    },
    Optional {
        margins: &["descent speed"],
        called: "descent speed",
        flag: "--descent",
        given: |limits| limits.descent.is_some(),
    },
    Optional {
        margins: &["turn fit"],
        called: "turn radius",
        flag: "--load-factor",
        given: |limits| limits.load_factor.is_some(),
    },
];

/// Margins against keys that come from the mission itself: they always hold.
const OF_ITSELF: &[&str] = &[
    "start",
    "goal",
    "finish",
    "takeoff heading",
    "loiter radius",
    "departure",
    "speed",
    "area",
    "item count",
    "fence complete",
];

/// Retains the margins judged against a given limit; returns the limits that were not judged.
pub(crate) fn keep_given(review: &mut Review, spec: &MissionSpec, limits: &Limits) -> Vec<String> {
    let mut not_judged = Vec::new();
    for optional in OPTIONAL.iter().filter(|optional| !(optional.given)(limits)) {
        let of = |what: &str| {
            optional.margins.iter().any(|name| {
                what.strip_prefix(name)
                    .is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
            })
        };
        review.margins.retain(|margin| !of(&margin.what));
        if optional.called != "separation" || spec.vehicles.len() > 1 {
            not_judged.push(format!("{} ({})", optional.called, optional.flag));
        }
    }
    review.margins.retain(|margin| {
        let itself = OF_ITSELF.contains(&margin.what.as_str())
            // Of a rally point as well.
            || margin.what.ends_with(" in the area");
        // A missing home still fails.
        let home = margin.what == "home position" && margin.ok;
        !itself && !home
    });
    if limits.terrain.is_none() && !limits.no_terrain {
        for vehicle in &spec.vehicles {
            review.margins.push(Margin::unjudged(
                &vehicle.id,
                "terrain clearance",
                "not judged: no elevation was given (--terrain FILE, or --no-terrain to go without)",
            ));
        }
    }
    not_judged
}
