//! Numbers as short decimals.

use sim_core::pose::Heading;
use sim_core::unit::{Quantity, degrees_from_radians, metres_from_mm, mm_from_metres, radians_from_degrees};

/// Number of neighbouring `f64` values that are tried on either side if no short decimal reads back.
const NEIGHBOURS: u32 = 4;

/// Number near `start` with the fewest digits for which `reads_back` returns true; `start` if there is none.
pub(crate) fn shortest(start: f64, reads_back: impl Fn(f64) -> bool) -> f64 {
    if start == 0.0 && reads_back(0.0) {
        return 0.0;
    }
    let rounded_numbers = (0..17).filter_map(|digits| format!("{start:.digits$e}").parse::<f64>().ok());
    let (mut above, mut below) = (start, start);
    let neighbours = (0..NEIGHBOURS).flat_map(|_| {
        (above, below) = (above.next_up(), below.next_down());
        [above, below]
    });
    rounded_numbers.chain(neighbours).find(|number| reads_back(*number)).unwrap_or(start)
}

/// Converts an SI value to the unit of `quantity`.
pub(crate) fn in_unit(quantity: &Quantity, si: f64) -> f64 {
    shortest(quantity.in_unit(si), |number| quantity.si(number) == si)
}

/// Length in millimetres.
pub(crate) fn mm(metres: f64) -> f64 {
    shortest(mm_from_metres(metres), |mm| metres_from_mm(mm) == metres)
}

/// Angle in degrees.
pub(super) fn degrees(radians: f64) -> f64 {
    shortest(degrees_from_radians(radians), |degrees| radians_from_degrees(degrees) == radians)
}

/// Heading in degrees, including whole turns.
pub(crate) fn heading(heading: Heading) -> f64 {
    let approximate = degrees_from_radians(heading.radians());
    shortest(approximate, |degrees| Heading::new(radians_from_degrees(degrees)) == heading)
}

/// Formats a number: never with an exponent, and whole numbers without a point.
pub(crate) fn written(number: f64) -> String {
    // Adding 0.0 turns -0 into 0.
    format!("{}", number + 0.0)
}

/// Formats a length in millimetres.
pub(crate) fn written_mm(metres: f64) -> String {
    written(mm(metres))
}

/// Formats an angle in degrees.
pub(crate) fn written_degrees(radians: f64) -> String {
    written(degrees(radians))
}
