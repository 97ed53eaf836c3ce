//! The terminal: results go to stdout, everything else to stderr.
//!
//! All output passes through here. Text may come from a vehicle, a file or a server, so
//! hidden and control characters are written out ([`text::escaped`]), a newline within a
//! line too. Colours are marks without width (Unicode tags) until the text is safe.

use std::borrow::Cow;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;

use super::failure::Failure;
use crate::numeric::text;
use crate::report::json_text;
use crate::verify::{Review, landings_on_parked};

/// Prints one line of a result.
pub(crate) fn out(line: &str) -> Result<(), Failure> {
    print(&shown(line))
}

/// Prints lines of a result.
pub(crate) fn out_lines<S: AsRef<str>>(lines: &[S]) -> Result<(), Failure> {
    lines.iter().try_for_each(|line| out(line.as_ref()))
}

/// Prints a text of several lines that the program itself has laid out.
pub(crate) fn out_text(text: &str) -> Result<(), Failure> {
    print(&text::escaped_except(text.trim_end(), |c| {
        matches!(c, '\n' | '\t')
    }))
}

/// Prints a JSON document.
pub(crate) fn out_json<D: Serialize>(document: &D) -> Result<(), Failure> {
    out_json_text(&json_text(document))
}

/// Whether stdout has its one JSON document.
static HAS_DOCUMENT: AtomicBool = AtomicBool::new(false);

/// Whether a JSON document was printed.
pub(crate) fn has_document() -> bool {
    HAS_DOCUMENT.load(Ordering::Relaxed)
}

/// Prints the text of a JSON document, hidden characters escaped as JSON has them.
pub(crate) fn out_json_text(text: &str) -> Result<(), Failure> {
    HAS_DOCUMENT.store(true, Ordering::Relaxed);
    print(&text::escaped_json(text.trim_end()))
}

/// Prints one line that is no result.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", shown(line));
}

/// Prints which vehicles of a review land where another one stands.
pub(crate) fn warn_of_parked(review: &Review) {
    for text in landings_on_parked(&review.margins) {
        note(&format!("warning: {text}"));
    }
}

/// Prints lines that are no result.
pub(crate) fn note_lines<S: AsRef<str>>(lines: &[S]) {
    lines.iter().for_each(|line| note(line.as_ref()));
}

/// Prints the content of a file byte for byte.
pub(crate) fn out_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    let done = stdout.write_all(bytes).and_then(|()| stdout.flush());
    written(done)
}

fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    written(writeln!(stdout, "{text}").and_then(|()| stdout.flush()))
}

/// Whether the terminal has hung up.
static HUNG_UP: AtomicBool = AtomicBool::new(false);

/// The terminal has hung up: what cannot be written from now on is no failure of the command.
pub(crate) fn hang_up() {
    HUNG_UP.store(true, Ordering::Relaxed);
}

/// A closed pipe is the reader's choice, not an error; nor is a terminal that has gone.
fn written(done: std::io::Result<()>) -> Result<(), Failure> {
    match done {
        Err(_) if HUNG_UP.load(Ordering::Relaxed) => Ok(()),
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let message = format!("cannot write to standard output: {error}");
            Err(Failure::new(Failure::OUTPUT, message))
        }
        _ => Ok(()),
    }
}

/// One line as the terminal gets it: hidden characters are written out, marks become
/// colours.
pub(crate) fn shown(line: &str) -> Cow<'_, str> {
    coloured(line, Paint::for_stdout())
}

fn coloured(line: &str, paint: Paint) -> Cow<'_, str> {
    if !paint.on || !line.contains(is_mark) {
        return text::escaped(line);
    }
    let mut text = safe(line).into_owned();
    for (mark, code) in MARKS {
        text = text.replace(mark, &format!("\u{1b}[{code}m"));
    }
    // A mark out of the text itself ends with its line.
    Cow::Owned(text + "\u{1b}[0m")
}

/// A line with its hidden characters written out; marks of colours stay.
pub(super) fn safe(line: &str) -> Cow<'_, str> {
    text::escaped_except(line, is_mark)
}

/// Marks that [`Paint`] sets, each with the code that becomes of it.
const MARKS: [(char, &str); 4] = [(GOOD, "32"), (BAD, "31;1"), (DIM, "2"), (PLAIN, "0")];
const GOOD: char = '\u{e0067}';
const BAD: char = '\u{e0062}';
const DIM: char = '\u{e0064}';
const PLAIN: char = '\u{e007f}';

fn is_mark(sign: char) -> bool {
    MARKS.iter().any(|(mark, _)| *mark == sign)
}

/// Colours for a terminal that wants them: marks that [`out`] and [`note`] turn into codes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    on: bool,
}

impl Paint {
    /// For stdout: colours only on a terminal, and never with NO_COLOR or TERM=dumb.
    pub(crate) fn for_stdout() -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
            || std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        Self {
            on: std::io::stdout().is_terminal() && !refused,
        }
    }

    fn wrap(self, mark: char, text: &str) -> String {
        if self.on {
            format!("{mark}{text}{PLAIN}")
        } else {
            text.to_owned()
        }
    }

    /// For a limit that is met.
    pub(crate) fn good(self, text: &str) -> String {
        self.wrap(GOOD, text)
    }

    /// For a failure.
    pub(crate) fn bad(self, text: &str) -> String {
        self.wrap(BAD, text)
    }

    /// For secondary text.
    pub(crate) fn dim(self, text: &str) -> String {
        self.wrap(DIM, text)
    }
}

#[cfg(test)]
mod tests {
    use super::{Paint, coloured};

    #[test]
    fn colours_are_added_to_text_that_is_safe() {
        let hostile = "\u{1b}[2K\r landed\n";
        for (on, expected) in [
            (false, "FAIL \\u{1b}[2K\\r landed\\n"),
            (
                true,
                "\u{1b}[31;1mFAIL\u{1b}[0m \\u{1b}[2K\\r landed\\n\u{1b}[0m",
            ),
        ] {
            let paint = Paint { on };
            let line = format!("{} {hostile}", paint.bad("FAIL"));
            assert_eq!(coloured(&line, paint), expected);
        }
        let marked = coloured("\u{e0067}", Paint { on: false });
        assert_eq!(marked, "\\u{e0067}");
    }
}
