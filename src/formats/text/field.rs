//! The fields of a row as numbers.

use super::number::{allowed_coordinate, coordinate};
use crate::formats::FormatError;
use crate::mission::command_named;

/// A field with its line and column.
#[derive(Clone, Copy)]
pub(crate) struct Field<'a> {
    pub(crate) text: &'a str,
    pub(crate) line: usize,
    pub(crate) column: usize,
}

fn bad(field: Field<'_>, allowed: impl Into<String>) -> FormatError {
    let found: String = field.text.chars().take(40).collect();
    FormatError::Text {
        line: field.line,
        column: field.column,
        found: format!("{found:?}"),
        allowed: allowed.into(),
    }
}

/// A whole number from 0; some writers give it decimals (`16.0`).
pub(crate) fn whole(field: Field<'_>, most: u32) -> Result<u32, FormatError> {
    let value: f64 = field.text.parse().map_err(|_| {
        let digits = if is_hexadecimal(field.text) {
            ", in decimal digits"
        } else {
            ""
        };
        bad(field, format!("0 to {most}{digits}"))
    })?;
    let whole = saturated(value);
    if whole <= most && f64::from(whole).to_bits() == value.abs().to_bits() {
        Ok(whole)
    } else {
        Err(bad(field, format!("0 to {most}, whole")))
    }
}

fn saturated(value: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates; the caller compares with the original"
    )]
    let whole = value as u32;
    whole
}

pub(crate) fn byte(field: Field<'_>) -> Result<u8, FormatError> {
    u8::try_from(whole(field, 255)?).map_err(|_| bad(field, "0 to 255"))
}

/// A command by number or by name.
pub(crate) fn command_number(field: Field<'_>) -> Result<u16, FormatError> {
    if let Some(command) = command_named(field.text) {
        return Ok(command);
    }
    let number = whole(field, u32::from(u16::MAX))?;
    u16::try_from(number).map_err(|_| bad(field, "0 to 65535"))
}

pub(crate) fn float(field: Field<'_>) -> Result<f32, FormatError> {
    field
        .text
        .parse::<f32>()
        .ok()
        .filter(|value| !value.is_infinite())
        .ok_or_else(|| bad(field, number_like(field.text)))
}

/// The allowed text; decimal commas are common in Europe.
fn number_like(text: &str) -> &'static str {
    if text.contains(',') {
        "a number, with a point before its decimals"
    } else if is_hexadecimal(text) {
        "a number in decimal digits"
    } else {
        "a number"
    }
}

fn is_hexadecimal(text: &str) -> bool {
    text.starts_with("0x") || text.starts_with("0X")
}

pub(crate) fn scaled(field: Field<'_>, frame: u8) -> Result<i32, FormatError> {
    field
        .text
        .parse()
        .ok()
        .and_then(|value| coordinate(frame, value))
        .ok_or_else(|| {
            let allowed = match number_like(field.text) {
                "a number" => allowed_coordinate(frame),
                other => other.to_owned(),
            };
            bad(field, allowed)
        })
}
