//! The record of one honest flight, to be doctored.
#![allow(dead_code, unreachable_pub)]

use std::sync::OnceLock;

use sortie::flight::*;
use sortie::geodesy::{Amsl, LatLon};
use sortie::spec::{Finish, OnLinkLoss, Vehicle as Spec};

use super::sky::{Planned, Sky, lane, plan};

/// Alpha lands a kilometre from home, bravo lands where it stood, charlie stays in the air.
pub fn three() -> Vec<Spec> {
    let mut fleet = vec![
        lane("alpha", 1, 36.300),
        lane("bravo", 2, 36.308),
        lane("charlie", 3, 36.316),
    ];
    fleet[1].finish = Finish::Return;
    fleet[2].finish = Finish::Loiter;
    fleet
}

/// The plan, and how it was flown.
pub fn flown() -> (&'static Planned, &'static Record) {
    let (plan, record, _) = told();
    (plan, record)
}

/// The same, and what was told of it.
pub fn told() -> &'static (Planned, Record, Vec<Event>) {
    static FLOWN: OnceLock<(Planned, Record, Vec<Event>)> = OnceLock::new();
    FLOWN.get_or_init(|| {
        let plan = plan(three(), OnLinkLoss::Continue);
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        let (record, events) = (plan.record(&sky), std::mem::take(&mut sky.events));
        drop(sky);
        (plan, record, events)
    })
}

/// What fails when the record is doctored so.
pub fn failed(doctor: impl FnOnce(&mut Record)) -> Vec<(String, String)> {
    let (plan, record) = flown();
    let mut record = record.clone();
    doctor(&mut record);
    let report = judge(&plan.spec, &plan.world, &record);
    let bad = report.margins.iter().filter(|margin| !margin.ok);
    let bad: Vec<_> = bad
        .map(|m| (m.vehicle.clone(), m.limit.to_string()))
        .collect();
    let ended = report.vehicles.iter().all(|v| v.ended_as_planned);
    assert_eq!(report.passes(), bad.is_empty() && ended, "{report:#?}");
    bad
}

pub fn says(failed: &[(String, String)], vehicle: &str, what: &str) -> bool {
    failed.iter().any(|(v, w)| v == vehicle && w == what)
}

/// A position moved to the north and up.
pub fn moved(fix: &Fix, north_m: f64, up_m: f64) -> Fix {
    let lat_deg = fix.place.lat_deg + north_m / 111_000.0;
    Fix {
        place: LatLon::new(lat_deg, fix.place.lon_deg).expect("a place"),
        amsl: Amsl(fix.amsl.0 + up_m),
        ..*fix
    }
}
