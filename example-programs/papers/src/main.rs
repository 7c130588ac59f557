//! Runs the scenes of three papers with `eyesim` and sets our figures beside their claims.

fn main() {}
