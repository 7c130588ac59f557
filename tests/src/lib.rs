//! Helpers for the black-box tests: a fresh folder, the real binary, its outputs.
