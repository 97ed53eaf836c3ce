//! The paper's experiment (Shi, Zhang, Xia 2020, section 4), so that anyone can run it:
//! seven algorithms on three maps, every choice on record, judged finely afterwards.

mod account;
mod claims;
mod config;
mod contest;
mod convergence;
mod deliveries;
mod figures;
mod ground;
mod growth;
mod output;
mod page;
mod parts;
mod planner;
mod printed;
mod record;
mod runner;
mod scenario;
mod setting;
mod speed;
mod speed_course;
mod stats;
mod store;
mod svg;
mod tables;
mod view;

pub use account::results_md;
pub use config::{Config, ConfigError, MapText};
pub use contest::{Contestant, Method, Protocol, Role, ablations, contestants, readings};
pub use deliveries::{DELIVERY_TERRAIN, Deliveries, MOST_DELIVERIES, deliveries, delivery_ground};
pub use growth::{FleetGrowth, FleetRun};
pub use output::write_results;
pub use planner::{
    Arena, BestKnown, Known, MissionText, PlannerJob, PlannerRun, PlannerStudy, planner_json,
    planner_md, run_planner, variants,
};
pub use record::{Record, Terms, VehicleRecord};
pub use runner::{Job, run};
pub use scenario::{MOST_DIFFICULT, scenario};
pub use setting::Setting;
pub use speed::{Level, Paper, Speed, speed};
pub use speed_course::{Population, SpeedCourse};
pub use stats::{Summary, friedman, rank_sum_p};
pub use store::{Store, StoreError, Study, merge, read_kind, write_whole};
pub use tables::Results;

/// The maps that come with the program: name and text.
#[must_use]
pub fn shipped_maps() -> [(&'static str, &'static str); 3] {
    [
        ("s1.yaml", include_str!("../../missions/paper/s1.yaml")),
        ("s2.yaml", include_str!("../../missions/paper/s2.yaml")),
        ("s3.yaml", include_str!("../../missions/paper/s3.yaml")),
    ]
}

/// Which of the paper's three scenarios a map stands for, from 0: one of the shipped, with
/// either number of control points.
fn paper_scenario(text: &str) -> Option<usize> {
    let harder = [
        include_str!("../../missions/paper/s1-8.yaml"),
        include_str!("../../missions/paper/s2-8.yaml"),
        include_str!("../../missions/paper/s3-8.yaml"),
    ];
    let shipped = shipped_maps().into_iter().zip(harder);
    shipped
        .into_iter()
        .position(|((_, map), harder)| text == map || text == harder)
}
