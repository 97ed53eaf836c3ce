//! The vehicle as a body: where it is, how fast, and what the air does to it.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::numeric::Seed;
use crate::simulator::parameters::Limits;
use crate::spec::Wind;

/// Standard deviation of the acceleration by gusts, for each m/s of wind, m/s^2.
const GUST_MPS2: f64 = 0.03;
/// How long a gust or an error of position lasts, seconds.
const MEMORY_S: f64 = 4.0;

/// A point mass; east, north (of the tangent plane at home) and altitude above the sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Body {
    pub(crate) at_m: [f64; 3],
    pub(crate) velocity_mps: [f64; 3],
}

impl Body {
    /// Goes towards a commanded velocity for a while, as fast as the accelerations allow.
    pub(crate) fn step(
        &mut self,
        demand_mps: [f64; 3],
        limits: &Limits,
        gust: [f64; 2],
        dt_s: f64,
    ) {
        let most = limits.accel_mps2.max(limits.corner_accel_mps2) * dt_s;
        let before = self.velocity_mps;
        let delta = [demand_mps[0] - before[0], demand_mps[1] - before[1]];
        let size = delta[0].hypot(delta[1]);
        let share = if size > most { most / size } else { 1.0 };
        for axis in 0..2 {
            self.velocity_mps[axis] += delta[axis] * share + gust[axis] * dt_s;
        }
        let max_z = limits.accel_z_mps2 * dt_s;
        self.velocity_mps[2] += (demand_mps[2] - before[2]).clamp(-max_z, max_z);
        for ((at, old), new) in self.at_m.iter_mut().zip(before).zip(self.velocity_mps) {
            *at += 0.5 * (old + new) * dt_s;
        }
    }
}

/// Gusts, and the error of the vehicle's own idea of where it is: both vary slowly.
#[derive(Clone, Debug)]
pub(crate) struct Weathering {
    rng: ChaCha8Rng,
    /// Standard deviations: gusts m/s^2, position m.
    gust_mps2: f64,
    noise_m: f64,
    gust: [f64; 2],
    error: [f64; 3],
}

impl Weathering {
    pub(crate) fn new(wind: Option<Wind>, noise_m: f64, seed: u64, sysid: u8) -> Self {
        Self {
            rng: Seed(seed).stream("flight", u64::from(sysid)),
            gust_mps2: wind.map_or(0.0, |wind| GUST_MPS2 * wind.speed_mps),
            noise_m,
            gust: [0.0; 2],
            error: [0.0; 3],
        }
    }

    /// Goes on for a while (a Gauss-Markov process).
    pub(crate) fn step(&mut self, dt_s: f64) {
        let keep = (-dt_s / MEMORY_S).exp();
        let fresh = (1.0 - keep * keep).sqrt();
        if self.gust_mps2 > 0.0 {
            for axis in 0..2 {
                let drawn = self.gust_mps2 * self.normal();
                self.gust[axis] = keep * self.gust[axis] + fresh * drawn;
            }
        }
        if self.noise_m > 0.0 {
            for axis in 0..3 {
                let drawn = self.noise_m * self.normal();
                self.error[axis] = keep * self.error[axis] + fresh * drawn;
            }
        }
    }

    /// The acceleration by the present gust, m/s^2.
    pub(crate) fn gust(&self) -> [f64; 2] {
        self.gust
    }

    /// How fast the air moves in the present gust, m/s: so much that what is carried by it is
    /// accelerated as above.
    pub(crate) fn gust_mps(&self) -> [f64; 2] {
        self.gust.map(|gust| gust * MEMORY_S)
    }

    /// Where the vehicle thinks it is.
    pub(crate) fn sensed(&self, at_m: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| at_m[axis] + self.error[axis])
    }

    /// A draw of the standard normal distribution (Box and Muller).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.rng.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.rng.random::<f64>()).cos()
    }
}
