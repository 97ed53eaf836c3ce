//! The air between a simulated vehicle and its ground stations: seeded loss and delay.

use std::collections::VecDeque;
use std::net::SocketAddr;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::link::Time;
use crate::numeric::Seed;

/// What happens to frames on their way, in each direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Weather {
    /// Probability that a frame is lost, 0 to 1.
    pub loss: f64,
    /// How long a frame takes, milliseconds.
    pub delay_ms: u64,
    /// Seed of the losses; every vehicle draws its own from it.
    pub seed: u64,
}

/// Frames on their way in one direction, oldest first.
#[derive(Debug)]
pub(crate) struct Air {
    weather: Weather,
    rng: ChaCha8Rng,
    flying: VecDeque<(Time, SocketAddr, Vec<u8>)>,
}

impl Air {
    /// One direction (`up` or `down`) of one vehicle's air.
    pub(crate) fn new(weather: Weather, sysid: u8, direction: &str) -> Self {
        Self {
            weather,
            rng: Seed(weather.seed).stream(direction, u64::from(sysid)),
            flying: VecDeque::new(),
        }
    }

    /// A frame sets out, or is lost.
    pub(crate) fn send(&mut self, now: Time, peer: SocketAddr, frame: Vec<u8>) {
        if self.weather.loss > 0.0 && self.rng.random_bool(self.weather.loss.min(1.0)) {
            return;
        }
        let arrival = now + self.weather.delay_ms;
        self.flying.push_back((arrival, peer, frame));
    }

    /// The next frame that has arrived.
    pub(crate) fn arrived(&mut self, now: Time) -> Option<(SocketAddr, Vec<u8>)> {
        if self.next_arrival()? > now {
            return None;
        }
        let (_, peer, frame) = self.flying.pop_front()?;
        Some((peer, frame))
    }

    /// When the next frame arrives.
    pub(crate) fn next_arrival(&self) -> Option<Time> {
        self.flying.front().map(|(arrival, ..)| *arrival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survivors(loss: f64, seed: u64) -> Vec<u8> {
        let weather = Weather {
            loss,
            delay_ms: 30,
            seed,
        };
        let mut air = Air::new(weather, 1, "up");
        let peer = SocketAddr::from(([127, 0, 0, 1], 1));
        (0..=255).for_each(|n| air.send(Time(u64::from(n)), peer, vec![n]));
        assert_eq!(air.arrived(Time(29)), None, "nothing is early");
        std::iter::from_fn(|| air.arrived(Time(1000)))
            .flat_map(|(_, frame)| frame)
            .collect()
    }

    #[test]
    fn frames_arrive_in_order_and_losses_follow_the_seed() {
        assert_eq!(survivors(0.0, 1), (0..=255).collect::<Vec<u8>>());
        assert_eq!(survivors(1.0, 1), Vec::<u8>::new());
        let some = survivors(0.25, 7);
        assert!((160..220).contains(&some.len()), "{}", some.len());
        assert!(some.is_sorted());
        assert_eq!(some, survivors(0.25, 7));
        assert_ne!(some, survivors(0.25, 8));
    }
}
