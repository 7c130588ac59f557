//! Macros that implement the calls of a generation, one line per function.
//!
//! A file that uses the macros must import the generation's enum of calls as `Call`.

/// Methods that act at the call's end: `fn Name(arguments) -> Result = |robot, world| effect;`.
macro_rules! act {
    ($(fn $name:ident($($argument:ident: $kind:ty),* $(,)?) -> $result:ty = $act:expr;)*) => {$(
        fn $name(&self, $($argument: $kind),*) -> Result<$result, Stop> {
            self.call(Call::$name, $act)
        }
    )*};
}

/// Methods that wait, with the same syntax: `poll` returns a `Poll`.
macro_rules! wait {
    ($(fn $name:ident($($argument:ident: $kind:ty),* $(,)?) -> $result:ty = $poll:expr;)*) => {$(
        fn $name(&self, $($argument: $kind),*) -> Result<$result, Stop> {
            self.wait(Call::$name, $poll)
        }
    )*};
}
