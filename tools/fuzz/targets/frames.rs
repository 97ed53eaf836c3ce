//! Bytes from anybody: no panic, every message that is understood is written and read
//! back the same, and a good frame is found whatever came before it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sortie::link::{Address, Body, Decoder, Encoder, Message, MissionMessage, Version};

const US: Address = Address {
    system: 245,
    component: 190,
};

fn decode(bytes: &[u8]) -> Vec<(Address, Message)> {
    let mut decoder = Decoder::default();
    decoder.push(bytes);
    std::iter::from_fn(|| decoder.next_message()).collect()
}

fuzz_target!(|data: &[u8]| {
    let (sizes, bytes) = data.split_at(data.len().min(4));
    let mut decoder = Decoder::default();
    let mut found = Vec::new();
    let mut rest = bytes;
    let mut cuts = sizes.iter().cycle();
    while !rest.is_empty() {
        let size = 1 + usize::from(*cuts.next().unwrap_or(&0));
        let (piece, after) = rest.split_at(size.min(rest.len()));
        decoder.push(piece);
        found.extend(std::iter::from_fn(|| decoder.next_message()));
        rest = after;
    }
    for (_, message) in &found {
        for version in [Version::One, Version::Two] {
            let frame = Encoder::new(US).encode_in(version, message);
            let [(from, again)] = &decode(&frame)[..] else {
                panic!("{message:?} does not come back");
            };
            assert_eq!(*from, US);
            if version == Version::Two {
                // NaN is not equal to itself; its words are.
                assert_eq!(format!("{again:?}"), format!("{message:?}"));
            }
        }
    }
    // Longer than the longest frame that the garbage may have begun.
    decoder.push(&[0; 300]);
    while decoder.next_message().is_some() {}
    let good = Message::Mission(MissionMessage {
        target: US,
        mission_type: 1,
        body: Body::Request { seq: 4 },
    });
    decoder.push(&Encoder::new(US).encode(&good));
    assert_eq!(decoder.next_message(), Some((US, good)));
});
