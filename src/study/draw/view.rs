//! A map of the study as a view from the south-west.

use super::ground::{DANGER, rim, tint};
use super::{Drawing, outline};
use crate::geodesy::EastNorth;
use crate::spec::{Cylinder, Scenario};

/// Squares along one side of the view.
const SQUARES: u32 = 30;

/// A parallel projection from the south-west.
struct View<'a> {
    scenario: &'a Scenario,
    at: [f64; 2],
}

/// The ground with threats from the south-west, about 540 by 390 pixels.
pub(in crate::study) fn view(drawing: &mut Drawing, scenario: &Scenario, at: [f64; 2]) {
    let view = View { scenario, at };
    // Far parts first; the distance of a threat is that of its axis.
    let mut parts = Vec::new();
    for row in 0..SQUARES {
        for column in 0..SQUARES {
            parts.push((f64::from(row + column), view.square(column, row)));
        }
    }
    for threat in &scenario.threats {
        let [east, north] = view.share(threat.center);
        parts.push(((east + north) * f64::from(SQUARES), view.cylinder(threat)));
    }
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    drawing.add("<g stroke=\"#000\" stroke-opacity=\".15\" stroke-width=\".4\">");
    for (_, part) in parts {
        drawing.add(&part);
    }
    drawing.add("</g>");
    view.axes(drawing);
}

impl View<'_> {
    /// A point as shares of the map east and north.
    fn share(&self, at: EastNorth) -> [f64; 2] {
        let (low, high) = (self.scenario.south_west, self.scenario.north_east);
        [
            (at.east_m - low.east_m) / (high.east_m - low.east_m),
            (at.north_m - low.north_m) / (high.north_m - low.north_m),
        ]
    }

    fn project(&self, [east, north]: [f64; 2], up_m: f64) -> [f64; 2] {
        [
            self.at[0] + 290.0 + 240.0 * (east - north),
            self.at[1] + 340.0 - 105.0 * (east + north) - up_m * 0.03,
        ]
    }

    fn square(&self, column: u32, row: u32) -> String {
        let (low, high) = (self.scenario.south_west, self.scenario.north_east);
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
            let share = |k: u32| f64::from(k) / f64::from(SQUARES);
            let [east, north] = [share(column + right), share(row + up)];
            let height_m = self.scenario.surface.height_m(EastNorth {
                east_m: low.east_m + east * (high.east_m - low.east_m),
                north_m: low.north_m + north * (high.north_m - low.north_m),
            });
            ([east, north], height_m)
        });
        // Light from the west.
        let rise_m = corners[1].1 - corners[0].1;
        let light = (0.93 + rise_m / 3000.0).clamp(0.7, 1.0);
        format!(
            "<path d=\"{}z\" fill=\"{}\"/>",
            outline(&corners.map(|(at, up_m)| self.project(at, up_m))),
            tint(corners[0].1, light)
        )
    }

    /// The wall of a threat up to the top of the map, and its lid.
    fn cylinder(&self, threat: &Cylinder) -> String {
        let rim = rim(threat);
        let ring = |up_m: f64| -> Vec<[f64; 2]> {
            rim.iter()
                .map(|at| self.project(self.share(*at), up_m))
                .collect()
        };
        let (foot, lid) = (ring(0.0), ring(self.scenario.max_amsl.0));
        let utmost = |better: fn(f64, f64) -> bool| {
            (0..foot.len())
                .reduce(|a, b| if better(foot[b][0], foot[a][0]) { b } else { a })
                .unwrap_or(0)
        };
        let (west, east) = (utmost(|a, b| a < b), utmost(|a, b| a > b));
        // Around the near side of the foot, from the westmost to the eastmost point.
        let mut near: Vec<usize> = (0..foot.len())
            .map(|k| (west + k) % foot.len())
            .take_while(|k| *k != east)
            .collect();
        near.push(east);
        let wall: Vec<[f64; 2]> = near
            .iter()
            .map(|k| foot[*k])
            .chain(near.iter().rev().map(|k| lid[*k]))
            .collect();
        format!(
            "<g fill=\"{DANGER}\" stroke=\"{DANGER}\" stroke-opacity=\".6\"><path d=\"{}z\" \
             fill-opacity=\".16\"/><path d=\"{}z\" fill-opacity=\".3\"/></g>",
            outline(&wall),
            outline(&lid)
        )
    }

    /// Scales in km along the two near edges and up the western corner.
    fn axes(&self, drawing: &mut Drawing) {
        let (low, high) = (self.scenario.south_west, self.scenario.north_east);
        let sides = [
            (
                [1.0, 0.0],
                low.east_m,
                high.east_m,
                "east, km",
                1.0,
                "start",
            ),
            (
                [0.0, 1.0],
                low.north_m,
                high.north_m,
                "north, km",
                -1.0,
                "end",
            ),
        ];
        for (along, from_m, to_m, name, side, anchor) in sides {
            let at = |share: f64| self.project(along.map(|part: f64| part * share), 0.0);
            drawing.line(&[at(0.0), at(1.0)], "#333", 1.0);
            for part in 0..=4 {
                let share = f64::from(part) / 4.0;
                let [x, y] = at(share);
                let km = (from_m + share * (to_m - from_m)) * 1e-3;
                drawing.line(&[[x, y], [x + 3.0 * side, y + 4.0]], "#333", 1.0);
                drawing.text(
                    [x + 5.0 * side, y + 15.0],
                    11.0,
                    anchor,
                    &format!("{km:.0}"),
                );
            }
            let [x, y] = at(0.6);
            drawing.text([x + 30.0 * side, y + 32.0], 12.0, anchor, name);
        }
        let top_m = self.scenario.max_amsl.0;
        let corner = [0.0, 1.0];
        let (foot, top) = (self.project(corner, 0.0), self.project(corner, top_m));
        drawing.line(&[foot, top], "#333", 1.0);
        for part in [0.0, 0.5, 1.0] {
            let [x, y] = self.project(corner, part * top_m);
            drawing.line(&[[x - 4.0, y], [x, y]], "#333", 1.0);
            let km = format!("{}", part * top_m * 1e-3);
            drawing.text([x - 7.0, y + 4.0], 11.0, "end", &km);
        }
        drawing.text([top[0], top[1] - 8.0], 12.0, "middle", "up, km");
    }
}
