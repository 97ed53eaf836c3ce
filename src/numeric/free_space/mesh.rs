//! The triangulation of the free part of the plane.

use std::collections::BTreeMap;

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;
use robust::{Coord, orient2d};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::numeric::geometry::{Point, doubled_area};

/// No triangle: the edge is the border of the free space.
pub const NONE: usize = usize::MAX;

/// Triangles that cover all of the free space that some sites are joined to.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    /// Corners.
    pub nodes: Vec<Point>,
    /// Corners of each triangle, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// The triangle beyond the edge from each corner to the next, or [`NONE`].
    pub beyond: Vec<[usize; 3]>,
    /// The node at each place; none at a place that is not free.
    pub sites: Vec<Option<usize>>,
}

/// Positive where `c` is left of the line from `a` to `b`, exactly.
pub(super) fn left_of(a: Point, b: Point, c: Point) -> f64 {
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    orient2d(coord(a), coord(b), coord(c))
}

impl FreeSpace {
    /// The part of `area` that no ring of `closed` covers, as far as it is joined to one of
    /// `sites`, with nodes at them.
    ///
    /// Rings are closed polygons, counter-clockwise; a clockwise ring within one of them is a
    /// hole of it. Corners may move by a hundred-millionth of the extent of all rings. `None`
    /// where numbers are not finite.
    #[must_use]
    pub fn new(area: &[Point], closed: &[Vec<Point>], sites: &[Point]) -> Option<Self> {
        let mut outer = area.to_vec();
        if doubled_area(&outer) < 0.0 {
            outer.reverse();
        }
        let closed = closed.to_vec();
        let shapes = vec![outer].overlay(&closed, OverlayRule::Difference, FillRule::NonZero);
        let mut corners = Corners::default();
        let sites = sites
            .iter()
            .map(|&at| {
                let is_free = shapes.iter().any(|rings| covers(rings, at));
                is_free.then(|| corners.index(at))
            })
            .collect();
        let edges = shapes
            .iter()
            .flat_map(|rings| corners.edges(rings))
            .collect();
        Self::triangulated(corners.nodes, edges, sites)
    }

    fn triangulated(
        nodes: Vec<Point>,
        edges: Vec<[usize; 2]>,
        sites: Vec<Option<usize>>,
    ) -> Option<Self> {
        let points = nodes.iter().map(|at| Point2::new(at[0], at[1])).collect();
        // An edge that is left out opens a gap: paths only get shorter.
        let mesh: ConstrainedDelaunayTriangulation<Point2<f64>> =
            ConstrainedDelaunayTriangulation::try_bulk_load_cdt(points, edges, |_| ()).ok()?;
        if mesh.num_vertices() != nodes.len() {
            return None;
        }
        // Inner faces are numbered from 1: the outer one is 0.
        let mut triangles = Vec::with_capacity(mesh.num_inner_faces());
        let mut beyond = Vec::with_capacity(mesh.num_inner_faces());
        for face in mesh.inner_faces() {
            triangles.push(face.vertices().map(|vertex| vertex.fix().index()));
            beyond.push(face.adjacent_edges().map(|edge| {
                let across = edge.rev().face().as_inner();
                match (edge.is_constraint_edge(), across) {
                    (false, Some(other)) => other.fix().index() - 1,
                    _ => NONE,
                }
            }));
        }
        let mut space = Self {
            nodes,
            triangles,
            beyond,
            sites,
        };
        space.keep_joined();
        Some(space)
    }

    /// Keeps only the triangles that are joined to a place.
    fn keep_joined(&mut self) {
        let mut is_place = vec![false; self.nodes.len()];
        for &node in self.sites.iter().flatten() {
            is_place[node] = true;
        }
        let mut number = vec![NONE; self.triangles.len()];
        let mut joined: Vec<usize> = (0..self.triangles.len())
            .filter(|&at| self.triangles[at].iter().any(|&node| is_place[node]))
            .collect();
        for (rank, &at) in joined.iter().enumerate() {
            number[at] = rank;
        }
        let mut next = 0;
        while let Some(&at) = joined.get(next) {
            for side in self.beyond[at] {
                if side != NONE && number[side] == NONE {
                    number[side] = joined.len();
                    joined.push(side);
                }
            }
            next += 1;
        }
        let old = std::mem::take(&mut self.triangles);
        self.triangles = joined.iter().map(|&at| old[at]).collect();
        let beyond = std::mem::take(&mut self.beyond);
        let renumbered = |side: usize| if side == NONE { NONE } else { number[side] };
        self.beyond = joined
            .iter()
            .map(|&at| beyond[at].map(renumbered))
            .collect();
    }
}

/// Whether a shape of an outer ring and holes covers a point.
fn covers(rings: &[Vec<Point>], at: Point) -> bool {
    let crossings = rings.iter().flat_map(|ring| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next)
    });
    let crossed = crossings.filter(|(a, b)| {
        (a[1] > at[1]) != (b[1] > at[1]) && (left_of(**a, **b, at) > 0.0) == (b[1] > a[1])
    });
    crossed.count() % 2 == 1
}

/// Corners, each once.
#[derive(Default)]
struct Corners {
    nodes: Vec<Point>,
    known: BTreeMap<[u64; 2], usize>,
}

impl Corners {
    fn index(&mut self, at: Point) -> usize {
        // Adding 0 turns -0 into 0.
        let at = at.map(|value| value + 0.0);
        *self.known.entry(at.map(f64::to_bits)).or_insert_with(|| {
            self.nodes.push(at);
            self.nodes.len() - 1
        })
    }

    fn edges(&mut self, rings: &[Vec<Point>]) -> Vec<[usize; 2]> {
        let mut edges = Vec::new();
        for ring in rings {
            let corners: Vec<usize> = ring.iter().map(|&at| self.index(at)).collect();
            let next = corners.iter().cycle().skip(1);
            edges.extend(corners.iter().zip(next).map(|(&a, &b)| [a, b]));
        }
        edges.retain(|[a, b]| a != b);
        edges
    }
}
