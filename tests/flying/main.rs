//! Flights of simulated vehicles: launch, alarms, records, new paths in flight.

#[path = "../support/mod.rs"]
mod support;

mod alarms;
mod armed_time;
mod before_t0;
mod diversion;
mod elsewhere;
mod flight;
mod flight_commands;
mod flight_hold;
mod flight_hostile;
mod flight_pace;
mod flight_record;
mod flight_reports;
mod flight_trouble;
mod flight_truth;
mod flight_vehicle;
mod flight_watch;
mod flight_wings;
mod ground_and_air;
mod hostile_fleet;
mod hostile_udp;
mod launch_time;
mod never_false;
mod noisy_flights;
mod orders_and_ends;
mod orders_meanwhile;
mod ready_and_t0;
mod replan_columns;
mod replan_left;
mod replan_returns;
mod replan_stops;
mod replan_trouble;
mod replan_wings;
mod screen_stalls;
mod seen_in_flight;
mod served;
mod taken_over;
mod two_commanders;
mod untrue_lines;
