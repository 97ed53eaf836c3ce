//! The clocks that a flight needs: real vehicles fly in real time.

use std::cell::Cell;
use std::sync::OnceLock;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::link::Time;

/// Milliseconds since 1970 on the wall's clock.
#[must_use]
#[expect(
    clippy::disallowed_methods,
    reason = "records carry the time they were made"
)]
pub fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
    })
}

/// A time on the clock that runs since the computer was started, which nobody sets.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BootTime {
    /// Which start of the computer: another one begins another clock.
    pub id: String,
    /// Milliseconds since it.
    pub ms: u64,
}

impl BootTime {
    /// Now, where the system has such a clock for all of its processes: on Linux.
    #[must_use]
    pub fn now() -> Option<Self> {
        uptime_ms()?;
        let id = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
        Some(Self {
            id: id.trim().to_owned(),
            ms: steady_ms(),
        })
    }
}

/// Milliseconds on a clock that nobody sets, the same one for every process of this computer. Where the system has
/// none: that of the wall at the begin of the process, and evenly on from it.
#[must_use]
pub fn steady_ms() -> u64 {
    static BEGAN: OnceLock<(Instant, u64)> = OnceLock::new();
    let (instant, began_ms) =
        BEGAN.get_or_init(|| (now(), next_uptime_ms().unwrap_or_else(unix_ms)));
    let even_ms = began_ms + millis(instant);
    // The other clock stands still while the computer sleeps.
    match uptime_ms() {
        Some(up_ms) if up_ms > even_ms + SLEPT_MS => up_ms,
        _ => even_ms,
    }
}

/// A computer that is behind by more than this has slept, milliseconds.
const SLEPT_MS: u64 = 1000;

/// Milliseconds since the computer was started, to ten of them.
fn uptime_ms() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/uptime").ok()?;
    let (seconds, hundredths) = text.split_whitespace().next()?.split_once('.')?;
    let seconds: u64 = seconds.parse().ok()?;
    let hundredths: u64 = hundredths.get(..2)?.parse().ok()?;
    Some(1000 * seconds + 10 * hundredths)
}

/// The same at its next step, so that it is known to a millisecond.
fn next_uptime_ms() -> Option<u64> {
    let first_ms = uptime_ms()?;
    let mut ms = first_ms;
    while ms == first_ms {
        ms = uptime_ms()?;
    }
    Some(ms)
}

#[expect(
    clippy::disallowed_methods,
    reason = "vehicles fly in real time; the state machines take time as a value"
)]
fn now() -> Instant {
    Instant::now()
}

fn millis(since: &Instant) -> u64 {
    u64::try_from(since.elapsed().as_millis()).unwrap_or(u64::MAX)
}

/// Time since a command began. The time in which the computer sleeps counts: vehicles fly on.
#[derive(Debug)]
pub(super) struct Clock {
    began: Instant,
    began_up_ms: Option<u64>,
    /// Milliseconds that it slept.
    slept_ms: Cell<u64>,
}

impl Clock {
    pub(super) fn start() -> Self {
        Self {
            began: now(),
            began_up_ms: uptime_ms(),
            slept_ms: Cell::new(0),
        }
    }

    /// Looks whether the computer has slept.
    pub(super) fn look(&self) {
        if let (Some(began_ms), Some(up_ms)) = (self.began_up_ms, uptime_ms()) {
            let slept_ms = slept_ms(up_ms.saturating_sub(began_ms), millis(&self.began));
            self.slept_ms.set(slept_ms.max(self.slept_ms.get()));
        }
    }

    pub(super) fn now(&self) -> Time {
        Time(millis(&self.began) + self.slept_ms.get())
    }

    pub(super) fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }
}

/// How long a computer slept that was up for one time and ran for another, milliseconds.
fn slept_ms(up_ms: u64, ran_ms: u64) -> u64 {
    let slept_ms = up_ms.saturating_sub(ran_ms);
    if slept_ms > SLEPT_MS { slept_ms } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::{BootTime, slept_ms, steady_ms};

    #[test]
    fn the_time_in_which_a_computer_sleeps_counts_and_its_ticks_do_not() {
        assert_eq!(slept_ms(10_000, 9_992), 0);
        assert_eq!(slept_ms(9_990, 10_001), 0);
        assert_eq!(slept_ms(310_000, 10_000), 300_000);
    }

    #[test]
    fn a_steady_clock_goes_on_and_is_that_of_this_start_of_the_computer() {
        let before_ms = steady_ms();
        std::thread::sleep(std::time::Duration::from_millis(30));
        let passed_ms = steady_ms() - before_ms;
        assert!((30..3000).contains(&passed_ms), "{passed_ms}");
        if let (Some(one), Some(two)) = (BootTime::now(), BootTime::now()) {
            assert_eq!(one.id, two.id);
        }
    }
}
