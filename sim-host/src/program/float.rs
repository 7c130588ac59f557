//! The floating-point environment of a thread: the host computes in the default one, independent of the program's settings.
//!
//! A rounding mode, flushed subnormals (`-ffast-math` sets them when a library is loaded) or exception traps would otherwise change the
//! results of the host on the program's thread, or stop it there.

/// Control bits of the default environment: round to nearest, all traps masked, subnormals kept.
#[cfg(target_arch = "x86_64")]
const DEFAULT: u32 = 0x1f80;

/// Mask of the register's control bits; the other bits are status flags.
#[cfg(target_arch = "x86_64")]
const CONTROL: u32 = 0xffc0;

/// Sets the default environment; returns the previous one if it was different.
#[cfg(target_arch = "x86_64")]
pub fn set_default() -> Option<u32> {
    let mut present = 0_u32;
    // SAFETY: stores the register MXCSR in a valid variable.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut present, options(nostack, preserves_flags)) };
    if present & CONTROL == DEFAULT {
        return None;
    }
    restore(DEFAULT);
    Some(present)
}

/// Restores an environment that [`set_default`] returned.
#[cfg(target_arch = "x86_64")]
pub fn restore(environment: u32) {
    // SAFETY: `environment` is the default, or was in the register before, so that no reserved bit is set.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const environment, options(nostack, preserves_flags)) };
}

/// Does nothing: on other processors the host runs in the program's environment, outside the guarantee of equal results.
#[cfg(not(target_arch = "x86_64"))]
pub fn set_default() -> Option<u32> {
    None
}

/// Does nothing, see [`set_default`].
#[cfg(not(target_arch = "x86_64"))]
pub fn restore(_: u32) {}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn what_a_program_has_set_is_held_and_comes_back() {
        assert_eq!(set_default(), None);
        // Upwards, subnormals flushed, all traps on but that of inexact results.
        let of_program = 0xd000;
        restore(of_program);
        let held = set_default();
        let third = std::hint::black_box(1.0_f64) / std::hint::black_box(3.0);
        restore(held.unwrap_or(DEFAULT));
        assert_eq!(set_default().map(|environment| environment & CONTROL), Some(of_program & CONTROL));
        assert_eq!(
            (held.map(|environment| environment & CONTROL), third.to_bits()),
            (Some(of_program), 0x3fd5_5555_5555_5555)
        );
    }
}
