//! Against programs of others: pymavlink, MAVProxy, MAVSDK, real simulators.

#[path = "../support/mod.rs"]
mod support;

mod flight_sitl;
mod peers_files;
mod peers_flight;
mod peers_lossy;
mod peers_mavproxy;
mod peers_mavsdk;
mod sitl;
