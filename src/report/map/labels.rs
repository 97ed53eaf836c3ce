//! Label placement on the map: inside its frame and, where possible, without overlap, off the paths.

use std::collections::BTreeSet;

use crate::numeric::geometry;

/// Height of a line, and width of a letter on average, as shares of the size.
const LINE: f64 = 1.2;
const LETTER: f64 = 0.58;
/// Size of a label that finds no free place, as a share of the common size.
const SMALLER: f64 = 0.8;
/// Side of the squares that paths are drawn through, as a share of the size.
const SQUARE: f64 = 0.4;

/// A rectangle of the picture, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Area {
    pub(in crate::report) left: f64,
    pub(in crate::report) top: f64,
    pub(in crate::report) right: f64,
    pub(in crate::report) bottom: f64,
}

/// The side of its place that a label takes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::report) enum Side {
    /// On the place itself.
    Middle,
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

/// The anchor of a label: its middle, and the share of the common size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Anchor {
    pub(in crate::report) x: f64,
    pub(in crate::report) y: f64,
    pub(in crate::report) share: f64,
}

/// Labels, placed one after the other.
pub(in crate::report) struct Labels {
    frame: Area,
    /// Size of the letters.
    size: f64,
    taken: Vec<Area>,
    /// Squares that paths lead through, by column and row.
    crossed: BTreeSet<(i32, i32)>,
}

impl Area {
    fn around((x, y): (f64, f64), width: f64, height: f64) -> Self {
        Self {
            left: x - width / 2.0,
            top: y - height / 2.0,
            right: x + width / 2.0,
            bottom: y + height / 2.0,
        }
    }

    /// The area that two have in common.
    fn shared(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

impl Labels {
    pub(in crate::report) fn new(frame: Area, size: f64) -> Self {
        Self {
            frame,
            size,
            taken: Vec::new(),
            crossed: BTreeSet::new(),
        }
    }

    /// Keeps labels away from a mark.
    pub(in crate::report) fn avoid(&mut self, at: (f64, f64), size: f64) {
        self.taken.push(Area::around(at, size, size));
    }

    /// Keeps labels off a path.
    pub(in crate::report) fn pass(&mut self, path: impl Iterator<Item = (f64, f64)>) {
        let square = SQUARE * self.size;
        let mut last: Option<(f64, f64)> = None;
        for (x, y) in path {
            let from = last.unwrap_or((x, y));
            let steps = geometry::steps((x - from.0).hypot(y - from.1), square, (1, 1000));
            for step in 1..=steps {
                let share = f64::from(step) / f64::from(steps);
                let at = (from.0 + share * (x - from.0), from.1 + share * (y - from.1));
                self.crossed.insert(cell(at, square));
            }
            last = Some((x, y));
        }
    }

    /// What a label in this area would cover of other labels, marks and paths.
    fn covers(&self, area: &Area) -> f64 {
        let square = SQUARE * self.size;
        let (left, top) = cell((area.left, area.top), square);
        let (right, bottom) = cell((area.right, area.bottom), square);
        let crossed = (left..=right).flat_map(|column| {
            self.crossed
                .range((column, top)..=(column, bottom))
                .map(|_| square * square)
        });
        let taken = self.taken.iter().map(|taken| taken.shared(area));
        taken.chain(crossed).sum()
    }

    /// The first free anchor around a place, in small letters if necessary; if all
    /// overlap, the one that covers least.
    pub(in crate::report) fn place(&mut self, at: (f64, f64), side: Side, text: &str) -> Anchor {
        let mut best: Option<(f64, Anchor, Area)> = None;
        'tried: for share in [1.0, SMALLER] {
            for offset in offsets(side) {
                let (anchor, area) = self.anchor(at, offset, text, share);
                let covers = self.covers(&area);
                if best.is_none_or(|(least, ..)| covers < least) {
                    best = Some((covers, anchor, area));
                }
                if covers <= 0.0 {
                    break 'tried;
                }
            }
        }
        let (_, anchor, area) = best.expect("every side has offsets");
        self.taken.push(area);
        anchor
    }

    /// The anchor and area of a label at an offset from its place, pushed into the frame.
    fn anchor(&self, (x, y): (f64, f64), offset: Offset, text: &str, share: f64) -> (Anchor, Area) {
        let size = self.size * share;
        let (width, height) = (width(text) * size, LINE * size);
        let inside = |value: f64, from: f64, to: f64, length: f64| {
            value.min(to - length / 2.0).max(from + length / 2.0)
        };
        let x = x + offset.dx * self.size + offset.aside * width / 2.0;
        let anchor = Anchor {
            x: inside(x, self.frame.left, self.frame.right, width),
            y: inside(
                y + offset.dy * self.size,
                self.frame.top,
                self.frame.bottom,
                height,
            ),
            share,
        };
        (anchor, Area::around((anchor.x, anchor.y), width, height))
    }
}

/// Offset of a label from its place.
#[derive(Clone, Copy)]
struct Offset {
    /// Side on which the text lies: -1 left, 0 centred, 1 right.
    aside: f64,
    /// Shift in sizes of the text, to the right.
    dx: f64,
    /// Shift in sizes of the text, down.
    dy: f64,
}

impl Offset {
    const LEFT: Self = Self::new(-1.0, -0.85, 0.0);
    const RIGHT: Self = Self::new(1.0, 0.85, 0.0);

    const fn new(aside: f64, dx: f64, dy: f64) -> Self {
        Self { aside, dx, dy }
    }

    const fn centred(dy: f64) -> Self {
        Self::new(0.0, 0.0, dy)
    }
}

/// Offsets from a place, the preferred first.
fn offsets(side: Side) -> [Offset; 7] {
    let (left, right) = (Offset::LEFT, Offset::RIGHT);
    let (below, above) = (Offset::centred(1.3), Offset::centred(-1.3));
    let (far_below, far_above) = (Offset::centred(2.5), Offset::centred(-2.5));
    match side {
        Side::Middle => [
            Offset::centred(0.0),
            below,
            above,
            right,
            left,
            far_below,
            far_above,
        ],
        Side::Left => [left, right, above, below, far_above, far_below, left],
        Side::Right => [right, left, above, below, far_above, far_below, right],
    }
}

/// Column and row of the square with a point.
#[expect(clippy::cast_possible_truncation, reason = "saturates")]
fn cell((x, y): (f64, f64), square: f64) -> (i32, i32) {
    ((x / square).floor() as i32, (y / square).floor() as i32)
}

/// Width of a text of size 1: letters beyond ASCII may be wide.
fn width(text: &str) -> f64 {
    text.chars()
        .map(|c| if c.is_ascii() { LETTER } else { 1.0 })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::{Area, Labels, Side};

    const FRAME: Area = Area {
        left: 0.0,
        top: 0.0,
        right: 1000.0,
        bottom: 600.0,
    };

    #[test]
    fn names_stay_inside_of_the_frame() {
        let mut labels = Labels::new(FRAME, 15.0);
        let wide = 0.58 * 15.0 * 20.0;
        for (at, side) in [
            ((3.0, 2.0), Side::Middle),
            ((998.0, 300.0), Side::Right),
            ((1.0, 599.0), Side::Left),
        ] {
            let anchor = labels.place(at, side, "a-name-of-20-letters");
            assert!(anchor.x - wide / 2.0 >= -1e-9 && anchor.x + wide / 2.0 <= 1000.0 + 1e-9);
            assert!(anchor.y >= 9.0 - 1e-9 && anchor.y <= 591.0 + 1e-9);
        }
    }

    #[test]
    fn a_name_gives_way_to_the_path_through_its_place() {
        let mut labels = Labels::new(FRAME, 15.0);
        labels.pass([(0.0, 300.0), (1000.0, 300.0)].into_iter());
        let anchor = labels.place((500.0, 300.0), Side::Middle, "watch-post");
        assert!(
            (anchor.y - 300.0).abs() > 9.0 && anchor.share >= 1.0,
            "{anchor:?}"
        );
        assert!((anchor.x - 500.0).abs() < 1e-9, "{anchor:?}");
    }

    #[test]
    fn names_of_one_place_are_written_apart() {
        let mut labels = Labels::new(FRAME, 15.0);
        let anchors: Vec<_> = (0..5)
            .map(|_| labels.place((500.0, 300.0), Side::Middle, "watch-post"))
            .collect();
        for (number, a) in anchors.iter().enumerate() {
            for b in &anchors[number + 1..] {
                let wide = 0.58 * 15.0 * 10.0;
                assert!((a.x - b.x).abs() >= wide - 1e-9 || (a.y - b.y).abs() >= 18.0 - 1e-9);
            }
        }
    }
}
