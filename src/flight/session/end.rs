//! How a flight ends.

/// A flight that has not ended this share and this many seconds after its planned end has failed.
const LATE_SHARE: f64 = 0.25;
const LATE_S: f64 = 90.0;

/// How long a flight may last that ends at `ends_s` as planned, seconds. What a simulated vehicle's clock slipped behind
/// that of the fleet is no time that it had; but it is given up where it lives less than half of the time.
pub(in crate::flight) fn may_last_s(ends_s: f64, slipped_s: f64) -> f64 {
    ends_s * (1.0 + LATE_SHARE) + LATE_S + slipped_s.clamp(0.0, ends_s.max(0.0))
}

/// How the flight of one vehicle ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// It never flew.
    #[default]
    NotFlown,
    /// It landed and stopped its motors, at the end of its mission.
    Landed,
    /// It stays in the air at the end of its mission, as planned.
    Loitering,
    /// It stays in the air because it was ordered to.
    Held,
    /// It was ordered to hold, and stopped its motors later: somebody else brought it down.
    StoppedAfterHold,
    /// It was ordered to land, and did.
    LandedEarly,
    /// It was ordered to return to launch, and landed there.
    Returned,
    /// It was ordered to return, and landed at a rally point.
    ReturnedToRally,
    /// It was left flying.
    LeftFlying,
    /// Something else; what, in words.
    Failed(String),
}

impl End {
    /// As the record has it.
    #[must_use]
    pub fn words(&self) -> &str {
        match self {
            Self::NotFlown => "not flown",
            Self::Landed => "landed",
            Self::Loitering => "loiters",
            Self::Held => "held",
            Self::StoppedAfterHold => "ordered to hold, then stopped its motors",
            Self::LandedEarly => "landed early",
            Self::Returned => "returned",
            Self::ReturnedToRally => "returned to a rally point",
            Self::LeftFlying => "left flying",
            Self::Failed(why) => why,
        }
    }

    /// Out of the words of a record.
    #[must_use]
    pub fn of_words(words: &str) -> Self {
        let known = [
            Self::NotFlown,
            Self::Landed,
            Self::Loitering,
            Self::Held,
            Self::StoppedAfterHold,
            Self::LandedEarly,
            Self::Returned,
            Self::ReturnedToRally,
            Self::LeftFlying,
        ];
        let found = known.into_iter().find(|end| end.words() == words);
        found.unwrap_or_else(|| Self::Failed(words.to_owned()))
    }

    /// As an operator reads it when it happens.
    pub(crate) fn sentence(&self) -> String {
        match self {
            Self::Landed => "landed, motors stopped",
            Self::Loitering => "loiters at the end of its mission",
            Self::Held => "still holds, and is not watched any more",
            Self::StoppedAfterHold => "stopped its motors after it was ordered to hold",
            Self::LandedEarly => "landed as ordered",
            Self::Returned => "landed at home as ordered",
            Self::ReturnedToRally => "landed at a rally point: it was ordered to return",
            Self::LeftFlying => "is left flying",
            Self::NotFlown => "was not flown",
            Self::Failed(why) => why,
        }
        .to_owned()
    }
}
