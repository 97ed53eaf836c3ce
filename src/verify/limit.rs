//! Limits as data: what a margin is about, and how each part of the program treats it.
//!
//! # Adding a limit
//!
//! Example: the greatest distance from home. (The distance flown is [`Limit::Endurance`].)
//!
//! 1. A variant of [`Limit`], its text in `Display` and its row in `Limit::class`: the compiler asks
//!    for both. The row states the [`Topic`] (tables and pages), the [`Repair`] (planning again) and
//!    the [`Basis`] (review without a spec). A limit with a buffer also needs `Limit::buffer_of`,
//!    whose default is 0.
//! 2. Only for a new `Topic`, `Repair` or `Basis`: `report/words.rs`, `cli/plan.rs` (`has_column`, and
//!    `more_columns` by hand), `dispatch/tighten.rs`, `cli/review/without_spec/given.rs` (`BY_FLAG` by
//!    hand).
//! 3. The measurement: a margin in `verify/limits/` for missions, with its line in `MissionCheck::margins`, which calls it,
//!    and in `flight/conformance/` for flown tracks. Where the flight model changes, its text in `verify/mod.rs` and
//!    `tools/check_missions.py`.
//! 4. In flight: a live alarm, where one is due, in `flight/alarms/`, and the way of a return in
//!    `flight/alarms/order_safety.rs`. Where a path may fail for it: `plan/diagnosis/`.
//! 5. Its key (see [`crate::spec`]), and a term in `cost/` if planning respects it.

use crate::spec::Buffers;
use Topic::Other;
use std::fmt;
use std::mem::discriminant;

/// One limit that missions or flown tracks are judged against. Its text, as in `review.json`, is
/// its `Display`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Limit {
    /// Height above the ground on the route.
    TerrainClearance,
    /// Height above the ground on the climb-out and the glide of a plane.
    TakeoffLandingClearance,
    /// Height above the ground in the column of a vertical takeoff or landing.
    GroundContact,
    /// Least altitude above home on the route, where the ground is not known.
    AboveHome,
    /// Greatest altitude.
    Ceiling,
    /// Greatest height above the ground, everywhere.
    MaxHeight,
    /// Least altitude on the route.
    MinAltitude,
    /// Distance to the threat with this id.
    Threat(String),
    /// Distance to the no-fly zone with this id.
    Zone(String),
    /// Distance of two vehicles.
    Separation,
    /// Distance of a landing to a vehicle that stands there, or how long that one is down before.
    LandingPlace,
    /// Distance to the edge of the area.
    Area,
    /// Distance to the fence of the mission.
    Fence,
    /// Whether the fence of the mission holds the fence of the spec.
    FenceComplete,
    /// Distance of the flight to boundaries of the fence that are wider than those of the spec.
    FenceWider,
    /// Distance of the flight and its ways back to a boundary that the fence leaves out, such as
    /// `zone town`.
    FenceLeftOut(String),
    /// Height of a rally point above the ground; rally points count from 1.
    RallyClearance(usize),
    /// Altitude of a rally point under the ceiling and the greatest height above ground.
    RallyCeiling(usize),
    /// Distance of a rally point to threats and zones.
    RallyObstacles(usize),
    /// Distance of a rally point to the edge of the area.
    RallyArea(usize),
    /// Distance of a rally point to the fence.
    RallyFence(usize),
    /// Distance of the home row to the home of the spec.
    HomePosition,
    /// Altitude of the home row against the ground.
    HomeAltitude,
    /// Distance of the home row to the fence.
    HomeFence,
    /// Distance of the first position of the route to the start of the spec.
    Start,
    /// Distance of the route to the goal of the spec.
    Goal,
    /// Distance of the nearest rest to the stop with this id.
    Stop(String),
    /// Time that the vehicle rests at the stop with this id.
    StopHold(String),
    /// What the mission does not do at the stop with this id.
    StopActions(String),
    /// Items that move a load where nothing that the vehicle does asks for it.
    StrayActions,
    /// Legs from start to goal without pictures along the way, or after it with them.
    CameraTrigger,
    /// Places of the task with this id that one vehicle visits in their order.
    Task(String),
    /// Share of the area of the task with this id that is seen at the overlap asked for.
    AreaCovered(String),
    /// By how much what is done for the task with this id begins outside of its window.
    TaskWindow(String),
    /// Distance of the end of the mission to where the spec ends it.
    Finish,
    /// Delay before the takeoff.
    Departure,
    /// Commanded speed.
    Speed,
    /// Speed through the air that a copter needs, on its way and where it hovers, against the one that it is known to reach at the
    /// lean angle that its parameters allow.
    FlyableSpeed,
    /// Climb angle on the route.
    ClimbAngle,
    /// Descent angle on the route.
    DescentAngle,
    /// Vertical speed upwards.
    ClimbSpeed,
    /// Vertical speed downwards.
    DescentSpeed,
    /// What the turns leave of each leg.
    TurnFit,
    /// Course of the takeoff of a plane.
    TakeoffHeading,
    /// Course of the landing of a plane.
    LandingHeading,
    /// Slope of the glide of a plane.
    GlideAngle,
    /// Radius of a circle of a wing: of the last one that of the spec, of all what it can turn.
    LoiterRadius,
    /// Whether the wind of the spec is the one that the model of a wing has.
    Wind,
    /// Within how far of a waypoint a copter may cut the corner, against the margin of its fence.
    FenceMargin,
    /// Acceptance radius of waypoints on PX4.
    AcceptanceRadius,
    /// Whether the autopilot accepts and understands the mission.
    Acceptance,
    /// Time, distance or energy from takeoff to touchdown.
    Endurance,
    /// Number of items.
    ItemCount,
    /// Number of items that the flight model can fly.
    ItemsJudged,
    /// Whether the mission is for the autopilot and airframe of the spec.
    Autopilot,
    /// Whether each vehicle has one mission.
    Mission,
    /// Whether the path of a vehicle can be encoded as a mission.
    Encoding,
    /// Whether planning found a path that satisfies every limit.
    Path,
    /// Whether the items ahead of a vehicle in the air are in order.
    ItemsAhead,
    /// A limit of flown tracks alone.
    Flown(Flown),
}

/// A limit that only a flown track is judged against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Flown {
    /// Whether the record holds any position.
    Recorded,
    /// Longest time without a position.
    Gap,
    /// Positions outside the area.
    OutsideArea,
    /// Distance of the first position to home.
    FirstPosition,
    /// Speed between two positions.
    Leap,
    /// Cross-track error.
    CrossTrack,
    /// Altitude error.
    Altitude,
    /// Waypoints that were not passed.
    WaypointsMissed,
    /// Least distance to the goal of the spec.
    Goal,
    /// Distance of the last position to where the spec ends.
    Finish,
    /// Distance of the last position to the end of the plan.
    PlannedEnd,
    /// Height of the last position above the ground.
    Landed,
    /// Speed at the last position.
    LastSpeed,
    /// Angle flown on the loiter circle.
    CircleTurned,
    /// When the flight ended, or whether it ended as planned.
    End,
    /// Ground speed over some seconds.
    GroundSpeed,
    /// Distance covered against the speed that the vehicle reports.
    ReportedSpeed,
    /// Climb rate over some seconds.
    ClimbRate,
    /// Descent rate over some seconds.
    DescentRate,
}

/// What tables and pages show a limit under.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Height above the ground on the route.
    Clearance,
    /// Greatest height above the ground on the route.
    Height,
    /// Distance between vehicles.
    Separation,
    /// Distance to threats.
    Threat,
    /// Distance to no-fly zones.
    Zone,
    /// Time, distance or energy used.
    Endurance,
    /// Listed in full tables only.
    Other,
}

/// What planning again can make stricter to satisfy a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repair {
    /// Vertical buffer to ground and ceiling.
    Clearance,
    /// Vertical buffer under the greatest height above ground.
    Height,
    /// Horizontal buffer to threats, zones, the area and the fence.
    Obstacle,
    /// Buffer between vehicles, in distance or time.
    Separation,
    /// Share of the climb and descent limits that is not used.
    Slope,
    /// Share by which turns are wider.
    Turn,
}

/// What must be given to judge a limit without a spec.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Nothing but the mission.
    Mission,
    /// Nothing, and only the lack of a home row is a violation.
    HomeRow,
    /// A spec: against values taken from the mission itself it holds always.
    Spec,
    /// An elevation model.
    Terrain,
    /// The greatest altitude.
    Ceiling,
    /// The least distance between vehicles.
    Separation,
    /// The steepest climb.
    ClimbAngle,
    /// The steepest descent.
    DescentAngle,
    /// The greatest climb rate.
    ClimbSpeed,
    /// The greatest descent rate.
    DescentSpeed,
    /// The load factor in turns.
    TurnRadius,
}

impl Limit {
    /// What tables and pages show it under.
    #[must_use]
    pub fn topic(&self) -> Topic {
        self.class().0
    }

    /// What planning again can make stricter, if anything.
    #[must_use]
    pub fn repair(&self) -> Option<Repair> {
        self.class().1
    }

    /// What must be given to judge it without a spec.
    #[must_use]
    pub fn basis(&self) -> Basis {
        self.class().2
    }

    /// What of its bound, in `unit`, is a buffer.
    pub(crate) fn buffer_of(&self, buffers: &Buffers, unit: &str) -> f64 {
        match self {
            Self::Threat(_) => buffers.threats_m,
            Self::Area | Self::RallyArea(_) => buffers.area_m,
            Self::TerrainClearance | Self::RallyClearance(_) | Self::MinAltitude => {
                buffers.terrain_m
            }
            Self::Ceiling | Self::RallyCeiling(_) | Self::MaxHeight => buffers.ceiling_m,
            // In seconds where two are never in the air together.
            Self::Separation if unit == "m" => buffers.separation_m,
            // A rally point has that of the nearest obstacle already.
            _ => 0.0,
        }
    }

    /// Whether two limits differ in their ids at most.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Flown(one), Self::Flown(two)) => one == two,
            (one, two) => discriminant(one) == discriminant(two),
        }
    }

    /// One row for each limit. No wildcard: a new limit must state how it is treated.
    #[rustfmt::skip]
    fn class(&self) -> (Topic, Option<Repair>, Basis) {
        match self {
            Self::TerrainClearance => (Topic::Clearance, Some(Repair::Clearance), Basis::Terrain),
            Self::Ceiling => (Other, Some(Repair::Clearance), Basis::Ceiling),
            Self::RallyCeiling(_) => (Other, None, Basis::Ceiling),
            Self::MaxHeight => (Topic::Height, Some(Repair::Height), Basis::Spec),
            Self::MinAltitude => (Other, Some(Repair::Clearance), Basis::Spec),
            Self::Threat(_) => (Topic::Threat, Some(Repair::Obstacle), Basis::Mission),
            Self::Zone(_) => (Topic::Zone, Some(Repair::Obstacle), Basis::Mission),
            Self::Area => (Other, Some(Repair::Obstacle), Basis::Spec),
            Self::Fence => (Other, Some(Repair::Obstacle), Basis::Mission),
            Self::Separation => (
                Topic::Separation,
                Some(Repair::Separation),
                Basis::Separation,
            ),
            Self::LandingPlace => (Other, None, Basis::Separation),
            Self::ClimbAngle => (Other, Some(Repair::Slope), Basis::ClimbAngle),
            Self::DescentAngle => (Other, Some(Repair::Slope), Basis::DescentAngle),
            Self::ClimbSpeed => (Other, Some(Repair::Slope), Basis::ClimbSpeed),
            Self::DescentSpeed => (Other, Some(Repair::Slope), Basis::DescentSpeed),
            Self::TurnFit => (Other, Some(Repair::Turn), Basis::TurnRadius),
            Self::GroundContact
            | Self::HomeAltitude
            | Self::RallyClearance(_)
            | Self::RallyObstacles(_)
            | Self::RallyFence(_) => (Other, None, Basis::Terrain),
            Self::HomePosition => (Other, None, Basis::HomeRow),
            Self::Endurance => (Topic::Endurance, None, Basis::Spec),
            Self::Start | Self::Goal | Self::Stop(_) | Self::StopHold(_) | Self::StopActions(_)
            | Self::StrayActions | Self::CameraTrigger | Self::Task(_) | Self::AreaCovered(_) | Self::TaskWindow(_)
            | Self::Finish
            | Self::Departure | Self::Speed | Self::FlyableSpeed | Self::TakeoffHeading
            | Self::LoiterRadius | Self::ItemCount | Self::FenceMargin | Self::FenceComplete
            | Self::FenceWider | Self::FenceLeftOut(_) | Self::RallyArea(_) =>
                (Other, None, Basis::Spec),
            Self::TakeoffLandingClearance | Self::LandingHeading | Self::GlideAngle
            | Self::AboveHome | Self::HomeFence | Self::Wind | Self::AcceptanceRadius
            | Self::Acceptance | Self::ItemsJudged | Self::Autopilot | Self::Mission
            | Self::Encoding | Self::Path | Self::ItemsAhead | Self::Flown(_) =>
                (Other, None, Basis::Mission),
        }
    }
}

impl fmt::Display for Limit {
    #[rustfmt::skip]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Threat(id) => return write!(f, "threat {id}"),
            Self::Zone(id) => return write!(f, "zone {id}"),
            Self::Stop(id) => return write!(f, "stop {id}"),
            Self::StopHold(id) => return write!(f, "hold at stop {id}"),
            Self::StopActions(id) => return write!(f, "actions at stop {id}"),
            Self::Task(id) => return write!(f, "task {id}"),
            Self::AreaCovered(id) => return write!(f, "area covered of task {id}"),
            Self::TaskWindow(id) => return write!(f, "window of task {id}"),
            Self::FenceLeftOut(name) => return write!(f, "{name} left out of the fence"),
            Self::RallyClearance(point) => return write!(f, "rally {point}"),
            Self::RallyCeiling(point) => return write!(f, "ceiling of rally {point}"),
            Self::RallyObstacles(at) => return write!(f, "rally {at} to threats and zones"),
            Self::RallyArea(point) => return write!(f, "rally {point} in the area"),
            Self::RallyFence(point) => return write!(f, "rally {point} in the fence"),
            Self::Flown(flown) => return flown.fmt(f),
            Self::StrayActions => "load moved elsewhere",
            Self::CameraTrigger => "pictures along the way",
            Self::TerrainClearance => "terrain clearance",
            Self::TakeoffLandingClearance => "takeoff and landing clearance",
            Self::GroundContact => "ground contact",
            Self::AboveHome => "altitude above home",
            Self::Ceiling => "ceiling",
            Self::MaxHeight => "greatest height above ground",
            Self::MinAltitude => "least altitude",
            Self::Separation => "separation",
            Self::LandingPlace => "landing place",
            Self::Area => "area",
            Self::Fence => "fence",
            Self::FenceComplete => "fence complete",
            Self::FenceWider => "wider fence",
            Self::FenceMargin => "waypoint radius in the fence margin",
            Self::HomePosition => "home position",
            Self::HomeAltitude => "home altitude",
            Self::HomeFence => "home in the fence",
            Self::Start => "start", Self::Goal => "goal", Self::Finish => "finish",
            Self::Departure => "departure", Self::Speed => "speed",
            Self::FlyableSpeed => "airspeed",
            Self::ClimbAngle => "climb angle", Self::DescentAngle => "descent angle",
            Self::ClimbSpeed => "climb speed", Self::DescentSpeed => "descent speed",
            Self::TurnFit => "turn fit",
            Self::TakeoffHeading => "takeoff heading",
            Self::LandingHeading => "landing heading",
            Self::GlideAngle => "glide angle",
            Self::LoiterRadius => "loiter radius",
            Self::Wind => "wind",
            Self::AcceptanceRadius => "acceptance radius",
            Self::Acceptance => "acceptance",
            Self::Endurance => "endurance",
            Self::ItemCount => "item count",
            Self::ItemsJudged => "items judged",
            Self::Autopilot => "autopilot",
            Self::Mission => "mission",
            Self::Encoding => "encoding",
            Self::Path => "path",
            Self::ItemsAhead => "items ahead",
        })
    }
}

impl fmt::Display for Flown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Recorded => "flight",
            Self::Gap => "longest time without a position",
            Self::OutsideArea => "outside the area",
            Self::FirstPosition => "first position from home",
            Self::Leap => "speed between two positions",
            Self::CrossTrack => "cross-track error",
            Self::Altitude => "altitude error",
            Self::WaypointsMissed => "waypoints missed",
            Self::Goal => "nearest to its goal",
            Self::Finish => "last position from where the spec ends",
            Self::PlannedEnd => "last position from the planned end",
            Self::Landed => "last position from the ground",
            Self::LastSpeed => "last speed",
            Self::CircleTurned => "turned on its circle",
            Self::End => "end of the flight",
            Self::GroundSpeed => "ground speed held",
            Self::ReportedSpeed => "ground covered by its own speed",
            Self::ClimbRate => "climb rate held",
            Self::DescentRate => "descent rate held",
        })
    }
}
