//! Where one more job is cheapest for a vehicle.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Assignment, Form, Spent};

/// What insertions are dearer by, at random.
pub(super) struct Noise<'a> {
    pub(super) rng: &'a mut ChaCha8Rng,
    /// At most.
    pub(super) scale: u64,
}

impl Noise<'_> {
    fn draw(&mut self) -> u64 {
        self.rng.random_range(0..=self.scale)
    }
}

/// Where a job is inserted into the visits of a vehicle.
#[derive(Clone, Debug)]
pub(super) struct Insertion {
    /// The time that it adds.
    pub(super) added: i64,
    at: Placed,
}

/// Before which of the visits the places of a job come.
#[derive(Clone, Debug)]
enum Placed {
    /// Each of its own; ascending.
    Apart(Vec<usize>),
    /// All of them, in their order or from the last to the first.
    Together(usize, bool),
}

impl Insertion {
    pub(super) fn into(self, visits: &mut Vec<(usize, usize)>, (job, count): (usize, usize)) {
        *visits = self.at.merged(visits, (job, count)).collect();
    }
}

impl Placed {
    /// Visits with all `count` visits of one more job.
    fn merged<'a>(
        &'a self,
        visits: &'a [(usize, usize)],
        (job, count): (usize, usize),
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let mut next = 0;
        let mut index = 0;
        std::iter::from_fn(move || {
            let before = match self {
                Self::Apart(at) => at.get(next).copied(),
                Self::Together(at, _) => (next < count).then_some(*at),
            };
            if before.is_some_and(|before| before <= index) {
                next += 1;
                return Some((job, self.position(next - 1, count)));
            }
            index += 1;
            visits.get(index - 1).copied()
        })
    }

    /// Which of its places a job visits as its `nth`.
    fn position(&self, nth: usize, count: usize) -> usize {
        match self {
            Self::Together(_, true) => count - 1 - nth,
            _ => nth,
        }
    }
}

impl Assignment<'_> {
    /// The cheapest way for a vehicle with these visits to do one more job within its budget.
    pub(super) fn cheapest(
        &self,
        visits: &[(usize, usize)],
        (vehicle, job): (usize, usize),
        mut noise: Option<&mut Noise<'_>>,
    ) -> Option<Insertion> {
        let (count, own) = (self.jobs[job].visits.len(), &self.vehicles[vehicle]);
        if visits.len() + count > own.max_visits || !self.jobs[job].vehicles[vehicle] {
            return None;
        }
        let before = self.go(vehicle, visits.iter().copied())?;
        let has_time = |(job, position): &(usize, usize)| {
            let visit = &self.jobs[*job].visits[*position];
            visit.window.is_some() || own.minds_time_at(visit.place)
        };
        let is_timed =
            visits.iter().any(has_time) || (0..count).any(|position| has_time(&(job, position)));
        let mut best: Option<Insertion> = None;
        let mut consider = |at: Placed| {
            let found = match is_timed {
                true => self.go(vehicle, at.merged(visits, (job, count))),
                false => self.changed(before, visits, (vehicle, job), &at),
            };
            let Some(found) = found.filter(|found| found.uses <= own.budget) else {
                return;
            };
            let above = noise.as_mut().map_or(0, |noise| noise.draw());
            let added = (found.time + above).cast_signed() - before.time.cast_signed();
            if best.as_ref().is_none_or(|best| added < best.added) {
                best = Some(Insertion { added, at });
            }
        };
        self.each_position(visits, job, &mut consider);
        best
    }

    /// All positions of a job among visits.
    fn each_position(
        &self,
        visits: &[(usize, usize)],
        job: usize,
        consider: &mut dyn FnMut(Placed),
    ) {
        let (form, count) = (self.jobs[job].form, self.jobs[job].visits.len());
        // Between two visits of a job that are made at once nothing comes.
        let is_open = |at: usize| {
            let around = at
                .checked_sub(1)
                .and_then(|before| visits.get(before))
                .zip(visits.get(at));
            around.is_none_or(|(before, after)| {
                before.0 != after.0 || self.jobs[before.0].form == Form::Open
            })
        };
        if form == Form::Open && count > 1 {
            let mut at = vec![0; count];
            loop {
                if at.iter().all(|at| is_open(*at)) {
                    consider(Placed::Apart(at.clone()));
                }
                if !next_positions(&mut at, visits.len()) {
                    return;
                }
            }
        }
        for at in (0..=visits.len()).filter(|at| is_open(*at)) {
            consider(Placed::Together(at, false));
            if form == Form::EitherWay {
                consider(Placed::Together(at, true));
            }
        }
    }

    /// What a vehicle spends with a job more, where nothing waits for a window.
    fn changed(
        &self,
        before: Spent,
        visits: &[(usize, usize)],
        (vehicle, job): (usize, usize),
        at: &Placed,
    ) -> Option<Spent> {
        let (own, of) = (&self.vehicles[vehicle], &self.jobs[job].visits);
        let place = |index: Option<usize>, end: usize| {
            let visit = index.and_then(|index| visits.get(index));
            visit.map_or(end, |&(job, position)| {
                self.jobs[job].visits[position].place
            })
        };
        let index = |nth: usize| match at {
            Placed::Apart(at) => at[nth],
            Placed::Together(at, _) => *at,
        };
        let mut spent = before;
        for nth in 0..of.len() {
            let (here, visit) = (index(nth), of[at.position(nth, of.len())]);
            let follows = nth > 0 && index(nth - 1) == here;
            let from = match follows {
                true => of[at.position(nth - 1, of.len())].place,
                false => place(here.checked_sub(1), own.start),
            };
            spent.add(own.ways[from][visit.place]?);
            spent.rest += u64::from(visit.rest);
            spent.uses += u64::from(visit.rest) * own.rest_uses;
            if nth + 1 == of.len() || index(nth + 1) != here {
                let next = place(Some(here), own.goal);
                spent.add(own.ways[visit.place][next]?);
                let left = own.ways[place(here.checked_sub(1), own.start)][next]?;
                spent.time -= u64::from(left.time);
                spent.uses -= u64::from(left.uses);
            }
        }
        Some(spent)
    }

    /// What a vehicle spends with its own job and one more, the least use in any order and whatever
    /// its budget; none where there is no way, or the job is not for it.
    #[must_use]
    pub fn alone(&self, vehicle: usize, job: usize) -> Option<Spent> {
        if !self.jobs[job].vehicles[vehicle] {
            return None;
        }
        let (own, count) = (self.own_visits(vehicle), self.jobs[job].visits.len());
        let mut best: Option<Spent> = None;
        self.each_position(&own, job, &mut |at| {
            let spent = self.go(vehicle, at.merged(&own, (job, count)));
            best = best.into_iter().chain(spent).min_by_key(|spent| spent.uses);
        });
        best
    }
}

/// The next ascending positions up to `most`; none after the last.
fn next_positions(at: &mut [usize], most: usize) -> bool {
    for place in (0..at.len()).rev() {
        if at[place] < most {
            let value = at[place] + 1;
            at[place..].fill(value);
            return true;
        }
    }
    false
}
