//! Where the vehicles are when the monitoring ends, for the record and for those who ask.

use std::collections::BTreeMap;

use crate::flight::record::Flown;
use crate::flight::record::handoff::Ended;
use crate::flight::session::Fleet;
use crate::flight::session::end::End;

impl Fleet<'_> {
    /// The vehicles that are in the air when the monitoring ends.
    #[must_use]
    pub fn in_the_air(&self) -> Vec<&str> {
        let stays = |end: &End| matches!(end, End::Held | End::LeftFlying | End::Loitering);
        let vehicles = self.vehicles.iter();
        let up = vehicles.filter(|of| stays(&of.flown.end) || of.is_left_up());
        up.map(|of| of.of.vehicle).collect()
    }

    /// Those that were not heard since their flight was taken over.
    #[must_use]
    pub fn unheard(&self) -> Vec<&str> {
        let vehicles = self.vehicles.iter();
        let unheard = vehicles.filter(|of| of.is_unheard());
        unheard.map(|of| of.of.vehicle).collect()
    }

    /// The vehicles whose flight is over and whose motors stand.
    pub(super) fn down(&self) -> impl Iterator<Item = &str> {
        let vehicles = self.vehicles.iter();
        vehicles
            .filter(|of| of.is_known_down())
            .map(|of| of.of.vehicle)
    }

    /// How the flights of those ended, by id.
    #[must_use]
    pub fn ended(&self) -> BTreeMap<String, Ended> {
        let vehicles = self.vehicles.iter().filter(|of| of.is_known_down());
        let ended = vehicles.map(|of| {
            let (end, t_s) = (of.flown.end.words().to_owned(), of.flown.until_s);
            (of.of.vehicle.to_owned(), Ended { end, t_s })
        });
        ended.collect()
    }

    pub(super) fn unrecorded_ends(&self) -> impl Iterator<Item = (&str, &Flown)> {
        let vehicles = self.vehicles.iter();
        let due = vehicles.filter(|of| !of.is_unheard() && !of.has_recorded_end());
        due.map(|of| (of.of.vehicle, &of.flown))
    }
}
