//! What the ground shows of a spec that has problems already.

use super::{Check, terrain, unread};
use crate::spec::{Incomplete, KnownPlace, PlaceKind, SpecError};
use crate::world::World;

/// The problems of a spec with those that show only over the ground, as far as it is known.
#[must_use]
pub fn with_ground(incomplete: Box<Incomplete>) -> SpecError {
    let Incomplete { error, known } = *incomplete;
    let Some(known) = known else { return error };
    let file = &known.file;
    let found = match terrain(file) {
        Err(error) => vec![unread(file, &error)],
        Ok(terrain) => {
            let mut check = Check {
                file,
                terrain: &terrain,
                issues: Vec::new(),
            };
            check.fleet(&known.vehicles);
            for place in &known.sites {
                check.place(place);
            }
            let mut found = check.issues;
            if found.is_empty()
                && let Ok(world) = World::new(&file.spec, terrain)
            {
                found = crate::world::approach::blocked(file, &world, &known.vehicles);
            }
            found
        }
    };
    let found = found.into_iter().filter(|issue| known.is_known(issue));
    let mut issues = error.issues;
    issues.extend(found);
    file.error(issues)
}

impl Check<'_> {
    /// A place of a vehicle that has a problem elsewhere, of a task or a rally point.
    fn place(&mut self, KnownPlace { path, kind }: &KnownPlace) {
        match *kind {
            PlaceKind::Home(home) => {
                if let Some(ground) = self.ground(path, home) {
                    self.zones(path, "takeoff", home, ground);
                }
            }
            PlaceKind::Airborne {
                what,
                end,
                altitudes,
                can_drop,
            } => self.airborne((path, what), end, (altitudes, can_drop)),
            PlaceKind::Rally(place, agl_m) => self.rally(path, place, agl_m),
        }
    }
}
