//! Alarms about what may change over and over: some of them within a period, then a count.

/// Changes that are said within a period, and the period, seconds.
const MAX_CHANGES: u32 = 5;
const PERIOD_S: f64 = 10.0;

/// What is said of something that changes.
#[derive(Debug, Default)]
pub(in crate::flight::alarms) struct Changes {
    said: Option<String>,
    /// When this period began, seconds after T0, and the changes in it.
    since_s: f64,
    count: u32,
    /// What was not said of the last of them.
    unsaid: Option<String>,
}

impl Changes {
    /// Whether it is another one than was said last, and shall be said.
    pub(in crate::flight::alarms) fn is_news(&mut self, t_s: f64, now: Option<&str>) -> bool {
        let Some(now) = now.filter(|now| Some(*now) != self.said.as_deref()) else {
            return false;
        };
        if self.count == 0 {
            self.since_s = t_s;
        }
        self.said = Some(now.to_owned());
        self.count = self.count.saturating_add(1);
        if self.count <= MAX_CHANGES {
            return true;
        }
        self.unsaid = Some(now.to_owned());
        false
    }

    /// How many were not said, in words, at the end of a period.
    pub(in crate::flight::alarms) fn poll(&mut self, t_s: f64) -> Option<String> {
        if t_s - self.since_s < PERIOD_S {
            return None;
        }
        let more = std::mem::take(&mut self.count).saturating_sub(MAX_CHANGES);
        let last = self.unsaid.take()?;
        Some(format!(
            "{last} (changed {more} more times within {PERIOD_S:.0} s)"
        ))
    }
}
