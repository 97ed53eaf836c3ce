//! The ways that wings fly around corners: each law asks for an acceleration across, the wing banks late and slips, and
//! overshoots. [`super::l1`] is that of ArduPlane, [`super::npfg`] that of PX4.

use crate::autopilot::{Autopilot, Version};
use crate::geodesy::{Amsl, EastNorth};
use crate::mission::VehicleMission;
use crate::spec::{GRAVITY_MPS2, Vehicle};

use super::STEP_S;
use super::l1::L1;
use super::line::Line;
use super::npfg::Npfg;
use crate::verify::execute::legs::Knot;

/// A way that comes to a place along a line is looked at from this long before its turn there, seconds.
const LEAD_S: f64 = 1.0;

/// What steers a wing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guidance {
    pub(super) law: Law,
    /// Speed through the air, as a share of that of the leg.
    pub(super) pace: f64,
    /// It may be faster than planned by this share.
    pub(super) faster_share: f64,
    /// In wind, or slower by this share.
    pub(super) slower_share: f64,
    pub(super) bank_rad: f64,
    /// Share of a coordinated turn that turns the wing.
    pub(super) turning_share: f64,
    /// How long an error of bank lasts, seconds.
    pub(super) bank_lag_s: f64,
    /// What the air moves with, m/s east and north; none in still air.
    pub(super) wind_mps: Option<[f64; 2]>,
}

/// The law of an autopilot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    L1(L1),
    Npfg(Npfg),
}

/// A way that was flown.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Way {
    pub(crate) fixes: Vec<Fix>,
    /// Slower than planned: how late that makes it is in other figures.
    pub(super) is_slower: bool,
    /// Somewhere on it the wing might have turned to the other side.
    turns_either_way: bool,
}

/// A place on the way, and the leg that it is flown to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fix {
    pub(crate) leg: usize,
    pub(crate) at: EastNorth,
    /// Seconds since the first knot.
    pub(crate) t_s: f64,
    /// Distance from the place to the line of its leg or of the one before, whichever is less,
    /// metres.
    pub(crate) cross_track_m: f64,
}

/// The state of the wing.
struct Wing {
    at: [f64; 2],
    /// Of the motion through the air, radians counter-clockwise from east.
    heading_rad: f64,
    bank_rad: f64,
    integral_rad: f64,
    turns_either_way: bool,
    /// Whether it heads for the end of its leg from wherever it is.
    is_homing: bool,
    /// Over the ground, as a unit vector and a speed.
    motion: ([f64; 2], f64),
}

impl Guidance {
    /// The guidance of a mission's vehicle; only a wing has one.
    pub(crate) fn of(vehicle: &Vehicle, mission: &VehicleMission) -> Option<Self> {
        let facts = mission.facts();
        let version = mission.autopilot_version;
        let turning_share = facts.behaviour.turning_share.of(version)?.value;
        let held = |name: &str| mission.param_si(name).filter(|value| *value > 0.0);
        let (law, bank) = match mission.autopilot {
            Autopilot::ArduPilot => (Law::L1(L1::of(mission)?), "ROLL_LIMIT_DEG"),
            Autopilot::Px4 => (Law::Npfg(Npfg::of(mission)?), "FW_R_LIM"),
        };
        let planned_rad = (1.0 / vehicle.max_load_factor).acos();
        Some(Self {
            law,
            pace: 1.0,
            faster_share: facts.behaviour.faster_share.value(version),
            slower_share: facts.behaviour.slower_share.value(version),
            bank_rad: held(bank).map_or(planned_rad, f64::to_radians),
            turning_share,
            bank_lag_s: facts.behaviour.bank_lag_s.value(version),
            wind_mps: vehicle.carried_by().map(|wind| wind.velocity_mps()),
        })
    }

    /// The ways in which a version may fly along legs, each to be judged: to either side where the course is nearly opposite
    /// to the next leg, faster than planned (ArduPlane), and slower in wind or onto the next leg earlier (PX4).
    pub(crate) fn ways(self, version: Option<Version>, fly: impl Fn(Self) -> Way) -> Vec<Way> {
        let mut ways: Vec<Way> = Vec::new();
        for left in self.to_the_left(version) {
            let way = fly(left);
            let other = way.turns_either_way.then(|| fly(left.to_the_right()));
            for way in std::iter::once(way).chain(other) {
                if (ways.last()).is_none_or(|last| last.fixes != way.fixes) {
                    ways.push(way);
                }
            }
        }
        ways
    }

    /// The variants of a version, those that turn to the left where they may turn either way.
    pub(super) fn to_the_left(self, version: Option<Version>) -> Vec<Self> {
        let (laws, off_pace): (Vec<Law>, _) = match self.law {
            Law::L1(law) => (vec![Law::L1(law.to_the_left())], self.faster_share),
            Law::Npfg(law) => {
                // In still air a slower one turns within.
                let slower_share = self.wind_mps.map_or(0.0, |_| self.slower_share);
                (
                    law.variants(version).map(Law::Npfg).collect(),
                    -slower_share,
                )
            }
        };
        let paces = [Some(1.0), (off_pace.abs() > 0.0).then_some(1.0 + off_pace)];
        let ways = paces.into_iter().flatten().flat_map(|pace| {
            let laws = laws.iter();
            laws.map(move |&law| Self { law, pace, ..self })
        });
        ways.collect()
    }

    pub(super) fn to_the_right(self) -> Self {
        let law = match self.law {
            Law::L1(law) => Law::L1(law.to_the_right()),
            Law::Npfg(law) => Law::Npfg(law.to_the_right()),
        };
        Self { law, ..self }
    }

    /// Whether it flies straight at the first place after its takeoff, from where that ends.
    pub(crate) fn flies_straight_on(&self) -> bool {
        matches!(self.law, Law::L1(_))
    }

    /// The motion through the air, m/s, of a wing that makes a ground speed along a line.
    fn through_air(&self, line: &Line, ground_mps: f64) -> [f64; 2] {
        let [east_mps, north_mps] = self.wind_mps.unwrap_or_default();
        [
            line.unit[0] * ground_mps - east_mps,
            line.unit[1] * ground_mps - north_mps,
        ]
    }

    /// Its speed, m/s; in still air that over the ground to the last bit.
    fn air_mps(&self, line: &Line, ground_mps: f64) -> f64 {
        let [east_mps, north_mps] = self.through_air(line, ground_mps);
        match self.wind_mps {
            Some(_) => east_mps.hypot(north_mps),
            None => ground_mps,
        }
    }

    /// The motion over the ground, as a unit vector and a speed, of a wing on a heading.
    fn over_ground(&self, heading_rad: f64, air_mps: f64) -> ([f64; 2], f64) {
        let (sin, cos) = heading_rad.sin_cos();
        let Some([east_mps, north_mps]) = self.wind_mps else {
            return ([cos, sin], air_mps);
        };
        let ground = [air_mps * cos + east_mps, air_mps * sin + north_mps];
        let speed_mps = ground[0].hypot(ground[1]).max(1e-3);
        (ground.map(|part| part / speed_mps), speed_mps)
    }

    /// So far before a waypoint the next leg is turned onto.
    fn turn_distance_m(&self, turn_rad: f64, speed_mps: f64, at: Amsl) -> f64 {
        match self.law {
            Law::L1(law) => law.turn_distance_m(turn_rad, speed_mps, at),
            Law::Npfg(law) => law.turn_distance_m(speed_mps),
        }
    }

    /// The way along knots, begun at the first on the course of its leg, at a speed over the
    /// ground on each leg; ends past the last knot, or when it takes too long.
    pub(crate) fn follow(&self, knots: &[Knot], grounds_mps: &[f64]) -> Way {
        let lines = lines(knots);
        let turns: Vec<f64> = lines
            .windows(2)
            .map(|pair| pair[0].turn_rad(&pair[1]))
            .collect();
        match lines.first() {
            Some(first) => {
                let wing = self.on_line(first, first.from, grounds_mps[0]);
                self.fly((wing, &lines), (&turns, knots), grounds_mps)
            }
            None => Way::default(),
        }
    }

    /// The way of a wing from the first of some knots, where it is on a heading, straight at the next and along the
    /// legs from there.
    pub(crate) fn leave(&self, heading_rad: f64, knots: &[Knot], grounds_mps: &[f64]) -> Way {
        let lines = lines(knots);
        let turns = lines.windows(2).map(|pair| pair[0].turn_rad(&pair[1]));
        let turns: Vec<f64> = turns.collect();
        let Some(first) = lines.first() else {
            return Way::default();
        };
        let air_mps = self.pace * self.air_mps(first, grounds_mps[0]);
        let wing = Wing {
            heading_rad,
            is_homing: true,
            motion: self.over_ground(heading_rad, air_mps),
            ..self.on_line(first, first.from, grounds_mps[0])
        };
        self.fly((wing, &lines), (&turns, knots), grounds_mps)
    }

    /// The way of a wing that comes to the first of some knots along a line, from where it turns onto
    /// the leg after that. How far before it that is, ArduPlane takes from the legs of the mission:
    /// `turn_rad` is their change of course there.
    pub(crate) fn arrive(
        &self,
        (along, turn_rad): (Line, f64),
        knots: &[Knot],
        grounds_mps: &[f64],
    ) -> Way {
        let mut all = lines(knots);
        let (Some(first), Some(&ground_mps)) = (knots.first(), grounds_mps.first()) else {
            return Way::default();
        };
        let turns = std::iter::once(turn_rad);
        let turns = turns.chain(all.windows(2).map(|pair| pair[0].turn_rad(&pair[1])));
        let turns: Vec<f64> = turns.collect();
        let before_m = self.turn_distance_m(turn_rad, self.pace * ground_mps, Amsl(first.amsl_m));
        let begin = along.before_end((before_m + LEAD_S * ground_mps).min(along.length_m));
        let wing = self.on_line(&along, begin, ground_mps);
        all.insert(0, along);
        let grounds_mps: Vec<f64> = std::iter::once(ground_mps)
            .chain(grounds_mps.iter().copied())
            .collect();
        let mut knots_after = vec![*first];
        knots_after.extend(knots);
        let way = self.fly((wing, &all), (&turns, &knots_after), &grounds_mps);
        let turned = way.fixes.into_iter().filter_map(|fix| {
            let leg = fix.leg.checked_sub(1)?;
            Some(Fix { leg, ..fix })
        });
        Way {
            fixes: turned.collect(),
            ..way
        }
    }

    /// A wing on the course of a line, at a place on it.
    fn on_line(&self, line: &Line, at: EastNorth, ground_mps: f64) -> Wing {
        let [east_mps, north_mps] = match self.wind_mps {
            Some(_) => self.through_air(line, ground_mps),
            None => line.unit,
        };
        let heading_rad = north_mps.atan2(east_mps);
        Wing {
            at: [at.east_m, at.north_m],
            heading_rad,
            bank_rad: 0.0,
            integral_rad: 0.0,
            turns_either_way: false,
            is_homing: false,
            motion: self.over_ground(heading_rad, self.pace * self.air_mps(line, ground_mps)),
        }
    }

    /// The way of a wing along lines between knots, with the changes of course between them.
    fn fly(
        &self,
        (mut wing, lines): (Wing, &[Line]),
        (turns_rad, knots): (&[f64], &[Knot]),
        grounds_mps: &[f64],
    ) -> Way {
        let min_s = lines.iter().zip(grounds_mps);
        let min_s: f64 = min_s.map(|(line, speed)| line.length_m / speed).sum();
        // What is the same all along a leg: how far before its end the next is turned onto, and the speed through the air.
        let of_leg = |leg: usize| {
            let (line, speed_mps): (&Line, f64) = (&lines[leg], grounds_mps[leg]);
            let before_m = turns_rad.get(leg).map_or(0.0, |turn_rad| {
                let at = Amsl(knots[leg + 1].amsl_m);
                self.turn_distance_m(*turn_rad, self.pace * speed_mps, at)
            });
            (line, before_m, self.pace * self.air_mps(line, speed_mps))
        };
        let bank_share = 1.0 - (-STEP_S / self.bank_lag_s).exp();
        let (mut t_s, mut leg, mut fixes) = (0.0, 0, Vec::new());
        let (mut line, mut before_m, mut air_mps) = of_leg(leg);
        while t_s < 2.0 * min_s + 60.0 {
            let gone_m = line.along(wing.at);
            if gone_m >= line.length_m || line.ends_within(before_m, wing.at) {
                leg += 1;
                wing.is_homing = false;
                if leg == lines.len() {
                    break;
                }
                (line, before_m, air_mps) = of_leg(leg);
                wing.motion = self.over_ground(wing.heading_rad, air_mps);
                continue;
            }
            let aims_along = match wing.is_homing {
                true => &Line::new(wing.place(), line.to),
                false => line,
            };
            wing.step(self, aims_along, (air_mps, bank_share));
            t_s += STEP_S;
            let own_m = line.cross_track_m(wing.at);
            let before = leg.checked_sub(1).map(|before| &lines[before]);
            fixes.push(Fix {
                leg,
                at: wing.place(),
                t_s,
                cross_track_m: before
                    .map_or(own_m, |other| other.cross_track_or_less_m(own_m, wing.at)),
            });
        }
        Way {
            fixes,
            is_slower: self.pace < 1.0,
            turns_either_way: wing.turns_either_way,
        }
    }
}

/// The legs between knots.
fn lines(knots: &[Knot]) -> Vec<Line> {
    let pairs = knots.windows(2);
    pairs
        .map(|pair| Line::new(pair[0].at, pair[1].at))
        .collect()
}

impl Wing {
    fn place(&self) -> EastNorth {
        let [east_m, north_m] = self.at;
        EastNorth { east_m, north_m }
    }

    /// One step along a leg, at a speed through the air, with the share of an error of bank that a step corrects.
    fn step(&mut self, guidance: &Guidance, line: &Line, (air_mps, bank_share): (f64, f64)) {
        let (demand_mps2, turns_either_way) = match guidance.law {
            Law::L1(law) => law.demand_mps2((line, self.at), self.motion, &mut self.integral_rad),
            Law::Npfg(law) => law.demand_mps2(
                (line, self.at),
                (self.heading_rad, air_mps, self.motion.1),
                guidance.wind_mps.unwrap_or_default(),
            ),
        };
        self.turns_either_way |= turns_either_way;
        let demand_rad = (demand_mps2 / GRAVITY_MPS2).atan();
        let demand_rad = demand_rad.clamp(-guidance.bank_rad, guidance.bank_rad);
        self.bank_rad += (demand_rad - self.bank_rad) * bank_share;
        let across_mps2 = guidance.turning_share * GRAVITY_MPS2 * self.bank_rad.tan();
        self.heading_rad += across_mps2 / air_mps * STEP_S;
        self.motion = guidance.over_ground(self.heading_rad, air_mps);
        let (velocity, speed_mps) = self.motion;
        self.at[0] += speed_mps * velocity[0] * STEP_S;
        self.at[1] += speed_mps * velocity[1] * STEP_S;
    }
}
