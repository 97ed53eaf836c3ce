//! Buffers: what planning and verdict add to the limits.

use crate::numeric::digits;

/// What is added to each limit for the errors of position and control, metres, not negative.
/// A plan and the verdict on it satisfy limit and buffer; a flight is judged by the limit alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Buffers {
    /// Distance from threats.
    pub threats_m: f64,
    /// Distance from zones; over one with a height as much altitude.
    pub zones_m: f64,
    /// Distance from the edge of the area, inside of it.
    pub area_m: f64,
    /// Height above ground, over the minimum.
    pub terrain_m: f64,
    /// Altitude below the ceiling.
    pub ceiling_m: f64,
    /// Distance of two vehicles, horizontal and vertical, over the separation.
    pub separation_m: f64,
}

impl Buffers {
    /// No buffer.
    pub const NONE: Self = Self::even(0.0);

    /// The same buffer for every limit, metres.
    #[must_use]
    pub const fn even(all_m: f64) -> Self {
        Self {
            threats_m: all_m,
            zones_m: all_m,
            area_m: all_m,
            terrain_m: all_m,
            ceiling_m: all_m,
            separation_m: all_m,
        }
    }

    /// Whether no limit has a buffer.
    #[must_use]
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }
}

/// A limit and what a plan adds to it, for the message on a point in between.
pub(crate) struct BufferedLimit<'a> {
    /// The key of the buffer below `buffer_m`.
    pub(crate) key: &'static str,
    /// What the limit is of, such as ``threat `radar` `` or `area.min_agl_m`.
    pub(crate) of: &'a str,
    /// The limit, metres.
    pub(crate) limit_m: f64,
    /// The limit with its buffer, metres: less for a ceiling.
    pub(crate) buffered_m: f64,
}

impl<'a> BufferedLimit<'a> {
    /// A least value with a buffer, by the key of the buffer and what the limit is of.
    pub(crate) fn beyond((key, of): (&'static str, &'a str), limit_m: f64, buffer_m: f64) -> Self {
        Self {
            key,
            of,
            limit_m,
            buffered_m: limit_m + buffer_m,
        }
    }

    /// Which values are allowed: limit, buffer, and the largest buffer that a value allows,
    /// metres.
    pub(crate) fn allowed(&self, value_m: f64) -> String {
        let (side, sign, spare_m) = match self.buffered_m < self.limit_m {
            true => ("at most", "-", self.limit_m - value_m),
            false => ("at least", "+", value_m - self.limit_m),
        };
        // Cut off, so that what is named works.
        let largest_m = (10.0 * spare_m.max(0.0)).floor() / 10.0;
        format!(
            "{side} {} m: {} {} m {sign} buffer_m.{} {} m; the largest buffer that works here is {} m",
            digits::plain(self.buffered_m),
            self.of,
            digits::plain(self.limit_m),
            self.key,
            digits::plain((self.buffered_m - self.limit_m).abs()),
            digits::plain(largest_m)
        )
    }
}
