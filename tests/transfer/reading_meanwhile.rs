//! What is read of a vehicle while another station writes to it is what it holds, or a failure.

use crate::mission_upload::{Scene, VEHICLE, ack, mission, say, vehicle};
use crate::support::{lossy_link, transfers};
use lossy_link::CLEAR;
use sortie::link::*;
use sortie::mission::Item;
use sortie::simulator::{Profile, Vehicle};
use transfers::{STRANGER, US};

/// Uploads this mission while the other one is read, whose answers wait so long.
struct Writer {
    rows: Vec<Item>,
    /// Whether what it and the vehicle say to each other is not overheard.
    deaf: bool,
    upload: Option<Upload>,
    waiting: Vec<Message>,
}

impl Writer {
    fn begin(&mut self, now: Time) {
        let (us, vehicle, list) = (STRANGER, VEHICLE, MissionType::Mission);
        let route = Route { us, vehicle, list };
        let rows = self.rows.iter().map(|row| (*row, 0)).collect();
        let upload = Upload::new(route, rows, 4000, now + 60_000, now);
        self.upload.get_or_insert(upload);
    }

    fn writes(&self) -> bool {
        let upload = self.upload.as_ref();
        upload.is_some_and(|upload| upload.outcome().is_none())
    }
}

fn is_for_us(message: &Message) -> bool {
    !matches!(message, Message::Mission(mission) if mission.target == STRANGER)
}

/// Reads all lists; the writer begins when so many items of the mission were read.
fn read(vehicle: &mut Vehicle, writer: &mut Writer, after: usize) -> Result<Onboard, Failure> {
    let mut now = Time(100_000);
    let mut reading = Reading::new(Some(VEHICLE.system), US, now);
    while reading.outcome().is_none() && now < Time(400_000) {
        now = now + 10;
        if reading
            .progress()
            .is_some_and(|(list, items)| list == MissionType::Mission && items >= after)
        {
            writer.begin(now);
        }
        reading.handle_timeout(now);
        writer
            .waiting
            .extend(std::iter::from_fn(|| reading.poll_transmit()));
        if let Some(upload) = &mut writer.upload {
            upload.handle_timeout(now);
            while let Some(message) = upload.poll_transmit() {
                vehicle.handle(now, STRANGER, &message);
                if !writer.deaf {
                    reading.handle(now, STRANGER, &message);
                }
            }
        }
        if !writer.writes() {
            for message in writer.waiting.drain(..) {
                vehicle.handle(now, US, &message);
            }
        }
        vehicle.handle_timeout(now);
        while let Some(message) = vehicle.poll_transmit() {
            if let Some(upload) = &mut writer.upload {
                upload.handle(now, VEHICLE, &message);
            }
            if !writer.deaf || is_for_us(&message) {
                reading.handle(now, VEHICLE, &message);
            }
        }
    }
    reading.outcome().cloned().expect("an outcome")
}

/// A vehicle that holds a mission, and the rows of another one that is 60 m higher.
fn loaded(profile: Profile) -> (Vehicle, Vec<Item>) {
    let mission = mission(profile, 20);
    let mut scene = Scene::new(11, CLEAR, vehicle(profile), &mission);
    assert_eq!(scene.run().verdict, Verdict::Verified);
    let mut rows = scene.vehicle.items(MissionType::Mission).to_vec();
    for row in &mut rows {
        row.z += 60.0;
    }
    if profile == Profile::ArduPilot {
        let home = Item {
            z: transfers::HOME.amsl_m,
            ..rows[0]
        };
        rows.insert(0, home);
    }
    (scene.vehicle, rows)
}

#[test]
fn a_mission_that_another_station_replaces_while_it_is_read_is_no_mix_of_both() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        for deaf in [false, true] {
            for after in [1, 4, 15] {
                let (mut vehicle, rows) = loaded(profile);
                let mut writer = Writer {
                    rows,
                    deaf,
                    upload: None,
                    waiting: Vec::new(),
                };
                let onboard = read(&mut vehicle, &mut writer, after).expect("the lists");
                assert!(
                    writer
                        .upload
                        .is_some_and(|upload| upload.outcome().is_some())
                );
                let held = vehicle.items(MissionType::Mission);
                assert_eq!(
                    onboard.mission, held,
                    "{profile:?} deaf: {deaf} after {after}"
                );
                assert_eq!(onboard.fence.len(), 4);
            }
        }
    }
}

#[test]
fn a_list_that_another_station_writes_again_and_again_is_not_read_and_it_is_named() {
    let (mut vehicle, _) = loaded(Profile::Px4);
    let mut reading = Reading::new(Some(VEHICLE.system), US, Time(100_000));
    let mut now = Time(100_000);
    let accepted = say(STRANGER, MissionType::Rally, ack(MissionResult::ACCEPTED));
    while reading.outcome().is_none() && now < Time(400_000) {
        now = now + 10;
        reading.handle_timeout(now);
        while let Some(message) = reading.poll_transmit() {
            vehicle.handle(now, US, &message);
        }
        vehicle.handle_timeout(now);
        while let Some(message) = vehicle.poll_transmit() {
            reading.handle(now, VEHICLE, &message);
        }
        if now.0.is_multiple_of(100) {
            reading.handle(now, VEHICLE, &accepted);
        }
    }
    let failure = reading
        .outcome()
        .cloned()
        .expect("an outcome")
        .expect_err("a failure");
    assert_eq!(
        failure.to_string(),
        "rally: changed by system 255 while it was read, again and again; read it again while no other station \
         writes to the vehicle"
    );
}
