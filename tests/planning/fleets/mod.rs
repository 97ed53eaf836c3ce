//! Fleets: from their compact form to files, and the conflicts between vehicles.

mod conflicts;
mod crowds;
mod freedoms;
mod holds;
mod repairs;
mod retiming;
mod table;
