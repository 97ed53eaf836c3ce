//! Planning: the objective, the algorithms, vehicles alone and fleets, verdicts, studies.

#[path = "../support/mod.rs"]
mod support;

mod altitude_limits;
mod anytime;
mod assignment;
mod both_autopilots;
mod bound;
mod certificates;
mod cost;
mod cost_worlds;
mod determinism;
mod evaluate;
mod fleets;
mod hard_routes;
mod optimizers;
mod plan_fleet;
mod plan_verdicts;
mod shipped_missions;
mod stops;
mod stops_wings;
mod study;
mod study_fleet;
mod study_problems;
mod survey_cameras;
mod surveys;
mod tasks;
mod timed_zones;
