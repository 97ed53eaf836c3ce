//! A fence within what an autopilot keeps: far boundaries left out, others covered by simpler ones.
//!
//! ArduPilot keeps 70 fence items, PX4 64, and a map of airspace has thousands of corners. Each
//! boundary that is near the path or a way back is covered by a circle or by fewer corners that
//! stay clear of both; where these are still too many, neighbours are covered together. Then the
//! nearest of the far ones have what is left, and the nearest of all get their own corners back.

use std::collections::BTreeMap;

use super::clear::{Clear, Plane, Shape};
use crate::numeric::geometry::cover::{convex_hull, twice_area, widened};
use crate::numeric::geometry::{Point, distance};

/// Neighbours with which a boundary may be covered together, at first and where that is not enough.
const NEIGHBOURS: [usize; 2] = [8, 64];

/// A boundary that a fence should hold.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) shape: Shape,
    /// To the path or a way back, metres.
    pub(super) distance_m: f64,
    /// To a way back, metres.
    back_m: f64,
}

impl Piece {
    pub(super) fn new(shape: Shape, clear: &Clear) -> Self {
        let (distance_m, back_m) = clear.distances_m(&shape);
        Self {
            shape,
            distance_m,
            back_m,
        }
    }
}

/// What stands for some pieces in a fence.
#[derive(Clone, Debug)]
pub(super) struct Cover {
    /// Indices, in order.
    pub(super) pieces: Vec<usize>,
    /// The shape; none: that of its piece.
    pub(super) wider: Option<Shape>,
}

/// Fits pieces into a number of items. Those further than `far_m` may be left out; the rest is
/// covered even if that takes more items.
pub(super) fn fit(
    pieces: &[Piece],
    (plane, clear): (&Plane, &Clear),
    (capacity, far_m): (usize, f64),
) -> Vec<Cover> {
    let fit = Fit {
        pieces,
        plane,
        clear,
    };
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|a, b| {
        let (one, other) = (pieces[*a].distance_m, pieces[*b].distance_m);
        one.total_cmp(&other).then(a.cmp(b))
    });
    let near = order.partition_point(|&piece| pieces[piece].distance_m <= far_m);
    let mut covers: Vec<Cover> = order[..near]
        .iter()
        .map(|&piece| fit.alone(piece))
        .collect();
    fit.merge(&mut covers, capacity);
    let total = |covers: &[Cover]| covers.iter().map(|cover| fit.items(cover)).sum::<usize>();
    for &piece in &order[near..] {
        let used = total(&covers);
        if used >= capacity {
            break;
        }
        let cover = fit.alone(piece);
        if used + fit.items(&cover) <= capacity {
            covers.push(cover);
        }
    }
    let mut used = total(&covers);
    for cover in &mut covers {
        let [piece] = cover.pieces[..] else { continue };
        let (now, exact) = (fit.items(cover), pieces[piece].shape.items());
        if cover.wider.is_some() && used + exact <= capacity + now {
            used = used + exact - now;
            cover.wider = None;
        }
    }
    covers.sort_by_key(|cover| cover.pieces.first().copied());
    covers
}

/// A cover of several pieces, and the area that it adds for each item that it saves, square metres.
type Priced = (Cover, f64);

struct Fit<'a> {
    pieces: &'a [Piece],
    plane: &'a Plane,
    clear: &'a Clear,
}

impl Fit<'_> {
    fn shape<'c>(&'c self, cover: &'c Cover) -> Option<&'c Shape> {
        let exact = || Some(&self.pieces.get(*cover.pieces.first()?)?.shape);
        cover.wider.as_ref().or_else(exact)
    }

    fn items(&self, cover: &Cover) -> usize {
        self.shape(cover).map_or(0, Shape::items)
    }

    /// The cover of one piece with the fewest items.
    fn alone(&self, piece: usize) -> Cover {
        let exact = &self.pieces[piece].shape;
        let back_m = self.pieces[piece].back_m;
        let wider = match exact {
            Shape::Circle(..) => None,
            Shape::Polygon(corners) => self.around(corners, back_m).or_else(|| {
                let fewer = Shape::Polygon(self.widened(corners, back_m));
                (fewer.items() < corners.len()).then_some(fewer)
            }),
        };
        Cover {
            pieces: vec![piece],
            wider: wider.filter(|wider| wider.items() < exact.items()),
        }
    }

    /// The circle around corners, or what their hull can be widened to; none if both are in the way.
    fn around(&self, corners: &[Point], back_m: f64) -> Option<Shape> {
        let circle = self.plane.circle(corners);
        if self.clear.allows(&circle, back_m) {
            return Some(circle);
        }
        let hull = Shape::Polygon(convex_hull(corners));
        if hull.items() < 3 || !self.clear.allows(&hull, back_m) {
            return None;
        }
        Some(Shape::Polygon(self.widened(&hull.corners(), back_m)))
    }

    fn widened(&self, corners: &[Point], back_m: f64) -> Vec<Point> {
        widened(corners, 3, &|added| {
            let added = Shape::Polygon(added.to_vec());
            self.clear.allows(&added, back_m)
        })
    }

    /// Covers neighbours together, those first whose cover adds the least area for each item that
    /// it saves, until all fit.
    fn merge(&self, covers: &mut Vec<Cover>, capacity: usize) {
        let mut used: usize = covers.iter().map(|cover| self.items(cover)).sum();
        let mut known: BTreeMap<[Vec<usize>; 2], Option<Priced>> = BTreeMap::new();
        let mut reach = NEIGHBOURS.iter();
        let mut count = reach.next().copied().unwrap_or_default();
        while used > capacity {
            let mut best: Option<(f64, usize, usize, Cover)> = None;
            for (one, other) in self.neighbours(covers, count) {
                let key = [one, other].map(|cover| covers[cover].pieces.clone());
                let joined = known
                    .entry(key)
                    .or_insert_with(|| self.joined(&covers[one], &covers[other]));
                if let Some((cover, price)) = joined
                    && best.as_ref().is_none_or(|(least, ..)| *price < *least)
                {
                    best = Some((*price, one, other, cover.clone()));
                }
            }
            let Some((_, one, other, cover)) = best else {
                match reach.next() {
                    Some(more) => count = *more,
                    None => break,
                }
                continue;
            };
            used =
                used + self.items(&cover) - self.items(&covers[one]) - self.items(&covers[other]);
            covers[one] = cover;
            covers.remove(other);
        }
    }

    /// Pairs of covers that lie near each other, the first index the smaller.
    fn neighbours(&self, covers: &[Cover], count: usize) -> Vec<(usize, usize)> {
        let middles: Vec<Point> = covers.iter().map(|cover| self.middle(cover)).collect();
        let mut pairs = Vec::new();
        for (one, middle) in middles.iter().enumerate() {
            let mut others: Vec<(f64, usize)> = (middles.iter().enumerate())
                .filter(|(other, _)| *other != one)
                .map(|(other, at)| (distance(*middle, *at), other))
                .collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let near = others.into_iter().take(count);
            pairs.extend(near.map(|(_, other)| (one.min(other), one.max(other))));
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn middle(&self, cover: &Cover) -> Point {
        match self.shape(cover) {
            Some(Shape::Circle(center, _)) => *center,
            Some(Shape::Polygon(corners)) => {
                let count = f64::from(u32::try_from(corners.len()).unwrap_or(u32::MAX));
                let sum = corners.iter().fold([0.0, 0.0], |sum: Point, corner| {
                    [sum[0] + corner[0], sum[1] + corner[1]]
                });
                [sum[0] / count, sum[1] / count]
            }
            None => Point::default(),
        }
    }

    /// What covers all pieces of two covers, and the area that it adds for each item that it saves.
    fn joined(&self, one: &Cover, other: &Cover) -> Option<Priced> {
        let mut pieces: Vec<usize> = one.pieces.iter().chain(&other.pieces).copied().collect();
        pieces.sort_unstable();
        let own = pieces.iter().map(|&piece| &self.pieces[piece]);
        let back_m = own.clone().map(|piece| piece.back_m);
        let back_m = back_m.fold(f64::INFINITY, f64::min);
        let corners: Vec<Point> = own.flat_map(|piece| piece.shape.corners()).collect();
        let shape = self.around(&corners, back_m)?;
        let (before, after) = (self.items(one) + self.items(other), shape.items());
        let saved = before.checked_sub(after).filter(|saved| *saved > 0)?;
        let saved = f64::from(u32::try_from(saved).unwrap_or(u32::MAX));
        let parts = [one, other].map(|cover| self.shape(cover).map_or(0.0, area_m2));
        let price = (area_m2(&shape) - parts[0] - parts[1]) / saved;
        let wider = Some(shape);
        Some((Cover { pieces, wider }, price))
    }
}

fn area_m2(shape: &Shape) -> f64 {
    match shape {
        Shape::Circle(_, radius) => std::f64::consts::PI * radius * radius,
        Shape::Polygon(corners) => 0.5 * twice_area(corners),
    }
}
