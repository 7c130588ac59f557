//! Display functions of RoBIOS-7, based on the model in [`super::screen`].
//!
//! Source: RoBIOS-7 library, LCD output; `docs/robios7.md` describes our choices where the source is silent.

use robios_sys::robios7::{
    BOLD, CAM5MP, COURIER, HELVETICA, ITALICS, LCD_AUTOREFRESH, LCD_BGCOL_INVERSE, LCD_BGCOL_NOINVERSE,
    LCD_BGCOL_NOTRANSPARENT, LCD_BGCOL_TRANSPARENT, LCD_CLASSICMENU, LCD_FGCOL_INVERSE, LCD_FGCOL_NOINVERSE,
    LCD_HIDEMENU, LCD_LINEFEED, LCD_LISTMENU, LCD_NOAUTOREFRESH, LCD_NOLINEFEED, LCD_NOSCROLLING, LCD_SCROLLING,
    LCD_SHOWMENU, NORMAL, RESOLUTIONS, TIMES,
};
use robios_sys::{Out, Robios7Call as Call};

use super::robot::Robot;
use super::screen::canvas::{Canvas, Rgb, WHITE, code, rgb};
use super::screen::font::{Family, Size, Variation};
use super::screen::list::ListLine;
use super::screen::menu::MenuLabel;
use super::text;
use sim_core::record::Event;

/// `LCDPrintf`
pub fn put(robot: &mut Robot, call: Call, characters: Option<&[u8]>) -> i32 {
    let Some(characters) = characters else { return robot.fail_call(call, 1) };
    let text = text(characters);
    let [row, column] = robot.screen().position().map(|coordinate| coordinate.clamp(0, u8::MAX.into()) as u8);
    robot.record(Event::LcdText { row, column, text: &text });
    robot.screen().write(&text);
    0
}

/// `LCDSetPrintf`
pub fn put_at(robot: &mut Robot, position: [i32; 2], characters: Option<&[u8]>) -> i32 {
    move_to(robot, Call::LCDSetPrintf, position);
    put(robot, Call::LCDSetPrintf, characters)
}

/// `LCDClear`
pub fn clear(robot: &mut Robot) -> i32 {
    robot.screen().clear();
    robot.record(Event::LcdClear {});
    0
}

/// `LCDSetPos`
pub fn set_position(robot: &mut Robot, position: [i32; 2]) -> i32 {
    move_to(robot, Call::LCDSetPos, position);
    0
}

/// Moves the cursor; gives a hint, once, if the position is outside the display.
fn move_to(robot: &mut Robot, call: Call, [row, column]: [i32; 2]) {
    robot.screen().set_position(row, column);
    let [rows, columns] = robot.screen().rows_and_columns();
    if (0..rows).contains(&row) && (0..columns).contains(&column) {
        return;
    }
    if robot.robios.hints.is_first_reason(call.into()) {
        let name = call.name();
        robot.hint(&format!(
            "`{name}`: the display has {rows} rows and {columns} columns, none at ({row}, {column}); `[lcd]` of the \
             robi's companion sets its size"
        ));
    }
}

/// `LCDGetPos`
pub fn position(robot: &mut Robot, row: &mut Out<i32>, column: &mut Out<i32>) -> i32 {
    let position = robot.screen().position();
    row.set(position[0]);
    column.set(position[1]);
    0
}

/// `LCDSetColor`
pub fn set_colours(robot: &mut Robot, ink: i32, paper: i32) -> i32 {
    robot.screen().set_colours(rgb(ink), rgb(paper));
    0
}

/// `LCDSetFont`
pub fn set_font(robot: &mut Robot, font: i32, variation: i32) -> i32 {
    let family = match font {
        HELVETICA => Some(Family::Helvetica),
        TIMES => Some(Family::Times),
        COURIER => Some(Family::Courier),
        _ => None,
    };
    let variation = match variation {
        NORMAL => Some(Variation::Normal),
        BOLD => Some(Variation::Bold),
        ITALICS => Some(Variation::Italics),
        _ => None,
    };
    let (Some(family), Some(variation)) = (family, variation) else { return robot.fail_call(Call::LCDSetFont, 1) };
    robot.screen().set_font(family, variation);
    0
}

/// `LCDSetFontSize`
pub fn set_font_size(robot: &mut Robot, number: i32) -> i32 {
    let Some(size) = Size::from_number(number) else {
        return robot.refuse_call(Call::LCDSetFontSize, 1, |_| format!("{number} is none of 8, 12, 14, 18 and 24"));
    };
    robot.screen().set_font_size(size);
    0
}

/// `LCDSetMode`: switches without a flag in `mode` keep their state.
pub fn set_mode(robot: &mut Robot, mode: i32) -> i32 {
    let screen = robot.screen();
    let modes = &mut screen.modes;
    for (on, off, is_on) in [
        (LCD_SCROLLING, LCD_NOSCROLLING, &mut modes.is_scrolling),
        (LCD_LINEFEED, LCD_NOLINEFEED, &mut modes.has_linefeed),
        (LCD_BGCOL_TRANSPARENT, LCD_BGCOL_NOTRANSPARENT, &mut modes.is_transparent),
        (LCD_FGCOL_INVERSE, LCD_FGCOL_NOINVERSE, &mut modes.is_ink_inverse),
        (LCD_BGCOL_INVERSE, LCD_BGCOL_NOINVERSE, &mut modes.is_paper_inverse),
    ] {
        *is_on = switch_state(mode, on, off).unwrap_or(*is_on);
    }
    if let Some(is_shown) = switch_state(mode, LCD_SHOWMENU, LCD_HIDEMENU) {
        screen.set_menu_shown(is_shown);
    }
    if let Some(is_shown) = switch_state(mode, LCD_LISTMENU, LCD_CLASSICMENU) {
        screen.set_list_shown(is_shown);
    }
    if let Some(is_automatic) = switch_state(mode, LCD_AUTOREFRESH, LCD_NOAUTOREFRESH) {
        screen.set_auto_refresh(is_automatic);
    }
    0
}

/// State to which a mode sets a switch; `None` if the mode contains neither flag. Both flags together mean off.
fn switch_state(mode: i32, on: i32, off: i32) -> Option<bool> {
    (mode & (on | off) != 0).then_some(mode & off == 0)
}

/// `LCDMenu`
pub fn set_menu(robot: &mut Robot, texts: [Option<&[u8]>; 4]) -> i32 {
    for (index, text) in texts.into_iter().enumerate() {
        if let Some(text) = text {
            set_menu_text(robot, index, text);
        }
    }
    0
}

/// `LCDMenuI`
pub fn set_menu_entry(robot: &mut Robot, position: i32, text: Option<&[u8]>, colours: [i32; 2]) -> i32 {
    let (Some(text), 1..=4) = (text, position) else {
        return robot
            .refuse_call(Call::LCDMenuI, 1, |_| format!("{position} is none of the keys 1 to 4, or the text is null"));
    };
    let index = position as usize - 1;
    let [ink, paper] = colours.map(rgb);
    robot.screen().set_menu_colours(index, ink, paper);
    set_menu_text(robot, index, text);
    0
}

fn set_menu_text(robot: &mut Robot, index: usize, characters: &[u8]) {
    let text = text(characters);
    robot.screen().set_menu_text(index, &text);
    robot.record(Event::LcdMenu { position: index as u8 + 1, text: &text });
}

/// `LCDListLine`
pub fn set_list_line(robot: &mut Robot, [index, key]: [i32; 2], characters: Option<&[u8]>, colours: [i32; 2]) -> i32 {
    let [ink, paper] = colours.map(rgb);
    let line =
        characters.map(text).map(|text| ListLine { entry: MenuLabel { text: text.into_owned(), ink, paper }, key });
    let text = line.as_ref().map(|line| line.entry.text.clone());
    let is_set = usize::try_from(index).is_ok_and(|index| robot.screen().set_list_line(index, line));
    if !is_set {
        return robot
            .refuse_call(Call::LCDListLine, 0, |_| format!("there is no line {index} in the list, or no room for it"));
    }
    if let Some(text) = text {
        robot.record(Event::LcdText { row: index.clamp(0, u8::MAX.into()) as u8, column: 0, text: &text });
    }
    robot.screen().max_list_lines() as i32
}

/// `LCDGetSize`
pub fn size(robot: &mut Robot, x: &mut Out<i32>, y: &mut Out<i32>) -> i32 {
    let [width, height] = robot.screen().size();
    x.set(width.into());
    y.set(height.into());
    0
}

/// `LCDGetPixel`
pub fn pixel(robot: &mut Robot, x: i32, y: i32) -> i32 {
    code(robot.screen().pixel(x, y))
}

/// `LCDPixel`, `LCDLine`, `LCDCircle`, `LCD...Invert`: draws a shape.
pub fn draw(robot: &mut Robot, call: Call, shape: impl FnOnce(&mut Canvas) -> u32) -> i32 {
    let changed = robot.screen().draw(shape);
    record_drawing(robot, call, changed)
}

/// `LCDArea`
pub fn draw_area(robot: &mut Robot, from: [i32; 2], to: [i32; 2], colour: i32, is_filled: bool) -> i32 {
    let screen = robot.screen();
    let changed =
        if is_filled { screen.fill_area(from, to, rgb(colour)) } else { screen.draw_rectangle(from, to, rgb(colour)) };
    record_drawing(robot, Call::LCDArea, changed)
}

fn record_drawing(robot: &mut Robot, call: Call, changed_pixels: u32) -> i32 {
    robot.record(Event::LcdGraphics { function: call.name(), changed_pixels });
    0
}

/// `LCDImageStart`: sets the position; each image call passes its own size.
pub fn set_image_start(robot: &mut Robot, corner: [i32; 2], [width, height]: [i32; 2]) -> i32 {
    if !is_size([width, height]) {
        return robot.refuse_call(Call::LCDImageStart, 1, |_| format!("{width} x {height} is not a size of an image"));
    }
    robot.screen().set_image_corner(corner);
    0
}

/// Returns true for a size from 1 x 1 up to the pixel count of the largest camera.
fn is_size([width, height]: [i32; 2]) -> bool {
    let max_pixels = RESOLUTIONS.iter().find(|(_, number, ..)| *number == CAM5MP).map_or(0, |(_, _, x, y)| x * y);
    width > 0 && height > 0 && i64::from(width) * i64::from(height) <= max_pixels as i64
}

/// `LCDImage`
pub fn show_colours(robot: &mut Robot, size: [i32; 2], image: Option<&[u8]>) -> i32 {
    show(robot, Call::LCDImage, size, image.map(|image| image.as_chunks::<3>().0.iter().copied()))
}

/// `LCDImageGray`
pub fn show_grey(robot: &mut Robot, size: [i32; 2], image: Option<&[u8]>) -> i32 {
    show(robot, Call::LCDImageGray, size, image.map(|image| image.iter().map(|level| [*level; 3])))
}

/// `LCDImageBinary`: 0 is white, everything else black, as in PBM files.
pub fn show_binary(robot: &mut Robot, size: [i32; 2], image: Option<&[u8]>) -> i32 {
    let colour = |bit: &u8| if *bit == 0 { WHITE } else { [0; 3] };
    show(robot, Call::LCDImageBinary, size, image.map(|image| image.iter().map(colour)))
}

fn show(robot: &mut Robot, call: Call, size: [i32; 2], image: Option<impl Iterator<Item = Rgb>>) -> i32 {
    let Some(image) = image else { return robot.refuse_call(call, 1, |_| "it is given no image".to_owned()) };
    if !is_size(size) {
        return robot.fail_call(call, 1);
    }
    let changed = robot.screen().show_image(size.map(|side| side as usize), image);
    record_drawing(robot, call, changed)
}

/// `LCDRefresh`
pub fn refresh(robot: &mut Robot) -> i32 {
    robot.screen().refresh();
    0
}
