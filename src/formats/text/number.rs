//! Numbers as text, without loss.

/// Scaled integer coordinates per unit: 1e-7 degrees, or 1e-4 metres in a local frame.
pub(crate) fn scale(frame: u8) -> f64 {
    match frame {
        0 | 3 | 5 | 6 | 10 | 11 => 1e7,
        // MAV_FRAME_MISSION: param5 and param6 as they are.
        2 => 1.0,
        _ => 1e4,
    }
}

/// A scaled coordinate as exact decimals.
pub(crate) fn coordinate_text(frame: u8, value: i32) -> String {
    let scale: u32 = match frame {
        0 | 3 | 5 | 6 | 10 | 11 => 10_000_000,
        2 => return value.to_string(),
        _ => 10_000,
    };
    let digits = if scale == 10_000 { 4 } else { 7 };
    let sign = if value < 0 { "-" } else { "" };
    let size = value.unsigned_abs();
    format!("{sign}{}.{:0digits$}", size / scale, size % scale)
}

/// The scaled integer of a coordinate, nearest; none if it does not fit.
pub(crate) fn coordinate(frame: u8, value: f64) -> Option<i32> {
    let scaled = (value * scale(frame)).round();
    if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&scaled) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, reason = "a whole number in range")]
    let scaled = scaled as i32;
    Some(scaled)
}

/// What a coordinate of an item in a frame may be.
pub(crate) fn allowed_coordinate(frame: u8) -> String {
    let scale = scale(frame);
    let at = |end: i32| f64::from(end) / scale;
    format!("a number from {} to {}", at(i32::MIN), at(i32::MAX))
}

/// What becomes of a coordinate that an item in a frame without degrees cannot hold, in words.
pub(crate) fn rounded(frame: u8, value: f64) -> Option<String> {
    let scale = scale(frame);
    let held = (value * scale).round() / scale;
    let is_held = scale > 1e6 || (value - held).abs() <= 1e-6 / scale;
    (!is_held).then(|| format!("{value} becomes {held} (an item in frame {frame} holds no more)"))
}

/// The f64 whose shortest decimals are those of the f32, if it reads back as the same f32.
pub(crate) fn shortest(value: f32) -> f64 {
    let exact = f64::from(value);
    match value.to_string().parse::<f64>() {
        Ok(short) if float(short).to_bits() == value.to_bits() => short,
        _ => exact,
    }
}

/// Nearest f32.
pub(crate) fn float(value: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "items are float32 on the wire"
    )]
    let value = value as f32;
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn coordinates_that_a_frame_cannot_hold_are_found() {
        for (frame, value, is_held) in [
            (2, 47.0, true),
            (2, 47.41, false),
            (2, 0.5, false),
            (1, 12.345_6, true),
            (1, 12.345_678, false),
            (3, 47.123_456_789, true),
        ] {
            assert_eq!(rounded(frame, value).is_none(), is_held, "{frame} {value}");
        }
    }

    #[test]
    fn coordinates_have_all_their_digits_and_their_sign() {
        assert_eq!(coordinate_text(0, -5), "-0.0000005");
        assert_eq!(coordinate_text(3, 363_000_001), "36.3000001");
        assert_eq!(coordinate_text(2, -7), "-7");
        assert_eq!(coordinate_text(1, 12_345), "1.2345");
        assert_eq!(coordinate_text(0, i32::MIN), "-214.7483648");
    }

    proptest! {
        #[test]
        fn every_coordinate_comes_back(frame in prop::sample::select(vec![0_u8, 1, 2, 3, 10]), value in any::<i32>()) {
            let text = coordinate_text(frame, value);
            let number: f64 = text.parse().expect("decimals");
            prop_assert_eq!(coordinate(frame, number), Some(value));
        }

        #[test]
        fn every_float_comes_back(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(float(shortest(value)).to_bits(), bits);
        }
    }
}
