//! Where a candidate's spline is read.

use crate::numeric::Basis;
use crate::spec::{MissionSpec, Objective};

/// Most ground readings for each piece between two samples.
pub(super) const MAX_SUBSTEPS: usize = 4;

/// Where a candidate's spline is read.
#[derive(Clone, Debug)]
pub(super) struct Sampling {
    /// Samples, with `substeps - 1` more between each two.
    pub(super) fine: Basis,
    /// The same, sample by sample.
    pub(super) rows: Vec<(usize, [f64; 4])>,
    pub(super) substeps: usize,
    /// Number of samples proper, k.
    pub(super) samples: usize,
}

impl Sampling {
    pub(super) fn new(
        spec: &MissionSpec,
        parameters: &[f64],
        straight_m: f64,
        spacing_m: f64,
    ) -> Self {
        let samples = parameters.len();
        let substeps = match spec.planner.objective {
            Objective::Operational => substeps(straight_m, samples, spacing_m),
            Objective::Paper => 1,
        };
        let mut fine = Vec::with_capacity((samples - 1) * substeps + 1);
        for pair in parameters.windows(2) {
            #[expect(clippy::cast_precision_loss, reason = "few steps")]
            let share = |step: usize| step as f64 / substeps as f64;
            fine.extend((0..substeps).map(|step| pair[0] + (pair[1] - pair[0]) * share(step)));
        }
        fine.extend(parameters.last());
        let fine = Basis::new(spec.planner.control_points + 2, &fine);
        Self {
            rows: (0..fine.samples()).map(|k| fine.row(k)).collect(),
            fine,
            substeps,
            samples,
        }
    }

    pub(super) fn per_substep(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "few steps")]
        let substeps = self.substeps as f64;
        1.0 / substeps
    }
}

/// Ground readings for each piece, so that a path a fifth longer than the
/// straight one is read about once a cell of the ground.
fn substeps(straight_m: f64, samples: usize, spacing_m: f64) -> usize {
    #[expect(clippy::cast_precision_loss, reason = "few samples")]
    let piece_m = 1.2 * straight_m / (samples - 1) as f64;
    let found = (1..MAX_SUBSTEPS).find(|&substeps| {
        #[expect(clippy::cast_precision_loss, reason = "few steps")]
        let reach_m = spacing_m * substeps as f64;
        piece_m <= reach_m
    });
    found.unwrap_or(MAX_SUBSTEPS)
}
