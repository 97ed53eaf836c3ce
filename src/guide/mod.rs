//! The guide: how to write a mission, plan, review, upload and fly it.

#[doc = include_str!("spec.md")]
pub mod spec {}
#[doc = include_str!("keys.md")]
pub mod keys {}
#[doc = include_str!("tasks.md")]
pub mod tasks {}
#[doc = include_str!("plan.md")]
pub mod plan {}
#[doc = include_str!("fleets.md")]
pub mod fleets {}
#[doc = include_str!("review.md")]
pub mod review {}
#[doc = include_str!("upload.md")]
pub mod upload {}
#[doc = include_str!("fly.md")]
pub mod fly {}
#[doc = include_str!("replan.md")]
pub mod replan {}
#[doc = include_str!("terrain.md")]
pub mod terrain {}
#[doc = include_str!("airspace.md")]
pub mod airspace {}
#[doc = include_str!("study.md")]
pub mod study {}
#[doc = include_str!("flight_model.md")]
pub mod flight_model {}
#[doc = include_str!("glossary.md")]
pub mod glossary {}
#[doc = include_str!("library.md")]
pub mod library {}
#[doc = include_str!("design.md")]
pub mod design {}
#[doc = include_str!("decisions.md")]
pub mod decisions {}
#[doc = include_str!("troubleshooting.md")]
pub mod troubleshooting {}
