//! Macro that generates from one list of functions the C table, the host's trait, the thunks between them, and the
//! description from which headers and shim are generated.

use std::any::Any;
use std::ffi::c_void;
use std::fmt::{self, Display, Formatter};

use crate::abi::Stop;
use crate::param::{Return, ShownResult};

/// Interface between the thunks and the implementor of a table's trait: one robot of a host.
///
/// The `robot` pointer that a program passes back in each call points to an implementor. It is shared, not exclusive:
/// a timer callback makes calls while the interrupted call is still in progress.
pub trait CallContext {
    /// The robot that a call is for; `None` answers the call with [`Status::STOP`](crate::Status::STOP).
    ///
    /// A host that shares one image between robots uses the current robot of its thread instead; programs then pass
    /// null.
    ///
    /// # Safety
    /// `context` is the pointer that the host has passed to the program's `run`, and the robot outlives the call.
    unsafe fn from_context<'a>(context: *mut c_void) -> Option<&'a Self>
    where
        Self: Sized,
    {
        // SAFETY: the host passed a pointer to `Self` (or null) to `run`, valid until `run` has returned.
        unsafe { context.cast::<Self>().as_ref() }
    }

    /// Returns true if [`log_call`](Self::log_call) must be called; queried once after each call.
    fn is_logging(&self) -> bool {
        false
    }

    /// Logs a call that has returned.
    fn log_call(&self, record: &CallRecord<'_>) {
        let _ = record;
    }

    /// Handles a call to function `index` of the list with number `table` if the host forbids this function. Returns
    /// true if the host forbids it: the call then fails as documented, without any effect.
    ///
    /// # Errors
    /// [`Stop`] when the program must end.
    #[inline]
    fn forbid(&self, table: u32, index: usize) -> Result<bool, Stop> {
        let _ = (table, index);
        Ok(false)
    }

    /// Reports a call to a function that the host does not implement and that fails as documented.
    fn unavailable(&self, name: &'static str) {
        let _ = name;
    }

    /// Reports a panic of the host itself inside a call; the program is then stopped. The panic hook has run.
    fn panicked(&self, name: &'static str, payload: Box<dyn Any + Send>) {
        let _ = (name, payload);
    }
}

/// Record of a call, displayed as `VWDriveStraight(1, 0.5, 0.2) = 0`; it is formatted only when displayed.
pub struct CallRecord<'a> {
    /// The function.
    pub name: &'static str,
    /// The arguments; outputs show the values that the call has set.
    pub arguments: &'a [&'a dyn Display],
    /// The result; `None` when the program was stopped.
    pub result: Option<&'a dyn Display>,
}

impl Display for CallRecord<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}(", self.name)?;
        for (index, argument) in self.arguments.iter().enumerate() {
            write!(f, "{}{argument}", if index == 0 { "" } else { ", " })?;
        }
        match self.result {
            Some(result) => write!(f, ") = {result}"),
            None => f.write_str(") stopped"),
        }
    }
}

impl fmt::Debug for CallRecord<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        Display::fmt(self, f)
    }
}

/// Description of a function of a list, for headers, shims and cost tables.
#[derive(Debug)]
pub struct Function {
    /// Its name in C and in the trait.
    pub name: &'static str,
    /// The family that it belongs to, such as `VW`.
    pub family: &'static str,
    /// Lines of its documentation, each with the leading blank of the doc comment.
    pub doc: &'static [&'static str],
    /// Its parameters in order.
    pub parameters: &'static [Parameter],
    /// Rust type of the result, as written in the list.
    pub returns: &'static str,
    /// The prototype in C if it does not follow from the parameters; then the function's shim is written by hand.
    pub prototype: Option<&'static str>,
}

/// One parameter of a [`Function`].
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Its Rust type, as written in the list.
    pub kind: &'static str,
}

/// One family of a list: functions of one device or service.
#[derive(Debug)]
pub struct Family {
    /// Its name, the prefix of most of its functions.
    pub name: &'static str,
    /// Description in one line.
    pub title: &'static str,
    /// Source of the descriptions of its functions.
    pub source: &'static str,
}

/// The first element, if any. With it, the macro turns an optional part of the list into an `Option`.
pub(crate) const fn first(elements: &'static [&'static str]) -> Option<&'static str> {
    if let [first, ..] = elements { Some(*first) } else { None }
}

/// Runs `method` of the host and catches its panic, which must not cross the ABI. Without type parameters, so that it
/// is compiled only once.
#[inline]
pub(crate) fn caught(method: &mut dyn FnMut()) -> std::thread::Result<()> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(method))
}

/// Logs a completed call.
#[cold]
pub(crate) fn log<H: CallContext + ?Sized, R: Copy + Return>(
    host: &H,
    name: &'static str,
    arguments: &[&dyn Display],
    outcome: Result<R, Stop>,
) {
    let shown = outcome.ok().map(ShownResult);
    host.log_call(&CallRecord { name, arguments, result: shown.as_ref().map(|shown| shown as &dyn Display) });
}

/// Generates from one list of functions the table, the trait, the thunks, the enum of calls and the description.
///
/// ```text
/// function_table! {
///     /// Doc of the table.
///     table Table, trait Trait, call Call, number 6, version 1;
///     family VW "driving in metres and radians", source "RoBIOS 6 library, VW interface" {
///         /// Doc of the function: goes to rustdoc and to the C header.
///         fn VWDriveStraight(h: VWHandle, delta_m: Metre, v_mps: MetrePerSecond) -> i32 = -1;
///         /// `c`: the prototype in C where it does not follow from the parameters.
///         fn LCDPrintf(text: Text) -> i32 = -1, c "int LCDPrintf(const char *format, ...)";
///     }
/// }
/// ```
///
/// `number` identifies the list in messages of programs in other processes.
/// The value after `=` is the documented failure, which the trait's default method and a forbidden function return.
macro_rules! function_table {
    (
        $(#[$table_attribute:meta])*
        table $Table:ident, trait $Trait:ident, call $Call:ident, number $number:literal, version $version:literal;
        $(
            family $family:ident $title:literal, source $source:literal {
                $(
                    $(#[doc = $doc:expr])*
                    fn $name:ident ( $($parameter:ident : $kind:ty),* $(,)? ) -> $result:ty = $failure:expr
                        $(, c $prototype:literal)? ;
                )*
            }
        )*
    ) => {
        $(#[$table_attribute])*
        ///
        /// Each entry is a C function `(robot, arguments..., result) -> Status`: `robot` is the argument of the
        /// program's `run`, `result` is written unless the status is `STOP` and may be null. Callable from any task of
        /// the robot, on the thread that runs it, also from within a callback. No pointer is kept after the return.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[repr(C)]
        pub struct $Table {
            /// Size of this struct in the host, in bytes.
            pub size: u32,
            /// Version of this table, for messages; `size` determines which functions it has.
            pub version: u32,
            $($(
                #[doc = concat!("Calls [`", stringify!($Trait), "::", stringify!($name), "`].")]
                pub $name: unsafe extern "C" fn(
                    robot: *mut ::std::ffi::c_void,
                    $($parameter: <$kind as $crate::param::Param>::Abi,)*
                    result: *mut $result,
                ) -> $crate::abi::Status,
            )*)*
        }

        impl $Table {
            /// Version of this table.
            pub const VERSION: u32 = $version;

            /// The table whose entries call the methods of `H`; `robot` must then point to an `H`, see
            /// [`CallContext::from_context`](crate::table::CallContext::from_context).
            pub const fn of<H: $Trait>() -> Self {
                Self {
                    size: size_of::<Self>() as u32,
                    version: Self::VERSION,
                    $($($name: thunk::$name::<H>,)*)*
                }
            }

            /// The table of a program in another process than its host: each entry sends the call through the
            /// connection `L` of the calling thread and waits for the reply.
            pub const fn remote<L: $crate::wire::HostConnection>() -> Self {
                Self {
                    size: size_of::<Self>() as u32,
                    version: Self::VERSION,
                    $($($name: client::$name::<L>,)*)*
                }
            }
        }

        /// The host's side of the table: one method per function, named as in C.
        ///
        /// The methods take `&self`: a callback makes calls while the interrupted call is in progress. They must not
        /// hold a lock across a wait or a callback. Methods that are not implemented return the documented failure,
        /// after [`CallContext::unavailable`](crate::table::CallContext::unavailable).
        ///
        /// # Errors
        /// Every method returns [`Stop`](crate::Stop) when the program must end, and only then.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[allow(clippy::missing_errors_doc, reason = "said once, at the trait")]
        #[allow(clippy::too_many_arguments, reason = "the functions of RoBIOS have as many")]
        pub trait $Trait: $crate::table::CallContext {
            $($(
                $(#[doc = $doc])*
                #[doc = concat!("\n[any task of the robot] Source: ", $source, ".")]
                fn $name(
                    &self,
                    $($parameter: <$kind as $crate::param::Param>::View<'_>,)*
                ) -> Result<$result, $crate::abi::Stop> {
                    $(let _ = $parameter;)*
                    self.unavailable(stringify!($name));
                    Ok($failure)
                }
            )*)*
        }

        /// A function of the table, by number: dense from 0 in the order of the list.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[allow(non_camel_case_types, reason = "the names of RoBIOS")]
        #[repr(u16)]
        pub enum $Call {
            $($(
                #[doc = concat!("[`", stringify!($Trait), "::", stringify!($name), "`]")]
                $name,
            )*)*
        }

        impl $Call {
            /// Number of the list in messages of programs in other processes.
            pub const TABLE: u32 = $number;

            /// Carries out the call for a program in another process: reads the arguments from `request` and writes
            /// outputs and result to `reply`, unless the status is `STOP`.
            ///
            /// # Errors
            /// [`Malformed`](crate::wire::Malformed) if the arguments do not fit the function's parameters; no call is
            /// made then.
            pub fn serve(
                self,
                host: &dyn $Trait,
                request: &mut $crate::wire::Request<'_>,
                reply: &mut Vec<u8>,
            ) -> Result<$crate::abi::Status, $crate::wire::Malformed> {
                match self {
                    $($(Self::$name => server::$name(host, request, reply),)*)*
                }
            }

            /// All functions, each at its [`index`](Self::index).
            pub const ALL: &'static [Self] = &[$($(Self::$name,)*)*];

            /// The families in the order of the list.
            pub const FAMILIES: &'static [$crate::table::Family] = &[$(
                $crate::table::Family { name: stringify!($family), title: $title, source: $source },
            )*];

            /// Its number.
            #[inline]
            pub const fn index(self) -> usize {
                self as usize
            }

            /// Its name in C.
            pub const fn name(self) -> &'static str {
                self.function().name
            }

            /// The name of its family.
            pub const fn family(self) -> &'static str {
                self.function().family
            }

            /// The function of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|call| call.name() == name)
            }

            /// Its description.
            pub const fn function(self) -> &'static $crate::table::Function {
                const FUNCTIONS: &[$crate::table::Function] = &[$($(
                    $crate::table::Function {
                        name: stringify!($name),
                        family: stringify!($family),
                        doc: &[$($doc),*],
                        parameters: &[$(
                            $crate::table::Parameter { name: stringify!($parameter), kind: stringify!($kind) }
                        ),*],
                        returns: stringify!($result),
                        prototype: $crate::table::first(&[$($prototype)?]),
                    },
                )*)*];
                &FUNCTIONS[self as usize]
            }
        }

        /// The host's methods with panic guard and log, for arguments from any source.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[allow(clippy::too_many_arguments, reason = "the functions of RoBIOS have as many")]
        mod method {
            use super::*;
            use $crate::param::{Param, ShownArgument};
            $($(
                pub fn $name<H: $Trait + ?Sized>(
                    host: &H,
                    $($parameter: &mut <$kind as Param>::Storage,)*
                ) -> Result<$result, $crate::abi::Stop> {
                    let mut outcome = Err($crate::abi::Stop);
                    let caught = $crate::table::caught(&mut || {
                        outcome = match host.forbid($Call::TABLE, $Call::$name.index()) {
                            Ok(false) => host.$name($(<$kind as Param>::view($parameter)),*),
                            Ok(true) => Ok($failure),
                            Err(stop) => Err(stop),
                        };
                    });
                    if let Err(payload) = caught {
                        host.panicked(stringify!($name), payload);
                    }
                    if host.is_logging() {
                        $crate::table::log(host, stringify!($name), &[$(&ShownArgument::<$kind>($parameter)),*], outcome);
                    }
                    outcome
                }
            )*)*
        }

        /// The C functions between the table and the trait.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[allow(clippy::too_many_arguments, reason = "the functions of RoBIOS have as many")]
        mod thunk {
            use super::*;
            use $crate::param::Param;
            $($(
                /// # Safety
                /// `robot` is the pointer that the host has passed to the program's `run`; every other pointer is null
                /// or valid as its kind requires.
                pub unsafe extern "C" fn $name<H: $Trait>(
                    robot: *mut ::std::ffi::c_void,
                    $($parameter: <$kind as Param>::Abi,)*
                    result: *mut $result,
                ) -> $crate::abi::Status {
                    // SAFETY: the caller vouches for `robot`.
                    let Some(host) = (unsafe { H::from_context(robot) }) else { return $crate::abi::Status::STOP };
                    // SAFETY: the caller vouches for the pointers; the host's method does not run yet.
                    $(let mut $parameter = ($parameter, unsafe { <$kind as Param>::take($parameter) });)*
                    let Ok(value) = method::$name(host, $(&mut $parameter.1),*) else {
                        return $crate::abi::Status::STOP;
                    };
                    // SAFETY: the caller vouches for the pointers; the host's method has returned.
                    $(unsafe { <$kind as Param>::give($parameter.0, $parameter.1) };)*
                    if !result.is_null() {
                        // SAFETY: not null, and the caller vouches for it.
                        unsafe { result.write(value) };
                    }
                    $crate::abi::Status::OK
                }
            )*)*
        }

        /// The C functions between the table and a connection to a host in another process.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[allow(clippy::too_many_arguments, reason = "the functions of RoBIOS have as many")]
        mod client {
            use super::*;
            use $crate::param::Param;
            use $crate::wire::HostConnection;
            $($(
                /// # Safety
                /// `context` is the pointer passed to the program's `run`; every other pointer is null or valid as its
                /// kind requires.
                pub unsafe extern "C" fn $name<L: HostConnection>(
                    context: *mut ::std::ffi::c_void,
                    $($parameter: <$kind as Param>::Abi,)*
                    result: *mut $result,
                ) -> $crate::abi::Status {
                    // SAFETY: the caller vouches for `context`.
                    let Some(connection) = (unsafe { L::from_context(context) }) else { return $crate::abi::Status::STOP };
                    // SAFETY: the caller vouches for the pointers.
                    unsafe { remote::$name(connection, $($parameter,)* result) }
                }
            )*)*
        }

        /// The calls through a connection to a host in another process; without type parameters, so that they are
        /// compiled only once, in this crate.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        #[allow(clippy::too_many_arguments, reason = "the functions of RoBIOS have as many")]
        mod remote {
            use super::*;
            use $crate::param::{Param, Return};
            use $crate::wire::{HostConnection, Reader};
            $($(
                /// # Safety
                /// Every pointer is null or valid as its kind requires.
                pub unsafe fn $name(
                    connection: &dyn HostConnection,
                    $($parameter: <$kind as Param>::Abi,)*
                    result: *mut $result,
                ) -> $crate::abi::Status {
                    // SAFETY: the caller vouches for the pointers.
                    $(let mut $parameter = ($parameter, unsafe { <$kind as Param>::take($parameter) });)*
                    let reply = connection.exchange($Call::TABLE, $Call::$name as u32, &|_request| {
                        $(<$kind as Param>::write_request(&$parameter.1, _request);)*
                    });
                    let Ok(reply) = reply else { return $crate::abi::Status::STOP };
                    let mut reply = Reader::new(&reply);
                    $(
                        if <$kind as Param>::read_reply(&mut $parameter.1, &mut reply).is_err() {
                            return $crate::abi::Status::STOP;
                        }
                    )*
                    let Ok(value) = <$result as Return>::read_reply(&mut reply) else { return $crate::abi::Status::STOP };
                    // SAFETY: the caller vouches for the pointers.
                    $(unsafe { <$kind as Param>::give($parameter.0, $parameter.1) };)*
                    if !result.is_null() {
                        // SAFETY: not null, and the caller vouches for it.
                        unsafe { result.write(value) };
                    }
                    $crate::abi::Status::OK
                }
            )*)*
        }

        /// The functions between a request of another process and the trait; like those of `remote` compiled only once.
        #[allow(non_snake_case, reason = "the names of RoBIOS")]
        mod server {
            use super::*;
            use $crate::param::{Param, Return};
            use $crate::wire::{Malformed, Request};
            $($(
                pub fn $name(
                    host: &dyn $Trait,
                    _request: &mut Request<'_>,
                    reply: &mut Vec<u8>,
                ) -> Result<$crate::abi::Status, Malformed> {
                    $(let mut $parameter = <$kind as Param>::read_request(_request)?;)*
                    let Ok(value) = method::$name(host, $(&mut $parameter),*) else {
                        return Ok($crate::abi::Status::STOP);
                    };
                    $(<$kind as Param>::write_reply(&$parameter, reply);)*
                    Return::write_reply(&value, reply);
                    Ok($crate::abi::Status::OK)
                }
            )*)*
        }
    };
}
pub(crate) use function_table;
