//! The clocks that a flight needs: real vehicles fly in real time.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

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

/// Time since a command began.
#[derive(Debug)]
pub(super) struct Clock(Instant);

impl Clock {
    pub(super) fn start() -> Self {
        #[expect(
            clippy::disallowed_methods,
            reason = "vehicles fly in real time; the state machines take time as a value"
        )]
        let began = Instant::now();
        Self(began)
    }

    pub(super) fn now(&self) -> Time {
        Time(u64::try_from(self.0.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    pub(super) fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}
