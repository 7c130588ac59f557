//! Macro that generates Rust constants and the `#define`s of a C header from one list.

/// One `#define` of a C header.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Its name.
    pub name: &'static str,
    /// Its value.
    pub value: i64,
    /// Lines of its documentation, each with the leading blank of the doc comment.
    pub doc: &'static [&'static str],
}

/// Generates constants, and their description for a C header, from one list.
macro_rules! constants {
    ($(#[$attribute:meta])* list $list:ident; $($(#[doc = $doc:expr])* $name:ident: $kind:ty = $value:expr;)*) => {
        $($(#[doc = $doc])* pub const $name: $kind = $value;)*

        $(#[$attribute])*
        pub const $list: &[$crate::constant::Constant] = &[$(
            $crate::constant::Constant { name: stringify!($name), value: $name as i64, doc: &[$($doc),*] },
        )*];
    };
}
pub(crate) use constants;
