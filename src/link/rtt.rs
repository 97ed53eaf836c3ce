//! Round-trip time estimator: how long to wait for an answer.

/// Wait before an item message is repeated while the link is unknown, milliseconds
/// (mission service guide: 250 ms).
const INITIAL_MS: u64 = 250;
/// Least margin over twice the round-trip time, milliseconds: the loop of the vehicle and
/// our machine. No repetition comes earlier, however quick the link is.
const MIN_MS: u64 = 100;
/// Longest wait before an item message is repeated, milliseconds.
const MAX_MS: u64 = 2000;

/// Round-trip time of a link, and the wait that follows from it.
///
/// A fixed wait of 250 ms would repeat every item on a slow radio, and the repeats would
/// slow it down further; on a quick link it would waste time. The estimate falls at once
/// and rises slowly, so that losses, which look like slowness, hardly move it.
#[derive(Clone, Copy, Debug)]
pub(super) struct RttEstimator {
    rtt_ms: Option<u64>,
    margin_ms: u64,
}

impl Default for RttEstimator {
    fn default() -> Self {
        Self {
            rtt_ms: None,
            margin_ms: MIN_MS,
        }
    }
}

impl RttEstimator {
    /// Takes in the time from the first message to its first answer.
    pub(super) fn sample(&mut self, after_ms: u64) {
        self.rtt_ms = Some(match self.rtt_ms {
            Some(before) => after_ms.min(before + before / 8 + 1),
            None => after_ms,
        });
    }

    /// Doubles the margin, because repetitions did harm.
    pub(super) fn back_off(&mut self) {
        self.margin_ms = (2 * self.margin_ms).min(MAX_MS / 2);
    }

    /// The wait before the next repetition, milliseconds.
    pub(super) fn wait_ms(self) -> u64 {
        let wait_ms = match self.rtt_ms {
            Some(rtt_ms) => 2 * rtt_ms + self.margin_ms,
            None => INITIAL_MS.max(self.margin_ms),
        };
        wait_ms.min(MAX_MS)
    }
}

#[cfg(test)]
mod tests {
    use super::RttEstimator;

    #[test]
    fn a_slow_link_is_given_time_and_losses_are_not_taken_for_slowness() {
        let mut slow = RttEstimator::default();
        (0..5).for_each(|_| slow.sample(600));
        assert_eq!(slow.wait_ms(), 1300);
        let mut lossy = RttEstimator::default();
        for after_ms in [20, 270, 20, 520, 270, 20] {
            lossy.sample(after_ms);
        }
        assert_eq!(lossy.wait_ms(), 140);
    }

    #[test]
    fn a_quick_link_is_repeated_sooner_than_an_unknown_one_and_less_often_after_harm() {
        let mut quick = RttEstimator::default();
        assert_eq!(quick.wait_ms(), 250);
        quick.sample(2);
        assert_eq!(quick.wait_ms(), 104);
        (0..9).for_each(|_| quick.back_off());
        assert_eq!(quick.wait_ms(), 1004);
    }
}
