//! The colour display of RoBIOS-7: pixels, text in cells of a font, four keys at the lower edge, touches.
//!
//! This model does not depend on calls and robots. Source: RoBIOS-7 library, LCD output; `docs/robios7.md` describes
//! our choices where the source is silent.

pub mod canvas;
pub mod font;
pub mod list;
pub mod menu;
pub mod page;
#[cfg(test)]
mod tests;

use canvas::{Canvas, Ink, Rgb, WHITE, inverse};
use font::{Family, Font, Size, Variation};
use list::ListLine;
use menu::MenuLabel;
use page::{Cell, Page};

/// Default width and height in pixels: those of an EyeBot 7. Programs for EyeSim VR place text where only these have
/// room.
pub const DEFAULT_SIZE: [u16; 2] = [480, 320];

/// Columns between tab stops.
const TAB: i32 = 4;

/// Modes of text output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// Text below the last row scrolls the display; otherwise it continues in row 0.
    pub is_scrolling: bool,
    /// Text that reaches the right edge continues in the next row; otherwise it is cut.
    pub has_linefeed: bool,
    /// Text keeps the background as it is.
    pub is_transparent: bool,
    /// Text is drawn in the complement of its colour.
    pub is_ink_inverse: bool,
    /// The background of text is drawn in the complement of its colour.
    pub is_paper_inverse: bool,
}

impl Default for Modes {
    fn default() -> Self {
        Self {
            is_scrolling: true,
            has_linefeed: true,
            is_transparent: false,
            is_ink_inverse: false,
            is_paper_inverse: false,
        }
    }
}

/// The display's state.
#[derive(Clone, Debug)]
pub struct Screen {
    size: [u16; 2],
    /// Current content.
    content: Content,
    /// Content that is visible until the next refresh, if automatic refresh is off.
    visible: Option<Box<Content>>,
    /// Position of the next character in pixels.
    cursor: [i32; 2],
    font: Font,
    ink: Rgb,
    paper: Rgb,
    /// Modes of text output.
    pub modes: Modes,
    /// Upper left corner of the next image.
    image_corner: [i32; 2],
}

#[derive(Clone, Debug)]
struct Content {
    page: Page,
    entries: [MenuLabel; menu::KEYS],
    has_menu: bool,
    list: Vec<ListLine>,
    has_list: bool,
}

impl Default for Screen {
    fn default() -> Self {
        Self::new(DEFAULT_SIZE)
    }
}

impl Screen {
    /// A black display of `size` (width, height) pixels; at least 64 each.
    pub fn new(size: [u16; 2]) -> Self {
        let size = size.map(|pixels| pixels.max(64));
        Self {
            size,
            content: Content::new(size),
            visible: None,
            cursor: [0, 0],
            font: Font { family: Family::Courier, variation: Variation::Normal, size: Size::Normal },
            ink: WHITE,
            paper: canvas::BLACK,
            modes: Modes::default(),
            image_corner: [0, 0],
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u16; 2] {
        self.size
    }

    /// Makes the display black; the next text is written at the top left. Menu, colours and font are kept.
    pub fn clear(&mut self) {
        self.content.page.clear();
        self.cursor = [0, 0];
    }

    /// Visible pixels: drawing, text, list and menu.
    pub fn picture(&self) -> Canvas {
        self.visible_content().picture()
    }

    /// Colour of a pixel; black outside.
    pub fn pixel(&mut self, x: i32, y: i32) -> Rgb {
        let list_bottom = self.content.shown_list().len() as i32 * i32::from(list::ROW);
        if y < list_bottom || self.content.has_menu && y >= i32::from(self.text_bottom()) {
            return self.content.picture().pixel(x, y).unwrap_or(canvas::BLACK);
        }
        self.content.page.canvas_mut().pixel(x, y).unwrap_or(canvas::BLACK)
    }

    /// Visible text without trailing blanks. These are the lines of the list if one is shown, otherwise the rows from
    /// the top to the last one with text. One line of the menu texts follows, separated by ` | `; it is empty without a
    /// menu.
    pub fn lines(&self) -> Vec<String> {
        let content = self.visible_content();
        let mut lines = match content.shown_list() {
            [] => content.page.lines(),
            list => list.iter().map(|line| line.entry.text.trim_end().to_owned()).collect(),
        };
        let menu = content.entries.each_ref().map(|entry| entry.text.replace('\n', " "));
        lines.push(if content.has_menu { menu.join(" | ").trim_end().to_owned() } else { String::new() });
        lines
    }

    /// Switches automatic refresh: drawing becomes visible immediately, or at the next [`refresh`](Self::refresh).
    pub fn set_auto_refresh(&mut self, is_automatic: bool) {
        self.visible =
            if is_automatic { None } else { self.visible.take().or_else(|| Some(Box::new(self.content.clone()))) };
    }

    /// Makes everything drawn visible.
    pub fn refresh(&mut self) {
        if let Some(visible) = &mut self.visible {
            **visible = self.content.clone();
        }
    }

    fn visible_content(&self) -> &Content {
        self.visible.as_deref().unwrap_or(&self.content)
    }
}

impl Content {
    fn new([width, height]: [u16; 2]) -> Self {
        let page = Page::new(width, height);
        Self { page, entries: menu::entries(), has_menu: false, list: Vec::new(), has_list: false }
    }

    /// Lines of the list; none while the list is hidden.
    fn shown_list(&self) -> &[ListLine] {
        if self.has_list { &self.list } else { &[] }
    }

    fn picture(&self) -> Canvas {
        let mut picture = self.page.picture();
        list::draw(self.shown_list(), &mut picture);
        if self.has_menu {
            menu::draw(&self.entries, &mut picture);
        }
        picture
    }
}

/// Text.
impl Screen {
    /// Sets the colours of the following text.
    pub fn set_colours(&mut self, ink: Rgb, paper: Rgb) {
        (self.ink, self.paper) = (ink, paper);
    }

    /// Sets the font of the following text; the size does not change.
    pub fn set_font(&mut self, family: Family, variation: Variation) {
        self.font = Font { family, variation, size: self.font.size };
    }

    /// Sets the size of the following text.
    pub fn set_font_size(&mut self, size: Size) {
        self.font.size = size;
    }

    /// Row and column of the next character, in cells of the current size.
    pub fn position(&self) -> [i32; 2] {
        let [x, y] = self.cursor;
        let [width, height] = self.font.size.cell().map(i32::from);
        [y.div_euclid(height), x.div_euclid(width)]
    }

    /// Number of rows and columns of the whole display, in cells of the current size.
    pub fn rows_and_columns(&self) -> [i32; 2] {
        let [width, height] = self.font.size.cell().map(u16::from);
        [(self.size[1] / height).into(), (self.size[0] / width).into()]
    }

    /// Sets the position of the next character, in cells of the current size. A column beyond the last one lies beyond
    /// the edge, where the character after a full row lies.
    pub fn set_position(&mut self, row: i32, column: i32) {
        let [width, height] = self.font.size.cell().map(i32::from);
        let ([rows, columns], size) = (self.rows_and_columns(), self.size.map(i32::from));
        let beyond =
            [if column < columns { i32::MIN } else { size[0] + 1 }, if row < rows { i32::MIN } else { size[1] }];
        self.cursor = [column.saturating_mul(width).max(beyond[0]), row.saturating_mul(height).max(beyond[1])];
    }

    /// Writes text at the current position.
    ///
    /// `\n` begins a new row, `\r` goes back to the row's beginning, `\t` to the next multiple of 4 columns, `\b` one
    /// column back; other control characters are ignored, and so are characters that are not entirely on the display.
    /// Text outside of the display neither wraps nor scrolls.
    pub fn write(&mut self, text: &str) {
        let (width, edge) = (i32::from(self.font.size.cell()[0]), i32::from(self.size[0]));
        for character in text.chars() {
            match character {
                '\n' => self.begin_row(),
                '\r' => self.cursor[0] = 0,
                '\t' if self.cursor[0] <= edge => {
                    self.cursor[0] = ((self.cursor[0].div_euclid(width * TAB) + 1) * width * TAB).min(edge);
                }
                '\x08' => self.cursor[0] = self.cursor[0].saturating_sub(width).max(0),
                character if character.is_control() => {}
                character => self.write_character(character),
            }
        }
    }

    fn write_character(&mut self, character: char) {
        let width = self.font.advance(character);
        if width == 0 {
            return;
        }
        let edge = i32::from(self.size[0]);
        let is_past_edge = self.cursor[0].saturating_add(width.into()) > edge;
        if is_past_edge && self.modes.has_linefeed && (1..=edge).contains(&self.cursor[0]) {
            self.begin_row();
        }
        let [x, y] = self.cursor;
        let with_mode = |colour, is_inverse| if is_inverse { inverse(colour) } else { colour };
        let ink = with_mode(self.ink, self.modes.is_ink_inverse);
        let paper = (!self.modes.is_transparent).then(|| with_mode(self.paper, self.modes.is_paper_inverse));
        if paper.is_some() || character != ' ' {
            self.content.page.put(x, y, Cell { character, font: self.font, width, ink, paper });
        }
        self.cursor[0] = x.saturating_add(width.into());
    }

    fn begin_row(&mut self) {
        let row_height = i32::from(self.font.size.cell()[1]);
        let bottom = self.text_bottom();
        let is_on_display = self.cursor[1] < i32::from(self.size[1]);
        self.cursor = [0, self.cursor[1].saturating_add(row_height)];
        if is_on_display && self.cursor[1].saturating_add(row_height) > i32::from(bottom) {
            if self.modes.is_scrolling {
                self.cursor[1] = (i32::from(bottom) / row_height - 1) * row_height;
                self.content.page.scroll(bottom, row_height as u16);
            } else {
                self.cursor[1] = 0;
            }
        }
    }

    /// First row of pixels below the text: the top of the menu, or the row below the display.
    fn text_bottom(&self) -> u16 {
        self.size[1] - if self.content.has_menu { menu::HEIGHT } else { 0 }
    }
}

/// Graphics. Drawing functions return the number of changed pixels; the menu covers all drawing.
impl Screen {
    /// Draws on the pixels; text under the drawing stays part of [`lines`](Self::lines).
    pub fn draw(&mut self, shape: impl FnOnce(&mut Canvas) -> u32) -> u32 {
        shape(self.content.page.canvas_mut())
    }

    /// Fills the rectangle between two corners, edges included; the text that it covers is removed.
    pub fn fill_area(&mut self, from: [i32; 2], to: [i32; 2], colour: Rgb) -> u32 {
        self.content.page.cover(from, to);
        self.draw(|canvas| canvas.fill_area(from, to, Ink::Colour(colour)))
    }

    /// Draws the edges of the rectangle between two corners.
    pub fn draw_rectangle(&mut self, from: [i32; 2], to: [i32; 2], colour: Rgb) -> u32 {
        self.draw(|canvas| canvas.draw_rectangle(from, to, Ink::Colour(colour)))
    }

    /// Sets the upper left corner of the following images.
    pub fn set_image_corner(&mut self, corner: [i32; 2]) {
        self.image_corner = corner;
    }

    /// Shows an image of `width` x `height` pixels; the text that it covers is removed. If the image has fewer
    /// pixels, the rest of its area does not change.
    pub fn show_image(&mut self, [width, height]: [usize; 2], image: impl Iterator<Item = Rgb>) -> u32 {
        if width == 0 || height == 0 {
            return 0;
        }
        let corner = self.image_corner;
        let last = |first: i32, size: usize| first.saturating_add(i32::try_from(size - 1).unwrap_or(i32::MAX));
        self.content.page.cover(corner, [last(corner[0], width), last(corner[1], height)]);
        self.draw(|canvas| canvas.show(corner, width, image.take(width.saturating_mul(height))))
    }
}

/// The menu, and keys under a touch.
impl Screen {
    /// Shows or hides the menu.
    pub fn set_menu_shown(&mut self, is_shown: bool) {
        self.content.has_menu = is_shown;
    }

    /// Sets the text of key `index` (0 to 3) and shows the menu; the key's colours are kept.
    pub fn set_menu_text(&mut self, index: usize, text: &str) {
        self.content.has_menu = true;
        if let Some(entry) = self.content.entries.get_mut(index) {
            text.clone_into(&mut entry.text);
        }
    }

    /// Sets the colours of key `index` (0 to 3).
    pub fn set_menu_colours(&mut self, index: usize, ink: Rgb, paper: Rgb) {
        if let Some(entry) = self.content.entries.get_mut(index) {
            (entry.ink, entry.paper) = (ink, paper);
        }
    }

    /// Shows or hides the list.
    pub fn set_list_shown(&mut self, is_shown: bool) {
        self.content.has_list = is_shown;
    }

    /// Sets line `index` of the list and shows the list; `None` truncates the list before that line. Returns false if
    /// the line above it is missing, or the list is full.
    pub fn set_list_line(&mut self, index: usize, line: Option<ListLine>) -> bool {
        let is_valid_index = index <= self.content.list.len() && index < self.max_list_lines();
        match line {
            Some(line) if is_valid_index => {
                self.content.list.splice(index..self.content.list.len().min(index + 1), [line]);
                self.content.has_list = true;
            }
            Some(_) => return false,
            None => self.content.list.truncate(index),
        }
        true
    }

    /// Maximum number of lines in the list.
    pub fn max_list_lines(&self) -> usize {
        list::max_lines(self.size[1])
    }

    /// Code of the list line at a pixel; 0 for none.
    pub fn list_key_at(&self, [x, y]: [i32; 2]) -> i32 {
        let is_on_display = (0..i32::from(self.size[0])).contains(&x);
        let row = usize::try_from(y).ok().filter(|_| is_on_display).map(|y| y / usize::from(list::ROW));
        row.and_then(|row| self.content.shown_list().get(row)).map_or(0, |line| line.key)
    }

    /// Key (0 to 3) at a pixel, even if the menu is hidden.
    pub fn key_at(&self, [x, y]: [i32; 2]) -> Option<usize> {
        let [width, height] = self.size.map(i32::from);
        let is_key = (0..width).contains(&x) && (height - i32::from(menu::HEIGHT)..height).contains(&y);
        is_key.then(|| (0..menu::KEYS).rfind(|&index| menu::columns(index, width as usize)[0] <= x as usize))?
    }

    /// Pixel in the middle of key `index` (0 to 3).
    pub fn key_centre(&self, index: usize) -> [i32; 2] {
        let [width, height] = self.size.map(usize::from);
        let [left, right] = menu::columns(index, width);
        [(left + right) as i32 / 2, height as i32 - i32::from(menu::HEIGHT) / 2]
    }
}
