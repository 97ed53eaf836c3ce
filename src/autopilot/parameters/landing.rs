//! Parameters that set the speeds of a landing on rotors.

/// Parameters of a landing on rotors.
#[derive(Clone, Copy, Debug)]
pub struct LandingParameters {
    /// Its speed down to the slow end, above 0 instead of that of other descents.
    pub fast: Option<&'static str>,
    /// What none of its speeds exceeds.
    pub most: Option<&'static str>,
    /// Speed of the slow end.
    pub slow: &'static str,
    /// Whether it is at least as fast before the slow end.
    pub slow_is_least: bool,
    /// Height of the slow end.
    pub slow_below: &'static str,
    /// Another height that the slow end has at least.
    pub slow_below_too: Option<&'static str>,
    /// The least height of the slow end, metres.
    pub min_m: f64,
}

/// `Mode::land_run_vertical_control`.
pub(in crate::autopilot) const ARDUCOPTER_LANDING: LandingParameters = LandingParameters {
    fast: Some("LAND_SPEED_HIGH"),
    most: None,
    slow: "LAND_SPEED",
    slow_is_least: true,
    slow_below: "LAND_ALT_LOW",
    slow_below_too: None,
    min_m: 1.0,
};
/// `QuadPlane::landing_descent_rate_ms`, whose speed changes over the 6 m above that.
pub(in crate::autopilot) const QUADPLANE_LANDING: LandingParameters = LandingParameters {
    fast: None,
    most: None,
    slow: "Q_LAND_FINAL_SPD",
    slow_is_least: false,
    slow_below: "Q_LAND_FINAL_ALT",
    slow_below_too: None,
    min_m: 0.0,
};
/// `FlightTaskAuto::_prepareLandSetpoints`, whose speed changes from `MPC_LAND_ALT1` to `MPC_LAND_ALT2`: slow from the
/// first on, it is not late.
pub(in crate::autopilot) const PX4_LANDING: LandingParameters = LandingParameters {
    fast: None,
    most: Some("MPC_Z_VEL_MAX_DN"),
    slow: "MPC_LAND_SPEED",
    slow_is_least: false,
    slow_below: "MPC_LAND_ALT1",
    slow_below_too: Some("MPC_LAND_ALT2"),
    min_m: 0.0,
};
