//! Lookup of devices in the hardware description table.
//!
//! Source: RoBIOS 6 library, hardware description table.

use robios_sys::robios6::HDTEntry;
use robios_sys::robios6::hdt_type::{HDT_IRTV, HDT_MOTOR};
use robios_sys::{Out, Robios6Call as Call};

use super::robot::Robot;
use super::table::Device;

/// `HDT_FindEntry`: 1 if there is such a device.
pub fn find_entry(robot: &mut Robot, kind: i32, semantics: i32, entry: &mut Out<HDTEntry>) -> i32 {
    match robot.robios.table.find(kind, semantics) {
        Some(device) => {
            entry.set(HDTEntry { semantics, ..row(device) });
            1
        }
        None => robot.fail_call(Call::HDT_FindEntry, 0),
    }
}

/// `HDT_FindTable`
pub fn find_nth(robot: &mut Robot, kind: i32, index: i32, entry: &mut Out<HDTEntry>) -> i32 {
    let nth = usize::try_from(index).ok().and_then(|index| robot.robios.table.of_kind(kind).nth(index));
    match nth {
        Some(device) if !entry.is_null() => {
            entry.set(row(device));
            0
        }
        _ => robot.fail_call(Call::HDT_FindTable, -1),
    }
}

/// `HDT_TypeCount`
pub fn count(robot: &Robot, kind: i32) -> i32 {
    let is_kind = (HDT_MOTOR..=HDT_IRTV).contains(&kind);
    if is_kind { robot.robios.table.of_kind(kind).count() as i32 } else { 0 }
}

fn row(device: &Device) -> HDTEntry {
    let mut name = [0; 16];
    // The last byte stays 0.
    name[..15].iter_mut().zip(device.name.bytes()).for_each(|(target, byte)| *target = byte);
    HDTEntry { type_id: device.kind, semantics: device.number(), name }
}
