//! The C ABI between the simulator and a robot program.
