//! A vehicle's own clock against that of the fleet.

/// How long the quickest message is remembered, milliseconds of the vehicle's time.
const WINDOW_MS: f64 = 10_000.0;

/// Where a vehicle's time since boot lies on the fleet's clock.
///
/// A position is stamped when it is measured and arrives later. The quickest of the
/// last messages shows the difference best: the others were only late.
#[derive(Clone, Debug, Default)]
pub(crate) struct Offset {
    /// Least differences of this window and of the one before it.
    least_ms: [Option<f64>; 2],
    window: f64,
}

impl Offset {
    /// The time on the fleet's clock of a stamp that arrived at `arrived_ms` of it.
    pub(crate) fn align(&mut self, boot_ms: f64, arrived_ms: f64) -> f64 {
        let window = (boot_ms / WINDOW_MS).floor();
        let is_restarted = window < self.window;
        if is_restarted || window > self.window + 1.0 {
            self.least_ms = [None, None];
        } else if window > self.window {
            self.least_ms = [None, self.least_ms[0]];
        }
        self.window = window;
        let found = arrived_ms - boot_ms;
        let least = self.least_ms[0].map_or(found, |least| least.min(found));
        self.least_ms[0] = Some(least);
        boot_ms + self.least_ms[1].map_or(least, |before| before.min(least))
    }
}

#[cfg(test)]
mod tests {
    use super::Offset;

    #[test]
    fn late_messages_keep_the_time_at_which_they_were_measured() {
        let mut offset = Offset::default();
        assert!((offset.align(1000.0, 5000.0) - 5000.0).abs() < 1e-9);
        assert!((offset.align(1200.0, 5900.0) - 5200.0).abs() < 1e-9);
        // A clock that runs slow is followed, later.
        for step in 0..500 {
            let boot = 1400.0 + 200.0 * f64::from(step);
            offset.align(boot, boot + 4100.0);
        }
        assert!((offset.align(200_000.0, 204_100.0) - 204_100.0).abs() < 1e-9);
        // The vehicle was started again.
        assert!((offset.align(100.0, 300_000.0) - 300_000.0).abs() < 1e-9);
    }
}
