//! Messages in which a vehicle reports its own health: battery, position estimate, fence.

use super::fields::Fields;
use super::id;

/// One report of a vehicle about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Health {
    /// `SYS_STATUS` (1).
    System(SystemStatus),
    /// `GPS_RAW_INT` (24), the kind of fix alone.
    Gps {
        /// `GPS_FIX_TYPE`: from 3 on it has a position in space.
        fix: u8,
        /// Satellites in use; 255 when not known.
        satellites: u8,
    },
    /// `BATTERY_STATUS` (147).
    Battery {
        /// Which battery.
        id: u8,
        /// Percent left; -1 when not known.
        remaining: i8,
        /// `MAV_BATTERY_CHARGE_STATE`; 0 when not known.
        charge: u8,
    },
    /// `FENCE_STATUS` (162), of ArduPilot.
    Fence {
        /// Whether it is outside of its fence.
        is_breached: bool,
        /// Breaches so far.
        count: u16,
        /// `FENCE_BREACH` of the last one.
        kind: u8,
    },
    /// `EKF_STATUS_REPORT` (193), of ArduPilot.
    Ekf {
        /// Of velocity, horizontal position, altitude, compass: innovations against what the
        /// filter allows; 1 is its limit.
        variances: [f32; 4],
        /// `EKF_STATUS_FLAGS`.
        flags: u16,
    },
    /// `ESTIMATOR_STATUS` (230), of PX4.
    Estimator {
        /// Of velocity, horizontal position, altitude, compass: as in `EKF_STATUS_REPORT`.
        ratios: [f32; 4],
        /// `ESTIMATOR_STATUS_FLAGS`.
        flags: u16,
    },
}

/// `SYS_STATUS`: sensors and the battery.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SystemStatus {
    /// `MAV_SYS_STATUS_SENSOR` flags of what is on board.
    pub present: u32,
    /// Of what is in use.
    pub enabled: u32,
    /// Of what works.
    pub healthy: u32,
    /// Battery, millivolts.
    pub voltage_mv: u16,
    /// Percent of the battery left; -1 when not known.
    pub remaining: i8,
}

impl SystemStatus {
    /// `MAV_SYS_STATUS_GEOFENCE`.
    pub const GEOFENCE: u32 = 0x10_0000;

    /// Whether something is on board, in use, and does not work.
    #[must_use]
    pub fn is_bad(&self, sensor: u32) -> bool {
        self.present & self.enabled & !self.healthy & sensor != 0
    }
}

impl Health {
    /// The id of its message.
    #[must_use]
    pub fn id(&self) -> u32 {
        match self {
            Self::System(_) => id::SYS_STATUS,
            Self::Gps { .. } => id::GPS_RAW_INT,
            Self::Battery { .. } => id::BATTERY_STATUS,
            Self::Fence { .. } => id::FENCE_STATUS,
            Self::Ekf { .. } => id::EKF_STATUS_REPORT,
            Self::Estimator { .. } => id::ESTIMATOR_STATUS,
        }
    }

    /// A message of this id, for the layout to fill.
    pub(super) fn blank(of: u32) -> Option<Self> {
        Some(match of {
            id::SYS_STATUS => Self::System(SystemStatus::default()),
            id::GPS_RAW_INT => Self::Gps {
                fix: 0,
                satellites: 0,
            },
            id::BATTERY_STATUS => Self::Battery {
                id: 0,
                remaining: 0,
                charge: 0,
            },
            id::FENCE_STATUS => Self::Fence {
                is_breached: false,
                count: 0,
                kind: 0,
            },
            id::EKF_STATUS_REPORT => Self::Ekf {
                variances: [0.0; 4],
                flags: 0,
            },
            id::ESTIMATOR_STATUS => Self::Estimator {
                ratios: [0.0; 4],
                flags: 0,
            },
            _ => return None,
        })
    }

    /// Moves the fields between the message and a payload.
    pub(super) fn layout(&mut self, fields: &mut dyn Fields) {
        match self {
            Self::System(status) => {
                fields.u32(&mut status.present);
                fields.u32(&mut status.enabled);
                fields.u32(&mut status.healthy);
                fields.unused(&[0; 2]);
                fields.u16(&mut status.voltage_mv);
                fields.unused(&[0; 14]);
                signed(&mut status.remaining, fields);
            }
            Self::Gps { fix, satellites } => {
                fields.unused(&[0; 28]);
                fields.u8(fix);
                fields.u8(satellites);
            }
            Self::Battery {
                id,
                remaining,
                charge,
            } => {
                // Charge, energy, temperature, voltages, current.
                fields.unused(&[0; 32]);
                fields.u8(id);
                fields.unused(&[0; 2]);
                signed(remaining, fields);
                fields.unused(&[0; 4]);
                fields.u8(charge);
            }
            Self::Fence {
                is_breached,
                count,
                kind,
            } => {
                fields.unused(&[0; 4]);
                fields.u16(count);
                let mut status = u8::from(*is_breached);
                fields.u8(&mut status);
                *is_breached = status != 0;
                fields.u8(kind);
            }
            Self::Ekf { variances, flags } => {
                variances.iter_mut().for_each(|of| fields.f32(of));
                fields.unused(&[0; 4]);
                fields.u16(flags);
            }
            Self::Estimator { ratios, flags } => {
                fields.unused(&[0; 8]);
                ratios.iter_mut().for_each(|of| fields.f32(of));
                fields.unused(&[0; 16]);
                fields.u16(flags);
            }
        }
    }
}

fn signed(value: &mut i8, fields: &mut dyn Fields) {
    let mut byte = value.to_le_bytes();
    fields.bytes(&mut byte);
    *value = i8::from_le_bytes(byte);
}
