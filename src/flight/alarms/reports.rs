//! Reports of a vehicle that stop while it is heard: what it said last is not known any more.

/// How long ago a report came, in seconds in which the vehicle was heard.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Age {
    s: f64,
}

/// A value of a vehicle, by the number of the battery that it is of, and its age.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reported<T> {
    pub(super) id: u8,
    pub(super) value: T,
    pub(super) age: Age,
}

impl Age {
    pub(super) fn grow(&mut self, by_s: f64) {
        self.s += by_s;
    }

    /// For how long no report has come, if that is more than `max_s`.
    pub(super) fn beyond(self, max_s: f64) -> Option<f64> {
        (self.s > max_s).then_some(self.s)
    }

    /// That of the later one.
    pub(super) fn or_later(self, other: Self) -> Self {
        match other.s < self.s {
            true => other,
            false => self,
        }
    }
}

/// Takes in what a battery says, by its number.
pub(super) fn take<T>(known: &mut Vec<Reported<T>>, id: u8, value: T) {
    let age = Age::default();
    match known.iter_mut().find(|of| of.id == id) {
        Some(known) => (known.value, known.age) = (value, age),
        None => known.push(Reported { id, value, age }),
    }
}
