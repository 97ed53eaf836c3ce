//! Plan, encode, verify, and plan again where a limit is violated, in bounded rounds.
