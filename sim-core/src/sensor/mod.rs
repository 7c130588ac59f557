//! Geometry of sensors on the body: where a ray starts, which side is touched, what a compass shows.
