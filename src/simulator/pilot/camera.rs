//! The camera that mission items take pictures with.

use super::{Event, Pilot};
use crate::mission::{Item, command};

/// A camera, and how often it takes pictures by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Camera {
    /// Distance between two pictures, metres; 0: none by itself.
    every_m: f64,
    /// Where the last one was taken: east, north, metres.
    at_m: [f64; 2],
    /// Pictures so far.
    pictures: u32,
}

impl Pilot {
    /// Does what an item without a place says, as far as it is about the camera.
    pub(super) fn act(&mut self, item: &Item) {
        match item.command {
            command::IMAGE_START_CAPTURE => self.take_picture(),
            command::DO_SET_CAM_TRIGG_DIST => {
                self.camera.every_m = f64::from(item.params[0]).max(0.0);
                if item.params[2] > 0.0 {
                    self.take_picture();
                }
            }
            _ => {}
        }
    }

    fn take_picture(&mut self) {
        let [east_m, north_m, _] = self.body.at_m;
        self.camera.at_m = [east_m, north_m];
        self.camera.pictures += 1;
        self.events.push(Event::Picture(self.camera.pictures));
    }

    /// The next picture along the way, if it is due.
    pub(super) fn watch_camera(&mut self) {
        let [east_m, north_m, _] = self.body.at_m;
        let [from_east_m, from_north_m] = self.camera.at_m;
        let gone_m = (east_m - from_east_m).hypot(north_m - from_north_m);
        if self.airborne && self.camera.every_m > 0.0 && gone_m >= self.camera.every_m {
            self.take_picture();
        }
    }
}
