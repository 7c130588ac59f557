//! The fake robot's display.

use robios_sys::robios6::{LCD_COLUMNS, LCD_HEIGHT, LCD_ROWS, LCD_WIDTH};

/// The display's text and pixels, in separate buffers: pixels contain only drawings.
#[derive(Debug)]
pub struct LcdBuffer {
    text: Vec<Vec<u8>>,
    pixels: Vec<bool>,
    row: usize,
    column: usize,
    pub is_scrolling: bool,
}

impl LcdBuffer {
    /// Display of RoBIOS 6.
    pub fn new() -> Self {
        Self::with_size(LCD_ROWS, LCD_COLUMNS)
    }

    /// Display of RoBIOS-7, with characters of one width for every font.
    pub fn large() -> Self {
        Self::with_size(20, 40)
    }

    fn with_size(rows: usize, columns: usize) -> Self {
        Self {
            text: vec![vec![b' '; columns]; rows],
            pixels: vec![false; LCD_WIDTH * LCD_HEIGHT],
            row: 0,
            column: 0,
            is_scrolling: false,
        }
    }

    pub fn clear(&mut self) {
        let is_scrolling = self.is_scrolling;
        *self = Self { is_scrolling, ..Self::with_size(self.rows(), self.columns()) };
    }

    fn rows(&self) -> usize {
        self.text.len()
    }

    fn columns(&self) -> usize {
        self.text[0].len()
    }

    /// The lines without trailing blanks.
    pub fn lines(&self) -> Vec<String> {
        self.text.iter().map(|line| String::from_utf8_lossy(line).trim_end().to_owned()).collect()
    }

    /// Moves the cursor; returns true if the position is on the display.
    pub fn move_cursor(&mut self, row: i32, column: i32) -> bool {
        let (Ok(row), Ok(column)) = (usize::try_from(row), usize::try_from(column)) else { return false };
        let is_inside = row < self.rows() && column < self.columns();
        if is_inside {
            (self.row, self.column) = (row, column);
        }
        is_inside
    }

    pub fn cursor(&self) -> (i32, i32) {
        (self.row as i32, self.column as i32)
    }

    pub fn write(&mut self, text: &[u8]) {
        for byte in text {
            if *byte == b'\n' {
                self.break_line();
                continue;
            }
            if self.column == self.columns() {
                self.break_line();
            }
            self.text[self.row][self.column] = *byte;
            self.column += 1;
        }
    }

    fn break_line(&mut self) {
        self.column = 0;
        self.row += 1;
        if self.row == self.rows() {
            if self.is_scrolling {
                self.text.rotate_left(1);
                self.row -= 1;
                self.text[self.row].fill(b' ');
            } else {
                self.row = 0;
            }
        }
    }

    /// Writes the menu text above one of the four keys.
    pub fn menu(&mut self, key: usize, text: &[u8]) {
        let (width, last_row) = (self.columns() / 4, self.rows() - 1);
        if !text.is_empty() {
            let label = &mut self.text[last_row][key * width..][..width];
            label.fill(b' ');
            let len = text.len().min(width);
            label[..len].copy_from_slice(&text[..len]);
        }
    }

    pub fn pixel(&self, x: i32, y: i32) -> Option<bool> {
        index(x, y).map(|index| self.pixels[index])
    }

    /// Draws a pixel: `ink` 0 clears, 1 sets, 2 inverts. Returns true if the pixel is on the display.
    pub fn draw(&mut self, x: i32, y: i32, ink: i32) -> bool {
        let Some(index) = index(x, y) else { return false };
        let pixel = &mut self.pixels[index];
        *pixel = match ink {
            0 => false,
            1 => true,
            _ => !*pixel,
        };
        true
    }

    /// Draws a line with Bresenham's algorithm.
    pub fn line(&mut self, from: (i32, i32), to: (i32, i32), ink: i32) {
        let (mut x, mut y) = (i64::from(from.0), i64::from(from.1));
        let (to_x, to_y) = (i64::from(to.0), i64::from(to.1));
        let (dx, dy) = ((to_x - x).abs(), -(to_y - y).abs());
        let mut error = dx + dy;
        loop {
            self.draw(x as i32, y as i32, ink);
            if (x, y) == (to_x, to_y) {
                return;
            }
            let double_error = 2 * error;
            if double_error >= dy {
                error += dy;
                x += (to_x - x).signum();
            }
            if double_error <= dx {
                error += dx;
                y += (to_y - y).signum();
            }
        }
    }
}

fn index(x: i32, y: i32) -> Option<usize> {
    let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
    (x < LCD_WIDTH && y < LCD_HEIGHT).then_some(y * LCD_WIDTH + x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_wraps_and_scrolls() {
        let mut lcd = LcdBuffer::new();
        lcd.write(b"0123456789abcdefX\nsecond");
        assert_eq!(lcd.lines()[..3], ["0123456789abcdef", "X", "second"]);
        lcd.write(b"\n\n\n\n\nfirst");
        assert_eq!(lcd.lines()[0], "first56789abcdef");
        lcd.clear();
        lcd.is_scrolling = true;
        lcd.write(b"a\nb\nc\nd\ne\nf\ng\nh");
        assert_eq!(lcd.lines(), ["b", "c", "d", "e", "f", "g", "h"]);
    }

    #[test]
    fn line_includes_both_ends_and_is_clipped() {
        let mut lcd = LcdBuffer::new();
        lcd.line((-2, -2), (2, 2), 1);
        assert_eq!((lcd.pixel(0, 0), lcd.pixel(2, 2), lcd.pixel(3, 3)), (Some(true), Some(true), Some(false)));
        assert_eq!(lcd.pixel(128, 0), None);
    }
}
