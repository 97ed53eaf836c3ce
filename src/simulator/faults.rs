//! What may go wrong with a simulated vehicle, to try out those that watch it.

use crate::link::{Health, SystemStatus};
use crate::simulator::profile::Profile;
use crate::spec::Wind;

/// One thing that goes wrong from now on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The battery drains.
    BatteryDrain {
        /// Percent a second.
        percent_s: f64,
    },
    /// The positions that it sends stay the same; it flies on.
    FrozenPosition,
    /// The positions that it sends are off by so much to the east and the north; it flies on.
    Jump {
        /// To the east, metres.
        east_m: f64,
        /// To the north, metres.
        north_m: f64,
    },
    /// It reports that it is outside of its fence.
    FenceBreach,
    /// It reports that its position estimate is bad.
    BadEstimate,
    /// Its GPS loses the fix.
    NoFix,
    /// A wind that a copter cannot hold its speed in: it flies no faster through the air.
    Wind {
        /// The wind.
        wind: Wind,
        /// Its greatest airspeed, m/s.
        airspeed_mps: f64,
    },
}

/// The faults of one vehicle, and what they lead to.
#[derive(Clone, Debug)]
pub(crate) struct Faults {
    battery_percent: f64,
    drain_percent_s: f64,
    pub(crate) is_frozen: bool,
    /// By how much positions are off, east and north, metres.
    pub(crate) off_m: [f64; 2],
    is_breached: bool,
    is_bad: bool,
    has_fix: bool,
}

impl Faults {
    pub(crate) fn new() -> Self {
        Self {
            battery_percent: 100.0,
            drain_percent_s: 0.0,
            is_frozen: false,
            off_m: [0.0; 2],
            is_breached: false,
            is_bad: false,
            has_fix: true,
        }
    }

    pub(crate) fn take(&mut self, fault: Fault) {
        match fault {
            Fault::BatteryDrain { percent_s } => self.drain_percent_s = percent_s,
            Fault::FrozenPosition => self.is_frozen = true,
            Fault::Jump { east_m, north_m } => self.off_m = [east_m, north_m],
            Fault::FenceBreach => self.is_breached = true,
            Fault::BadEstimate => self.is_bad = true,
            Fault::NoFix => self.has_fix = false,
            Fault::Wind { .. } => {}
        }
    }

    /// Some time passes, seconds.
    pub(crate) fn pass(&mut self, time_s: f64) {
        let left = self.battery_percent - self.drain_percent_s * time_s;
        self.battery_percent = left.max(0.0);
    }

    /// What it reports of itself.
    pub(crate) fn reports(&self, profile: Profile) -> Vec<Health> {
        #[expect(clippy::cast_possible_truncation, reason = "0 to 100")]
        let remaining = self.battery_percent as i8;
        let fence = SystemStatus::GEOFENCE;
        let system = Health::System(SystemStatus {
            present: fence,
            enabled: fence,
            healthy: if self.is_breached { 0 } else { fence },
            voltage_mv: 12_600,
            remaining,
        });
        let gps = Health::Gps {
            fix: if self.has_fix { 3 } else { 1 },
            satellites: 12,
        };
        // Attitude, velocities, positions: all known.
        let flags = 0x3F;
        let spread = if self.is_bad { 1.6 } else { 0.1 };
        let values = [0.1, spread, 0.1, 0.1];
        match profile {
            Profile::ArduPilot => vec![
                system,
                gps,
                Health::Ekf {
                    variances: values,
                    flags,
                },
                Health::Fence {
                    is_breached: self.is_breached,
                    count: u16::from(self.is_breached),
                    kind: if self.is_breached { 3 } else { 0 },
                },
            ],
            Profile::Px4 => {
                let ratios = values;
                vec![system, gps, Health::Estimator { ratios, flags }]
            }
            Profile::Generic => vec![system],
        }
    }
}
