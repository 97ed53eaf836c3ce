//! Limits the rate of alarms about what may change over and over: some within a period, then a count.

/// Changes reported within a period, and the period, seconds.
const MAX_CHANGES: u32 = 5;
const PERIOD_S: f64 = 10.0;

/// Reports of something that changes: at most `MAX_CHANGES` a period, then their count.
#[derive(Debug, Default)]
pub(in crate::flight::alarms) struct RateLimited {
    reported: Option<String>,
    /// When this period began, seconds after T0, and the changes in it.
    since_s: f64,
    count: u32,
    /// The last change that was not reported.
    withheld: Option<String>,
}

impl RateLimited {
    /// Whether it is another one than was reported last, to be reported now.
    pub(in crate::flight::alarms) fn is_news(&mut self, t_s: f64, now: Option<&str>) -> bool {
        let Some(now) = now.filter(|now| Some(*now) != self.reported.as_deref()) else {
            return false;
        };
        if self.count == 0 {
            self.since_s = t_s;
        }
        self.reported = Some(now.to_owned());
        self.count = self.count.saturating_add(1);
        if self.count <= MAX_CHANGES {
            return true;
        }
        self.withheld = Some(now.to_owned());
        false
    }

    /// How many were withheld, in words, at the end of a period.
    pub(in crate::flight::alarms) fn poll(&mut self, t_s: f64) -> Option<String> {
        if t_s - self.since_s < PERIOD_S {
            return None;
        }
        let more = std::mem::take(&mut self.count).saturating_sub(MAX_CHANGES);
        let last = self.withheld.take()?;
        Some(format!(
            "{last} (changed {more} more times within {PERIOD_S:.0} s)"
        ))
    }
}
