//! How planes and VTOLs fly mission items.

pub(crate) mod altitude_lag;
pub(crate) mod altitude_offsets;
pub(crate) mod drift;
pub(crate) mod items;
pub(crate) mod l1;
pub(crate) mod line;
pub(crate) mod loiter;
pub(crate) mod maneuvers;
pub(crate) mod overshoot;
