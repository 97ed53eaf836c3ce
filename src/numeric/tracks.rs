//! Which of many tracks come too near to one: a space-time index over their pieces, and
//! the exact closest approach for the pieces it brings together.

mod ends;
mod run;

use std::ops::Range;

use rayon::prelude::*;

use super::approach::{Segment, Whole, are_surely_apart, closest_approach, closest_horizontal};
use super::cells::{Cells, Extent};
use ends::ByPlace;
use run::Run;

pub use ends::{CLEARED_AFTER_S, Ends, LEVEL_M, clear_m};

/// How many times as large as the next a part of the index is.
const PARTS: usize = 4;

/// When two tracks are too near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// They are below this distance, metres: horizontal, if there is a vertical one.
    pub distance_m: f64,
    /// Their heights differ by at most this, metres.
    pub vertical_m: Option<f64>,
    /// One may be this much later or earlier than it says, seconds.
    pub slack_s: f64,
    /// One lands nearer than this to where the other stands, metres; 0 where that does not count.
    pub clear_m: f64,
}

impl Nearness {
    fn is_broken(&self, a: &Segment, b: &Segment) -> bool {
        let nearest = match self.vertical_m {
            None => closest_approach(a, b, self.slack_s),
            Some(vertical_m) => closest_horizontal(a, b, self.slack_s, vertical_m),
        };
        nearest.is_some_and(|nearest| nearest.value < self.distance_m)
    }

    /// Whether one of two lands where the other stands.
    fn is_broken_on_ground(&self, own: Option<&Ends>, other: &Track) -> bool {
        let ends = own.zip(other.ends.as_ref());
        ends.is_some_and(|(own, other)| own.are_in_conflict(other, self.clear_m, self.slack_s))
    }

    /// Heights that differ by more never count, metres.
    fn height_m(&self) -> f64 {
        self.vertical_m.unwrap_or(self.distance_m)
    }
}

/// Something that moves, in order of time.
#[derive(Clone, Debug)]
pub struct Track {
    segments: Vec<Segment>,
    runs: Vec<Run>,
    /// Where it stands on the ground before and after, if that counts.
    ends: Option<Ends>,
}

impl Track {
    /// A track of motions in order of time.
    #[must_use]
    pub fn new(segments: Vec<Segment>) -> Self {
        let mut runs = Vec::new();
        // What stays for ever is at rest, and far from any motion over others.
        let stays = segments
            .iter()
            .position(|segment| !segment.t1_s.is_finite());
        let (moving, staying) = segments.split_at(stays.unwrap_or(segments.len()));
        for part in [(0, moving), (moving.len(), staying)] {
            if !part.1.is_empty() {
                Run::push_all(part.0, part.1, &mut runs);
            }
        }
        Self {
            segments,
            runs,
            ends: None,
        }
    }

    /// The same track, with where the vehicle stands before and after it.
    #[must_use]
    pub fn standing_at(self, ends: Option<Ends>) -> Self {
        Self { ends, ..self }
    }

    /// The motions.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    fn segments_of(&self, run: &Run) -> &[Segment] {
        &self.segments[run.first..run.end]
    }

    /// Whether two runs come too near each other, the own one some seconds later than its motions.
    fn meets(
        &self,
        (own, later_s): (&Run, f64),
        (other, run): (&Self, &Run),
        nearness: &Nearness,
    ) -> bool {
        let (distance_m, height_m) = (nearness.distance_m, nearness.height_m());
        let may_be_near = |own: &Whole| {
            let whole = &run.whole;
            whole.may_be_near(own, nearness.slack_s, (distance_m, height_m))
        };
        if !may_be_near(&own.whole) {
            return false;
        }
        let own = self.segments_of(own).iter();
        let own = own.map(|segment| segment.later(later_s));
        let mut own = own.filter(|a| may_be_near(&Whole::of(a)));
        own.any(|a| {
            other.segments_of(run).iter().any(|b| {
                !are_surely_apart(&a, b, nearness.slack_s, distance_m, height_m)
                    && nearness.is_broken(&a, b)
            })
        })
    }
}

/// Tracks in the order in which they came, found by time and place.
///
/// The index has parts, each some times as large as the next: a new
/// track makes a part of its own, and parts that have become alike are made one. So
/// adding `n` tracks costs `n log n`, and a look goes through `log n` parts.
#[derive(Clone, Debug)]
pub struct Tracks {
    least: [f64; 3],
    tracks: Vec<Track>,
    parts: Vec<Part>,
    by_place: ByPlace,
}

/// Tracks from `first` on, as far as the next part.
#[derive(Clone, Debug)]
struct Part {
    first: usize,
    /// Track and run of every item of the cells.
    items: Vec<(u32, u32)>,
    cells: Cells,
}

impl Tracks {
    /// No tracks; `nearness` is what will be asked, roughly.
    #[must_use]
    pub fn new(nearness: &Nearness) -> Self {
        let side_m = 4.0 * nearness.distance_m;
        Self {
            least: [4.0 * nearness.slack_s.max(5.0), side_m, side_m],
            tracks: Vec::new(),
            parts: Vec::new(),
            by_place: ByPlace::default(),
        }
    }

    /// Number of tracks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tracks.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }

    /// All of them, by number.
    #[must_use]
    pub fn all(&self) -> &[Track] {
        &self.tracks
    }

    /// Adds tracks; their numbers go on from [`Self::len`].
    pub fn extend(&mut self, tracks: impl IntoIterator<Item = Track>) {
        let mut first = self.tracks.len();
        self.tracks.extend(tracks);
        for (number, track) in self.tracks.iter().enumerate().skip(first) {
            if let Some(ends) = &track.ends {
                self.by_place.add(number, ends);
            }
        }
        while let Some(part) = self.parts.last() {
            if first - part.first > PARTS * (self.tracks.len() - first) {
                break;
            }
            first = part.first;
            self.parts.pop();
        }
        if first < self.tracks.len() {
            self.parts.push(self.part(first));
        }
    }

    fn part(&self, first: usize) -> Part {
        let mut items = Vec::new();
        let mut extents = Vec::new();
        for (index, track) in (0_u32..).zip(&self.tracks).skip(first) {
            items.extend((0_u32..).zip(&track.runs).map(|(run, _)| (index, run)));
            extents.extend(track.runs.iter().map(|run| run.extent));
        }
        Part {
            first,
            items,
            cells: Cells::new(&extents, self.least),
        }
    }

    /// The numbers, in order, of the tracks from number `from` on that come too near.
    #[must_use]
    pub fn near(&self, own: &Track, nearness: &Nearness, from: usize) -> Vec<usize> {
        self.near_among(own, nearness, from..self.tracks.len())
    }

    /// The same of the tracks with numbers in a range.
    #[must_use]
    pub fn near_among(
        &self,
        own: &Track,
        nearness: &Nearness,
        Range { start: from, end }: Range<usize>,
    ) -> Vec<usize> {
        let mut is_near = self.near_on_ground((own, 0.0), nearness, &(from..end));
        let ends = self.parts.iter().skip(1).map(|part| part.first);
        let ends = ends.chain([self.tracks.len()]);
        let parts = self.parts.iter().zip(ends);
        for (part, _) in parts.filter(|(part, until)| *until > from && part.first < end) {
            for run in &own.runs {
                let reach = run.reach(nearness);
                part.cells.each(&reach, |item| {
                    let (track, other) = part.items[item];
                    let (track, other) = (track as usize, other as usize);
                    if track < from || track >= end || is_near[track] {
                        return;
                    }
                    let track_of = &self.tracks[track];
                    let other = &track_of.runs[other];
                    is_near[track] = run.may_meet(&reach, other, nearness)
                        && own.meets((run, 0.0), (track_of, other), nearness);
                });
            }
        }
        numbers(&is_near)
    }

    /// The same of a track at several delays, seconds: the index is looked through once for all.
    #[must_use]
    pub fn near_delayed(
        &self,
        own: &Track,
        nearness: &Nearness,
        among: Range<usize>,
        delays_s: &[f64],
    ) -> Vec<Vec<usize>> {
        let pairs = self.pairs_of_runs(own, nearness, &among, delays_s);
        let near = |later_s: f64| {
            let runs = own.runs.iter().map(|run| run.later(later_s));
            let runs: Vec<Run> = runs.collect();
            let reaches: Vec<Extent> = runs.iter().map(|run| run.reach(nearness)).collect();
            let mut is_near = self.near_on_ground((own, later_s), nearness, &among);
            for &(run, track, other) in &pairs {
                if is_near[track] {
                    continue;
                }
                let track_of = &self.tracks[track];
                let (reach, other) = (&reaches[run], &track_of.runs[other]);
                let run = &runs[run];
                is_near[track] = run.may_meet(reach, other, nearness)
                    && own.meets((run, later_s), (track_of, other), nearness);
            }
            numbers(&is_near)
        };
        delays_s.par_iter().map(|&later_s| near(later_s)).collect()
    }

    /// Runs of a track and those of others that may meet at some delay: by number, the track, and
    /// the run of it.
    fn pairs_of_runs(
        &self,
        own: &Track,
        nearness: &Nearness,
        among: &Range<usize>,
        delays_s: &[f64],
    ) -> Vec<(usize, usize, usize)> {
        /// More than rounding takes from a time, seconds.
        const ROUNDING_S: f64 = 1e-3;
        let min_s = delays_s.iter().copied().fold(f64::INFINITY, f64::min);
        let max_s = delays_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut pairs = Vec::new();
        for (number, run) in own.runs.iter().enumerate() {
            let mut reach = run.reach(nearness);
            reach[0].0 += min_s - ROUNDING_S;
            reach[0].1 += max_s + ROUNDING_S;
            for part in &self.parts {
                part.cells.each(&reach, |item| {
                    let (track, other) = part.items[item];
                    let (track, other) = (track as usize, other as usize);
                    let other_run = &self.tracks[track].runs[other];
                    if among.contains(&track) && run.may_meet(&reach, other_run, nearness) {
                        pairs.push((number, track, other));
                    }
                });
            }
        }
        pairs
    }

    /// By number, which of the tracks in a range stand where one lands that is flown some seconds later, or land where
    /// that stands.
    fn near_on_ground(
        &self,
        (own, later_s): (&Track, f64),
        nearness: &Nearness,
        among: &Range<usize>,
    ) -> Vec<bool> {
        let mut is_near = vec![false; self.tracks.len()];
        let found = self.on_ground((own, later_s), nearness);
        for number in found.filter(|number| among.contains(number)) {
            is_near[number] = true;
        }
        is_near
    }

    /// The numbers of those, some of them twice.
    fn on_ground(
        &self,
        (own, later_s): (&Track, f64),
        nearness: &Nearness,
    ) -> impl Iterator<Item = usize> {
        let counts = nearness.clear_m > 0.0;
        let ends = own.ends.filter(|_| counts).map(|ends| ends.later(later_s));
        let near = ends
            .into_iter()
            .flat_map(|ends| self.by_place.near(ends).map(move |number| (ends, number)));
        let nearness = *nearness;
        let met = near.filter(move |(ends, number)| {
            nearness.is_broken_on_ground(Some(ends), &self.tracks[*number])
        });
        met.map(|(_, number)| number)
    }

    /// Whether any of the tracks that count comes too near to a track that is flown some seconds
    /// later. `counts` gets the number of a track.
    #[must_use]
    pub fn is_any_near(
        &self,
        (own, later_s): (&Track, f64),
        nearness: &Nearness,
        counts: impl Fn(usize) -> bool,
    ) -> bool {
        self.on_ground((own, later_s), nearness).any(&counts)
            || own.runs.iter().any(|run| {
                let run = &run.later(later_s);
                let reach = run.reach(nearness);
                self.parts.iter().any(|part| {
                    part.cells.any(&reach, |item| {
                        let (track, other) = part.items[item];
                        let track = track as usize;
                        let track_of = &self.tracks[track];
                        let other = &track_of.runs[other as usize];
                        run.may_meet(&reach, other, nearness)
                            && counts(track)
                            && own.meets((run, later_s), (track_of, other), nearness)
                    })
                })
            })
    }

    /// The same by looking at every motion of every track.
    #[must_use]
    pub fn near_by_all(&self, own: &Track, nearness: &Nearness, from: usize) -> Vec<usize> {
        let meets = |track: &Track| {
            own.segments
                .iter()
                .any(|a| track.segments.iter().any(|b| nearness.is_broken(a, b)))
                || nearness.is_broken_on_ground(own.ends.as_ref(), track)
        };
        let is_near: Vec<bool> = self
            .tracks
            .iter()
            .enumerate()
            .map(|(index, track)| index >= from && meets(track))
            .collect();
        numbers(&is_near)
    }
}

fn numbers(is_near: &[bool]) -> Vec<usize> {
    let all = is_near.iter().enumerate();
    all.filter(|(_, near)| **near)
        .map(|(index, _)| index)
        .collect()
}

#[cfg(test)]
mod tests;
