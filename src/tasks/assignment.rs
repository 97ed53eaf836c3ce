//! Who does which job, and in which order: regret insertion, then removal and new insertion.

mod insertion;
mod search;
#[cfg(test)]
mod tests;

/// How long ways take at least, in thousandths of their times.
const SOONEST: u64 = 995;

/// Jobs to share among vehicles.
#[derive(Clone, Copy, Debug)]
pub struct Assignment<'a> {
    /// The vehicles; each goes once.
    pub vehicles: &'a [Carrier<'a>],
    /// The jobs.
    pub jobs: &'a [Job],
}

/// A vehicle as the assignment sees it.
#[derive(Clone, Copy, Debug)]
pub struct Carrier<'a> {
    /// The way from the place of the row to that of the column; square, none where there is no
    /// way.
    pub ways: &'a [Vec<Option<Way>>],
    /// Place where it begins.
    pub start: usize,
    /// Place where it ends.
    pub goal: usize,
    /// The job that is its own: it does its places in their order, whatever that uses.
    pub own: Option<usize>,
    /// Most that it may use.
    pub budget: u64,
    /// What resting uses in one unit of time.
    pub rest_uses: u64,
    /// Most places that it visits.
    pub max_visits: usize,
    /// When it is at its start, at the earliest and at the latest.
    pub begins: (u64, u64),
    /// How long its ways may take, in thousandths of their times: windows hold for that and for
    /// the times themselves.
    pub slowest: u64,
    /// By how much later it may be after each way, besides.
    pub late_after_way: u64,
    /// Waits are whole numbers of this.
    pub wait_step: u64,
    /// When it may not be at each place, from and to: it lies in a zone with times. Empty where
    /// that is nowhere.
    pub closed: &'a [Vec<(u64, u64)>],
}

impl Carrier<'_> {
    /// How long a way may take it; from a place to itself there is none.
    fn longest(&self, way: Way) -> u64 {
        match way.time {
            0 => 0,
            time => (u64::from(time) * self.slowest).div_ceil(1000) + self.late_after_way,
        }
    }

    /// Whether it may be at a place from one time to another.
    fn may_be_at(&self, place: usize, (comes, leaves): (u64, u64)) -> bool {
        let mut closed = self.closed.get(place).into_iter().flatten();
        !closed.any(|&(from, to)| comes < to && from < leaves)
    }

    /// Whether it depends on the time if it may be at a place.
    fn minds_time_at(&self, place: usize) -> bool {
        self.closed
            .get(place)
            .is_some_and(|spans| !spans.is_empty())
    }
}

/// A way from one place to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// How long it takes.
    pub time: u32,
    /// What it uses, in the unit of the budget of its vehicle.
    pub uses: u32,
}

/// A job for one vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Its places, visited in this order by one vehicle: one for a visit, pick-up and drop for a
    /// delivery, both ends of a line.
    pub visits: Vec<Visit>,
    /// Which vehicles may do it.
    pub vehicles: Vec<bool>,
    /// What may come between its visits.
    pub form: Form,
}

/// How the visits of a job follow each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Visits of other jobs may come between.
    #[default]
    Open,
    /// At once.
    Together,
    /// At once, forwards or backwards.
    EitherWay,
}

/// A place of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Row and column of the ways.
    pub place: usize,
    /// How long the vehicle stays there.
    pub rest: u32,
    /// When its rest may begin, first and last; who comes earlier waits.
    pub window: Option<(u64, u64)>,
    /// How deep its drop is: visits that follow each other at one place and depth become one stop, which
    /// begins once. None for the end of a line.
    pub depth: Option<u64>,
}

/// Who does what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assigned {
    /// For each vehicle its visits in order, as job and position within the job, without start
    /// and goal.
    pub visits: Vec<Vec<(usize, usize)>>,
    /// Jobs that found no vehicle with enough budget left, ascending.
    pub left: Vec<usize>,
    /// Sum of the times of the ways of all vehicles; one without jobs goes from its start to its
    /// goal.
    pub cost: u64,
}

impl Assignment<'_> {
    /// Shares the jobs: as many as it can, then for the least cost. The same seed gives the same
    /// result. `None` where a place or a vehicle is outside of its list, or ways are not square.
    #[must_use]
    pub fn assign(&self, seed: u64) -> Option<Assigned> {
        self.is_whole().then(|| self.search(seed))
    }

    fn is_whole(&self) -> bool {
        let count = self.vehicles.len();
        let is_whole = |(index, one): (usize, &Carrier<'_>)| {
            let size = one.ways.len();
            let jobs = self.jobs.iter().filter(|job| job.vehicles[index]);
            let mut sites = jobs.flat_map(|job| &job.visits).map(|visit| visit.place);
            one.ways.iter().all(|row| row.len() == size)
                && sites.all(|place| place < size)
                && one.start.max(one.goal) < size
                && one.own.is_none_or(|own| own < self.jobs.len())
        };
        self.jobs.iter().all(|job| job.vehicles.len() == count)
            && self.vehicles.iter().enumerate().all(is_whole)
    }

    /// The visits of the job that is a vehicle's own.
    fn own_visits(&self, vehicle: usize) -> Vec<(usize, usize)> {
        let own = self.vehicles[vehicle].own.into_iter();
        own.flat_map(|job| (0..self.jobs[job].visits.len()).map(move |at| (job, at)))
            .collect()
    }

    /// Time and use of a vehicle with these visits; none where there is no way, a window is missed,
    /// or a place is closed as the vehicle is there.
    #[must_use]
    pub fn go(
        &self,
        vehicle: usize,
        visits: impl Iterator<Item = (usize, usize)>,
    ) -> Option<Spent> {
        self.walk(vehicle, visits, &mut |_| ())
    }

    /// How long a vehicle with these visits waits at each.
    #[must_use]
    pub fn waits(&self, vehicle: usize, visits: &[(usize, usize)]) -> Vec<u64> {
        let mut waits = Vec::with_capacity(visits.len());
        let visits = visits.iter().copied();
        self.walk(vehicle, visits, &mut |wait| waits.push(wait));
        waits
    }

    /// Whether there are ways for a vehicle from its start to each place of a job, and from there to its goal.
    #[must_use]
    pub fn has_ways(&self, vehicle: usize, job: usize) -> bool {
        let (Some(own), Some(of)) = (self.vehicles.get(vehicle), self.jobs.get(job)) else {
            return false;
        };
        let has_ways = |visit: &Visit| {
            let (to, from) = (
                own.ways[own.start][visit.place],
                own.ways[visit.place][own.goal],
            );
            to.is_some() && from.is_some()
        };
        of.visits.iter().all(has_ways)
    }

    /// The first place of a job whose window is shorter than what a vehicle straight from its start may
    /// be late there; with that time, at least, which a window has to have.
    #[must_use]
    pub fn short_window(&self, vehicle: usize, job: usize) -> Option<(usize, u64)> {
        let (own, of) = (self.vehicles.get(vehicle)?, self.jobs.get(job)?);
        if !of.vehicles[vehicle] {
            return None;
        }
        let mut at = own.start;
        let (mut early, mut late) = own.begins;
        for (position, visit) in of.visits.iter().enumerate() {
            let way = own.ways[at][visit.place]?;
            early += u64::from(way.time) * SOONEST / 1000;
            late += own.longest(way);
            let mut rest = u64::from(visit.rest);
            if let Some((first, last)) = visit.window {
                let wait = first.saturating_sub(early).div_ceil(own.wait_step) * own.wait_step;
                // Who is there only after the window begins may be too late for a long one as well.
                if early <= last && last.saturating_sub(first) < late - early {
                    return Some((position, late - early));
                }
                rest += wait;
            }
            (early, late) = (early + rest, late + rest);
            at = visit.place;
        }
        None
    }

    fn walk(
        &self,
        vehicle: usize,
        visits: impl Iterator<Item = (usize, usize)>,
        waits: &mut dyn FnMut(u64),
    ) -> Option<Spent> {
        let own = &self.vehicles[vehicle];
        let mut spent = Spent::default();
        let mut at = own.start;
        // A wait is as long as it is in the plan, whether the vehicle comes early or late.
        let (mut early, mut late) = own.begins;
        let mut stop: Option<Stop> = None;
        for (job, position) in visits {
            let visit = self.jobs[job].visits[position];
            let way = own.ways[at][visit.place]?;
            spent.add(way);
            early += u64::from(way.time) * SOONEST / 1000;
            late += own.longest(way);
            let joined = stop.filter(|stop| visit.depth.is_some() && stop.place == visit.at());
            let mut here = joined.unwrap_or(Stop {
                place: visit.at(),
                early,
                late,
                wait: 0,
                last: u64::MAX,
            });
            let waited = here.wait;
            here.begin_within(visit.window, own.wait_step)?;
            waits(here.wait);
            let rest = u64::from(visit.rest) + here.wait - waited;
            stop = Some(here);
            if !own.may_be_at(visit.place, (early, late + rest)) {
                return None;
            }
            (early, late) = (early + rest, late + rest);
            spent.rest += rest;
            spent.uses += rest * own.rest_uses;
            at = visit.place;
        }
        spent.add(own.ways[at][own.goal]?);
        Some(spent)
    }
}

/// A stop of a vehicle: one visit, or several that are joined.
#[derive(Clone, Copy)]
struct Stop {
    place: (usize, Option<u64>),
    /// When the vehicle comes there, at the earliest and at the latest.
    early: u64,
    late: u64,
    /// How long it waits there before anything is done.
    wait: u64,
    /// When it must have begun.
    last: u64,
}

impl Stop {
    /// Waits for one more window; none where another one, or this, is missed then.
    fn begin_within(&mut self, window: Option<(u64, u64)>, wait_step: u64) -> Option<()> {
        let Some((first, last)) = window else {
            return (self.late + self.wait <= self.last).then_some(());
        };
        let wait = first.saturating_sub(self.early).div_ceil(wait_step) * wait_step;
        self.wait = self.wait.max(wait);
        self.last = self.last.min(last);
        (self.late + self.wait <= self.last).then_some(())
    }
}

impl Visit {
    fn at(&self) -> (usize, Option<u64>) {
        (self.place, self.depth)
    }
}

/// What a vehicle spends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Time on its ways.
    pub time: u64,
    /// Time at rest.
    pub rest: u64,
    /// Of its budget.
    pub uses: u64,
}

impl Spent {
    fn add(&mut self, way: Way) {
        self.time += u64::from(way.time);
        self.uses += u64::from(way.uses);
    }
}
