//! Sets the floating-point environment of a thread: the host always computes in the default environment, even if the
//! program has set another one.
//!
//! Otherwise a changed rounding mode or flush-to-zero (set when a library built with `-ffast-math` is loaded) would
//! change the host's results on the program's thread, and an unmasked exception would stop the host with SIGFPE.

/// MXCSR of the default environment: round to nearest, all exceptions masked, subnormals kept.
#[cfg(target_arch = "x86_64")]
const MXCSR_DEFAULT: u32 = 0x1f80;

/// Mask of MXCSR's control bits; the other bits are status flags.
#[cfg(target_arch = "x86_64")]
const MXCSR_CONTROL: u32 = 0xffc0;

/// Sets the default environment; returns the previous environment if it was different.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn set_default() -> Option<u32> {
    let mut current = 0_u32;
    // SAFETY: stores the register MXCSR in a valid variable.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut current, options(nostack, preserves_flags)) };
    if current & MXCSR_CONTROL == MXCSR_DEFAULT {
        return None;
    }
    restore(MXCSR_DEFAULT);
    Some(current)
}

/// Restores an environment that [`set_default`] returned.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn restore(environment: u32) {
    // SAFETY: `environment` is the default, or was in the register before, so that no reserved bit is set.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const environment, options(nostack, preserves_flags)) };
}

/// Does nothing: on other processors the host runs in the program's environment, so bit-identical results are not
/// guaranteed there.
#[cfg(not(target_arch = "x86_64"))]
pub fn set_default() -> Option<u32> {
    None
}

/// Does nothing, see [`set_default`].
#[cfg(not(target_arch = "x86_64"))]
pub fn restore(_: u32) {}

/// The floating-point environment of a flow that shares its thread with other flows: control bits and sticky exception
/// flags of SSE and of the x87.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Environment {
    /// MXCSR, with its status flags.
    sse: u32,
    /// Control word of the x87.
    control: u16,
    /// Exception flags of the x87's status word.
    flags: u16,
}

#[cfg(target_arch = "x86_64")]
impl Environment {
    /// The environment with which a thread starts.
    pub const INITIAL: Self = Self { sse: MXCSR_DEFAULT, control: 0x37f, flags: 0 };

    /// Exception flags in the x87's status word, stack fault included.
    const X87_FLAGS: u16 = 0x7f;

    /// The calling thread's current environment.
    #[inline]
    pub fn current() -> Self {
        let (mut sse, mut control, mut status) = (0_u32, 0_u16, 0_u16);
        // SAFETY: each instruction stores a register in a valid variable of its size, and changes nothing else.
        unsafe {
            std::arch::asm!(
                "stmxcsr [{sse}]",
                "fnstcw [{control}]",
                "fnstsw [{status}]",
                sse = in(reg) &raw mut sse,
                control = in(reg) &raw mut control,
                status = in(reg) &raw mut status,
                options(nostack, preserves_flags)
            );
        }
        Self { sse, control, flags: status & Self::X87_FLAGS }
    }

    /// Makes this the calling thread's environment.
    #[inline]
    pub fn apply(self) {
        restore(self.sse);
        let Self { control, flags, .. } = Self::current();
        if (control, flags) == (self.control, self.flags) {
            return;
        }
        // Control, status and tag word, each in the lower half of its element; then addresses of the last instruction
        // and operand.
        let mut image = [0_u32; 7];
        // SAFETY: stores the x87's environment in `image`, which has its size of 28 bytes.
        unsafe { std::arch::asm!("fnstenv [{}]", in(reg) image.as_mut_ptr(), options(nostack, preserves_flags)) };
        image[0] = image[0] & !0xffff | u32::from(self.control);
        image[1] = image[1] & !u32::from(Self::X87_FLAGS) | u32::from(self.flags);
        // SAFETY: loads what was stored above, whose control word and flags were themselves read from an x87. The
        // register stack stays empty, as the calling convention requires.
        unsafe { std::arch::asm!("fldenv [{}]", in(reg) image.as_ptr(), options(nostack, preserves_flags)) };
    }
}

/// Gives the calling thread the environment with which it started, and empties the x87's register stack: the thread may
/// have jumped out of the middle of an expression.
pub fn reset() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: by the ABI the x87 register stack is empty at a call.
    unsafe {
        std::arch::asm!("fninit", out("st(0)") _, out("st(1)") _, out("st(2)") _, out("st(3)") _,
            out("st(4)") _, out("st(5)") _, out("st(6)") _, out("st(7)") _, options(nomem, nostack));
    }
    Environment::INITIAL.apply();
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn environment_is_saved_and_restored_with_its_flags() {
        let initial = Environment::current();
        // The x87 rounds up in single precision, SSE rounds down; flags of division by zero and of inexact results are
        // set.
        let strange = Environment { sse: MXCSR_DEFAULT | 0x2000 | 0x04, control: 0x087f, flags: 0x24 };
        strange.apply();
        assert_eq!(Environment::current(), strange);
        Environment::INITIAL.apply();
        assert_eq!(Environment::current(), Environment::INITIAL);
        initial.apply();
    }

    #[test]
    fn environment_of_a_program_is_replaced_and_restored() {
        assert_eq!(set_default(), None);
        // Rounds upwards, flushes subnormals, and traps on all exceptions except inexact results.
        let program_environment = 0xd000;
        restore(program_environment);
        let previous = set_default();
        let third = std::hint::black_box(1.0_f64) / std::hint::black_box(3.0);
        restore(previous.unwrap_or(MXCSR_DEFAULT));
        assert_eq!(
            set_default().map(|environment| environment & MXCSR_CONTROL),
            Some(program_environment & MXCSR_CONTROL)
        );
        assert_eq!(
            (previous.map(|environment| environment & MXCSR_CONTROL), third.to_bits()),
            (Some(program_environment), 0x3fd5_5555_5555_5555)
        );
    }
}
