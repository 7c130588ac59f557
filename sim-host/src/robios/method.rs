//! Macros for the call list of a generation: one line per function.
//!
//! `Call` is the call list of the generation that uses the macros.

/// Methods that act at the call's end: `fn Name(arguments) -> Result = |robot, world| effect;`.
macro_rules! act {
    ($(fn $name:ident($($argument:ident: $kind:ty),* $(,)?) -> $result:ty = $act:expr;)*) => {$(
        fn $name(&self, $($argument: $kind),*) -> Result<$result, Stop> {
            self.call(Call::$name, $act)
        }
    )*};
}

/// Methods that wait, in the same form.
macro_rules! wait {
    ($(fn $name:ident($($argument:ident: $kind:ty),* $(,)?) -> $result:ty = $poll:expr;)*) => {$(
        fn $name(&self, $($argument: $kind),*) -> Result<$result, Stop> {
            self.wait(Call::$name, $poll)
        }
    )*};
}
