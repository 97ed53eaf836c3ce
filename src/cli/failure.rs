//! Why a command failed, and the exit code that says so.

use std::process::ExitCode;

use super::output::OutputError;
use crate::spec::SpecError;

/// A failed command: its exit code, and what to tell on stderr.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) code: Code,
    /// Empty when everything was said already.
    pub(super) message: String,
}

/// An exit code of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Code(u8);

impl Code {
    /// The number that the process ends with.
    pub(super) fn number(self) -> i32 {
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
    pub(super) const OUTPUT: Code = Code(1);
    /// Wrong usage.
    pub(super) const USAGE: Code = Code(2);
    /// Bad spec or input file.
    pub(super) const INPUT: Code = Code(3);
    /// Nothing that passes verification.
    pub(super) const VERDICT: Code = Code(4);
    /// Transfer failed.
    pub(super) const TRANSFER: Code = Code(5);

    pub(super) fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }
}

impl From<SpecError> for Failure {
    fn from(error: SpecError) -> Self {
        Self::new(Self::INPUT, error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::new(Self::OUTPUT, error.to_string())
    }
}
