//! The documents and pages of a review.

#[path = "../support/mod.rs"]
mod support;

mod browser;
mod documents;
mod facts;
mod keys_page;
mod layout;
mod page;
