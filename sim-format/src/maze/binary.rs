//! Binary mazes of micro-mouse contests: a byte for each cell.
//!
//! Source: the collections of micromouseonline.com and of D. Otten's and D. Woodfield's maze editors: cells by columns
//! from the south-west corner, upwards; bit 0 north, bit 1 east, bit 2 south, bit 3 west.

use super::cells::{CellWalls, StartAndGoals, add_start};
use super::{ContestMaze, Drawing};
use crate::Span;
use crate::code::Code;
use crate::diagnostic::Sink;

const FORM: &str = "a byte for each cell: 256 for 16 x 16 cells, 1024 for 32 x 32";

/// Returns true for bytes that are not text: fewer than half are printable, and some are control characters other than
/// tabs and line ends.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let is_utf16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let printable = bytes.iter().filter(|byte| matches!(byte, b' '..=b'~')).count();
    let controls = bytes.iter().filter(|byte| matches!(byte, 0..=8 | 11 | 12 | 14..=31)).count();
    !is_utf16 && controls > 0 && 2 * printable < bytes.len()
}

/// Order of the cells in a file: the index of the byte of cell (x, y) in a maze of `side` times `side` cells.
type Order = fn(x: usize, y: usize, side: usize) -> usize;

/// Orders that are tried, the usual one first.
const ORDERS: [(&str, Order); 8] = [
    ("by columns from the south-west corner, upwards", |x, y, side| x * side + y),
    ("by rows from the south-west corner, eastwards", |x, y, side| y * side + x),
    ("by rows from the north-west corner, eastwards", |x, y, side| (side - 1 - y) * side + x),
    ("by columns from the north-west corner, downwards", |x, y, side| x * side + side - 1 - y),
    ("by rows from the south-east corner, westwards", |x, y, side| y * side + side - 1 - x),
    ("by columns from the south-east corner, upwards", |x, y, side| (side - 1 - x) * side + y),
    ("by rows from the north-east corner, westwards", |x, y, side| (side - 1 - y) * side + side - 1 - x),
    ("by columns from the north-east corner, downwards", |x, y, side| (side - 1 - x) * side + side - 1 - y),
];

/// Numbers of the bits for north, east, south and west, the usual ones first.
fn bit_orders() -> impl Iterator<Item = [u32; 4]> {
    (0..4).flat_map(|north| {
        (0..4).flat_map(move |east| {
            (0..4).filter_map(move |south| {
                let west = 6_u32.checked_sub(north + east + south)?;
                let bits = [north, east, south, west];
                (0..4).all(|bit| bits.contains(&bit)).then_some(bits)
            })
        })
    })
}

pub(super) fn read(sink: &mut Sink, bytes: &[u8]) -> ContestMaze {
    let side = match bytes.len() {
        256 => 16,
        1024 => 32,
        length => {
            let message = format!("a binary maze of {length} bytes");
            sink.error(Code::MazBytes, Span::default(), message, FORM);
            return ContestMaze { drawing: Drawing::empty(0), rows: 1, note: None };
        }
    };
    if let Some(index) = bytes.iter().position(|byte| *byte > 15) {
        let count = bytes.iter().filter(|byte| **byte > 15).count();
        let which = if count == 1 { "a byte has".to_owned() } else { format!("{count} bytes have") };
        let message = format!(
            "{which} bits above the four walls, the first byte {index} ({:#04x}); they are ignored",
            bytes[index]
        );
        sink.warn(Code::MazBytes, Span::default(), message, "bytes of 0 to 15");
    }
    let cells_in = |order: Order, bits: [u32; 4]| {
        let walls = (0..side).flat_map(|x| (0..side).map(move |y| (x, y))).map(|(x, y)| {
            let byte = bytes[order(x, y, side)];
            (0..4).fold(0, |walls, number| walls | (byte >> bits[number] & 1) << number)
        });
        CellWalls { size: [side, side], walls: walls.collect() }
    };
    let usual = cells_in(ORDERS[0].1, [0, 1, 2, 3]);
    let mut order = ORDERS[0].1;
    let mut cells = usual.clone();
    if usual.one_sided_walls().next().is_some() {
        // Start in the south-west corner, open to the north only.
        let is_maze = |cells: &CellWalls| {
            cells.walls[0] == 0b1110 && cells.is_closed() && cells.one_sided_walls().next().is_none()
        };
        let layouts = ORDERS.into_iter().flat_map(|(name, order)| bit_orders().map(move |bits| (name, order, bits)));
        let mut candidates = layouts.map(|(name, order, bits)| (name, order, bits, cells_in(order, bits)));
        if let Some((name, found_order, bits, found)) = candidates.find(|(.., cells)| is_maze(cells)) {
            let [north, east, south, west] = bits;
            let message = format!(
                "the walls fit together only if the cells are {name}, with the bits {north} north, {east} east, {south} south, \
                 {west} west; the maze is read so"
            );
            let expected =
                "cells by columns from the south-west corner, upwards; bits 0 north, 1 east, 2 south, 3 west";
            sink.warn(Code::MazBytes, Span::default(), message, expected);
            (order, cells) = (found_order, found);
        }
    }
    cells.check_shared(sink, |[x, y]| {
        let index = order(x, y, side);
        (Span::default(), format!(", byte {index} ({:#04x}),", bytes[index]))
    });
    let mut drawing = cells.drawing(|_| Span::default());
    let note = add_start(&mut drawing, side, &StartAndGoals::usual([side, side]), Span::default());
    ContestMaze { drawing, rows: side, note: Some(note) }
}
