//! A value of a `.plan` file and its path.

use serde_json::Value;

use crate::formats::FormatError;
use crate::formats::text::number::{allowed_coordinate, coordinate, float};
use crate::mission::frame;

/// A value and its path.
#[derive(Clone)]
pub(super) struct Node<'a> {
    pub(super) value: &'a Value,
    pub(super) at: String,
    pub(super) item: Option<usize>,
}

impl<'a> Node<'a> {
    /// A member; `null` if there is none.
    pub(super) fn get(&self, key: &str) -> Self {
        Self {
            value: &self.value[key],
            at: if self.at.is_empty() {
                key.to_owned()
            } else {
                format!("{}.{key}", self.at)
            },
            item: self.item,
        }
    }

    /// The elements of a list; of none if it is absent.
    pub(super) fn list(&self) -> Result<Vec<Self>, FormatError> {
        if self.value.is_null() {
            return Ok(Vec::new());
        }
        let values = self.value.as_array().ok_or_else(|| self.bad("a list"))?;
        Ok(values
            .iter()
            .enumerate()
            .map(|(index, value)| Self {
                value,
                at: format!("{}[{index}]", self.at),
                item: self.item,
            })
            .collect())
    }

    pub(super) fn bad(&self, allowed: &str) -> FormatError {
        let text = self.value.to_string();
        let found: String = text.chars().take(60).collect();
        FormatError::Json {
            at: self.at.clone(),
            item: self.item,
            found,
            allowed: allowed.to_owned(),
        }
    }

    pub(super) fn expect_version(&self, version: u64) -> Result<(), FormatError> {
        if self.value.as_u64() == Some(version) {
            Ok(())
        } else {
            Err(self.bad(&version.to_string()))
        }
    }

    /// A number; NaN if it is `null`.
    pub(super) fn number(&self) -> Result<f64, FormatError> {
        match self.value {
            Value::Null => Ok(f64::NAN),
            value => value.as_f64().ok_or_else(|| self.bad("a number or null")),
        }
    }

    pub(super) fn float(&self) -> Result<f32, FormatError> {
        let value = float(self.number()?);
        if value.is_infinite() {
            return Err(self.bad("a number of 32 bits, at most 3.4e38"));
        }
        Ok(value)
    }

    pub(super) fn flag(&self) -> Result<bool, FormatError> {
        self.value
            .as_bool()
            .ok_or_else(|| self.bad("true or false"))
    }

    pub(super) fn unsigned<T: TryFrom<u64>>(&self, allowed: &str) -> Result<T, FormatError> {
        self.value
            .as_u64()
            .and_then(|value| T::try_from(value).ok())
            .ok_or_else(|| self.bad(allowed))
    }

    pub(super) fn scaled(&self, frame: u8) -> Result<i32, FormatError> {
        let value = self.number()?;
        // A command without a place may leave its last parameters unset.
        if value.is_nan() && frame == frame::MISSION {
            return Ok(0);
        }
        coordinate(frame, value).ok_or_else(|| self.bad(&allowed_coordinate(frame)))
    }

    /// Latitude and longitude, 1e-7 degrees, and the altitude if there is one.
    pub(super) fn place(&self) -> Result<((i32, i32), Option<f32>), FormatError> {
        let numbers = self.list()?;
        let [lat, lon, rest @ ..] = numbers.as_slice() else {
            return Err(self.bad("[latitude, longitude]"));
        };
        let height = rest.first().map(Node::float).transpose()?;
        let at = (lat.scaled(frame::GLOBAL)?, lon.scaled(frame::GLOBAL)?);
        Ok((at, height))
    }
}
