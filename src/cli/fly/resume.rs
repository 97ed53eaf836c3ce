//! A flight whose ground station crashed is taken over in the air.

use std::thread;
use std::time::{Duration, Instant};

use super::{Output, POSITION_S, Screen};
use crate::cli::folder::runs::{self, PlanLock};
use crate::cli::folder::{self, claim};
use crate::cli::links;
use crate::cli::print::failure::Failure;
use crate::flight::{Driver, Fleet, FlightHandoff, FlightPlan, Interrupted, Options, Outcome};
use crate::link::Links;
use crate::spec::Link;

/// Of several that would take a flight over at once one does, and the others wait for this long until they
/// can attach to it.
const RACE: Duration = Duration::from_secs(20);

/// Attaches to the session of a flight or, where there is none, takes the flight over.
pub(in crate::cli) fn watch(
    plan: &FlightPlan,
    links: &[String],
    json: bool,
) -> Result<(), Failure> {
    let folder = runs::folder(&plan.folder);
    #[expect(
        clippy::disallowed_methods,
        reason = "terminals wait in real time; no plan depends on it"
    )]
    let began = Instant::now();
    loop {
        if super::attach(&folder)? {
            return Ok(());
        }
        let lock = match began.elapsed() < RACE {
            true => runs::try_lock(&folder, "fly")?,
            false => Some(runs::lock(&folder, "fly")?),
        };
        if let Some(lock) = lock {
            return take_over(plan, links, json, lock);
        }
        thread::sleep(Duration::from_millis(200));
    }
}

/// Takes over the flight of a plan: from its record, and from what its vehicles report.
pub(in crate::cli) fn take_over(
    plan: &FlightPlan,
    links: &[String],
    json: bool,
    _lock: PlanLock,
) -> Result<(), Failure> {
    let folder = runs::folder(&plan.folder);
    let handoff = FlightHandoff::find(folder.clone())?.ok_or_else(|| {
        let message = format!(
            "{}: no flight of this plan is under way (links.json is missing); nothing was sent",
            folder.display()
        );
        Failure::new(Failure::INPUT, message)
    })?;
    let flight = Interrupted::find(&folder, &handoff, plan.world.frame)?;
    if flight.spec_sha256() != folder::sha256(&plan.file.text) {
        let message = format!(
            "{} was planned anew since the flight began: its record is of another spec",
            plan.folder.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let links = links::under_way(plan, links, &handoff.notice)?;
    let systems = links
        .iter()
        .map(|(index, link)| (plan.vehicle(*index).sysid, link));
    let systems: Vec<(u8, &Link)> = systems.collect();
    let _claims = claim::claim(&handoff.notice.flight, &systems, &folder)?;
    let open = Links::open(&systems)
        .map_err(|(link, error)| Failure::new(Failure::TRANSFER, format!("{link}: {error}")))?;
    let ids = plan
        .missions
        .iter()
        .map(|(index, _)| plan.vehicle(*index).id.as_str());
    let journal = flight.journal(ids)?;
    let mut screen = Screen::begin(json, false, &folder)?;
    let mut driver = Driver::new(&open, &handoff, journal).resuming(&flight);
    let options = Options {
        speedup: flight.speedup(),
        set_params: false,
        force: false,
        on_alarm: plan.spec().answers(),
        position_s: POSITION_S,
        launch: None,
    };
    let assignments = plan.assignments(&plan.references(), &open, |_| false);
    let at = (driver.now(), flight.now_unix_ms());
    let fleet = Fleet::take_over(assignments, options, open.us(), at, &flight);
    let mut fleet = fleet.watched(plan.spec(), &plan.world);
    driver.fly(&mut fleet, &mut screen);
    // They may be in the air: then they can be taken over, and led, later.
    if fleet.unheard().is_empty() {
        handoff.withdraw(fleet.outcome() == Some(&Outcome::Flown));
    }
    super::end(driver, &fleet, plan, Output::of(screen, json, false))
}
