//! Outlines of threats and zones on the picture, and where labels may stand in and around them.

/// How far a disc stays away from the corners of its box, as a share of the box: `(1 - cos 45°) / 2`.
const CORNER: f64 = 0.146;

/// A rectangle of the picture, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

/// A threat or zone on the picture, which its label stands in or next to.
pub(super) struct Obstacle {
    /// Its corners, the first again at the end.
    pub(super) ring: Vec<(f64, f64)>,
    /// The box around it.
    pub(super) area: Area,
}

impl Area {
    pub(super) fn around((x, y): (f64, f64), width: f64, height: f64) -> Self {
        Self {
            left: x - width / 2.0,
            top: y - height / 2.0,
            right: x + width / 2.0,
            bottom: y + height / 2.0,
        }
    }

    /// The area with as much on its left and on its right.
    pub(super) fn widened(self, by: f64) -> Self {
        Self {
            left: self.left - by,
            right: self.right + by,
            ..self
        }
    }

    /// The area that two have in common.
    pub(super) fn shared(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

impl Obstacle {
    pub(super) fn new(ring: Vec<(f64, f64)>) -> Self {
        let by = |axis: fn(&(f64, f64)) -> f64, pick: fn(f64, f64) -> f64| {
            ring.iter().map(axis).reduce(pick).unwrap_or(0.0)
        };
        let area = Area {
            left: by(|at| at.0, f64::min),
            top: by(|at| at.1, f64::min),
            right: by(|at| at.0, f64::max),
            bottom: by(|at| at.1, f64::max),
        };
        Self { ring, area }
    }

    pub(super) fn middle(&self) -> (f64, f64) {
        let Area {
            left,
            top,
            right,
            bottom,
        } = self.area;
        (f64::midpoint(left, right), f64::midpoint(top, bottom))
    }

    /// Whether a point is inside of the outline.
    pub(super) fn holds(&self, (x, y): (f64, f64)) -> bool {
        let area = &self.area;
        if x < area.left || x > area.right || y < area.top || y > area.bottom {
            return false;
        }
        let crossed = self.ring.windows(2).filter(|edge| {
            let ((ax, ay), (bx, by)) = (edge[0], edge[1]);
            (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
        });
        crossed.count() % 2 == 1
    }
}

/// Middles of a label inside of the box of an obstacle, or outside of it, the nearer first.
pub(super) fn around(
    area: &Area,
    is_inside: bool,
    (width, height): (f64, f64),
    gap: f64,
) -> Vec<(f64, f64)> {
    let (x, y) = (
        f64::midpoint(area.left, area.right),
        f64::midpoint(area.top, area.bottom),
    );
    if is_inside {
        return vec![(x, y), (x, y + 1.1 * height), (x, y - 1.1 * height)];
    }
    // A disc leaves the corners of its box free.
    let cut_x = (area.right - area.left) * CORNER;
    let cut_y = (area.bottom - area.top) * CORNER;
    let at_gap = |gap: f64| {
        let (above, below) = (
            area.top - gap - height / 2.0,
            area.bottom + gap + height / 2.0,
        );
        let (before, after) = (
            area.left - gap - width / 2.0,
            area.right + gap + width / 2.0,
        );
        [
            (x, above),
            (x, below),
            (after, y),
            (before, y),
            (after - cut_x, above + cut_y),
            (before + cut_x, above + cut_y),
            (after - cut_x, below - cut_y),
            (before + cut_x, below - cut_y),
            (area.left + width / 2.0, above),
            (area.right - width / 2.0, above),
            (area.left + width / 2.0, below),
            (area.right - width / 2.0, below),
        ]
    };
    [at_gap(gap), at_gap(gap + height)].concat()
}
