//! Which steps the default search takes.

/// The steps of the default search. Plans are made with the default; studies leave out one step
/// at a time to measure what it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// Whether seeds come from homotopy classes; otherwise from the straight line alone.
    pub classes: bool,
    /// Slope limits of the cost fields, in units of the vehicle's. One field is not enough:
    /// dilation raises valleys between ridges as well.
    pub slope_factors: &'static [f64],
    /// Fits of one class with bunched control points, at most.
    pub warps: usize,
    /// Whether fits are drawn tight over the cost field.
    pub tightening: bool,
    /// Whether seeds detour around earlier flights; otherwise classes are ranked by what they
    /// cost straight through these.
    pub detours: bool,
    /// Whether swarms race; otherwise all go on to the end.
    pub racing: bool,
    /// Whether swarms have offspring.
    pub offspring: bool,
    /// Whether a swarm without gain begins again.
    pub restarts: bool,
    /// Whether a swarm that begins again fits its best path anew.
    pub redrawing: bool,
    /// Whether other valleys beside what is found are searched.
    pub valleys: bool,
    /// Whether the altitudes of what is found are solved for at least cost.
    pub polishing: bool,
    /// Whether each control point is judged by the part of the path that it moves.
    pub windows: bool,
    /// Price of violated limits, in units of the judge's: a short cut through the rim of a
    /// threat can cost less than the way around it, and fails. `None`: the judge's.
    pub penalty: Option<f64>,
    /// Price of violated limits in the relaxed problem, as a share of `penalty`: a swarm breaks
    /// limits on its way from one good path to another.
    pub relaxed_share: f64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            classes: true,
            slope_factors: &[1.0, 2.5, f64::INFINITY],
            warps: 24,
            tightening: true,
            detours: true,
            racing: true,
            offspring: true,
            restarts: true,
            redrawing: true,
            valleys: true,
            polishing: true,
            windows: true,
            penalty: Some(4.0),
            relaxed_share: 0.05,
        }
    }
}
