//! The flight that the orders of one mission lead to.

use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::VehicleMission;
use crate::spec::{Autopilot, Vehicle};
use crate::world::{NoData, Stations, World};

use super::chord::{Chord, Phase, stretches};
use super::decode::{self, Height, Order, Step, Unknown};
use super::legs::{self, Knot, Piece, Run, Shape};
use super::surface::Surface;

/// A curved or accelerated piece is cut into chords that are never further off than this.
const CHORD_ERROR_M: f64 = 0.02;
/// Knots nearer than this are one place: two units of 1e-7 degrees.
const SAME_PLACE_M: f64 = 0.025;
/// Places further from the origin than this are beyond the local frame.
const REACH_M: f64 = 500_000.0;

/// How steep and how fast one leg is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slope {
    /// Index of the chord where the leg begins, for the place and time.
    pub(super) chord: usize,
    pub(super) phase: Phase,
    /// Horizontal length; 0 for a vertical motion, metres.
    pub(super) run_m: f64,
    /// Rise, negative down, metres.
    pub(super) rise_m: f64,
    /// Highest ground speed, m/s.
    pub(super) speed_mps: f64,
    /// Highest point, metres above the sea.
    pub(super) top_m: f64,
}

/// What a leg has left beside its fillets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    pub(super) chord: usize,
    pub(super) left_m: f64,
}

/// The speed a leg is commanded to be flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cruise {
    pub(super) chord: usize,
    /// `None`: neither the mission nor its parameters say.
    pub(super) speed_mps: Option<f64>,
}

/// A point of the route and when the vehicle is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) point: PlanPoint,
    pub(super) row: usize,
    pub(super) t_s: f64,
}

/// How the flight ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// Touches down here.
    Landed(EastNorth),
    /// Stays in the air for ever here.
    Stays(EastNorth),
}

/// One vehicle's flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Flight {
    /// In order of time, but for chords that are not flown.
    pub(super) chords: Vec<Chord>,
    pub(super) slopes: Vec<Slope>,
    pub(super) turns: Vec<Turn>,
    pub(super) cruises: Vec<Cruise>,
    /// Points of the route, from the first that can be the start to the last before the landing.
    pub(super) route: Vec<Mark>,
    /// Delay before takeoff in the items, seconds.
    pub(super) delay_s: Option<f64>,
    pub(super) end: Option<End>,
    /// From where on the flight is not known.
    pub(super) unknown: Option<Unknown>,
    /// Whether the altitude above ground is the vehicle's own doing somewhere.
    pub(super) follows_terrain: bool,
}

impl Flight {
    /// When the last motion that ends has ended, seconds.
    pub(super) fn last_s(&self) -> f64 {
        self.chords
            .iter()
            .flat_map(|chord| [chord.from_s, chord.to_s])
            .filter(|time| time.is_finite())
            .fold(0.0, f64::max)
    }

    /// Ends every stay at `horizon_s`.
    pub(super) fn stay_until(&mut self, horizon_s: f64) {
        for chord in &mut self.chords {
            if chord.to_s.is_infinite() {
                chord.to_s = horizon_s.max(chord.from_s);
            }
        }
    }
}

/// Flies a mission from a home (its place, and the altitude the autopilot measures from).
pub(super) fn fly(
    vehicle: &Vehicle,
    mission: &VehicleMission,
    world: &World,
    stations: &Stations,
    home: PlanPoint,
    tolerance_m: f64,
) -> Flight {
    let (steps, unread) = decode::decode(mission, home.amsl);
    let mut pilot = Pilot {
        vehicle,
        world,
        surface: Surface::new(&world.terrain),
        stations,
        tolerance_m,
        flight: Flight::default(),
        home,
        t_s: 0.0,
        airborne: false,
        ended: false,
        phase: Phase::Join,
        speed_mps: known_speed_mps(mission),
        knots: Vec::new(),
    };
    for step in &steps {
        if let Err(unknown) = pilot.obey(step, mission) {
            // What is flown before it is still judged; its own troubles come earlier.
            pilot.flight.unknown = pilot.stop().err().or(Some(unknown));
            return pilot.flight.settled();
        }
        if matches!(pilot.flight.end, Some(End::Stays(_))) {
            return pilot.flight.settled();
        }
    }
    let settled = if unread.is_some() {
        pilot.stop()
    } else {
        pilot.finish(steps.last().map_or(1, |step| step.row))
    };
    pilot.flight.unknown = settled.err().or(unread);
    pilot.flight.settled()
}

impl Flight {
    /// A flight whose numbers are not finite is not known from there on: every
    /// later step may take them for granted.
    fn settled(mut self) -> Self {
        let is_known = |chord: &Chord| {
            let ends = [chord.from, chord.to];
            chord.from_s.is_finite()
                && !chord.to_s.is_nan()
                && chord.error_m.is_finite()
                && ends
                    .iter()
                    .all(|end| (end.at.east_m + end.at.north_m + end.amsl.0).is_finite())
        };
        if let Some(first) = self.chords.iter().position(|chord| !is_known(chord)) {
            self.unknown = Some(Unknown {
                row: self.chords[first].row,
                why: "the motion comes out as not a number".to_owned(),
            });
            self.chords.truncate(first);
        }
        self
    }
}

/// The cruise speed that the mission's parameters set, m/s.
fn known_speed_mps(mission: &VehicleMission) -> Option<f64> {
    let of = |name: &str| {
        let found = mission.params.iter().find(|param| param.name == name)?;
        Some(f64::from(found.value))
    };
    match mission.autopilot {
        Autopilot::ArduPilot => of("WPNAV_SPEED").map(|cm| cm / 100.0),
        Autopilot::Px4 => of("MPC_XY_CRUISE"),
    }
    .filter(|speed| speed.is_finite() && *speed > 0.0)
}

struct Pilot<'a> {
    vehicle: &'a Vehicle,
    world: &'a World,
    surface: Surface<'a>,
    stations: &'a Stations,
    tolerance_m: f64,
    flight: Flight,
    home: PlanPoint,
    t_s: f64,
    airborne: bool,
    /// Landed or staying: nothing follows.
    ended: bool,
    phase: Phase,
    /// Commanded ground speed, if known.
    speed_mps: Option<f64>,
    /// Where the vehicle last stopped, and where it goes from there.
    knots: Vec<Knot>,
}

impl Pilot<'_> {
    fn obey(&mut self, step: &Step, mission: &VehicleMission) -> Result<(), Unknown> {
        let row = step.row;
        let unknown = |why: &str| {
            Err(Unknown {
                row,
                why: why.to_owned(),
            })
        };
        let moves = !matches!(step.order, Order::Nothing | Order::Speed { .. });
        if moves && self.ended {
            return unknown("the mission goes on after the landing");
        }
        match step.order {
            Order::Nothing => {}
            Order::Speed { speed_mps } => self.speed_mps = Some(speed_mps),
            Order::Wait { hold_s } if !self.airborne => {
                *self.flight.delay_s.get_or_insert(0.0) += hold_s;
            }
            Order::Wait { hold_s } => {
                self.stop()?;
                self.hold(row, hold_s);
            }
            Order::Takeoff { .. } if self.airborne => return unknown("a second takeoff"),
            Order::Takeoff { at, height } => self.take_off(row, at, height, mission.autopilot)?,
            _ if !self.airborne => return unknown("no takeoff before it"),
            Order::Fly { at, height, hold_s } => {
                self.head_for(row, at, height)?;
                if hold_s > 0.0 {
                    self.stop()?;
                    self.hold(row, hold_s);
                }
            }
            Order::Stay { at, height } => {
                self.head_for(row, at, height)?;
                self.finish(row)?;
            }
            Order::Land { at } => self.land(row, at)?,
            Order::Return => self.return_home(row, mission)?,
        }
        Ok(())
    }

    fn take_off(
        &mut self,
        row: usize,
        at: Option<LatLon>,
        height: Height,
        autopilot: Autopilot,
    ) -> Result<(), Unknown> {
        // The encoded delay is the departure. PX4 is started by whoever launches the
        // fleet; an ArduPilot mission without a delay starts at once.
        self.t_s = match (self.flight.delay_s, autopilot) {
            (Some(delay_s), _) => delay_s,
            (None, Autopilot::Px4) => self.vehicle.depart_s,
            (None, Autopilot::ArduPilot) => 0.0,
        };
        let home = self.home;
        let place = self.world.frame.from_plan(home.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        if amsl_m <= home.amsl.0 || home.amsl.0.is_nan() {
            return Err(Unknown {
                row,
                why: format!(
                    "takeoff to {amsl_m:.2} m AMSL, not above home at {:.2} m",
                    home.amsl.0
                ),
            });
        }
        self.airborne = true;
        self.knots = vec![self.knot(row, home.at, home.amsl.0, None)];
        self.climb(row, amsl_m, true);
        if let Some(at) = at {
            let at = self.reach(row, at)?;
            if at.distance_m(home.at) > self.tolerance_m {
                let knot = self.knot(row, at, amsl_m, None);
                self.append(knot)?;
                self.stop()?;
                // That was still the takeoff, not the route.
                self.flight.route.clear();
            }
        }
        let start = self.stations.start;
        if self.here().distance_m(start) <= self.tolerance_m {
            self.phase = Phase::Route;
            self.mark();
        }
        Ok(())
    }

    /// Adds a leg to a place at a height.
    fn head_for(&mut self, row: usize, place: LatLon, height: Height) -> Result<(), Unknown> {
        let at = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        let knot = self.knot(row, at, amsl_m, agl_m);
        self.append(knot)?;
        if self.phase == Phase::Join {
            // The first place after the takeoff is the start of the route.
            self.phase = Phase::Route;
        }
        Ok(())
    }

    fn append(&mut self, knot: Knot) -> Result<(), Unknown> {
        let last = self.last();
        if knot.at.distance_m(last.at) > SAME_PLACE_M {
            self.knots.push(knot);
        } else if (knot.amsl_m - last.amsl_m).abs() > SAME_PLACE_M {
            self.stop()?;
            self.climb(knot.row, knot.amsl_m, false);
            self.mark();
        } else if knot.phase == Phase::Join {
            // A waypoint at the place of the takeoff: the route begins here.
            self.stop()?;
            self.mark();
        }
        Ok(())
    }

    fn land(&mut self, row: usize, at: Option<LatLon>) -> Result<(), Unknown> {
        if let Some(place) = at {
            let last = self.last();
            let at = self.reach(row, place)?;
            let knot = self.knot(row, at, last.amsl_m, None);
            self.append(knot)?;
        }
        self.stop()?;
        self.phase = Phase::Finish;
        self.touch_down(row)
    }

    fn return_home(&mut self, row: usize, mission: &VehicleMission) -> Result<(), Unknown> {
        let refuse = |why: &str| {
            Err(Unknown {
                row,
                why: why.to_owned(),
            })
        };
        let Some(Amsl(return_m)) = self.vehicle.return_amsl else {
            return refuse("NAV_RETURN_TO_LAUNCH, and the spec has no return_amsl_m");
        };
        if !mission.rally.is_empty() {
            return refuse("NAV_RETURN_TO_LAUNCH with rally points may end at one of them");
        }
        self.stop()?;
        self.phase = Phase::Finish;
        if self.last().amsl_m < return_m {
            self.climb(row, return_m, false);
        }
        let knot = self.knot(row, self.home.at, self.last().amsl_m, None);
        self.append(knot)?;
        self.stop()?;
        self.touch_down(row)
    }

    /// Descends to the ground.
    fn touch_down(&mut self, row: usize) -> Result<(), Unknown> {
        let at = self.last().at;
        let ground_m = self.ground_m(row, self.world.frame.from_plan(at))?;
        self.climb(row, ground_m, true);
        self.ended = true;
        self.flight.end = Some(End::Landed(at));
        Ok(())
    }

    /// Stays in the air for ever, unless it has landed.
    fn finish(&mut self, row: usize) -> Result<(), Unknown> {
        if self.ended {
            return Ok(());
        }
        if !self.airborne {
            return Err(Unknown {
                row,
                why: "no takeoff".to_owned(),
            });
        }
        self.stop()?;
        self.hold(row, f64::INFINITY);
        self.ended = true;
        self.flight.end = Some(End::Stays(self.last().at));
        Ok(())
    }

    /// A vertical motion from where the vehicle is.
    fn climb(&mut self, row: usize, to_m: f64, grounded: bool) {
        let from = self.here();
        let to = PlanPoint {
            at: from.at,
            amsl: Amsl(to_m),
        };
        let rise_m = to_m - from.amsl.0;
        let rate_mps = if rise_m > 0.0 {
            self.vehicle.climb_mps
        } else {
            self.vehicle.descent_mps
        };
        if !grounded {
            self.flight.slopes.push(Slope {
                chord: self.flight.chords.len(),
                phase: self.phase,
                run_m: 0.0,
                rise_m,
                speed_mps: 0.0,
                top_m: to_m.max(from.amsl.0),
            });
        }
        let duration_s = rise_m.abs() / rate_mps;
        self.straight(row, from, to, duration_s, grounded);
        let knot = self.knot(row, to.at, to_m, None);
        self.knots = vec![knot];
    }

    fn hold(&mut self, row: usize, hold_s: f64) {
        let here = self.here();
        self.straight(row, here, here, hold_s, false);
    }

    fn straight(
        &mut self,
        row: usize,
        from: PlanPoint,
        to: PlanPoint,
        duration_s: f64,
        grounded: bool,
    ) {
        let from_s = self.t_s;
        self.t_s += duration_s;
        self.flight.chords.push(Chord {
            row,
            phase: self.phase,
            from_s,
            to_s: self.t_s,
            from,
            to,
            error_m: 0.0,
            agl_m: None,
            grounded,
            flown: true,
        });
    }

    /// Flies the legs that were gathered, to a stop at the last knot.
    fn stop(&mut self) -> Result<(), Unknown> {
        let knots = std::mem::take(&mut self.knots);
        if let Some(&last) = knots.last() {
            self.knots = vec![last];
        }
        if knots.len() < 2 {
            return Ok(());
        }
        let run = legs::run(&knots, self.vehicle);
        let lines = knots
            .windows(2)
            .map(|pair| self.altitude_line(&pair[0], &pair[1]))
            .collect::<Result<Vec<_>, _>>()?;
        let mut firsts = vec![self.flight.chords.len(); lines.len()];
        let mut leg = usize::MAX;
        for piece in &run.pieces {
            if piece.leg != leg {
                leg = piece.leg;
                firsts[leg] = self.flight.chords.len();
            }
            self.lay_piece(piece, &knots, &lines)?;
        }
        self.take_stock(&knots, &lines, &run, &firsts);
        Ok(())
    }

    /// Notes what the limits on whole legs need.
    fn take_stock(&mut self, knots: &[Knot], lines: &[AltitudeLine], run: &Run, firsts: &[usize]) {
        for (leg, line) in lines.iter().enumerate() {
            let (from, to) = (&knots[leg], &knots[leg + 1]);
            let chord = firsts[leg];
            let end = firsts
                .get(leg + 1)
                .copied()
                .unwrap_or(self.flight.chords.len());
            if line.follows {
                self.flight.follows_terrain = true;
                self.slopes_over_ground(chord, end, run.peak_mps[leg]);
            } else {
                self.flight.slopes.push(Slope {
                    chord,
                    phase: to.phase,
                    run_m: from.at.distance_m(to.at),
                    rise_m: to.amsl_m - from.amsl_m,
                    speed_mps: run.peak_mps[leg],
                    top_m: to.amsl_m.max(from.amsl_m),
                });
            }
            self.flight.cruises.push(Cruise {
                chord,
                speed_mps: to.speed_is_known.then_some(to.speed_mps),
            });
            if to.phase != Phase::Finish {
                let t_s = self
                    .flight
                    .chords
                    .get(end)
                    .map_or(self.t_s, |next| next.from_s);
                self.flight.route.push(Mark {
                    point: point(to),
                    row: to.row,
                    t_s,
                });
            }
        }
        for room in &run.rooms {
            self.flight.turns.push(Turn {
                chord: firsts[room.leg],
                left_m: room.left_m,
            });
        }
    }

    /// Slopes of a leg that follows the terrain: chord by chord.
    fn slopes_over_ground(&mut self, first: usize, end: usize, speed_mps: f64) {
        for chord in first..end {
            let of = &self.flight.chords[chord];
            if of.flown && of.agl_m.is_some() {
                self.flight.slopes.push(Slope {
                    chord,
                    phase: of.phase,
                    run_m: of.from.at.distance_m(of.to.at),
                    rise_m: of.to.amsl.0 - of.from.amsl.0,
                    speed_mps,
                    top_m: of.to.amsl.0.max(of.from.amsl.0),
                });
            }
        }
    }

    /// Lays the chords of a piece, and of the two ends of legs beside an arc.
    fn lay_piece(
        &mut self,
        piece: &Piece,
        knots: &[Knot],
        lines: &[AltitudeLine],
    ) -> Result<(), Unknown> {
        let (row, phase) = (knots[piece.leg + 1].row, knots[piece.leg + 1].phase);
        let (start, end) = (piece.shape.at(0.0), piece.shape.at(1.0));
        let line = match piece.shape {
            Shape::Line { .. } => lines[piece.leg].part(piece.fraction),
            Shape::Arc { .. } => {
                let (here, there) = (&lines[piece.leg], &lines[piece.leg + 1]);
                let (leave, join) = piece.fraction;
                let follows = here.follows && there.follows;
                let end_m = |line: &AltitudeLine, fraction: f64, at: EastNorth| {
                    let value_m = line.value_m(fraction);
                    if line.follows && !follows {
                        Ok(value_m + self.ground_m(row, self.world.frame.from_plan(at))?)
                    } else {
                        Ok(value_m)
                    }
                };
                AltitudeLine {
                    follows,
                    value_m: (end_m(here, leave, start)?, end_m(there, join, end)?),
                }
            }
        };
        let duration_s = piece.duration_s();
        let acceleration_mps2 = piece.acceleration_mps2();
        let wanted = duration_s * (acceleration_mps2 / (8.0 * CHORD_ERROR_M)).sqrt();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = wanted.ceil().clamp(1.0, 1e5) as u32;
        let step_s = duration_s / f64::from(count);
        let base = Chord {
            row,
            phase,
            from_s: self.t_s,
            to_s: self.t_s,
            from: here_at(start),
            to: here_at(end),
            error_m: acceleration_mps2 * step_s * step_s / 8.0,
            agl_m: None,
            grounded: false,
            flown: true,
        };
        let from_s = self.t_s;
        for index in 0..count {
            let time = |i: u32| f64::from(i) / f64::from(count);
            let covered = (
                piece.covered(time(index)),
                piece.covered(time(index + 1)).min(1.0),
            );
            let chord = Chord {
                from_s: from_s + duration_s * time(index),
                to_s: from_s + duration_s * time(index + 1),
                from: here_at(piece.shape.at(covered.0)),
                to: here_at(piece.shape.at(covered.1)),
                ..base
            };
            self.lay(chord, &line.part(covered))?;
        }
        self.t_s = from_s + duration_s;
        if let Shape::Arc { .. } = piece.shape {
            self.lay_corner(piece, knots, lines, from_s)?;
        }
        Ok(())
    }

    /// The ends of the two legs beside a fillet, as far as the corner itself.
    fn lay_corner(
        &mut self,
        piece: &Piece,
        knots: &[Knot],
        lines: &[AltitudeLine],
        from_s: f64,
    ) -> Result<(), Unknown> {
        let middle_s = 0.5 * (from_s + self.t_s);
        let (corner, next) = (&knots[piece.leg + 1], &knots[piece.leg + 2]);
        let mut end = |knot: &Knot, (from, to), (from_s, to_s), line: AltitudeLine| {
            let chord = Chord {
                row: knot.row,
                phase: knot.phase,
                from_s,
                to_s,
                from: here_at(from),
                to: here_at(to),
                error_m: 0.0,
                agl_m: None,
                grounded: false,
                flown: false,
            };
            self.lay(chord, &line)
        };
        let (leave, join) = (piece.shape.at(0.0), piece.shape.at(1.0));
        let until_s = from_s + 2.0 * (middle_s - from_s);
        end(
            corner,
            (leave, corner.at),
            (from_s, middle_s),
            lines[piece.leg].part((piece.fraction.0, 1.0)),
        )?;
        end(
            next,
            (corner.at, join),
            (middle_s, until_s),
            lines[piece.leg + 1].part((0.0, piece.fraction.1)),
        )
    }

    /// Lays one chord with its altitudes; over terrain that is followed, several.
    fn lay(&mut self, chord: Chord, line: &AltitudeLine) -> Result<(), Unknown> {
        let raised = |at: EastNorth, amsl_m: f64| PlanPoint {
            at,
            amsl: Amsl(amsl_m),
        };
        if !line.follows {
            self.flight.chords.push(Chord {
                from: raised(chord.from.at, line.value_m.0),
                to: raised(chord.to.at, line.value_m.1),
                ..chord
            });
            return Ok(());
        }
        for stretch in stretches(&self.world.frame, chord.from.at, chord.to.at) {
            let patches = self
                .surface
                .under(stretch.from, stretch.to)
                .map_err(|gap| no_data(chord.row, gap))?;
            for patch in patches {
                let parts = split(patch.bulge_m);
                let error_m = patch.bulge_m.abs() / f64::from(parts * parts) + patch.error_m;
                for part in 0..parts {
                    let end = |index: u32| {
                        let v = f64::from(index) / f64::from(parts);
                        let u = stretch.along(patch.w.0 + (patch.w.1 - patch.w.0) * v);
                        let (h0, h1) = patch.height_m;
                        let ground_m = h0 + (h1 - h0) * v + 4.0 * patch.bulge_m * v * (1.0 - v);
                        let agl_m = line.value_m(u);
                        (
                            chord.time_s(u),
                            raised(chord.at(u).at, ground_m + agl_m),
                            agl_m,
                        )
                    };
                    let ((from_s, from, low_m), (to_s, to, high_m)) = (end(part), end(part + 1));
                    self.flight.chords.push(Chord {
                        from_s,
                        to_s,
                        from,
                        to,
                        error_m: chord.error_m + error_m,
                        agl_m: Some((low_m, high_m)),
                        ..chord
                    });
                }
            }
        }
        Ok(())
    }

    /// Altitude along the leg between two knots.
    fn altitude_line(&self, from: &Knot, to: &Knot) -> Result<AltitudeLine, Unknown> {
        let Some(agl_m) = to.agl_m else {
            return Ok(AltitudeLine {
                follows: false,
                value_m: (from.amsl_m, to.amsl_m),
            });
        };
        let ground_m = self.ground_m(to.row, self.world.frame.from_plan(from.at))?;
        Ok(AltitudeLine {
            follows: true,
            value_m: (from.amsl_m - ground_m, agl_m),
        })
    }

    /// Altitude above the sea, and above the ground if the item says so.
    fn resolve(
        &self,
        row: usize,
        place: LatLon,
        height: Height,
    ) -> Result<(f64, Option<f64>), Unknown> {
        match height {
            Height::Sea(Amsl(amsl_m)) => Ok((amsl_m, None)),
            Height::Ground(Agl(agl_m)) => Ok((self.ground_m(row, place)? + agl_m, Some(agl_m))),
        }
    }

    fn ground_m(&self, row: usize, place: LatLon) -> Result<f64, Unknown> {
        self.surface
            .height_m(place)
            .map_err(|gap| no_data(row, gap))
    }

    /// Planning coordinates of a place that is near enough to have any.
    fn reach(&self, row: usize, place: LatLon) -> Result<EastNorth, Unknown> {
        let origin = self.world.frame.origin();
        let away_m = (place.to_ecef(0.0) - origin.to_ecef(0.0)).norm();
        if away_m <= REACH_M {
            Ok(self.world.frame.to_plan(place))
        } else {
            Err(Unknown {
                row,
                why: format!("a place {:.0} km from the origin", away_m / 1000.0),
            })
        }
    }

    fn knot(&self, row: usize, at: EastNorth, amsl_m: f64, agl_m: Option<f64>) -> Knot {
        Knot {
            row,
            at,
            amsl_m,
            agl_m,
            speed_mps: self.speed_mps.unwrap_or(self.vehicle.speed_mps),
            speed_is_known: self.speed_mps.is_some(),
            phase: self.phase,
        }
    }

    fn last(&self) -> Knot {
        self.knots
            .last()
            .copied()
            .unwrap_or_else(|| self.knot(0, self.home.at, self.home.amsl.0, None))
    }

    fn here(&self) -> PlanPoint {
        point(&self.last())
    }

    /// Notes where the vehicle is as a point of the route.
    fn mark(&mut self) {
        let last = self.last();
        self.flight.route.push(Mark {
            point: point(&last),
            row: last.row,
            t_s: self.t_s,
        });
    }
}

/// Altitude along a leg: a straight line above the sea, or above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AltitudeLine {
    follows: bool,
    /// At the ends, metres.
    value_m: (f64, f64),
}

impl AltitudeLine {
    fn value_m(&self, fraction: f64) -> f64 {
        self.value_m.0 + (self.value_m.1 - self.value_m.0) * fraction
    }

    fn part(&self, (from, to): (f64, f64)) -> Self {
        Self {
            follows: self.follows,
            value_m: (self.value_m(from), self.value_m(to)),
        }
    }
}

fn point(knot: &Knot) -> PlanPoint {
    PlanPoint {
        at: knot.at,
        amsl: Amsl(knot.amsl_m),
    }
}

fn here_at(at: EastNorth) -> PlanPoint {
    PlanPoint {
        at,
        amsl: Amsl(f64::NAN),
    }
}

fn no_data(row: usize, gap: NoData) -> Unknown {
    Unknown {
        row,
        why: gap.to_string(),
    }
}

/// In how many parts a parabola is cut so that each is straight to a decimetre.
fn split(bulge_m: f64) -> u32 {
    const BULGE_M: f64 = 0.1;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a small positive count"
    )]
    let parts = (bulge_m.abs() / BULGE_M).sqrt().ceil().clamp(1.0, 1e4) as u32;
    parts
}
