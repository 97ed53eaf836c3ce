//! Experiments: the paper's (Shi, Zhang, Xia 2020, section 4), the planner against the best
//! known plans, growth with the fleet, and the speed of the objective.

mod document;
mod draw;
mod family;
mod fleet;
mod paper;
mod planner;
mod scenario;
mod setting;
mod speed;
mod stats;
mod store;
mod workers;

pub use family::Family;
pub use fleet::{
    DELIVERY_TERRAIN, Deliveries, FleetError, FleetFolder, FleetGrowth, FleetRun, MAX_DELIVERIES,
    deliveries, delivery_ground,
};
pub use paper::{
    Config, ConfigError, Contestant, Job, MapText, Method, Protocol, Record, Results, Role,
    VehicleRecord, ablations, contestants, readings, results_md, run, shipped_maps, write_results,
};
pub use planner::{
    Arena, BestKnown, Known, MissionText, PlannerJob, PlannerRun, PlannerStudy, planner_json,
    planner_md, run_planner, variants,
};
pub use scenario::{MAX_DIFFICULTY, scenario};
pub use setting::Setting;
pub use speed::{Level, Population, Rates, Speed, SpeedCourse, speed};
pub use stats::{Summary, friedman, rank_sum_p};
pub use store::{Progress, Store, StoreError, Study, merge, read_kind, write_whole};
