//! The floating-point environment of a host, put aside for the time of a call.
//!
//! A host may trap floating-point exceptions (OpenFOAM does), round in another direction, or flush subnormal numbers to zero.
//! The library computes with infinities on purpose and discards exceptions, and its results must not depend on such
//! settings. So every entry of the C interface and of the FMU holds a [`DefaultEnvironment`]: exceptions are masked, rounding
//! is to nearest, subnormal numbers are kept; when the call ends the host has its control word back, and its sticky
//! exception flags as they were.
//!
//! * x86-64: MXCSR, and control and status word of the x87 unit, which library functions may use.
//! * AArch64: FPCR and FPSR.
//! * elsewhere: nothing is changed.
//!
//! Callers from Rust have the default environment already; the language assumes it.
#![allow(unsafe_code)]

/// The default floating-point environment, until this is dropped.
#[must_use = "the environment of the host comes back when this is dropped"]
pub struct DefaultEnvironment {
    host: machine::Environment,
}

impl DefaultEnvironment {
    /// Puts the environment of the host aside.
    pub fn enter() -> DefaultEnvironment {
        DefaultEnvironment {
            host: machine::enter(),
        }
    }
}

impl Drop for DefaultEnvironment {
    fn drop(&mut self) {
        machine::leave(&self.host);
    }
}

#[cfg(target_arch = "x86_64")]
mod machine {
    use std::arch::asm;

    /// All exceptions masked, nearest, subnormal numbers kept; no flags.
    const MXCSR: u32 = 0x1f80;
    /// All exceptions masked, nearest, 64 bits of significand.
    const CONTROL: u16 = 0x037f;
    /// Exception flags: invalid, denormal, division by zero, overflow, underflow, precision.
    const FLAGS: u16 = 0x3f;
    /// Flags, error summary, stack fault and busy bit of the x87 status word, which go with the exceptions.
    const STATUS: u16 = 0x80ff;

    pub struct Environment {
        mxcsr: u32,
        control: u16,
        status: u16,
    }

    #[inline(never)]
    pub fn enter() -> Environment {
        let host = Environment {
            mxcsr: mxcsr(),
            control: control(),
            status: status(),
        };
        if host.mxcsr & !u32::from(FLAGS) != MXCSR {
            set_mxcsr(MXCSR);
        }
        if host.control != CONTROL {
            set_control(CONTROL);
        }
        host
    }

    #[inline(never)]
    pub fn leave(host: &Environment) {
        if mxcsr() != host.mxcsr {
            set_mxcsr(host.mxcsr);
        }
        // before the control word: a flag raised here must not meet the traps of the host
        if (status() ^ host.status) & FLAGS != 0 {
            set_status(host.status);
        }
        if control() != host.control {
            set_control(host.control);
        }
    }

    fn mxcsr() -> u32 {
        let mut value = 0_u32;
        // SAFETY: stores the register into a variable of its size
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
        value
    }

    fn set_mxcsr(value: u32) {
        // SAFETY: `value` is the default or what the register held before, so that no reserved bit is set
        unsafe {
            asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags))
        };
    }

    fn control() -> u16 {
        let mut value = 0_u16;
        // SAFETY: stores the register into a variable of its size
        unsafe { asm!("fnstcw [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
        value
    }

    fn set_control(value: u16) {
        // SAFETY: any control word is valid; the x87 stack is not touched
        unsafe { asm!("fldcw [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) };
    }

    fn status() -> u16 {
        let mut value = 0_u16;
        // SAFETY: stores the register into a variable of its size
        unsafe { asm!("fnstsw [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
        value
    }

    /// Puts the exception bits of a status word into the register; the rest of the environment stays.
    fn set_status(value: u16) {
        let mut environment = [0_u32; 7];
        let place = environment.as_mut_ptr();
        // SAFETY: the environment of the x87 unit has 28 bytes; storing it masks all exceptions, loading it with the exception
        // bits of its status word changed leaves stack and tags as they are
        unsafe {
            asm!("fnstenv [{}]", in(reg) place, options(nostack, preserves_flags));
            let bits = u32::from(STATUS);
            let status = place.add(1);
            status.write((status.read() & !bits) | (u32::from(value) & bits));
            asm!("fldenv [{}]", in(reg) place, options(nostack, preserves_flags));
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod machine {
    use std::arch::asm;

    pub struct Environment {
        control: u64,
        status: u64,
    }

    #[inline(never)]
    pub fn enter() -> Environment {
        let host = Environment {
            control: control(),
            status: status(),
        };
        if host.control != 0 {
            set_control(0);
        }
        host
    }

    #[inline(never)]
    pub fn leave(host: &Environment) {
        if status() != host.status {
            set_status(host.status);
        }
        if host.control != 0 {
            set_control(host.control);
        }
    }

    fn control() -> u64 {
        let value;
        // SAFETY: reads a register that every process may read
        unsafe { asm!("mrs {}, fpcr", out(reg) value, options(nostack, preserves_flags)) };
        value
    }

    fn set_control(value: u64) {
        // SAFETY: zero, or what the register held before
        unsafe { asm!("msr fpcr, {}", in(reg) value, options(nostack, preserves_flags)) };
    }

    fn status() -> u64 {
        let value;
        // SAFETY: reads a register that every process may read
        unsafe { asm!("mrs {}, fpsr", out(reg) value, options(nostack, preserves_flags)) };
        value
    }

    fn set_status(value: u64) {
        // SAFETY: what the register held before
        unsafe { asm!("msr fpsr, {}", in(reg) value, options(nostack, preserves_flags)) };
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod machine {
    pub struct Environment;

    pub fn enter() -> Environment {
        Environment
    }

    pub fn leave(_host: &Environment) {}
}
