//! Numbers as a message has them: short, and never one that reads like the limit it misses.

/// From here on a number is written with a power of ten.
const HUGE: f64 = 1e15;
/// Digits after the point beyond which nobody reads.
const MAX_DIGITS: usize = 9;

/// A number with the digits it has; a huge one with a power of ten.
#[must_use]
pub fn plain(value: f64) -> String {
    if value.is_finite() && value.abs() >= HUGE {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// How many there are of something: 1 item, 2 items.
#[must_use]
pub fn count(number: usize, one: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {one}{plural}")
}

/// A value that a file or a vehicle holds as a float32, with the digits that it has there: 6.1, not
/// 6.099999904632568.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "it is a float32")]
pub fn float32(value: f64) -> String {
    (value as f32).to_string()
}

/// A number with `digits` digits, or with as many more as distinguish it from the limit that it
/// is held against.
#[must_use]
pub fn distinct_from(value: f64, limit: f64, digits: usize) -> String {
    if !value.is_finite() || value.abs() >= HUGE {
        return plain(value);
    }
    let differs = |text: &String| match text.parse::<f64>() {
        Ok(read) => (read < limit) == (value < limit) && (read > limit) == (value > limit),
        Err(_) => false,
    };
    (digits..=MAX_DIGITS)
        .map(|digits| format!("{value:.digits$}"))
        .find(differs)
        .unwrap_or_else(|| plain(value))
}

#[cfg(test)]
mod tests {
    use super::{count, distinct_from, float32, plain};

    #[test]
    fn a_float32_has_the_digits_that_its_file_has() {
        for text in ["6.1", "-10", "0.8", "16384", "NaN", "inf"] {
            let held: f32 = text.parse().expect("a number");
            assert_eq!(float32(f64::from(held)), text);
        }
    }

    #[test]
    fn one_of_something_is_no_plural() {
        assert_eq!(
            [0, 1, 2].map(|n| count(n, "item")),
            ["0 items", "1 item", "2 items"]
        );
    }

    #[test]
    fn a_number_differs_from_its_limit_by_the_fewest_digits() {
        assert_eq!(distinct_from(640.0, 640.0, 0), "640");
        assert_eq!(distinct_from(612.3, 640.0, 0), "612");
        assert_eq!(distinct_from(639.96, 640.0, 0), "639.96");
        assert_eq!(distinct_from(640.000_04, 640.0, 1), "640.00004");
        assert_eq!(distinct_from(640.000_000_000_1, 640.0, 1), "640.0000000001");
        assert_eq!(distinct_from(-0.04, 0.0, 1), "-0.04");
        assert_eq!(distinct_from(f64::NAN, 0.0, 1), "NaN");
    }

    #[test]
    fn a_huge_number_has_a_power_of_ten() {
        assert_eq!(plain(1e308), "1e308");
        assert_eq!(distinct_from(-1e308, 60.0, 1), "-1e308");
        assert_eq!(plain(12.5), "12.5");
        assert_eq!(plain(f64::INFINITY), "inf");
    }
}
