//! A terminal may stop to take anything (Ctrl-S, a connection that stalls): a thread of its own writes to it, and what
//! flies waits for no line.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use super::failure::Failure;

/// Lines that wait for the terminal, at most; then the oldest are dropped.
const MAX_LINES: usize = 1000;

/// What is written on.
pub(crate) trait Paper: Send + 'static {
    /// A line of the result.
    fn line(&mut self, line: &str) -> Result<(), Failure>;
    /// A line that is no result.
    fn note(&mut self, line: &str);
    /// The newest table.
    fn table(&mut self, rows: &[String]);
}

/// Lines for a terminal, written one after the other by a thread.
pub(crate) struct Printer {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Desk {
    queue: Mutex<Queue>,
    wakes: Condvar,
}

/// What waits to be written.
#[derive(Default)]
struct Queue {
    lines: VecDeque<(Kind, String)>,
    /// Only the newest one is of use.
    table: Option<Vec<String>>,
    dropped: usize,
    /// What could not be written first.
    failed: Option<String>,
    is_over: bool,
    /// How often something was begun to be written, and whether that is not over.
    begun: u64,
    is_at_work: bool,
}

#[derive(Clone, Copy)]
enum Kind {
    Line,
    Note,
}

impl Printer {
    pub(crate) fn start(paper: impl Paper) -> Self {
        let desk = Arc::new(Desk::default());
        let of_thread = Arc::clone(&desk);
        let thread = std::thread::spawn(move || write(&of_thread, paper));
        Self {
            desk,
            thread: Some(thread),
        }
    }

    /// Hands a line of the result over.
    pub(crate) fn line(&self, line: String) {
        self.put(Kind::Line, line);
    }

    /// Hands a line over that is no result.
    pub(crate) fn note(&self, line: &str) {
        self.put(Kind::Note, line.to_owned());
    }

    /// Hands a table over, in place of one that was not written yet.
    pub(crate) fn table(&self, rows: Vec<String>) {
        self.desk.lock().table = Some(rows);
        self.desk.wakes.notify_one();
    }

    /// The number of what is being written, if anything is: one that stays shows a terminal that takes nothing.
    pub(crate) fn at_work(&self) -> Option<u64> {
        let queue = self.desk.lock();
        queue.is_at_work.then_some(queue.begun)
    }

    /// Waits until everything is written.
    ///
    /// # Errors
    /// A line could not be written.
    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        self.end();
        self.failure()
    }

    fn put(&self, kind: Kind, line: String) {
        let mut queue = self.desk.lock();
        queue.lines.push_back((kind, line));
        if queue.lines.len() > MAX_LINES {
            queue.lines.pop_front();
            queue.dropped += 1;
        }
        drop(queue);
        self.desk.wakes.notify_one();
    }

    /// # Errors
    /// A line of those that were written by now could not be.
    pub(crate) fn failure(&self) -> Result<(), Failure> {
        match &self.desk.lock().failed {
            Some(message) => Err(Failure::new(Failure::OUTPUT, message.clone())),
            None => Ok(()),
        }
    }

    fn end(&mut self) {
        self.desk.lock().is_over = true;
        self.desk.wakes.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that broke off has nothing more to write.
            let _ = thread.join();
        }
    }
}

impl Drop for Printer {
    fn drop(&mut self) {
        self.end();
    }
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Everything that waits, once something does; none: it is over.
    fn take(&self) -> Option<Queue> {
        let mut queue = self.lock();
        queue.is_at_work = false;
        loop {
            let has_work = !queue.lines.is_empty() || queue.table.is_some();
            if has_work {
                (queue.begun, queue.is_at_work) = (queue.begun + 1, true);
                return Some(Queue {
                    lines: std::mem::take(&mut queue.lines),
                    table: queue.table.take(),
                    dropped: std::mem::take(&mut queue.dropped),
                    ..Queue::default()
                });
            }
            if queue.is_over {
                return None;
            }
            let woken = self.wakes.wait(queue);
            queue = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Writes until it is over. What was dropped comes before the lines that are left: those are the newest.
fn write(desk: &Desk, mut paper: impl Paper) {
    while let Some(work) = desk.take() {
        if work.dropped > 0 {
            let dropped = work.dropped;
            paper.note(&format!(
                "{dropped} lines are not shown here: the terminal took nothing meanwhile; the record has them"
            ));
        }
        for (kind, line) in &work.lines {
            match kind {
                Kind::Note => paper.note(line),
                Kind::Line => {
                    if let Err(failure) = paper.line(line) {
                        desk.lock().failed.get_or_insert(failure.message);
                    }
                }
            }
        }
        if let Some(rows) = work.table {
            paper.table(&rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};
    use std::sync::{Arc, Mutex};

    use super::{Failure, MAX_LINES, Paper, Printer};

    /// Takes nothing before it is released.
    struct Stalled {
        stalls: Sender<()>,
        release: Receiver<()>,
        is_free: bool,
        written: Arc<Mutex<Vec<String>>>,
    }

    impl Paper for Stalled {
        fn line(&mut self, line: &str) -> Result<(), Failure> {
            self.note(line);
            Ok(())
        }

        fn note(&mut self, line: &str) {
            if !self.is_free {
                self.stalls.send(()).expect("the test waits");
                self.release.recv().expect("the test releases it");
                self.is_free = true;
            }
            self.written.lock().expect("sound").push(line.to_owned());
        }

        fn table(&mut self, rows: &[String]) {
            self.note(&rows.join(" "));
        }
    }

    #[test]
    fn lines_for_a_terminal_that_takes_nothing_wait_for_it_and_those_that_are_dropped_are_counted()
    {
        let written = Arc::new(Mutex::new(Vec::new()));
        let (stalls, is_stalled) = channel();
        let (free, release) = channel();
        let paper = Stalled {
            stalls,
            release,
            is_free: false,
            written: Arc::clone(&written),
        };
        let printer = Printer::start(paper);
        printer.line("first".to_owned());
        is_stalled.recv().expect("it writes");
        for number in 0..MAX_LINES + 5 {
            let line = format!("line {number}");
            printer.line(line);
            printer.table(vec![format!("table {number}")]);
        }
        free.send(()).expect("it waits");
        printer.finish().expect("nothing failed");
        let written = written.lock().expect("sound");
        assert_eq!(written.len(), MAX_LINES + 3, "{written:?}");
        assert_eq!(written[0], "first");
        assert!(
            written[1].starts_with("5 lines are not shown"),
            "{written:?}"
        );
        assert_eq!(written[2], "line 5");
        let newest = format!("table {}", MAX_LINES + 4);
        assert_eq!(written.last(), Some(&newest));
    }
}
