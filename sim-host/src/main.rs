//! The command `eyesim`.
fn main() {}
