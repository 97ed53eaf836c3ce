//! Vehicles for which there is no path among all others: they are planned among those before them in
//! priority order. Those after them that they then come too near to are planned again among all:
//! some of these may push others aside in the same way, always those after them.

use super::{Pending, Repair, in_order};

impl Repair<'_> {
    /// Plans vehicles among those before them, and returns those after them that are then in the
    /// way: they have no flight any more.
    pub(super) fn push_aside(&mut self, failed: &[usize]) -> Vec<usize> {
        self.take_out(failed);
        let pending = failed.iter().map(|&vehicle| Pending {
            below: vehicle,
            ..self.pending(vehicle).0
        });
        let waiting = pending.collect();
        self.plan_waiting(waiting);
        // Those that fail even so would fail again.
        self.failed.clear();
        let pushed = failed.iter().flat_map(|&vehicle| {
            let track = self.current[vehicle].map(|number| &self.tracks.all()[number]);
            let met = track.map(|track| self.met((vehicle, usize::MAX), track));
            let met = met.unwrap_or_default().into_iter();
            met.filter(move |&other| other > vehicle)
        });
        let mut pushed: Vec<usize> = pushed.collect();
        in_order(&mut pushed);
        self.take_out(&pushed);
        pushed
    }

    fn take_out(&mut self, vehicles: &[usize]) {
        for &vehicle in vehicles {
            self.flights[vehicle] = None;
            self.current[vehicle] = None;
        }
    }
}
