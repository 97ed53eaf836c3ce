//! Why a command failed, and the exit code that says so.

use std::process::ExitCode;

use crate::flight::FlightError;
use crate::formats::OutputError;
use crate::report::CheckDocument;
use crate::spec::{Issue, SpecError};

/// A failed command: its exit code, and what stderr says of it.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) code: Code,
    /// One line; empty if the command has printed the reason already.
    pub(crate) message: String,
    /// Further problems, a line each.
    pub(crate) more: Vec<String>,
    /// The problems of a spec that these lines are.
    issues: Vec<Issue>,
}

/// An exit code of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Code(u8);

impl Code {
    /// The exit code of another process.
    pub(crate) fn of(number: u8) -> Self {
        Self(number)
    }

    /// The number that the process ends with.
    pub(crate) fn number(self) -> i32 {
        self.0.into()
    }
}

impl From<Code> for ExitCode {
    fn from(code: Code) -> Self {
        Self::from(code.0)
    }
}

impl Failure {
    /// Internal, or output not writable.
    pub(crate) const OUTPUT: Code = Code(1);
    /// Wrong usage.
    pub(crate) const USAGE: Code = Code(2);
    /// Bad spec or input file.
    pub(crate) const INPUT: Code = Code(3);
    /// Nothing that passes verification.
    pub(crate) const VERDICT: Code = Code(4);
    /// A transfer failed, or a flight did not go as planned.
    pub(crate) const TRANSFER: Code = Code(5);

    pub(crate) fn new(code: Code, message: impl Into<String>) -> Self {
        Self::all(code, [message.into()])
    }

    /// Several problems at once, a line each.
    pub(crate) fn all(code: Code, problems: impl IntoIterator<Item = String>) -> Self {
        let mut problems = problems.into_iter();
        Self {
            code,
            message: problems.next().unwrap_or_default(),
            more: problems.collect(),
            issues: Vec::new(),
        }
    }

    /// What `--json` prints of a command that failed before it had a document.
    pub(crate) fn document(&self) -> CheckDocument {
        let lines = std::iter::once(&self.message).chain(&self.more);
        let of_line = |line: &String| Issue {
            path: String::new(),
            table: None,
            position: None,
            found: line.clone(),
            allowed: String::new(),
        };
        match self.issues.as_slice() {
            [] => CheckDocument::of_issues(&lines.map(of_line).collect::<Vec<_>>()),
            issues => CheckDocument::of_issues(issues),
        }
    }
}

impl From<SpecError> for Failure {
    fn from(error: SpecError) -> Self {
        // The spec's own text is escaped: each line is one problem.
        let lines = error.to_string();
        Self {
            issues: error.issues,
            ..Self::all(Self::INPUT, lines.lines().map(str::to_owned))
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::new(Self::OUTPUT, error.to_string())
    }
}

impl From<FlightError> for Failure {
    fn from(error: FlightError) -> Self {
        let code = match &error {
            FlightError::Input(_) => Self::INPUT,
            FlightError::Verdict(_) | FlightError::Rejected(_) => Self::VERDICT,
            FlightError::Transfer(_) => Self::TRANSFER,
            FlightError::Record(_) => Self::OUTPUT,
        };
        Self::new(code, error.to_string())
    }
}
