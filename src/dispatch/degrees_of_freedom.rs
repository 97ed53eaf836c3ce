//! What a spec leaves open must not make a fleet dearer: it is planned without each freedom too.

use super::Dispatched;
use crate::spec::{MissionSpec, Vehicle};

/// A freedom: departures, speeds, or keeping apart in height.
type Freedom = fn(&mut MissionSpec);

const ALL: [Freedom; 3] = [
    |spec| each(spec, |vehicle| vehicle.retiming.depart_s = None),
    |spec| each(spec, |vehicle| vehicle.retiming.speed_mps = None),
    |spec| spec.separation.vertical_m = None,
];

fn each(spec: &mut MissionSpec, change: fn(&mut Vehicle)) {
    spec.vehicles.iter_mut().for_each(change);
}

/// The spec, and the same without one or more of the freedoms that it gives, the fewest last. What
/// keeps the limits of one of them keeps those of the spec. So the best plan of all of them is
/// never dearer than that of a spec with fewer freedoms.
pub(super) fn with_fewer(spec: &MissionSpec) -> Vec<MissionSpec> {
    let mut specs = vec![spec.clone()];
    for without in ALL {
        let fewer: Vec<MissionSpec> = (specs.iter())
            .filter_map(|spec| {
                let mut fewer = spec.clone();
                without(&mut fewer);
                (fewer != *spec).then_some(fewer)
            })
            .collect();
        specs.extend(fewer);
    }
    specs
}

/// Vehicles of a fleet that is always planned with fewer freedoms as well.
pub(super) const ALWAYS: usize = 8;

/// Whether every vehicle has retiming and flies the path that it would fly alone.
pub(super) fn nobody_pays(spec: &MissionSpec, found: &Dispatched) -> bool {
    let mut fleet = spec.vehicles.iter().zip(&found.plan.vehicles);
    found.review.passes()
        && fleet.all(|(vehicle, plan)| vehicle.retiming.is_allowed() && plan.plans == 1)
}
