//! Geometry of the sensors on a body: rays, arcs of bumpers, directions of compasses.
//!
//! The functions are pure functions of poses and of a [`World`](crate::world::World) at one instant. Sampling periods,
//! unit conversion, saturation and noise are handled by the [devices](crate::device).

mod bumper;
mod compass;
mod echo;
mod errors;
mod range;
mod ray;
mod scan;
mod sonar;

pub use bumper::Bumper;
pub use compass::bearing_from_north;
pub use echo::{Echo, FRANCE_1999_SIGMA, incidence, recovered_distance, reflected_signal};
pub use range::{Posture, RangeModel, RangeSensor, Reading};
pub use ray::{Beam, Mount};
pub use scan::{Fan, Scan};
pub use sonar::{SideLobes, Sonar};
