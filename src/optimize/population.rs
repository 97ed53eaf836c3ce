//! What algorithms with a population share.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// A point uniform in the unit cube.
pub(super) fn uniform(dimension: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    (0..dimension).map(|_| rng.random()).collect()
}

/// `part / whole`; 0 of nothing.
pub(super) fn share(part: usize, whole: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 iterations")]
    let share = part as f64 / whole.max(1) as f64;
    share
}
