//! Open links: sockets and serial lines, their threads and clocks, captures.

pub(super) mod links;
pub(super) mod radio;
pub(super) mod socket;
pub(super) mod tlog;
