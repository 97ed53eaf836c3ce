//! Open links: sockets and serial lines, their threads and clocks, captures.

pub(super) mod links;
mod peers;
pub(super) mod radio;
mod sequences;
mod serial;
mod shared_id;
mod socket;
mod tcp;
pub(super) mod tlog;
