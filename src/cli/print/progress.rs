//! Progress: a line that changes on a terminal, and nothing where stderr is piped.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::console::shown;

/// The current step, on stderr.
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    pub(crate) fn start() -> Self {
        // indicatif draws on stderr, and not at all when that is no terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Self { bar }
    }

    /// A step among many.
    pub(crate) fn say(&self, message: &str) {
        self.bar.set_message(shown(message).into_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
