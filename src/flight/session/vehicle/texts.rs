//! Texts and positions of a vehicle that are not recorded: too many, or impossible.

use super::FlightVehicle;
use crate::link::{Position, TextChunks, Time};

/// Texts of one vehicle that are recorded within a period, of each class.
const MAX_TEXTS: u32 = 20;
/// The period, milliseconds.
const PERIOD_MS: u64 = 10_000;
/// Lines about a mode that comes and goes within a period; more of them are counted.
const MAX_MODES: u32 = 3;
/// `MAV_SEVERITY_ERROR`: texts up to this have a quota of their own.
const ERROR: u8 = 3;

/// The texts of one vehicle, and a limit on their rate.
#[derive(Debug, Default)]
pub(crate) struct Texts {
    /// Those that come in pieces.
    pub(crate) chunks: TextChunks,
    since: Time,
    /// Texts in this period: errors, others, and lines of ours about what it does.
    taken: [u32; 3],
    dropped: u32,
    /// Changes of its mode in this period.
    modes: u32,
}

impl Texts {
    /// Whether a text of a class is within the limit.
    fn passes(&mut self, class: usize) -> bool {
        let taken = &mut self.taken[class];
        *taken = taken.saturating_add(1);
        let passes = *taken <= MAX_TEXTS;
        self.dropped = self.dropped.saturating_add(u32::from(!passes));
        passes
    }

    /// A sentence about the texts that were dropped, once at the end of a period.
    pub(super) fn poll(&mut self, now: Time) -> Vec<String> {
        if now - self.since < PERIOD_MS {
            return Vec::new();
        }
        let sentences = self.sentence().into_iter().chain(self.modes_sentence());
        let sentences = sentences.collect();
        (self.since, self.taken, self.dropped, self.modes) = (now, [0; 3], 0, 0);
        sentences
    }

    fn modes_sentence(&self) -> Option<String> {
        let more = self.modes.saturating_sub(MAX_MODES);
        let period_s = PERIOD_MS / 1000;
        (more > 0).then(|| format!("{more} more changes of its mode within {period_s} s"))
    }

    fn sentence(&self) -> Option<String> {
        (self.dropped > 0).then(|| {
            format!(
                "{} more texts are not recorded (at most {MAX_TEXTS} in {} s)",
                self.dropped,
                PERIOD_MS / 1000
            )
        })
    }
}

impl FlightVehicle<'_> {
    pub(super) fn take_text(&mut self, severity: u8, text: &str) {
        if self.texts.passes(usize::from(severity > ERROR)) {
            self.news.push_back(text.to_owned());
        }
    }

    /// Says what it does, which it may do over and over.
    pub(super) fn say_often(&mut self, text: String) {
        if self.texts.passes(2) {
            self.news.push_back(text);
        }
    }

    /// Says that its mode has changed, which it may do over and over.
    pub(super) fn say_mode(&mut self, text: &str) {
        self.texts.modes = self.texts.modes.saturating_add(1);
        if self.texts.modes <= MAX_MODES {
            self.news.push_back(text.to_owned());
        }
    }

    /// Takes back the text that came last, if it was not dropped.
    pub(in crate::flight) fn unsay(&mut self) {
        let says = |text: &String| text.starts_with("says: ");
        if self.news.back().is_some_and(says) {
            self.news.pop_back();
        }
    }

    /// Counts a position that is none on earth, and reports the first. 0, 0 is what vehicles send
    /// before they have a position.
    pub(super) fn note_invalid(&mut self, position: &Position) {
        if (position.x, position.y) == (0, 0) {
            return;
        }
        self.invalid_positions += 1;
        if self.invalid_positions == 1 {
            let place = position.place();
            self.news.push_back(format!(
                "sent a position that cannot be: latitude {:.7}, longitude {:.7}, {:.0} m AMSL; it is not used",
                place.lat_deg,
                place.lon_deg,
                position.amsl().0
            ));
        }
    }

    /// At the end of its flight.
    pub(super) fn say_what_was_dropped(&mut self) {
        self.news.extend(self.texts.sentence());
        self.news.extend(self.texts.modes_sentence());
        (self.texts.dropped, self.texts.modes) = (0, 0);
        if self.invalid_positions > 1 {
            let count = self.invalid_positions;
            self.news.push_back(format!(
                "sent {count} positions that cannot be; none was used"
            ));
        }
    }
}
