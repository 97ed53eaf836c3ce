//! Search, and nothing but search: it must not know what is optimised.

/// What an algorithm minimises: costs of points in the unit cube.
///
/// There is no randomness in it, so batches may be evaluated in any order and
/// on any number of threads with the same result.
pub trait Problem: Sync {
    /// Number of decision variables; each lies in `[0, 1]`.
    fn dimension(&self) -> usize;

    /// Costs of a batch.
    ///
    /// `candidates` is row-major, `costs.len()` rows of [`Self::dimension`].
    /// A cost above `cutoff` need not be exact, only above `cutoff`; pass
    /// `f64::INFINITY` for exact costs. A cost is never NaN.
    fn evaluate(&self, candidates: &[f64], cutoff: f64, costs: &mut [f64]);
}
