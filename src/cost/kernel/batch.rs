//! Many candidates at once, and the instructions they are worked off with.

use fearless_simd::Level;

use crate::cost::Controls;

/// Control points of many candidates.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    controls: usize,
    /// Candidate after candidate: all east, all north, all altitudes.
    values: Vec<f64>,
}

impl Batch {
    /// An empty batch of splines with `controls` control points, ends included.
    #[must_use]
    pub fn new(controls: usize) -> Self {
        Self {
            controls,
            values: Vec::new(),
        }
    }

    /// Forgets all candidates, and keeps the memory.
    pub fn clear(&mut self, controls: usize) {
        self.controls = controls;
        self.values.clear();
    }

    /// Adds a candidate.
    ///
    /// # Panics
    /// When a coordinate has fewer numbers than the batch has control points.
    pub fn push(&mut self, controls: &Controls<'_>) {
        for values in [controls.east_m, controls.north_m, controls.amsl_m] {
            self.values.extend_from_slice(&values[..self.controls]);
        }
    }

    /// Number of candidates.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len() / (3 * self.controls).max(1)
    }

    /// Whether there is no candidate.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Control points of each, ends included.
    pub(crate) fn controls(&self) -> usize {
        self.controls
    }

    /// One candidate.
    pub(crate) fn candidate(&self, index: usize) -> Controls<'_> {
        let values = &self.values[3 * self.controls * index..][..3 * self.controls];
        let (east_m, others) = values.split_at(self.controls);
        let (north_m, amsl_m) = others.split_at(self.controls);
        Controls {
            east_m,
            north_m,
            amsl_m,
        }
    }
}

/// A set of processor instructions. All give the same bits; they differ in speed.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch(pub(crate) Level);

impl Dispatch {
    /// The fastest this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self(Level::new())
    }

    /// All this processor has, the slowest first.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let best = Level::new();
        #[cfg(target_arch = "x86_64")]
        let lesser = [
            best.as_sse2().map(Level::Sse2),
            best.as_sse4_2().map(Level::Sse4_2),
            best.as_avx2().map(Level::Avx2),
            best.as_avx512().map(Level::Avx512),
        ];
        #[cfg(not(target_arch = "x86_64"))]
        let lesser = [Some(best)];
        lesser.into_iter().flatten().map(Self).collect()
    }

    /// Its name, such as `avx2`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Sse2(_) => "sse2",
            #[cfg(target_arch = "x86_64")]
            Level::Sse4_2(_) => "sse4.2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => "avx512",
            #[cfg(target_arch = "aarch64")]
            Level::Neon(_) => "neon",
            _ => "baseline",
        }
    }
}
