//! Margins as words, and in the order of a report.

use std::cmp::Ordering;

use crate::geodesy::LatLon;
use crate::spec::{Stop, Vehicle};
use crate::verify::{Margin, Review, Sense, Topic};

/// The unit of a margin whose value is its note: how a flight ended.
pub const IN_WORDS: &str = "in words";

/// How a flight may end.
pub const END_AS_PLANNED: &str =
    "a flight as planned ends with the landing, or in the air where the plan ends";

/// The margins of a review, worst first, with how near each is to its limit.
pub(super) struct Ranked<'a> {
    pub(super) margin: &'a Margin,
    /// Slack as a share of the limit (or of a customary amount where the limit
    /// is 0): 0 at the limit, negative beyond it.
    pub(super) slack: f64,
}

/// Broken limits first, then kept ones, each from the tightest; margins without a
/// measure come last.
pub(super) fn ranked(review: &Review) -> Vec<Ranked<'_>> {
    let mut ranked: Vec<Ranked<'_>> = review
        .margins
        .iter()
        .map(|margin| Ranked {
            margin,
            slack: slack(margin),
        })
        .collect();
    ranked.sort_by(|a, b| {
        (a.margin.ok.cmp(&b.margin.ok))
            .then(measures(b.margin).cmp(&measures(a.margin)))
            .then(a.slack.partial_cmp(&b.slack).unwrap_or(Ordering::Equal))
    });
    ranked
}

/// The margins of a review: broken limits first, then kept ones, each from the tightest.
#[must_use]
pub fn worst_first(review: &Review) -> Vec<&Margin> {
    let ranked = ranked(review).into_iter();
    ranked.map(|entry| entry.margin).collect()
}

/// A stop: its id, how long the vehicle stays there, what it does.
pub(super) fn stop(vehicle: &Vehicle, stop: &Stop) -> String {
    let stay_s = vehicle.stay_s(stop);
    let stays = (stay_s > 0.0).then(|| format!("{} s", number(stay_s, 1)));
    let mut done: Vec<String> = stays.into_iter().collect();
    done.extend(stop.actions.iter().map(|action| action.key().to_owned()));
    match done.is_empty() {
        true => format!("stop {}", stop.id),
        false => format!("stop {}: {}", stop.id, done.join(", ")),
    }
}

/// Whether the value says how near the limit is. A count that is all it must be
/// (26 of 26 items, 0 of 0 faults) is at its limit without being near anything.
pub(super) fn measures(margin: &Margin) -> bool {
    let countable = customary(margin.unit).is_none();
    let full = (margin.value - margin.bound).abs() <= 0.0;
    !(margin.ok && (countable && full || !margin.value.is_finite()))
}

/// What counts as much of a unit, where the limit is 0 and gives no scale.
fn customary(unit: &str) -> Option<f64> {
    match unit {
        "m" => Some(100.0),
        "m/s" => Some(5.0),
        "s" | "deg" => Some(10.0),
        _ => None,
    }
}

fn slack(margin: &Margin) -> f64 {
    if !margin.value.is_finite() {
        return if margin.ok { 1.0 } else { -1.0 };
    }
    let scale = if margin.bound.abs() > 0.0 && margin.bound.is_finite() {
        margin.bound.abs()
    } else {
        customary(margin.unit).unwrap_or(1.0)
    };
    let off = (margin.value - margin.bound).abs() / scale;
    if margin.ok { off } else { -off }
}

/// Where a topic stands among the limits that hold; the most important first.
fn rank(topic: Topic) -> usize {
    match topic {
        Topic::Clearance => 0,
        Topic::Separation => 1,
        Topic::Threat => 2,
        Topic::Zone => 3,
        Topic::Height => 4,
        Topic::Endurance => 5,
        Topic::Other => 6,
    }
}

/// The worst margins of different limits: violated ones, then those of topics, then others.
pub(super) fn most_important<'a, 'r>(
    ranked: &'r [Ranked<'a>],
    count: usize,
) -> Vec<&'r Ranked<'a>> {
    let violated = ranked.iter().filter(|entry| !entry.margin.ok);
    let mut held: Vec<_> = ranked
        .iter()
        .filter(|entry| entry.margin.ok && measures(entry.margin))
        .collect();
    held.sort_by_key(|entry| rank(entry.margin.limit.topic()));
    let mut shown: Vec<&Ranked<'a>> = Vec::new();
    for entry in violated.chain(held) {
        let limit = &entry.margin.limit;
        if shown.len() < count && !shown.iter().any(|other| other.margin.limit.is_like(limit)) {
            shown.push(entry);
        }
    }
    shown
}

/// The verdict in one line.
pub(super) fn headline(review: &Review) -> String {
    let all = review.margins.len();
    let broken = review.margins.iter().filter(|margin| !margin.ok).count();
    match (all, broken) {
        (0, _) => "Nothing could be judged, so nothing may fly.".to_owned(),
        (1, 0) => "The one limit is kept.".to_owned(),
        (_, 0) => format!("All {all} limits are kept."),
        (_, 1) => format!("1 of {all} limits is broken."),
        _ => format!("{broken} of {all} limits are broken."),
    }
}

/// The vehicles of a margin.
pub(super) fn who(margin: &Margin) -> String {
    match &margin.other {
        Some(other) => format!("{} and {other}", margin.vehicle),
        None if margin.vehicle.is_empty() => "–".to_owned(),
        None => margin.vehicle.clone(),
    }
}

/// The worst value with its unit.
pub(super) fn value(margin: &Margin) -> String {
    if margin.unit == IN_WORDS {
        margin.note.clone()
    } else if margin.value.is_finite() {
        with_unit(&number_against(margin.value, margin.bound), margin.unit)
    } else if margin.ok {
        "–".to_owned()
    } else {
        "not known".to_owned()
    }
}

/// The remark of a margin, or what is allowed where the value is in words.
pub(super) fn note(margin: &Margin) -> &str {
    match margin.unit {
        IN_WORDS => END_AS_PLANNED,
        _ => &margin.note,
    }
}

/// The limit with its direction and unit.
pub(super) fn limit(margin: &Margin) -> String {
    if !margin.bound.is_finite() {
        return "–".to_owned();
    }
    let limit = with_unit(&number(margin.bound, 1), margin.unit);
    if !margin.value.is_finite() {
        limit
    } else if margin.sense == Sense::AtLeast {
        format!("at least {limit}")
    } else {
        format!("at most {limit}")
    }
}

fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" => number.to_owned(),
        "deg" => format!("{number}°"),
        _ => format!("{number} {unit}"),
    }
}

/// A number with the fewest digits that show on which side of the limit it is.
fn number_against(value: f64, limit: f64) -> String {
    let apart = (value - limit).abs() > 1e-9;
    let scales = [
        (1, 10.0),
        (2, 100.0),
        (3, 1e3),
        (4, 1e4),
        (5, 1e5),
        (6, 1e6),
    ];
    scales
        .into_iter()
        .skip(usize::from(value.abs() < 10.0 && limit.abs() < 10.0))
        .find(|(_, scale)| !apart || ((value * scale).round() / scale - limit).abs() > 1e-9)
        .map_or_else(|| format!("{value:e}"), |(digits, _)| number(value, digits))
}

/// From here on a number is written with a power of ten.
const HUGE: f64 = 1e12;

/// A number with `digits` decimals, a whole one with none; thousands are separated.
pub(super) fn number(value: f64, digits: usize) -> String {
    if value.abs() >= HUGE {
        let text = format!("{value:.3e}").replace('-', "−");
        let (mantissa, power) = text.split_at(text.find('e').unwrap_or(text.len()));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}{power}");
    }
    let whole = (value - value.round()).abs() < 1e-9;
    let digits = if whole { 0 } else { digits };
    let text = format!("{:.*}", digits, value.abs());
    let (integer, fraction) = text.split_at(text.find('.').unwrap_or(text.len()));
    let mut grouped = String::new();
    for (place, digit) in integer.chars().enumerate() {
        if place > 0 && (integer.len() - place).is_multiple_of(3) && integer.len() > 4 {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    let zero = text.chars().all(|c| matches!(c, '0' | '.'));
    let sign = if value < 0.0 && !zero { "−" } else { "" };
    format!("{sign}{grouped}{fraction}")
}

/// Seconds as minutes and seconds, or with hours.
pub(super) fn clock(t_s: f64) -> String {
    if !t_s.is_finite() || t_s.abs() > 1e9 {
        return "–".to_owned();
    }
    #[expect(clippy::cast_possible_truncation, reason = "below 1e9")]
    let whole = t_s.abs().round() as i64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    let sign = if t_s < 0.0 && whole > 0 { "−" } else { "" };
    if hours > 0 {
        format!("{sign}{hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{sign}{minutes}:{seconds:02}")
    }
}

/// Latitude and longitude, degrees.
pub(super) fn place(place: LatLon) -> String {
    format!("{:.6}, {:.6}", place.lat_deg, place.lon_deg)
}

/// Text for an element or a quoted attribute of HTML.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            // Not characters of XML.
            '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                safe.push('\u{fffd}');
            }
            _ => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::{clock, escaped, limit, number, ranked, value};
    use crate::verify::{Limit, Margin, Review, Sense};

    fn margin(limit: Limit, value: f64, bound: f64, unit: &'static str, ok: bool) -> Margin {
        Margin {
            vehicle: "alpha".to_owned(),
            other: None,
            limit,
            value,
            bound,
            buffer: 0.0,
            sense: if (value >= bound) == ok {
                Sense::AtLeast
            } else {
                Sense::AtMost
            },
            unit,
            at: None,
            shift: None,
            ok,
            note: String::new(),
        }
    }

    #[test]
    fn broken_limits_come_first_and_counts_of_nothing_last() {
        let review = Review {
            margins: vec![
                margin(Limit::Acceptance, 0.0, 0.0, "items", true),
                margin(Limit::TerrainClearance, 90.0, 60.0, "m", true),
                margin(Limit::ClimbAngle, 16.0, 15.0, "deg", false),
                margin(Limit::Threat("radar".to_owned()), 20.0, 0.0, "m", true),
                margin(Limit::Area, f64::NAN, 0.0, "m", false),
            ],
            tracks: Vec::new(),
            assumptions: Vec::new(),
        };
        let order: Vec<String> = ranked(&review)
            .iter()
            .map(|r| r.margin.limit.to_string())
            .collect();
        assert_eq!(
            order,
            [
                "area",
                "climb angle",
                "threat radar",
                "terrain clearance",
                "acceptance"
            ]
        );
    }

    #[test]
    fn a_value_never_reads_like_the_limit_it_misses() {
        assert_eq!(
            value(&margin(Limit::TerrainClearance, 59.96, 60.0, "m", false)),
            "59.96 m"
        );
        assert_eq!(
            value(&margin(Limit::TerrainClearance, 59.9996, 60.0, "m", false)),
            "59.9996 m"
        );
        assert_eq!(
            value(&margin(Limit::TerrainClearance, 60.0, 60.0, "m", true)),
            "60 m"
        );
        assert_eq!(
            value(&margin(Limit::TerrainClearance, f64::NAN, 60.0, "m", false)),
            "not known"
        );
    }

    #[test]
    fn a_limit_says_whether_it_is_a_least_or_a_greatest_value() {
        assert_eq!(
            limit(&margin(Limit::TerrainClearance, 61.0, 60.0, "m", true)),
            "at least 60 m"
        );
        assert_eq!(
            limit(&margin(Limit::TerrainClearance, 59.0, 60.0, "m", false)),
            "at least 60 m"
        );
        assert_eq!(
            limit(&margin(Limit::TerrainClearance, 9.0, 15.0, "deg", true)),
            "at most 15°"
        );
        assert_eq!(
            limit(&margin(Limit::TerrainClearance, 16.0, 15.0, "deg", false)),
            "at most 15°"
        );
        let none = Margin {
            sense: Sense::AtMost,
            ..margin(Limit::Acceptance, 0.0, 0.0, "problems", true)
        };
        assert_eq!(limit(&none), "at most 0 problems");
    }

    #[test]
    fn numbers_and_times_read_well() {
        assert_eq!(number(-0.04, 1), "0.0");
        assert_eq!(number(-12.34, 1), "−12.3");
        assert_eq!(number(9999.0, 1), "9999");
        assert_eq!(number(1_234_567.0, 1), "1\u{202f}234\u{202f}567");
        assert_eq!(number(1e308, 1), "1e308");
        assert_eq!(number(-f64::MAX, 1), "−1.798e308");
        assert_eq!(
            value(&margin(Limit::TerrainClearance, 1e300, 60.0, "m", true)),
            "1e300 m"
        );
        assert_eq!(clock(59.6), "1:00");
        assert_eq!(clock(3671.2), "1:01:11");
        assert_eq!(clock(-0.2), "0:00");
    }

    #[test]
    fn markup_in_a_name_is_text() {
        assert_eq!(
            escaped("<b a='\"'>&\u{1}"),
            "&lt;b a=&#39;&quot;&#39;&gt;&amp;\u{fffd}"
        );
    }
}
