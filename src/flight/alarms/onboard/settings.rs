//! Parameters that a vehicle in flight says to have other values than planned.

use super::Onboard;
use crate::flight::launch::parameters::ParameterMismatch;

/// What is said of them; nothing of most vehicles.
#[derive(Debug, Default)]
pub(super) struct ParameterMismatches {
    all: Option<String>,
    of_return: Option<String>,
}

impl Onboard {
    /// Takes in all of them, and one that says how it returns.
    pub(in crate::flight::alarms) fn take_settings(
        &mut self,
        others: &[ParameterMismatch],
        of_return: Option<&ParameterMismatch>,
    ) {
        let words: Vec<String> = others.iter().map(ParameterMismatch::words).collect();
        let all = (!words.is_empty()).then(|| format!("says that {}", words.join(", and ")));
        let of_return = of_return.map(|of| format!("it says that {}", of.words()));
        self.settings = ParameterMismatches { all, of_return };
    }

    /// What is wrong with its parameters, in words.
    pub(in crate::flight::alarms) fn settings(&self) -> Option<&str> {
        self.settings.all.as_deref()
    }

    /// Why it is not known how it would return.
    pub(super) fn returns_otherwise(&self) -> Option<String> {
        let why = self.settings.of_return.as_ref()?;
        Some(format!("{why}: how it would return is not known"))
    }
}
