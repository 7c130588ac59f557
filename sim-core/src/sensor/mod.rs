//! Models of the sensors of a robot: rays and echoes, arcs of bumpers, directions of compasses.
//!
//! The functions are pure: their results depend on poses, on a [`World`](crate::world::World) at one instant and on
//! noise values. The [devices](crate::device) handle sampling periods and draw the noise; the API of programs converts
//! units.

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
