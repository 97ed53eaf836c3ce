//! Seeds are data: every random stream is derived from one printed number.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The one number a run depends on. Same seed, same bytes, any thread count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Seed(pub u64);

impl Seed {
    /// An independent random stream for one purpose and index.
    ///
    /// Each purpose and index has a stream of its own, so adding
    /// a vehicle at the end leaves those before it unchanged. `ChaCha8Rng` is
    /// named, because `StdRng` may change between releases of `rand`.
    #[must_use]
    pub fn stream(self, purpose: &str, index: u64) -> ChaCha8Rng {
        // FNV-1a of the purpose picks the key, the index the ChaCha stream.
        let key = purpose
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        let mut rng = ChaCha8Rng::seed_from_u64(self.0 ^ key);
        rng.set_stream(index);
        rng
    }
}

#[cfg(test)]
mod tests {
    use super::Seed;
    use rand::Rng;

    #[test]
    fn streams_repeat_and_differ_by_purpose_and_index() {
        let draw = |seed: u64, purpose, index| Seed(seed).stream(purpose, index).next_u64();
        assert_eq!(draw(1, "plan", 0), draw(1, "plan", 0));
        assert_ne!(draw(1, "plan", 0), draw(1, "plan", 1));
        assert_ne!(draw(1, "plan", 0), draw(1, "link", 0));
        assert_ne!(draw(1, "plan", 0), draw(2, "plan", 0));
    }
}
