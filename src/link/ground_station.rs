//! Our own address on a link.

use super::message::Address;

/// Our system id, if no vehicle has it. Not 255, which other ground stations use: answers
/// to them must not be mistaken for answers to us.
const SYSTEM: u8 = 245;
/// Component ids for any use, `MAV_COMP_ID_USER1` to `USER75`.
const COMPONENTS: std::ops::RangeInclusive<u8> = 25..=99;

/// Our component id, another one for each process: what a vehicle answers to another Sortie is not for us.
fn component() -> u8 {
    let of_process = std::process::id() as usize % COMPONENTS.len();
    COMPONENTS
        .clone()
        .nth(of_process)
        .unwrap_or(*COMPONENTS.start())
}

/// An address with a system id that no vehicle has; `None` if they have every one.
pub(super) fn free_address(vehicles: &[u8]) -> Option<Address> {
    let mut systems = (1..=SYSTEM).rev();
    let system = systems.find(|system| !vehicles.contains(system))?;
    Some(Address {
        system,
        component: component(),
    })
}

/// [`free_address`], or that of a ground station if there is none.
pub(super) fn address(vehicles: &[u8]) -> Address {
    free_address(vehicles).unwrap_or(Address {
        system: SYSTEM,
        component: component(),
    })
}
