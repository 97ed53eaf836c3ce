//! Results of searches that were made before, by all that they read: a small fleet is planned again and again with
//! little changed, as with fewer freedoms, and many of its searches are the same.

use std::sync::{Arc, Mutex};

use geo::Polygon;

use super::route_context::RouteContext;
use super::search_options::SearchOptions;
use crate::cost::{Margins, RouteEnds};
use crate::geodesy::{Agl, Amsl};
use crate::numeric::Seed;
use crate::path::Flight;
use crate::spec::{MissionSpec, Retiming, Separation};
use crate::world::{Disc, Ground, Layer, PlanZone, VehicleSites};

/// Results by what they were made from.
pub(super) struct Memo<T>(Mutex<Vec<(Read, T)>>);

impl<T> Default for Memo<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Clone> Memo<T> {
    /// What was made before from the same, or is made now; that of a search that was cancelled is forgotten.
    /// `run` is the budget, the seed and the random stream.
    pub(super) fn of(
        &self,
        context: &RouteContext<'_>,
        run: (usize, Seed, u64),
        make: impl FnOnce() -> T,
    ) -> T {
        let read = Read::of(context, run);
        let known = |all: &Vec<(Read, T)>| {
            let mut all = all.iter();
            all.find(|(known, _)| *known == read)
                .map(|(_, made)| made.clone())
        };
        if let Some(made) = self.0.lock().ok().and_then(|all| known(&all)) {
            return made;
        }
        let made = make();
        if !context.is_cancelled()
            && let Ok(mut all) = self.0.lock()
            && known(&all).is_none()
        {
            all.push((read, made.clone()));
        }
        made
    }
}

/// All that the search of a route reads, of the fleet of one dispatch.
#[derive(PartialEq)]
struct Read {
    run: (usize, Seed, u64),
    ends: RouteEnds,
    margins: Margins,
    extra: Vec<f64>,
    options: SearchOptions,
    at_edges: bool,
    /// With one vehicle, as it flies this route.
    spec: MissionSpec,
    earlier: Vec<Flight>,
    around: Around,
}

/// What a search reads of the world.
struct Around {
    ground: Arc<Ground>,
    threats: Vec<Disc>,
    zones: Vec<PlanZone>,
    area: Polygon<f64>,
    min_agl: Agl,
    max_amsl: Amsl,
    layer: Layer,
    sites: VehicleSites,
}

impl Read {
    fn of(context: &RouteContext<'_>, run: (usize, Seed, u64)) -> Self {
        let mut vehicle = context.vehicle().clone();
        // When it departs is in the ends.
        (vehicle.retiming, vehicle.depart_s) = (Retiming::default(), 0.0);
        let mut spec = context.spec.clone();
        spec.vehicles = vec![vehicle];
        let (mut ends, mut margins) = (context.ends, context.margins);
        if context.earlier.is_empty() {
            // Nobody is there to be too near to, at any time.
            ends.start_s = 0.0;
            (margins.separation_m, margins.shift_s) = (0.0, 0.0);
            spec.separation = Separation::default();
        }
        Self {
            run,
            ends,
            margins,
            extra: context.extra.to_vec(),
            options: context.options,
            at_edges: context.at_edges,
            spec,
            earlier: context.earlier.to_vec(),
            around: Around::of(context),
        }
    }
}

impl Around {
    fn of(context: &RouteContext<'_>) -> Self {
        let world = context.world;
        Self {
            ground: Arc::clone(&world.ground),
            threats: world.threats.clone(),
            zones: world.zones.clone(),
            area: world.area.clone(),
            min_agl: world.min_agl,
            max_amsl: world.max_amsl,
            layer: context.layer(),
            sites: world.sites[context.index].clone(),
        }
    }
}

impl PartialEq for Around {
    fn eq(&self, other: &Self) -> bool {
        // The ground of a dispatch is never read again.
        Arc::ptr_eq(&self.ground, &other.ground)
            && self.threats == other.threats
            && self.zones == other.zones
            && self.area == other.area
            && (self.min_agl, self.max_amsl) == (other.min_agl, other.max_amsl)
            && self.layer == other.layer
            && self.sites == other.sites
    }
}
