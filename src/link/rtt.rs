//! How long to wait for an answer, learnt from the answers.

/// Wait before an item message is repeated, milliseconds, as long as nothing is known
/// about the link (mission service guide: 250 ms).
const FIRST_MS: u64 = 250;
/// What a vehicle's own loop and our machine may add to the turnaround, milliseconds:
/// no repetition comes earlier, however quick the link is.
const LEAST_MS: u64 = 100;
/// Longest wait before an item message is repeated, milliseconds.
const MOST_MS: u64 = 2000;

/// The time from a message to its answer, and the wait that follows from it.
///
/// A fixed 250 ms would repeat every item on a slow radio, and the repeats would
/// make it slower still; on a quick link it would only lose time. The estimate falls to a shorter time at once and rises to
/// a longer one slowly, so that losses, which look like slowness, hardly move it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    turnaround_ms: Option<u64>,
    least_ms: u64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            turnaround_ms: None,
            least_ms: LEAST_MS,
        }
    }
}

impl Pace {
    /// The first answer came so long after the first message.
    pub(super) fn answered(&mut self, after_ms: u64) {
        self.turnaround_ms = Some(match self.turnaround_ms {
            Some(before) => after_ms.min(before + before / 8 + 1),
            None => after_ms,
        });
    }

    /// Repetitions did harm: fewer of them from now on.
    pub(super) fn slow_down(&mut self) {
        self.least_ms = (2 * self.least_ms).min(MOST_MS / 2);
    }

    /// The wait before the next repetition, milliseconds.
    pub(super) fn wait_ms(self) -> u64 {
        let wait_ms = match self.turnaround_ms {
            Some(turnaround_ms) => 2 * turnaround_ms + self.least_ms,
            None => FIRST_MS.max(self.least_ms),
        };
        wait_ms.min(MOST_MS)
    }
}

#[cfg(test)]
mod tests {
    use super::Pace;

    #[test]
    fn a_slow_link_is_given_time_and_losses_are_not_taken_for_slowness() {
        let mut slow = Pace::default();
        (0..5).for_each(|_| slow.answered(600));
        assert_eq!(slow.wait_ms(), 1300);
        let mut lossy = Pace::default();
        for after_ms in [20, 270, 20, 520, 270, 20] {
            lossy.answered(after_ms);
        }
        assert_eq!(lossy.wait_ms(), 140);
    }

    #[test]
    fn a_quick_link_is_asked_again_sooner_than_an_unknown_one_and_less_often_after_harm() {
        let mut quick = Pace::default();
        assert_eq!(quick.wait_ms(), 250);
        quick.answered(2);
        assert_eq!(quick.wait_ms(), 104);
        (0..9).for_each(|_| quick.slow_down());
        assert_eq!(quick.wait_ms(), 1004);
    }
}
