//! Transfers: the protocol in virtual time, over sockets, and against simulated vehicles.

#[path = "../support/mod.rs"]
mod support;

mod changed_meanwhile;
mod link_commands;
mod mission_upload;
mod moved_links;
mod plan_and_upload;
mod reading_meanwhile;
mod simulated_vehicle;
mod udp_loopback;
