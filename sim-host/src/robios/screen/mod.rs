//! The colour display of RoBIOS-7: pixels, text in cells of a font, four keys at the lower edge, touches.
//!
//! A pure model: it knows no functions and no robots. Source: RoBIOS-7 library, LCD output; what it leaves open is our choice and
//! stands in `docs/robios7.md`.

pub mod canvas;
pub mod font;
pub mod list;
pub mod menu;
pub mod page;
#[cfg(test)]
mod tests;

use canvas::{Canvas, Ink, Rgb, WHITE, inverse};
use font::{Family, Font, Size, Variation};
use list::Line;
use menu::Entry;
use page::{Cell, Page};

/// Pixels across and down when nobody says: the window of EyeSim VR.
pub const DEFAULT_SIZE: [u16; 2] = [320, 240];

/// Columns between the stops of a tab.
const TAB: i32 = 4;

/// What text does beyond colours and fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// Text below the last row moves the others up; else it goes on in row 0.
    pub is_scrolling: bool,
    /// Text that reaches the right edge goes on in the next row; else it is cut.
    pub has_linefeed: bool,
    /// Text leaves what is behind it.
    pub is_transparent: bool,
    /// Text takes the complement of its colour.
    pub is_ink_inverse: bool,
    /// The paper of text takes the complement of its colour.
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
    /// What is shown.
    face: Face,
    /// What is shown instead, until the next refresh, where the display does not refresh itself.
    held: Option<Box<Face>>,
    /// Where the next character is written, in pixels.
    cursor: [i32; 2],
    font: Font,
    ink: Rgb,
    paper: Rgb,
    /// What text does.
    pub modes: Modes,
    /// Upper left corner of the next image.
    image_at: [i32; 2],
}

#[derive(Clone, Debug)]
struct Face {
    page: Page,
    entries: [Entry; menu::KEYS],
    has_menu: bool,
    list: Vec<Line>,
    has_list: bool,
}

impl Default for Screen {
    fn default() -> Self {
        Self::new(DEFAULT_SIZE)
    }
}

impl Screen {
    /// A black display, `size` pixels across and down; at least 64 each.
    pub fn new(size: [u16; 2]) -> Self {
        let size = size.map(|pixels| pixels.max(64));
        Self {
            size,
            face: Face::new(size),
            held: None,
            cursor: [0, 0],
            font: Font { family: Family::Courier, variation: Variation::Normal, size: Size::Normal },
            ink: WHITE,
            paper: canvas::BLACK,
            modes: Modes::default(),
            image_at: [0, 0],
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u16; 2] {
        self.size
    }

    /// Makes the display black; the next text is written at the top left. Menu, colours and font stay.
    pub fn clear(&mut self) {
        self.face.page.clear();
        self.cursor = [0, 0];
    }

    /// What is seen: pixels, text and menu.
    pub fn picture(&self) -> Canvas {
        self.shown().picture()
    }

    /// The colour of a pixel, black outside.
    pub fn pixel(&mut self, x: i32, y: i32) -> Rgb {
        let list_bottom = self.face.shown_list().len() as i32 * i32::from(list::ROW);
        if y < list_bottom || self.face.has_menu && y >= i32::from(self.text_bottom()) {
            return self.face.picture().pixel(x, y).unwrap_or(canvas::BLACK);
        }
        self.face.page.canvas_mut().pixel(x, y).unwrap_or(canvas::BLACK)
    }

    /// The text that is seen, without blanks at the ends: the lines of a list where there is one, else the rows from the top,
    /// the last one that has text being the last; then the texts of the menu with ` | ` between them, empty without a menu.
    pub fn lines(&self) -> Vec<String> {
        let face = self.shown();
        let mut lines = match face.shown_list() {
            [] => face.page.lines(),
            list => list.iter().map(|line| line.entry.text.trim_end().to_owned()).collect(),
        };
        let menu = face.entries.each_ref().map(|entry| entry.text.replace('\n', " "));
        lines.push(if face.has_menu { menu.join(" | ").trim_end().to_owned() } else { String::new() });
        lines
    }

    /// Whether what is drawn is seen at once, or at the next [`refresh`](Self::refresh).
    pub fn set_refreshing(&mut self, is_at_once: bool) {
        self.held = if is_at_once { None } else { self.held.take().or_else(|| Some(Box::new(self.face.clone()))) };
    }

    /// Shows what has been drawn.
    pub fn refresh(&mut self) {
        if let Some(held) = &mut self.held {
            **held = self.face.clone();
        }
    }

    fn shown(&self) -> &Face {
        self.held.as_deref().unwrap_or(&self.face)
    }
}

impl Face {
    fn new([width, height]: [u16; 2]) -> Self {
        let page = Page::new(width, height);
        Self { page, entries: menu::entries(), has_menu: false, list: Vec::new(), has_list: false }
    }

    /// The lines of the list that are shown.
    fn shown_list(&self) -> &[Line] {
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
    /// Colours of the text from now on.
    pub fn set_colours(&mut self, ink: Rgb, paper: Rgb) {
        (self.ink, self.paper) = (ink, paper);
    }

    /// Font of the text from now on; its size stays.
    pub fn set_font(&mut self, family: Family, variation: Variation) {
        self.font = Font { family, variation, size: self.font.size };
    }

    /// Size of the text from now on.
    pub fn set_font_size(&mut self, size: Size) {
        self.font.size = size;
    }

    /// Row and column of the next character, by the cells of the present size.
    pub fn position(&self) -> [i32; 2] {
        let [x, y] = self.cursor;
        let [column, row] = self.font.size.cell().map(i32::from);
        [y.div_euclid(row), x.div_euclid(column)]
    }

    /// How many rows and columns the whole display has, by the cells of the present size.
    pub fn rows_and_columns(&self) -> [i32; 2] {
        let [column, row] = self.font.size.cell().map(u16::from);
        [(self.size[1] / row).into(), (self.size[0] / column).into()]
    }

    /// Sets where the next character is written, by the cells of the present size.
    pub fn set_position(&mut self, row: i32, column: i32) {
        let [width, height] = self.font.size.cell().map(i32::from);
        self.cursor = [column.saturating_mul(width), row.saturating_mul(height)];
    }

    /// Writes text from the present position on.
    ///
    /// `\n` begins a new row, `\r` goes back to the row's beginning, `\t` to the next multiple of 4 columns, `\b` one column
    /// back; other control characters are left out. What is not wholly on the display is left out too.
    pub fn write(&mut self, text: &str) {
        let column = i32::from(self.font.size.cell()[0]);
        for character in text.chars() {
            match character {
                '\n' => self.begin_row(),
                '\r' => self.cursor[0] = 0,
                '\t' => self.cursor[0] = (self.cursor[0].div_euclid(column * TAB) + 1).saturating_mul(column * TAB),
                '\x08' => self.cursor[0] = self.cursor[0].saturating_sub(column).max(0),
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
        let is_past_edge = self.cursor[0].saturating_add(width.into()) > i32::from(self.size[0]);
        if is_past_edge && self.modes.has_linefeed && self.cursor[0] > 0 {
            self.begin_row();
        }
        let [x, y] = self.cursor;
        let turned = |colour, is_inverse| if is_inverse { inverse(colour) } else { colour };
        let ink = turned(self.ink, self.modes.is_ink_inverse);
        let paper = (!self.modes.is_transparent).then(|| turned(self.paper, self.modes.is_paper_inverse));
        if paper.is_some() || character != ' ' {
            self.face.page.put(x, y, Cell { character, font: self.font, width, ink, paper });
        }
        self.cursor[0] = x.saturating_add(width.into());
    }

    fn begin_row(&mut self) {
        let row = i32::from(self.font.size.cell()[1]);
        let bottom = self.text_bottom();
        self.cursor = [0, self.cursor[1].saturating_add(row)];
        if self.cursor[1].saturating_add(row) > i32::from(bottom) {
            if self.modes.is_scrolling {
                self.cursor[1] = (i32::from(bottom) / row - 1) * row;
                self.face.page.scroll(bottom, row as u16);
            } else {
                self.cursor[1] = 0;
            }
        }
    }

    /// The first row of pixels below the text: that of the menu, or the display's end.
    fn text_bottom(&self) -> u16 {
        self.size[1] - if self.face.has_menu { menu::HEIGHT } else { 0 }
    }
}

/// Graphics. Each function returns how many pixels have changed; the menu lies above them all.
impl Screen {
    /// Draws on the pixels; text that is there stays part of [`lines`](Self::lines).
    pub fn draw(&mut self, shape: impl FnOnce(&mut Canvas) -> u32) -> u32 {
        shape(self.face.page.canvas_mut())
    }

    /// Fills the rectangle between two corners, edges included; the text that it covers is gone.
    pub fn fill_area(&mut self, from: [i32; 2], to: [i32; 2], colour: Rgb) -> u32 {
        self.face.page.cover(from, to);
        self.draw(|canvas| canvas.fill_area(from, to, Ink::Colour(colour)))
    }

    /// Draws the edges of the rectangle between two corners.
    pub fn draw_frame(&mut self, from: [i32; 2], to: [i32; 2], colour: Rgb) -> u32 {
        self.draw(|canvas| canvas.draw_frame(from, to, Ink::Colour(colour)))
    }

    /// Sets where the upper left corner of images goes.
    pub fn set_image_place(&mut self, at: [i32; 2]) {
        self.image_at = at;
    }

    /// Shows an image of `width` x `height` pixels; the text that it covers is gone. What it lacks stays as it was.
    pub fn show_image(&mut self, [width, height]: [usize; 2], image: impl Iterator<Item = Rgb>) -> u32 {
        if width == 0 || height == 0 {
            return 0;
        }
        let at = self.image_at;
        let last = |at: i32, size: usize| at.saturating_add(i32::try_from(size - 1).unwrap_or(i32::MAX));
        self.face.page.cover(at, [last(at[0], width), last(at[1], height)]);
        self.draw(|canvas| canvas.show(at, width, image.take(width.saturating_mul(height))))
    }
}

/// The menu, and what lies under a touch.
impl Screen {
    /// Shows or hides the menu.
    pub fn set_menu_shown(&mut self, is_shown: bool) {
        self.face.has_menu = is_shown;
    }

    /// Sets the text of key `index` (0 to 3) and shows the menu; its colours stay.
    pub fn set_menu_text(&mut self, index: usize, text: &str) {
        self.face.has_menu = true;
        if let Some(entry) = self.face.entries.get_mut(index) {
            text.clone_into(&mut entry.text);
        }
    }

    /// Sets the colours of key `index` (0 to 3).
    pub fn set_menu_colours(&mut self, index: usize, ink: Rgb, paper: Rgb) {
        if let Some(entry) = self.face.entries.get_mut(index) {
            (entry.ink, entry.paper) = (ink, paper);
        }
    }

    /// Shows or hides the list.
    pub fn set_list_shown(&mut self, is_shown: bool) {
        self.face.has_list = is_shown;
    }

    /// Sets line `index` of the list, with the key that it is, and shows the list; without a line, the list ends before it.
    /// False where there is no line above it or no room.
    pub fn set_list_line(&mut self, index: usize, line: Option<Line>) -> bool {
        let is_place = index <= self.face.list.len() && index < self.list_room();
        match line {
            Some(line) if is_place => {
                self.face.list.splice(index..self.face.list.len().min(index + 1), [line]);
                self.face.has_list = true;
            }
            Some(_) => return false,
            None => self.face.list.truncate(index),
        }
        true
    }

    /// How many lines a list can have.
    pub fn list_room(&self) -> usize {
        list::room(self.size[1])
    }

    /// The code of the line of the list at a place; 0 for none.
    pub fn list_key_at(&self, [x, y]: [i32; 2]) -> i32 {
        let is_across = (0..i32::from(self.size[0])).contains(&x);
        let row = usize::try_from(y).ok().filter(|_| is_across).map(|y| y / usize::from(list::ROW));
        row.and_then(|row| self.face.shown_list().get(row)).map_or(0, |line| line.key)
    }

    /// The key (0 to 3) at a place, whether the menu is shown or not.
    pub fn key_at(&self, [x, y]: [i32; 2]) -> Option<usize> {
        let [width, height] = self.size.map(i32::from);
        let is_key = (0..width).contains(&x) && (height - i32::from(menu::HEIGHT)..height).contains(&y);
        is_key.then(|| (0..menu::KEYS).rfind(|&index| menu::columns(index, width as usize)[0] <= x as usize))?
    }

    /// The place in the middle of key `index` (0 to 3).
    pub fn middle_of_key(&self, index: usize) -> [i32; 2] {
        let [width, height] = self.size.map(usize::from);
        let [left, right] = menu::columns(index, width);
        [(left + right) as i32 / 2, height as i32 - i32::from(menu::HEIGHT) / 2]
    }
}
