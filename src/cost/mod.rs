//! The objective: seven named terms of one path, all at least 0.
//!
//! [`CostModel`] holds what one vehicle's search needs, laid out for speed.
//! [`CostModel::terms`] is the plain reference, [`CostModel::totals`] the fast
//! form: many candidates side by side, with the same operations in the same order, so
//! that both agree to the bit whatever the processor ([`Dispatch`]).

mod closed_zone;
mod evaluate;
mod hazards;
mod kernel;
mod model;
mod operational;
mod paper;
mod piece;
mod reference;
mod relief;
mod sampling;
mod timing;
mod traffic;

pub use crate::cost::kernel::batch::{Batch, Dispatch};
pub use crate::cost::kernel::scratch::Scratch;
pub use model::CostModel;
pub use paper::{PaperOptions, ThreatForm};
pub use relief::Relief;
pub use traffic::EarlierFlights;

use serde::{Deserialize, Serialize};

use crate::geodesy::PlanPoint;
use crate::spec::Separation;

/// The terms of the objective as they enter the total (design: they sum to it).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CostTerms {
    /// JL, Eq. 22.
    pub length: f64,
    /// JH, Eq. 21.
    pub altitude: f64,
    /// JT, Eq. 24, with zones and the area.
    pub threat: f64,
    /// CH, Eq. 23.
    pub terrain: f64,
    /// CT, Eq. 25.
    pub turn: f64,
    /// CG, Eq. 26.
    pub climb: f64,
    /// JP, Eq. 28 to 30.
    pub collision: f64,
}

impl CostTerms {
    /// The total, summed in the order of the fields.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.length
            + self.altitude
            + self.threat
            + self.terrain
            + self.turn
            + self.climb
            + self.collision
    }

    /// Whether no limit is violated.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.threat + self.terrain + self.turn + self.climb + self.collision <= 0.0
    }

    /// The same path without other vehicles.
    #[must_use]
    pub fn alone(&self) -> Self {
        Self {
            collision: 0.0,
            ..*self
        }
    }

    /// Whether no limit but the distance from other vehicles is violated.
    #[must_use]
    pub fn keeps_static_limits(&self) -> bool {
        self.alone().is_clean()
    }
}

/// How much stricter than the limits a search is, so that its samples leave
/// room for what lies between them and for what encoding changes. A judge has none.
///
/// Near start and goal a margin shrinks to what these places themselves keep:
/// a path cannot be better there than its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margins {
    /// More height above ground, and below the ceiling, metres.
    pub clearance_m: f64,
    /// The part of `clearance_m` that a line over the ground asks for, which is never made smaller,
    /// metres.
    pub line_m: f64,
    /// Less height above ground than the greatest, metres.
    pub under_m: f64,
    /// More distance from threats and zones, metres.
    pub threat_m: f64,
    /// More distance from earlier vehicles, horizontal and vertical, metres.
    pub separation_m: f64,
    /// More seconds by which earlier vehicles may be shifted, either way.
    pub shift_s: f64,
    /// Turn radius larger by this fraction of it.
    pub turn_fraction: f64,
    /// Slope limits smaller by this fraction of them.
    pub climb_fraction: f64,
}

impl Margins {
    /// The margins to least and greatest height above ground, smaller in a layer that has no
    /// space for both, metres.
    pub(crate) fn within_m(&self, layer_m: f64) -> (f64, f64) {
        /// Share of a layer that margins may take.
        const MAX: f64 = 0.8;
        let max_m = MAX * (layer_m - self.line_m);
        let more_m = self.clearance_m - self.line_m;
        let both_m = more_m + self.under_m;
        let share = match both_m > max_m {
            true => (max_m / both_m).max(0.0),
            false => return (self.clearance_m, self.under_m),
        };
        (self.line_m + share * more_m, share * self.under_m)
    }

    /// A separation with what is asked for beyond it.
    pub(crate) fn beyond(&self, separation: &Separation) -> Separation {
        Separation {
            distance_m: separation.distance_m + self.separation_m,
            vertical_m: separation
                .vertical_m
                .map(|vertical_m| vertical_m + self.separation_m),
            time_slack_s: separation.time_slack_s + self.shift_s,
        }
    }
}

/// What one route joins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RouteEnds {
    /// Where the route begins.
    pub from: PlanPoint,
    /// Where it ends.
    pub to: PlanPoint,
    /// When it begins, seconds after T0.
    pub start_s: f64,
}

/// Control points of a candidate, ends included, coordinate by coordinate, all finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls<'a> {
    /// Metres east.
    pub east_m: &'a [f64],
    /// Metres north.
    pub north_m: &'a [f64],
    /// Metres above mean sea level.
    pub amsl_m: &'a [f64],
}
