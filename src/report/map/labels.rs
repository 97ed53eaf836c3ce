//! Label placement on the map: inside its frame and, where possible, without overlap, off the paths.

use std::collections::BTreeSet;

use super::obstacle::{Area, Obstacle, around};
use crate::numeric::geometry;

/// Height of a line, and width of a letter on average, as shares of the size.
const LINE: f64 = 1.2;
const LETTER: f64 = 0.58;
/// Size of a label that finds no free place, as a share of the common size.
const SMALLER: f64 = 0.8;
/// Distance of labels of obstacles from each other in a line, as a share of the size.
const APART: f64 = 0.4;
/// Side of the squares that paths are drawn through, as a share of the size.
const SQUARE: f64 = 0.4;
/// Distance of a label from the outline of its obstacle, as a share of the size.
const GAP: f64 = 0.42;

/// The side of its place that a label takes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// To the left of it.
    Left,
    /// To the right of it.
    Right,
}

/// The anchor of a label: its middle, and the share of the common size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Anchor {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) share: f64,
}

/// Labels, placed one after the other.
pub(super) struct Labels {
    frame: Area,
    /// Size of the letters.
    size: f64,
    taken: Vec<Area>,
    /// Squares that paths lead through, by column and row.
    crossed: BTreeSet<(i32, i32)>,
    /// Squares that outlines of obstacles lead through.
    outlines: BTreeSet<(i32, i32)>,
}

impl Labels {
    pub(super) fn new(frame: Area, size: f64) -> Self {
        Self {
            frame,
            size,
            taken: Vec::new(),
            crossed: BTreeSet::new(),
            outlines: BTreeSet::new(),
        }
    }

    /// Keeps labels away from a mark.
    pub(super) fn avoid(&mut self, at: (f64, f64), size: f64) {
        self.taken.push(Area::around(at, size, size));
    }

    /// Keeps labels off an area.
    pub(super) fn leave_free(&mut self, area: Area) {
        self.taken.push(area);
    }

    /// Keeps labels off a path.
    pub(super) fn pass(&mut self, path: impl Iterator<Item = (f64, f64)>) {
        mark(&mut self.crossed, SQUARE * self.size, path);
    }

    /// What a label in this area would cover of other labels, marks and paths.
    fn covers(&self, area: &Area) -> f64 {
        let square = SQUARE * self.size;
        let crossings = u32::try_from(crossings(&self.crossed, area, square)).unwrap_or(u32::MAX);
        let taken = self.taken.iter().map(|taken| taken.shared(area));
        taken.sum::<f64>() + f64::from(crossings) * square * square
    }

    /// The first free anchor around a place, in small letters if necessary; if all
    /// overlap, the one that covers least.
    pub(super) fn place(&mut self, at: (f64, f64), side: Side, text: &str) -> Anchor {
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

    /// The first free anchor of a label of an obstacle, and the number of its form; none if all
    /// overlap. It is free inside of the frame, off other labels, marks, outlines and paths
    /// (`on_paths`: the last form on a path, if necessary), and not on another obstacle.
    pub(super) fn place_free(
        &mut self,
        obstacles: &[Obstacle],
        own: usize,
        forms: &[String],
        on_paths: bool,
    ) -> Option<(Anchor, usize)> {
        if self.outlines.is_empty() {
            for obstacle in obstacles {
                let ring = obstacle.ring.iter().copied();
                mark(&mut self.outlines, SQUARE * self.size, ring);
            }
        }
        let on_path = on_paths.then(|| forms.len().saturating_sub(1));
        let tried = (0..forms.len()).map(|form| (form, true));
        for (form, off_paths) in tried.chain(on_path.map(|form| (form, false))) {
            let found = self.free(obstacles, own, &forms[form], off_paths);
            if let Some((anchor, area)) = found {
                self.taken.push(area.widened(APART * self.size));
                return Some((anchor, form));
            }
        }
        None
    }

    fn free(
        &self,
        obstacles: &[Obstacle],
        own: usize,
        text: &str,
        off_paths: bool,
    ) -> Option<(Anchor, Area)> {
        let obstacle = &obstacles[own];
        let is_other = |at: (f64, f64)| {
            let middle = obstacle.middle();
            let mut others = obstacles.iter().enumerate();
            others.any(|(index, other)| index != own && other.holds(at) && !other.holds(middle))
        };
        for is_inside in [true, false] {
            for share in [1.0, SMALLER] {
                let (width, height) = (width(text) * self.size * share, LINE * self.size * share);
                for (x, y) in around(&obstacle.area, is_inside, (width, height), self.size * GAP) {
                    let area = Area::around((x, y), width, height);
                    if obstacle.holds((x, y)) == is_inside
                        && self.is_free(&area, off_paths)
                        && !is_other((x, y))
                    {
                        return Some((Anchor { x, y, share }, area));
                    }
                }
            }
        }
        None
    }

    fn is_free(&self, area: &Area, off_paths: bool) -> bool {
        let square = SQUARE * self.size;
        let frame = &self.frame;
        area.left >= frame.left
            && area.right <= frame.right
            && area.top >= frame.top
            && area.bottom <= frame.bottom
            && self.taken.iter().all(|taken| taken.shared(area) <= 0.0)
            && crossings(&self.outlines, area, square) == 0
            && (!off_paths || crossings(&self.crossed, area, square) == 0)
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

impl Anchor {
    /// Full size on a point.
    pub(super) fn full((x, y): (f64, f64)) -> Self {
        Self { x, y, share: 1.0 }
    }
}

/// Marks the squares that a line leads through.
fn mark(squares: &mut BTreeSet<(i32, i32)>, square: f64, line: impl Iterator<Item = (f64, f64)>) {
    let mut last: Option<(f64, f64)> = None;
    for (x, y) in line {
        let from = last.unwrap_or((x, y));
        let steps = geometry::steps((x - from.0).hypot(y - from.1), square, (1, 1000));
        for step in 1..=steps {
            let share = f64::from(step) / f64::from(steps);
            let at = (from.0 + share * (x - from.0), from.1 + share * (y - from.1));
            squares.insert(cell(at, square));
        }
        last = Some((x, y));
    }
}

/// How many of the marked squares an area touches.
fn crossings(squares: &BTreeSet<(i32, i32)>, area: &Area, square: f64) -> usize {
    let (left, top) = cell((area.left, area.top), square);
    let (right, bottom) = cell((area.right, area.bottom), square);
    (left..=right)
        .map(|column| squares.range((column, top)..=(column, bottom)).count())
        .sum()
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
fn offsets(side: Side) -> [Offset; 6] {
    let (first, second) = match side {
        Side::Left => (Offset::LEFT, Offset::RIGHT),
        Side::Right => (Offset::RIGHT, Offset::LEFT),
    };
    let (below, above) = (Offset::centred(1.3), Offset::centred(-1.3));
    let (far_below, far_above) = (Offset::centred(2.5), Offset::centred(-2.5));
    [first, second, above, below, far_above, far_below]
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
    use super::{Area, Labels, Obstacle, Side, width};

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
            ((3.0, 2.0), Side::Left),
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
        let anchor = labels.place((500.0, 300.0), Side::Right, "watch-post");
        assert!(
            (anchor.y - 300.0).abs() > 9.0 && anchor.share >= 1.0,
            "{anchor:?}"
        );
        assert!((anchor.x - 500.0).abs() < 1e-9, "{anchor:?}");
    }

    fn square((x, y): (f64, f64), half: f64) -> Obstacle {
        let corners = [
            (-1.0, -1.0),
            (1.0, -1.0),
            (1.0, 1.0),
            (-1.0, 1.0),
            (-1.0, -1.0),
        ];
        let corner = |(dx, dy): &(f64, f64)| (x + half * dx, y + half * dy);
        Obstacle::new(corners.iter().map(corner).collect())
    }

    #[test]
    fn a_label_stands_in_its_obstacle_or_next_to_it_but_never_across_its_outline() {
        for (half, text) in [(60.0, "in"), (20.0, "next-to-it"), (9.0, "small")] {
            let obstacles = [square((500.0, 300.0), half)];
            let mut labels = Labels::new(FRAME, 15.0);
            let (anchor, _) = labels
                .place_free(&obstacles, 0, &[text.to_owned()], false)
                .expect("free space");
            let half_width = width(text) * 15.0 * anchor.share / 2.0;
            let (dx, dy) = ((anchor.x - 500.0).abs(), (anchor.y - 300.0).abs());
            let is_inside = dx + half_width < half && dy + 9.0 < half;
            let is_outside = dx - half_width > half || dy - 9.0 * anchor.share > half;
            assert!(is_inside != is_outside, "{text}: {anchor:?}");
        }
    }

    #[test]
    fn of_obstacles_without_space_the_first_has_its_short_name_and_others_none() {
        let obstacles: Vec<Obstacle> = (0..900u16)
            .map(|index| (f64::from(index % 30) * 34.0, f64::from(index / 30) * 34.0))
            .map(|at| square(at, 15.0))
            .chain([square((500.0, 300.0), 15.0)])
            .collect();
        let mut labels = Labels::new(FRAME, 9.0);
        let forms = ["b1 below 640 m AMSL".to_owned(), "b1".to_owned()];
        let mut place = |own: usize| labels.place_free(&obstacles, own, &forms, false);
        let (anchor, form) = place(230).expect("its own square");
        assert_eq!((anchor.x, anchor.y, form), (680.0, 238.0, 1));
        assert_eq!(place(230), None);
    }

    #[test]
    fn names_of_one_place_are_written_apart() {
        let mut labels = Labels::new(FRAME, 15.0);
        let anchors: Vec<_> = (0..5)
            .map(|_| labels.place((500.0, 300.0), Side::Right, "watch-post"))
            .collect();
        for (number, a) in anchors.iter().enumerate() {
            for b in &anchors[number + 1..] {
                let wide = 0.58 * 15.0 * 10.0;
                assert!((a.x - b.x).abs() >= wide - 1e-9 || (a.y - b.y).abs() >= 18.0 - 1e-9);
            }
        }
    }
}
