//! The display: 128 x 64 pixels, black or white, with 7 lines of 16 characters; the last line is the menu line.
//!
//! A character is 8 x 8 pixels on a grid of 8 x 9, so that the six lines above the menu have the 54 pixel rows that
//! `LCDPutGraphic` fills. Characters are from the IBM code page 437. Source: RoBIOS 6 library, LCD output; grid and
//! font are our choice.

use ibm437::IBM437_8X8_REGULAR_DATA as FONT;

use super::screen::canvas::line;

/// Pixels in a row.
pub const WIDTH: usize = 128;
/// Rows of pixels.
pub const HEIGHT: usize = 64;
/// Lines of text.
pub const LINES: usize = 7;
/// Characters in a line.
pub const COLUMNS: usize = 16;
/// Columns of one of the four texts of the menu line.
pub const MENU_COLUMNS: usize = COLUMNS / 4;
/// Bytes of a whole picture, one bit per pixel.
pub const PICTURE_BYTES: usize = WIDTH * HEIGHT / 8;

const MENU_LINE: usize = LINES - 1;
const CELL_WIDTH: usize = WIDTH / COLUMNS;
const CELL_HEIGHT: usize = HEIGHT / LINES;
const GLYPH_HEIGHT: usize = 8;
const TAB: usize = 4;

/// The display's state.
#[derive(Clone)]
pub struct Lcd {
    /// Rows of pixels; the highest bit is the leftmost pixel, 1 is black.
    pixels: [u128; HEIGHT],
    text: [[u8; COLUMNS]; LINES],
    line: usize,
    /// [`COLUMNS`] after the last character of a line: the next character begins a new line.
    column: usize,
    /// Text that runs past the last line scrolls; otherwise it continues at the top.
    pub is_scrolling: bool,
    /// The program has switched the cursor on; the cursor is not drawn.
    pub has_cursor: bool,
}

/// Error for a position outside the display, or an invalid ink.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidPosition;

/// Effect of drawing on a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// White.
    Clear,
    /// Black.
    Set,
    /// The opposite colour.
    Invert,
}

impl TryFrom<i32> for Ink {
    type Error = InvalidPosition;

    /// 0 clear, 1 set, 2 invert.
    fn try_from(code: i32) -> Result<Self, InvalidPosition> {
        match code {
            0 => Ok(Self::Clear),
            1 => Ok(Self::Set),
            2 => Ok(Self::Invert),
            _ => Err(InvalidPosition),
        }
    }
}

impl Default for Lcd {
    fn default() -> Self {
        Self {
            pixels: [0; HEIGHT],
            text: [[b' '; COLUMNS]; LINES],
            line: 0,
            column: 0,
            is_scrolling: true,
            has_cursor: false,
        }
    }
}

/// Text.
impl Lcd {
    /// Clears pixels and text, including the menu line; the next text is written at the top left.
    pub fn clear(&mut self) {
        *self = Self { is_scrolling: self.is_scrolling, has_cursor: self.has_cursor, ..Self::default() };
    }

    /// Line and column of the next character.
    pub fn position(&self) -> (usize, usize) {
        (self.line, self.column.min(COLUMNS - 1))
    }

    /// Sets line and column of the next character.
    ///
    /// # Errors
    /// [`InvalidPosition`] outside of lines 0 to 6 and columns 0 to 15.
    pub fn set_position(&mut self, line: i32, column: i32) -> Result<(), InvalidPosition> {
        (self.line, self.column) = (index(line, LINES)?, index(column, COLUMNS)?);
        Ok(())
    }

    /// Writes text at the current position.
    ///
    /// `\n` begins a new line, `\r` goes back to the line's beginning, `\t` to the next multiple of 4 columns, `\b` one
    /// column back, `\f` clears; other control characters are ignored. Text wraps at the end of a line; past the line
    /// above the menu the display scrolls, or text continues at the top. The menu line is therefore reached only by
    /// [`set_position`](Self::set_position) and [`set_menu`](Self::set_menu).
    pub fn write(&mut self, text: &[u8]) {
        for &character in text {
            match character {
                b'\n' => self.begin_line(),
                b'\r' => self.column = 0,
                b'\t' => self.column = ((self.column / TAB + 1) * TAB).min(COLUMNS),
                0x08 => self.column = self.column.saturating_sub(1),
                0x0c => self.clear(),
                0..0x20 | 0x7f => {}
                _ => self.write_character(character),
            }
        }
    }

    /// Sets text `position` (1 to 4) of the menu line: at most 4 characters, padded with blanks. An empty text changes
    /// nothing.
    ///
    /// # Errors
    /// [`InvalidPosition`] for another position.
    pub fn set_menu(&mut self, position: i32, text: &[u8]) -> Result<(), InvalidPosition> {
        let first = index(position.checked_sub(1).ok_or(InvalidPosition)?, 4)? * MENU_COLUMNS;
        if !text.is_empty() {
            for column in 0..MENU_COLUMNS {
                self.draw_character(MENU_LINE, first + column, *text.get(column).unwrap_or(&b' '));
            }
        }
        Ok(())
    }

    /// Text of the lines without trailing blanks; `?` for characters outside ASCII.
    pub fn lines(&self) -> [String; LINES] {
        self.text.map(|line| {
            let line: String =
                line.iter().map(|&byte| if matches!(byte, 0x20..0x7f) { char::from(byte) } else { '?' }).collect();
            line.trim_end().to_owned()
        })
    }

    fn write_character(&mut self, character: u8) {
        if self.column == COLUMNS {
            self.begin_line();
        }
        self.draw_character(self.line, self.column, character);
        self.column += 1;
    }

    fn begin_line(&mut self) {
        self.column = 0;
        self.line += 1;
        if self.line >= MENU_LINE {
            if self.is_scrolling {
                self.line = MENU_LINE - 1;
                self.scroll();
            } else {
                self.line = 0;
            }
        }
    }

    /// Moves everything above the menu line up by one line.
    fn scroll(&mut self) {
        self.text.copy_within(1..MENU_LINE, 0);
        self.text[MENU_LINE - 1] = [b' '; COLUMNS];
        self.pixels.copy_within(CELL_HEIGHT..MENU_LINE * CELL_HEIGHT, 0);
        self.pixels[(MENU_LINE - 1) * CELL_HEIGHT..MENU_LINE * CELL_HEIGHT].fill(0);
    }

    fn draw_character(&mut self, line: usize, column: usize, character: u8) {
        self.text[line][column] = character;
        let shift = WIDTH - CELL_WIDTH * (column + 1);
        let (sheet_row, sheet_column) = (usize::from(character) / 16, usize::from(character) % 16);
        for row in 0..CELL_HEIGHT {
            let bits = if row < GLYPH_HEIGHT { FONT[(sheet_row * GLYPH_HEIGHT + row) * 16 + sheet_column] } else { 0 };
            let pixels = &mut self.pixels[line * CELL_HEIGHT + row];
            *pixels = *pixels & !(0xff << shift) | u128::from(bits) << shift;
        }
    }
}

/// Graphics. Drawing functions return the number of changed pixels.
impl Lcd {
    /// Returns true if the pixel is black.
    ///
    /// # Errors
    /// [`InvalidPosition`] outside of rows 0 to 63 and columns 0 to 127.
    pub fn pixel(&self, row: i32, column: i32) -> Result<bool, InvalidPosition> {
        let (row, column) = (index(row, HEIGHT)?, index(column, WIDTH)?);
        Ok(self.pixels[row] & mask(column, column) != 0)
    }

    /// Draws one pixel.
    ///
    /// # Errors
    /// [`InvalidPosition`] outside of rows 0 to 63 and columns 0 to 127.
    pub fn draw_pixel(&mut self, row: i32, column: i32, ink: Ink) -> Result<u32, InvalidPosition> {
        let (row, column) = (index(row, HEIGHT)?, index(column, WIDTH)?);
        Ok(self.draw(row, mask(column, column), ink))
    }

    /// Draws the line between two pixels (x, y), both included, each pixel once; parts outside the display are clipped.
    /// Both directions draw the same pixels.
    pub fn draw_line(&mut self, from: [i32; 2], to: [i32; 2], ink: Ink) -> u32 {
        let points = line(from, to, [WIDTH, HEIGHT]);
        points.map(|[x, y]| self.draw(y as usize, mask(x as usize, x as usize), ink)).sum()
    }

    /// Fills the rectangle from (`x1`, `y1`) to (`x2`, `y2`), edges included; parts outside the display are clipped.
    /// White or black removes the characters that it covers entirely.
    ///
    /// # Errors
    /// [`InvalidPosition`] if the first corner is to the right of the second one or below it.
    pub fn draw_area(&mut self, [x1, y1]: [i32; 2], [x2, y2]: [i32; 2], ink: Ink) -> Result<u32, InvalidPosition> {
        if x1 > x2 || y1 > y2 {
            return Err(InvalidPosition);
        }
        let (left, right) = (x1.max(0), x2.min(WIDTH as i32 - 1));
        let (top, bottom) = (y1.max(0), y2.min(HEIGHT as i32 - 1));
        if left > right {
            return Ok(0);
        }
        if ink != Ink::Invert {
            let cells =
                |first: i32, last: i32, size: usize| (first as usize).div_ceil(size)..(last + 1) as usize / size;
            for line in cells(top, bottom.max(-1), CELL_HEIGHT) {
                cells(left, right, CELL_WIDTH).for_each(|column| self.text[line][column] = b' ');
            }
        }
        let mask = mask(left as usize, right as usize);
        Ok((top..=bottom).map(|row| self.draw(row as usize, mask, ink)).sum())
    }

    /// Shows a grey image of `width` pixels per row at the top left, dithered: 0 is black, 255 white.
    ///
    /// The text under the image is removed. Parts outside the display are clipped.
    pub fn show_grey(&mut self, grey: impl Iterator<Item = u8>, width: usize) -> u32 {
        let mut changed = 0;
        let mut last_row = None;
        for (index, level) in grey.enumerate() {
            let (row, column) = (index / width, index % width);
            if row < HEIGHT && column < WIDTH {
                let ink = if is_black(level, row, column) { Ink::Set } else { Ink::Clear };
                changed += self.draw(row, mask(column, column), ink);
                last_row = Some(row);
            }
        }
        let text_lines = last_row.map_or(0, |row| row.div_ceil(CELL_HEIGHT).min(LINES));
        for line in &mut self.text[..text_lines] {
            line[..width.div_ceil(CELL_WIDTH).min(COLUMNS)].fill(b' ');
        }
        changed
    }

    /// Shows a whole picture, 16 bytes per row from the top; the highest bit is the leftmost pixel, 1 is black. All
    /// text is removed.
    pub fn show_picture(&mut self, picture: &[u8; PICTURE_BYTES]) -> u32 {
        let mut changed = 0;
        let (rows, _) = picture.as_chunks::<{ WIDTH / 8 }>();
        for (row, bytes) in self.pixels.iter_mut().zip(rows) {
            let new = u128::from_be_bytes(*bytes);
            changed += (*row ^ new).count_ones();
            *row = new;
        }
        self.text = [[b' '; COLUMNS]; LINES];
        changed
    }

    /// The whole picture, in the format of [`show_picture`](Self::show_picture).
    pub fn picture(&self) -> [u8; PICTURE_BYTES] {
        let mut picture = [0; PICTURE_BYTES];
        let (rows, _) = picture.as_chunks_mut::<{ WIDTH / 8 }>();
        for (bytes, row) in rows.iter_mut().zip(&self.pixels) {
            *bytes = row.to_be_bytes();
        }
        picture
    }

    fn draw(&mut self, row: usize, mask: u128, ink: Ink) -> u32 {
        let old = self.pixels[row];
        let new = match ink {
            Ink::Clear => old & !mask,
            Ink::Set => old | mask,
            Ink::Invert => old ^ mask,
        };
        self.pixels[row] = new;
        (old ^ new).count_ones()
    }
}

/// Text art, two rows of pixels per line.
impl std::fmt::Display for Lcd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for pair in self.pixels.chunks(2) {
            let line: String = (0..WIDTH)
                .map(|column| match [pair[0], pair[1]].map(|row| row & mask(column, column) != 0) {
                    [false, false] => ' ',
                    [true, false] => '▀',
                    [false, true] => '▄',
                    [true, true] => '█',
                })
                .collect();
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Returns true if a grey level is shown black at this pixel: ordered dithering with a 2 x 2 pattern of thresholds.
pub fn is_black(level: u8, row: usize, column: usize) -> bool {
    const THRESHOLDS: [[u8; 2]; 2] = [[32, 160], [224, 96]];
    level < THRESHOLDS[row % 2][column % 2]
}

/// Mask of pixels `left` to `right` of a row.
fn mask(left: usize, right: usize) -> u128 {
    u128::MAX >> (WIDTH - 1 - (right - left)) << (WIDTH - 1 - right)
}

/// Converts `value` to an index below `end`.
fn index(value: i32, end: usize) -> Result<usize, InvalidPosition> {
    usize::try_from(value).ok().filter(|index| *index < end).ok_or(InvalidPosition)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str) -> Lcd {
        let mut lcd = Lcd::default();
        lcd.write(text.as_bytes());
        lcd
    }

    /// The upper left `rows` x `columns` pixels as text art.
    fn art(lcd: &Lcd, rows: i32, columns: i32) -> String {
        let line = |row| -> String {
            (0..columns).map(|column| if lcd.pixel(row, column).unwrap() { '#' } else { '.' }).collect()
        };
        (0..rows).map(|row| line(row) + "\n").collect()
    }

    #[test]
    fn characters_are_drawn_on_a_grid_of_8_by_9() {
        insta::assert_snapshot!(art(&written("RoBIOS\n6.5"), 18, 48));
    }

    #[test]
    fn the_display_with_menu_and_frame_matches_its_snapshot() {
        let mut lcd = written("Wall 123 mm\nphi -1.571\n");
        for (position, text) in [(1, "GO"), (2, "STOP"), (3, "longer"), (4, "END")] {
            lcd.set_menu(position, text.as_bytes()).unwrap();
        }
        lcd.draw_line([0, 30], [127, 50], Ink::Set);
        lcd.draw_area([100, 2], [120, 24], Ink::Invert).unwrap();
        lcd.draw_area([104, 6], [116, 20], Ink::Invert).unwrap();
        assert_eq!(lcd.lines(), ["Wall 123 mm", "phi -1.571", "", "", "", "", "GO  STOPlongEND"]);
        insta::assert_snapshot!(lcd);
    }

    #[test]
    fn text_wraps_only_when_a_17th_character_follows() {
        let mut lcd = written("0123456789abcdef");
        assert_eq!(lcd.position(), (0, 15));
        lcd.write(b"\nB");
        assert_eq!(lcd.lines()[..3], ["0123456789abcdef", "B", ""]);
        let mut lcd = written("0123456789abcdef");
        lcd.write(b"B");
        assert_eq!((lcd.lines()[1].as_str(), lcd.position()), ("B", (1, 1)));
    }

    #[test]
    fn text_scrolls_above_the_menu_line() {
        let mut lcd = Lcd::default();
        lcd.set_menu(1, b"MENU").unwrap();
        lcd.write(b"1\n2\n3\n4\n5\n6\n7");
        assert_eq!(lcd.lines(), ["2", "3", "4", "5", "6", "7", "MENU"]);
        assert_eq!(art(&lcd, 9, 8), art(&written("2"), 9, 8), "pixels scroll with the text");
        lcd.is_scrolling = false;
        lcd.write(b"\nA\n");
        assert_eq!(lcd.lines(), ["A", "3", "4", "5", "6", "7", "MENU"]);
        assert_eq!(lcd.position(), (1, 0));
    }

    #[test]
    fn control_characters() {
        let mut lcd = written("abc\rX\tT\x08U\x01\x7f");
        assert_eq!(lcd.lines()[0], "Xbc U");
        lcd.write(b"\x0cnew");
        assert_eq!(lcd.lines()[0], "new");
        assert_eq!(written("\t\t\t\t\tx").lines()[1], "x", "a tab stops at the line's end");
    }

    #[test]
    fn the_menu_line_is_written_by_set_position_and_set_menu() {
        let mut lcd = Lcd::default();
        lcd.set_position(6, 14).unwrap();
        lcd.write(b"abc");
        assert_eq!(lcd.lines()[6], "              ab");
        assert_eq!(lcd.lines()[5], "c", "after the last cell text goes on above the menu");
        assert_eq!(lcd.set_position(7, 0), Err(InvalidPosition));
        assert_eq!(lcd.set_position(-1, 0), Err(InvalidPosition));
        assert_eq!(lcd.set_position(0, 16), Err(InvalidPosition));
        assert_eq!(lcd.set_menu(0, b"a"), Err(InvalidPosition));
        assert_eq!(lcd.set_menu(i32::MIN, b"a"), Err(InvalidPosition));
        lcd.set_menu(4, b"").unwrap();
        assert_eq!(lcd.lines()[6], "              ab", "an empty text leaves the place");
        lcd.set_menu(4, b" ").unwrap();
        assert_eq!(lcd.lines()[6], "");
    }

    #[test]
    fn pixels_and_lines() {
        let mut lcd = Lcd::default();
        assert_eq!(lcd.draw_pixel(63, 127, Ink::Set), Ok(1));
        assert_eq!(lcd.draw_pixel(63, 127, Ink::Set), Ok(0), "it was set");
        assert_eq!((lcd.pixel(63, 127), lcd.pixel(0, 0)), (Ok(true), Ok(false)));
        assert_eq!(lcd.pixel(64, 0), Err(InvalidPosition));
        assert_eq!(lcd.draw_pixel(0, 128, Ink::Set), Err(InvalidPosition));
        assert_eq!(lcd.draw_line([0, 0], [3, 3], Ink::Set), 4);
        assert_eq!(lcd.draw_line([3, 3], [0, 0], Ink::Invert), 4, "the same pixels in the other direction");
        assert_eq!(lcd.draw_line([5, 60], [5, 2], Ink::Set), 59);
        assert_eq!(lcd.draw_line([9, 9], [9, 9], Ink::Set), 1);
        assert_eq!(lcd.draw_area([0, 0], [127, 63], Ink::Clear), Ok(61));
        assert_eq!(lcd.draw_area([1, 0], [0, 5], Ink::Set), Err(InvalidPosition));
        assert_eq!(Ink::try_from(3), Err(InvalidPosition));
    }

    #[test]
    fn drawing_is_clipped_to_the_display() {
        let mut lcd = Lcd::default();
        assert_eq!(lcd.draw_line([-5, 10], [2, 10], Ink::Set), 3);
        assert_eq!(lcd.draw_line([i32::MIN, i32::MIN], [i32::MAX, i32::MAX], Ink::Set), 64, "the diagonal");
        assert_eq!(lcd.pixel(63, 63), Ok(true));
        assert_eq!(lcd.draw_line([200, 0], [300, 63], Ink::Set), 0);
        lcd.clear();
        assert_eq!(lcd.draw_area([i32::MIN, 60], [1, i32::MAX], Ink::Set), Ok(8));
        assert_eq!(lcd.draw_area([128, 0], [200, 63], Ink::Set), Ok(0));
        assert_eq!(lcd.draw_area([0, -9], [5, -1], Ink::Set), Ok(0));
    }

    #[test]
    fn an_area_removes_the_characters_that_it_covers() {
        let mut lcd = written("abcd\nefgh");
        lcd.draw_area([8, 0], [24, 16], Ink::Set).unwrap();
        assert_eq!(lcd.lines()[..2], ["a  d", "efgh"], "the lower line is covered in part");
        lcd.draw_area([0, 0], [127, 63], Ink::Invert).unwrap();
        assert_eq!(lcd.lines()[..2], ["a  d", "efgh"]);
        lcd.draw_area([-5, 9], [200, 90], Ink::Clear).unwrap();
        assert_eq!(lcd.lines()[..2], ["a  d", ""]);
    }

    #[test]
    fn a_line_of_slope_one_third() {
        let mut lcd = Lcd::default();
        lcd.draw_line([0, 0], [6, 2], Ink::Set);
        assert_eq!(art(&lcd, 3, 7), "##.....\n..###..\n.....##\n");
    }

    #[test]
    fn a_picture_is_shown_and_read_back() {
        let mut picture = [0; PICTURE_BYTES];
        picture[0] = 0b1000_0001;
        picture[PICTURE_BYTES - 1] = 1;
        let mut lcd = written("gone");
        lcd.show_picture(&picture);
        assert_eq!([lcd.pixel(0, 0), lcd.pixel(0, 7), lcd.pixel(63, 127)], [Ok(true); 3]);
        assert_eq!((lcd.picture(), lcd.lines()[0].as_str()), (picture, ""));
    }

    #[test]
    fn grey_is_dithered() {
        let mut lcd = written("x");
        // At half grey every second pixel is black: the thresholds form a chequered pattern.
        lcd.show_grey(std::iter::repeat_n(128, 80 * 54), 80);
        assert_eq!(art(&lcd, 2, 4), ".#.#\n#.#.\n");
        assert_eq!(lcd.pixel(0, 81), Ok(false));
        assert_eq!(lcd.lines()[0], "");
        assert!(is_black(0, 0, 0) && !is_black(255, 1, 0));
    }
}
