//! The greater and the lesser of two numbers in one instruction each, which `f64::max` and
//! `f64::min` are not, since these pass over what is not a number.

/// The greater of two numbers; `b` if either is not a number.
#[inline(always)]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The lesser of two numbers; `b` if either is not a number.
#[inline(always)]
#[must_use]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
