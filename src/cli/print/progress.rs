//! Progress: a line that changes on a terminal, now and then a line where stderr is piped.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::console::{note, shown};

/// Between two lines where stderr is no terminal.
const PIPED: Duration = Duration::from_secs(10);

/// The current step, on stderr.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// When the last line went into a pipe.
    piped: Option<Mutex<Instant>>,
}

impl Progress {
    pub(crate) fn start() -> Self {
        // indicatif draws on stderr, and not at all when that is no terminal.
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        let piped = (!std::io::stderr().is_terminal()).then(|| Mutex::new(now()));
        Self { bar, piped }
    }

    /// A step among many: into a pipe it goes only when nothing went there for a while.
    pub(crate) fn say(&self, message: &str) {
        self.bar.set_message(shown(message).into_owned());
        let Some(Ok(mut last)) = self.piped.as_ref().map(Mutex::lock) else {
            return;
        };
        if last.elapsed() >= PIPED {
            *last = now();
            note(message);
        }
    }

    /// A step that is always said, into a pipe too.
    pub(crate) fn mark(&self, message: &str) {
        self.bar.set_message(shown(message).into_owned());
        if self.piped.is_some() {
            note(message);
        }
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "paces the lines of progress; no result depends on it"
)]
fn now() -> Instant {
    Instant::now()
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
