//! Speed against error: brute-force oracles and naive integrators that the core is compared with.
#![forbid(unsafe_code)]
