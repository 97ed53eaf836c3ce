//! Active times.

use jiff::Timestamp;
use serde_json::Value;

use crate::numeric::text::timestamp;

/// From and to.
pub(super) type Period = (Option<Timestamp>, Option<Timestamp>);

/// The period that holds all periods of a list of ED-269 or ED-318: without end where one of
/// them is or one is permanent. A weekly schedule within a period counts as all of it.
///
/// # Errors
/// A time that is none.
pub(super) fn hull(list: Option<&Value>) -> Result<Period, String> {
    let Some(periods) = list
        .and_then(Value::as_array)
        .filter(|list| !list.is_empty())
    else {
        return Ok((None, None));
    };
    let mut all: Option<Period> = None;
    for period in periods {
        let is_permanent = period.get("permanent").is_some_and(|of| match of {
            Value::String(word) => word.trim().eq_ignore_ascii_case("yes"),
            other => other.as_bool() == Some(true),
        });
        if is_permanent {
            return Ok((None, None));
        }
        let end = |key: &str| match period.get(key).and_then(Value::as_str) {
            Some(text) => timestamp(text)
                .map(Some)
                .ok_or_else(|| format!("{key} `{}` is no time", text.escape_debug())),
            None => Ok(None),
        };
        let next = (end("startDateTime")?, end("endDateTime")?);
        all = Some(match all {
            None => next,
            Some((from, to)) => (
                from.zip(next.0).map(|(a, b)| a.min(b)),
                to.zip(next.1).map(|(a, b)| a.max(b)),
            ),
        });
    }
    Ok(all.unwrap_or((None, None)))
}
