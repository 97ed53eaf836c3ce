//! Missions to and from vehicles: sans-IO machines, codec, sockets.
