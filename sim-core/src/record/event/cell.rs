//! Fields of events as cells of a table.

use super::{ActionText, FloatList, Obstacle, Outcome};

/// Value of an event's field, as a cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// No value.
    Null,
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// A text; JSON text for the action of an intervention.
    Text(&'a str),
    /// Bytes.
    Bytes(&'a [u8]),
    /// A list of numbers.
    Numbers(FloatList<'a>),
    /// An obstacle.
    Obstacle(Obstacle),
}

/// Type of the cells of a field, which may also be [`Cell::Null`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellType {
    /// [`Cell::Number`].
    Number,
    /// [`Cell::Integer`].
    Integer,
    /// [`Cell::Text`].
    Text,
    /// [`Cell::Bytes`].
    Bytes,
    /// [`Cell::Numbers`].
    Numbers,
    /// [`Cell::Obstacle`].
    Obstacle,
}

/// A type of event fields whose values can be cells of a table.
pub trait Tabular {
    /// Type of the cells.
    const TYPE: CellType;

    /// The cell of this value.
    fn cell(&self) -> Cell<'_>;
}

/// Implements [`Tabular`] for types of fields. Each line gives a type, the type of its cells, and the content of the
/// cell that a value gives.
macro_rules! tabular {
    ($($type:ty: $cell:ident($value:ident => $content:expr),)*) => {$(
        impl Tabular for $type {
            const TYPE: CellType = CellType::$cell;

            fn cell(&self) -> Cell<'_> {
                let $value = *self;
                Cell::$cell($content)
            }
        }
    )*};
}
tabular! {
    f64: Number(value => value),
    u8: Integer(value => value.into()),
    i32: Integer(value => value.into()),
    u32: Integer(value => value.into()),
    i64: Integer(value => value),
    u64: Integer(value => value.cast_signed()),
    &str: Text(value => value),
    ActionText<'_>: Text(value => value.0),
    Outcome: Text(value => value.name()),
    &[u8]: Bytes(value => value),
    FloatList<'_>: Numbers(value => value),
    Obstacle: Obstacle(value => value),
}

impl<T: Tabular> Tabular for Option<T> {
    const TYPE: CellType = T::TYPE;

    fn cell(&self) -> Cell<'_> {
        self.as_ref().map_or(Cell::Null, T::cell)
    }
}
