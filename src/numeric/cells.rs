//! Things that last a while somewhere, found by the cells of time and place they touch.

/// Extent in time (s), east and north (m): lowest and highest of each. The end in time
/// may be infinite.
pub type Extent = [(f64, f64); 3];

/// Cells along time and each side of the plane, at most.
const MAX_CELLS: [f64; 3] = [256.0, 64.0, 64.0];
/// Cells for each thing, at most: more would cost more to make than they save.
const CELLS_PER_ITEM: f64 = 64.0;

/// Numbered extents, sorted into the equal cells of a box.
///
/// What lies beyond the box falls into its outermost cells, so a look never misses
/// anything; it may find what is a cell away.
#[derive(Clone, Debug)]
pub struct Cells {
    low: [f64; 3],
    per_unit: [f64; 3],
    counts: [usize; 3],
    /// `members` of cell `c` are `members[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    members: Vec<Member>,
}

/// An item in a cell, and the first cell along each axis that it touches.
#[derive(Clone, Copy, Debug)]
struct Member {
    item: u32,
    first: [u16; 3],
}

impl Member {
    /// Whether a cell of a range is the first in which the item is: there it is reported.
    fn is_first_in(&self, at: [usize; 3], range: &Range) -> bool {
        (0..3).all(|axis| at[axis] == range[axis].0.max(usize::from(self.first[axis])))
    }
}

/// First and last cell along each axis.
type Range = [(usize, usize); 3];

impl Cells {
    /// Sorts extents into cells no smaller than `least` (s, m, m).
    #[must_use]
    pub fn new(extents: &[Extent], least: [f64; 3]) -> Self {
        let mut cells = Self::over(extents, least);
        let ranges: Vec<Range> = extents.iter().map(|extent| cells.range(extent)).collect();
        let mut starts = vec![0_u32; cells.counts.iter().product::<usize>() + 1];
        for range in &ranges {
            cells.visit(range, |[cell, ..]| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let nobody = Member {
            item: 0,
            first: [0; 3],
        };
        let mut members = vec![nobody; starts.last().map_or(0, |end| *end as usize)];
        for (item, range) in (0_u32..).zip(&ranges) {
            // No axis has more than a few hundred cells.
            let first = range.map(|(first, _)| u16::try_from(first).unwrap_or(u16::MAX));
            cells.visit(range, |[cell, ..]| {
                members[next[cell] as usize] = Member { item, first };
                next[cell] += 1;
            });
        }
        cells.starts = starts;
        cells.members = members;
        cells
    }

    /// Whether nothing is in the cells that an extent touches.
    #[must_use]
    pub fn is_clear(&self, extent: &Extent) -> bool {
        let [times, easts, norths] = self.range(extent);
        for time in times.0..times.1 + 1 {
            for east in easts.0..easts.1 + 1 {
                // Cells along north follow each other, so one look covers them.
                let first = self.index([time, east, norths.0]);
                let last = self.index([time, east, norths.1]);
                if self.starts[first] != self.starts[last + 1] {
                    return false;
                }
            }
        }
        true
    }

    /// Calls `act` with the number of everything in the cells that an extent touches, once.
    pub fn each(&self, extent: &Extent, mut act: impl FnMut(usize)) {
        self.any(extent, |item| {
            act(item);
            false
        });
    }

    /// Whether `is_it` holds for anything in the cells that an extent touches, which are gone
    /// through until it does.
    pub fn any(&self, extent: &Extent, mut is_it: impl FnMut(usize) -> bool) -> bool {
        let range = self.range(extent);
        for time in range[0].0..range[0].1 + 1 {
            for east in range[1].0..range[1].1 + 1 {
                // Cells along north follow each other, so one look finds that all are empty.
                let row = [range[2].0, range[2].1 + 1].map(|north| self.index([time, east, north]));
                if self.starts[row[0]] == self.starts[row[1]] {
                    continue;
                }
                for north in range[2].0..range[2].1 + 1 {
                    let at = [time, east, north];
                    let cell = self.index(at);
                    let members = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                    let found = self.members[members].iter().any(|member| {
                        member.is_first_in(at, &range) && is_it(member.item as usize)
                    });
                    if found {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Empty cells over all extents.
    fn over(extents: &[Extent], least: [f64; 3]) -> Self {
        let mut all = [(f64::INFINITY, f64::NEG_INFINITY); 3];
        for extent in extents {
            for (all, &(low, high)) in all.iter_mut().zip(extent) {
                all.0 = all.0.min(low);
                all.1 = all.1.max(if high.is_finite() { high } else { low });
            }
        }
        let count_along = |axis: usize| {
            let width = all[axis].1 - all[axis].0;
            if width > 0.0 && least[axis] > 0.0 {
                (width / least[axis]).ceil().clamp(1.0, MAX_CELLS[axis])
            } else {
                1.0
            }
        };
        let mut counts = [count_along(0), count_along(1), count_along(2)];
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52")]
        let most = (CELLS_PER_ITEM * extents.len() as f64).max(1.0);
        // Motions follow time, so its cells tell most of them apart and are kept.
        let shrink = (most / (counts[0] * counts[1] * counts[2])).sqrt().min(1.0);
        for count in &mut counts[1..] {
            *count = (*count * shrink).floor().max(1.0);
        }
        let mut cells = Self {
            low: [0.0; 3],
            per_unit: [0.0; 3],
            counts: [1; 3],
            starts: Vec::new(),
            members: Vec::new(),
        };
        for axis in 0..3 {
            if counts[axis] > 1.0 {
                cells.low[axis] = all[axis].0;
                cells.per_unit[axis] = counts[axis] / (all[axis].1 - all[axis].0);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "at most the most cells"
                )]
                let count = counts[axis] as usize;
                cells.counts[axis] = count;
            }
        }
        cells
    }

    fn index(&self, [time, east, north]: [usize; 3]) -> usize {
        (time * self.counts[1] + east) * self.counts[2] + north
    }

    /// Calls `act` with the number of each cell, and that along each axis.
    fn visit(&self, range: &Range, mut act: impl FnMut([usize; 4])) {
        for time in range[0].0..range[0].1 + 1 {
            for east in range[1].0..range[1].1 + 1 {
                for north in range[2].0..range[2].1 + 1 {
                    act([self.index([time, east, north]), time, east, north]);
                }
            }
        }
    }

    fn range(&self, extent: &Extent) -> Range {
        let cells = |axis: usize| {
            let last = self.counts[axis] - 1;
            // Not a number (nothing times infinity) and what is negative become 0.
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a cast saturates, then the cell is clamped"
            )]
            let cell = |at: f64| (((at - self.low[axis]) * self.per_unit[axis]) as usize).min(last);
            (cell(extent[axis].0), cell(extent[axis].1))
        };
        [cells(0), cells(1), cells(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::{Cells, Extent};
    use proptest::prelude::*;

    fn extent() -> impl Strategy<Value = Extent> {
        let side =
            || (-2000.0..2000.0_f64, 0.0..600.0_f64).prop_map(|(low, wide)| (low, low + wide));
        let time = prop_oneof![
            4 => (0.0..900.0_f64, 0.0..60.0_f64).prop_map(|(low, wide)| (low, low + wide)),
            1 => (0.0..900.0_f64).prop_map(|low| (low, f64::INFINITY)),
        ];
        (time, side(), side()).prop_map(|(time, east, north)| [time, east, north])
    }

    fn touches(a: &Extent, b: &Extent) -> bool {
        a.iter().zip(b).all(|(a, b)| a.0 <= b.1 && b.0 <= a.1)
    }

    proptest! {
        #[test]
        fn a_query_finds_all_it_touches_and_nothing_twice(
            extents in prop::collection::vec(extent(), 0..60), look in extent()
        ) {
            let cells = Cells::new(&extents, [10.0, 100.0, 100.0]);
            let mut found = vec![false; extents.len()];
            cells.each(&look, |item| assert!(!std::mem::replace(&mut found[item], true)));
            prop_assert_eq!(cells.is_clear(&look), found.iter().all(|found| !found));
            for (item, &found) in found.iter().enumerate() {
                prop_assert_eq!(cells.any(&look, |other| other == item), found);
            }
            for (extent, found) in extents.iter().zip(found) {
                prop_assert!(found || !touches(extent, &look), "{extent:?} {look:?}");
            }
        }
    }
}
