//! Numbers as people write them.

use sim_core::pose::Heading;
use sim_core::unit::{Quantity, degrees_from_radians, metres_from_mm, mm_from_metres, radians_from_degrees};

/// Doubles above and below that are tried when the nearest does not read back.
const NEIGHBOURS: u32 = 4;

/// The number of fewest digits near `near` for which `reads_back` holds; `near` if there is none.
pub(crate) fn shortest(near: f64, reads_back: impl Fn(f64) -> bool) -> f64 {
    if near == 0.0 && reads_back(0.0) {
        return 0.0;
    }
    let rounded = (0..17).filter_map(|digits| format!("{near:.digits$e}").parse::<f64>().ok());
    let (mut above, mut below) = (near, near);
    let around = (0..NEIGHBOURS).flat_map(|_| {
        (above, below) = (above.next_up(), below.next_down());
        [above, below]
    });
    rounded.chain(around).find(|number| reads_back(*number)).unwrap_or(near)
}

/// What `quantity` is in its own unit.
pub(crate) fn in_unit(quantity: &Quantity, si: f64) -> f64 {
    shortest(quantity.in_unit(si), |number| quantity.si(number) == si)
}

/// Millimetres of a length in metres.
pub(super) fn mm(metres: f64) -> f64 {
    shortest(mm_from_metres(metres), |mm| metres_from_mm(mm) == metres)
}

/// Degrees of an angle in radians.
pub(super) fn degrees(radians: f64) -> f64 {
    shortest(degrees_from_radians(radians), |degrees| radians_from_degrees(degrees) == radians)
}

/// Degrees of a heading, with its whole turns.
pub(crate) fn heading(heading: Heading) -> f64 {
    let near = degrees_from_radians(heading.radians());
    shortest(near, |degrees| Heading::new(radians_from_degrees(degrees)) == heading)
}

/// A number as it is written: never with an exponent, and whole ones without a point.
pub(super) fn written(number: f64) -> String {
    // Not `-0`.
    format!("{}", number + 0.0)
}

/// Millimetres of a length in metres, as written.
pub(super) fn written_mm(metres: f64) -> String {
    written(mm(metres))
}

/// Degrees of an angle in radians, as written.
pub(super) fn written_degrees(radians: f64) -> String {
    written(degrees(radians))
}
