//! Identifiers of the functions that programs call.

use robios_sys::{Robios6Call, Robios7Call, SupportCall};

/// A function of the host that a program can call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Call {
    /// A function of RoBIOS 6.
    Robios6(Robios6Call),
    /// A function of RoBIOS-7.
    Robios7(Robios7Call),
    /// A service for the program's language runtime.
    Support(SupportCall),
}

impl Call {
    /// Name of the function in programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robios6(call) => call.name(),
            Self::Robios7(call) => call.name(),
            Self::Support(call) => call.name(),
        }
    }

    /// Description of the function that the program calls, for messages. Programs call services through the C library.
    pub fn description(self) -> String {
        match self {
            Self::Support(_) => "a function of the C library".to_owned(),
            call => format!("`{}`", call.name()),
        }
    }

    /// Number of the function among those of both RoBIOS generations; `None` for a service.
    #[inline]
    pub fn robios_number(self) -> Option<u16> {
        match self {
            Self::Robios6(call) => Some(call as u16),
            Self::Robios7(call) => Some(Robios6Call::ALL.len() as u16 + call as u16),
            Self::Support(_) => None,
        }
    }

    /// The RoBIOS function `index` of the list with number `table`; `None` for a service.
    pub fn of_table(table: u32, index: usize) -> Option<Self> {
        match table {
            Robios6Call::TABLE => Robios6Call::ALL.get(index).map(|call| (*call).into()),
            Robios7Call::TABLE => Robios7Call::ALL.get(index).map(|call| (*call).into()),
            _ => None,
        }
    }

    /// The RoBIOS function with this number; `None` if there is none.
    pub fn of_robios_number(number: u16) -> Option<Self> {
        let (number, robios6_count) = (usize::from(number), Robios6Call::ALL.len());
        match number.checked_sub(robios6_count) {
            None => Some(Robios6Call::ALL[number].into()),
            Some(number) => Robios7Call::ALL.get(number).map(|call| (*call).into()),
        }
    }
}

impl From<Robios6Call> for Call {
    fn from(call: Robios6Call) -> Self {
        Self::Robios6(call)
    }
}

impl From<Robios7Call> for Call {
    fn from(call: Robios7Call) -> Self {
        Self::Robios7(call)
    }
}

impl From<SupportCall> for Call {
    fn from(call: SupportCall) -> Self {
        Self::Support(call)
    }
}
