//! Families of hard problems by rule: what no planner was tuned on, one problem for each seed.
//!
//! [`plane`] has those that are hard in the plane (walls, mazes, city blocks, rows of threats with
//! narrow gaps, 100 km), [`ground`] those that are hard in altitude (canyons, plateaus, rough
//! ground, zones to fly over).

mod ground;
mod plane;

use std::fmt::Write;

use rand_chacha::ChaCha8Rng;

use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::numeric::Seed;

/// The south-west corner of every area lies near it; coordinates are metres east and north of it.
const ORIGIN: LatLon = LatLon {
    lat_deg: 46.5,
    lon_deg: 8.0,
};
/// Ground far from every hill, metres above the sea.
const BASE_AMSL_M: f64 = 300.0;

/// A family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Thin walls from edge to edge, with gaps at their ends by turns.
    Walls,
    /// Corridors between thin walls, with dead ends.
    Maze,
    /// Blocks of several heights with streets between them.
    City,
    /// Rows of threats with one narrow gap in each.
    Gaps,
    /// 100 km among 1000 threats and 500 zones.
    Far,
    /// A winding valley between ridges higher than the ceiling.
    Canyon,
    /// A plateau, and a vehicle that climbs slowly: over or around.
    Plateau,
    /// Hills of three sizes, and threats.
    Rough,
    /// Rows of zones with heights, some with gaps.
    Overflight,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 9] = [
        Self::Walls,
        Self::Maze,
        Self::City,
        Self::Gaps,
        Self::Far,
        Self::Canyon,
        Self::Plateau,
        Self::Rough,
        Self::Overflight,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Walls => "walls",
            Self::Maze => "maze",
            Self::City => "city",
            Self::Gaps => "gaps",
            Self::Far => "far",
            Self::Canyon => "canyon",
            Self::Plateau => "plateau",
            Self::Rough => "rough",
            Self::Overflight => "overflight",
        }
    }

    /// The family of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|family| family.name() == name)
    }

    /// The text of the mission spec of a seed. The same seed gives the same text. No path is known
    /// to exist.
    #[must_use]
    pub fn problem(self, seed: u64) -> String {
        let mut rng = Seed(seed).stream(self.name(), 0);
        let problem = match self {
            Self::Walls => plane::walls(&mut rng),
            Self::Maze => plane::maze(&mut rng),
            Self::City => plane::city(&mut rng),
            Self::Gaps => plane::gaps(&mut rng),
            Self::Far => plane::far(&mut rng),
            Self::Canyon => ground::canyon(&mut rng),
            Self::Plateau => ground::plateau(&mut rng),
            Self::Rough => ground::rough(&mut rng),
            Self::Overflight => ground::overflight(&mut rng),
        };
        problem.text(self, seed)
    }
}

/// Metres east and north.
type At = (f64, f64);

/// A round threat or hill.
#[derive(Clone, Copy, Debug)]
struct Round {
    at: At,
    radius_m: f64,
    /// Of a hill.
    height_m: f64,
}

/// A zone.
#[derive(Clone, Debug)]
struct Zone {
    corners: Vec<At>,
    /// Closed below this; none: at every height.
    below_amsl_m: Option<f64>,
}

impl Zone {
    /// A rectangle from one corner to the opposite one.
    fn block(from: At, to: At) -> Self {
        Self {
            corners: vec![from, (to.0, from.1), to, (from.0, to.1)],
            below_amsl_m: None,
        }
    }

    fn below(mut self, amsl_m: f64) -> Self {
        self.below_amsl_m = Some(amsl_m);
        self
    }
}

/// A problem of one vehicle.
#[derive(Clone, Debug)]
struct Problem {
    area: (At, At),
    ends: (At, At),
    max_amsl_m: f64,
    speed_mps: f64,
    /// Climb and descent, degrees.
    slopes_deg: (f64, f64),
    hills: Vec<Round>,
    threats: Vec<Round>,
    zones: Vec<Zone>,
}

impl Problem {
    /// Flat and empty, for a vehicle that climbs well.
    fn new(area: (At, At), ends: (At, At)) -> Self {
        Self {
            area,
            ends,
            max_amsl_m: BASE_AMSL_M + 300.0,
            speed_mps: 8.0,
            slopes_deg: (12.0, 8.0),
            hills: Vec::new(),
            threats: Vec::new(),
            zones: Vec::new(),
        }
    }

    fn text(&self, family: Family, seed: u64) -> String {
        /// Items that a long or winding path may need.
        const ITEMS: usize = 600;
        let name = family.name();
        let vehicle = format!(
            "vehicles:\n  - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, finish: land, speed_mps: {}, \
             max_climb_deg: {:.2}, max_descent_deg: {:.2},\n     start: {{{}, agl_m: 60}}, goal: {{{}, agl_m: 60}}}}\n",
            self.speed_mps,
            self.slopes_deg.0,
            self.slopes_deg.1,
            named(self.ends.0),
            named(self.ends.1),
        );
        format!(
            "# Written by `sortie study scenario --family {name} --seed {seed}`.\n\
             sortie: 1\nname: {name}-{seed}\n\
             area: {{south_west: {{{}}}, north_east: {{{}}}, min_agl_m: 40, max_amsl_m: {:.0}}}\n\
             mission: {{max_items: {ITEMS}}}\n{}{}{}{vehicle}",
            named(self.area.0),
            named(self.area.1),
            self.max_amsl_m,
            self.terrain(),
            self.threats(),
            self.zones(),
        )
    }

    fn terrain(&self) -> String {
        let mut text = format!("terrain:\n  analytic:\n    base_amsl_m: {BASE_AMSL_M}\n    hills:");
        text.push_str(if self.hills.is_empty() { " []\n" } else { "\n" });
        for Round {
            at,
            radius_m,
            height_m,
        } in &self.hills
        {
            let _ = writeln!(
                text,
                "      - {{{}, height_m: {height_m:.1}, radius_m: {radius_m:.1}}}",
                named(*at)
            );
        }
        text
    }

    fn threats(&self) -> String {
        let mut text = String::new();
        for (index, Round { at, radius_m, .. }) in self.threats.iter().enumerate() {
            text.push_str(if index == 0 { "threats:\n" } else { "" });
            let _ = writeln!(
                text,
                "  - {{id: t{index}, {}, radius_m: {radius_m:.1}}}",
                named(*at)
            );
        }
        text
    }

    fn zones(&self) -> String {
        let mut text = String::new();
        for (index, zone) in self.zones.iter().enumerate() {
            text.push_str(if index == 0 { "no_fly:\n" } else { "" });
            let corners = zone.corners.iter().map(|at| {
                let place = place(*at);
                format!("[{:.7}, {:.7}]", place.lat_deg, place.lon_deg)
            });
            let corners: Vec<String> = corners.collect();
            let below = zone
                .below_amsl_m
                .map(|amsl_m| format!("below_amsl_m: {amsl_m:.0}, "));
            let _ = writeln!(
                text,
                "  - {{id: z{index}, {}polygon: [{}]}}",
                below.unwrap_or_default(),
                corners.join(", ")
            );
        }
        text
    }
}

fn place((east_m, north_m): At) -> LatLon {
    LocalFrame::new(ORIGIN).from_plan(EastNorth { east_m, north_m })
}

/// The keys of a place.
fn named(at: At) -> String {
    let place = place(at);
    format!("lat: {:.7}, lon: {:.7}", place.lat_deg, place.lon_deg)
}

/// Random numbers of a problem.
type Rng = ChaCha8Rng;
