use proptest::prelude::*;

use super::canvas::{BLACK, Canvas, Ink, Rgb, WHITE, code, rgb};
use super::font::{Family, Font, Size, Variation};
use super::list::ListLine;
use super::menu::MenuLabel;
use super::*;

const RED: Rgb = [255, 0, 0];
const BLUE: Rgb = [0, 0, 255];

fn written(text: &str) -> Screen {
    let mut screen = Screen::new([320, 240]);
    screen.write(text);
    screen
}

/// Draws a shape in white on a canvas of 20 x 12 pixels: number of changed pixels, and the canvas as text art.
fn art(shape: impl FnOnce(&mut Canvas) -> u32) -> (u32, String) {
    let mut canvas = Canvas::new(20, 12, BLACK);
    let changed = shape(&mut canvas);
    let rows = canvas.pixels().chunks(20).map(|row| row.iter().map(|pixel| if *pixel == BLACK { '.' } else { '#' }));
    (changed, rows.map(|row| row.collect::<String>().trim_end_matches('.').to_owned() + "\n").collect())
}

fn count(text: &str) -> u32 {
    text.matches('#').count() as u32
}

#[test]
fn colours_are_0xrrggbb() {
    assert_eq!([rgb(0x12_3456), rgb(-1)], [[0x12, 0x34, 0x56], WHITE]);
    assert_eq!(code([0x12, 0x34, 0x56]), 0x12_3456);
}

#[test]
fn lines_are_the_same_in_both_directions_and_clipped_at_the_edges() {
    let ink = Ink::Colour(WHITE);
    let (changed, shown) = art(|canvas| canvas.draw_line([0, 0], [6, 2], ink));
    assert_eq!((changed, shown.as_str()), (7, "##\n..###\n.....##\n\n\n\n\n\n\n\n\n\n"));
    assert_eq!(art(|canvas| canvas.draw_line([6, 2], [0, 0], ink)).1, shown);
    assert_eq!(art(|canvas| canvas.draw_line([i32::MIN, 5], [i32::MAX, 5], ink)).0, 20);
    assert_eq!(art(|canvas| canvas.draw_line([3, i32::MIN], [3, i32::MAX], ink)).0, 12);
    assert_eq!(art(|canvas| canvas.draw_line([i32::MIN; 2], [i32::MAX; 2], ink)).0, 12, "the diagonal");
    assert_eq!(art(|canvas| canvas.draw_line([20, 0], [40, 12], ink)).0, 0);
}

#[test]
fn areas_include_their_edges_for_any_order_of_corners() {
    let ink = Ink::Colour(WHITE);
    assert_eq!(art(|canvas| canvas.fill_area([2, 1], [5, 3], ink)).0, 4 * 3);
    assert_eq!(art(|canvas| canvas.fill_area([5, 3], [2, 1], ink)).0, 4 * 3);
    assert_eq!(art(|canvas| canvas.draw_rectangle([2, 1], [5, 3], ink)).0, 2 * 4 + 2);
    assert_eq!(art(|canvas| canvas.draw_rectangle([2, 1], [2, 3], ink)).0, 3);
    assert_eq!(art(|canvas| canvas.draw_rectangle([2, 1], [2, 1], Ink::Invert)).0, 1, "inverted once, not twice");
    assert_eq!(art(|canvas| canvas.fill_area([i32::MIN; 2], [i32::MAX; 2], ink)).0, 240);
    assert_eq!(art(|canvas| canvas.draw_rectangle([i32::MIN; 2], [i32::MAX; 2], ink)).0, 0);
}

#[test]
fn a_circle_is_round_without_gaps() {
    let ink = Ink::Colour(WHITE);
    insta::assert_snapshot!(art(|canvas| canvas.draw_circle([9, 5], 5, ink)).1);
    let (changed, shown) = art(|canvas| canvas.draw_circle([9, 5], 5, Ink::Invert));
    assert_eq!(changed, count(&shown), "each pixel once");
    let (_, disk) = art(|canvas| canvas.fill_circle([9, 5], 5, ink));
    // Centres within 5.5: 11 columns, and pi 5.5^2 pixels within the rim.
    assert!((count(&disk) as f64 - 95.0).abs() < 4.0, "{disk}");
    assert_eq!(art(|canvas| canvas.fill_circle([9, 5], 0, ink)).0, 1);
    assert_eq!(art(|canvas| canvas.draw_circle([9, 5], 0, ink)).0, 1);
    assert_eq!(art(|canvas| canvas.fill_circle([9, 5], -1, ink)).0, 0);
    // A circle so large that its rim is a straight line on the canvas.
    assert_eq!(art(|canvas| canvas.draw_circle([i32::MIN + 7, 5], i32::MAX, ink)).0, 12);
    assert_eq!(art(|canvas| canvas.draw_circle([i32::MAX - 5, 5], i32::MAX - 10, ink)).0, 12);
    assert_eq!(art(|canvas| canvas.fill_circle([0, 0], i32::MAX, ink)).0, 240);
}

proptest! {
    #[test]
    fn a_rim_is_the_edge_of_its_disk(radius in 0..40, x in -10..30, y in -10..22) {
        let (_, rim) = art(|canvas| canvas.draw_circle([x, y], radius, Ink::Colour(WHITE)));
        let mut both = Canvas::new(20, 12, BLACK);
        both.fill_circle([x, y], radius, Ink::Colour(WHITE));
        let added = both.draw_circle([x, y], radius, Ink::Colour(WHITE));
        prop_assert_eq!(added, 0, "the rim lies in the disk");
        for row in 0..12 {
            for column in 0..20 {
                let inside = |x: i32, y: i32| both.pixel(x, y).is_none_or(|pixel| pixel == WHITE);
                let is_rim = rim.lines().nth(row as usize).unwrap().chars().nth(column as usize) == Some('#');
                let is_inner = [(1, 0), (-1, 0), (0, 1), (0, -1)].iter().all(|(dx, dy)| inside(column + dx, row + dy));
                let is_at_edge = column == 0 || row == 0 || column == 19 || row == 11;
                prop_assert!(is_at_edge || !(is_rim && is_inner), "({column}, {row}) is not on the edge");
            }
        }
    }

    /// The visible display does not depend on when its pixels are allocated.
    #[test]
    fn the_display_does_not_depend_on_when_pixels_are_allocated(steps in proptest::collection::vec((0..9, 0..60, 0..25, ".{0,12}"), 0..40)) {
        let (mut lazy, mut eager) = (Screen::new([320, 240]), Screen::new([320, 240]));
        for (kind, a, b, text) in &steps {
            eager.draw(|_| 0);
            for screen in [&mut lazy, &mut eager] {
                match kind {
                    0..4 => {
                        screen.set_position(*b, *a);
                        screen.write(text);
                    }
                    4 => screen.write(&format!("{text}\n")),
                    5 => screen.set_font_size([Size::Tiny, Size::Normal, Size::Huge][*a as usize % 3]),
                    6 => screen.set_font([Family::Courier, Family::Times][*a as usize % 2], Variation::Normal),
                    7 => screen.set_colours([*a as u8 * 4, 200, 0], [0, *b as u8 * 8, 90]),
                    _ => screen.modes.is_transparent = *a % 3 == 0,
                }
            }
        }
        prop_assert_eq!(lazy.lines(), eager.lines());
        prop_assert!(lazy.picture() == eager.picture());
    }

    #[test]
    fn nothing_panics(
        numbers in proptest::collection::vec(
            prop_oneof![any::<i32>(), -5..400, Just(i32::MAX), Just(i32::MIN)], 12
        ),
        text in ".{0,80}",
    ) {
        let mut screen = Screen::new([64, 64]);
        let [a, b, c, d, ..] = numbers[..] else { unreachable!("twelve numbers") };
        screen.set_position(a, b);
        screen.write(&text);
        screen.write("\n\t\x08\r x");
        _ = (screen.position(), screen.pixel(a, b), screen.key_at([c, d]));
        for ink in [Ink::Invert, Ink::Colour(RED)] {
            screen.draw(|canvas| canvas.draw_line([a, b], [c, d], ink));
            screen.draw(|canvas| canvas.draw_rectangle([a, b], [c, d], ink));
            screen.draw(|canvas| canvas.draw_circle([a, b], c, ink));
            screen.draw(|canvas| canvas.fill_circle([a, b], c, ink));
        }
        screen.fill_area([a, b], [c, d], RED);
        screen.set_image_corner([a, b]);
        screen.show_image([c, d].map(|side| side.unsigned_abs() as usize), std::iter::repeat_n(BLUE, 5000));
        screen.set_menu_text(a as usize, &text);
        screen.lines();
        screen.picture();
    }
}

#[test]
fn a_robot_that_only_prints_needs_no_pixels() {
    let mut screen = Screen::new([320, 240]);
    for row in 0..100 {
        screen.write(&format!("row {row}\n"));
        screen.set_position(3, 7);
        screen.write("again");
        screen.set_position(16, 0);
    }
    screen.set_menu_text(0, "GO");
    assert!(screen.content.page.has_only_text());
    screen.fill_area([0, 0], [1, 1], RED);
    assert!(!screen.content.page.has_only_text());
    screen.clear();
    assert!(screen.content.page.has_only_text(), "a cleared display is black again");
    assert_eq!(screen.lines(), ["GO |  |  |"]);
}

#[test]
fn text_is_placed_in_rows_and_columns() {
    let mut screen = written("one\ntwo\t|\rTWO");
    assert_eq!(screen.lines(), ["one", "TWO |", ""]);
    assert_eq!(screen.position(), [1, 3]);
    screen.set_position(5, 10);
    screen.write("x = 3");
    assert_eq!(screen.lines(), ["one", "TWO |", "", "", "", "          x = 3", ""]);
    screen.set_position(5, 10);
    screen.write("y\x08z");
    assert_eq!(screen.lines()[5], "          z = 3");
    // 53 columns of 6 pixels are 318: further text goes to the next row.
    let mut screen = written(&"0123456789".repeat(6));
    assert_eq!(screen.lines()[1], "3456789");
    screen.modes.has_linefeed = false;
    screen.set_position(2, 50);
    screen.write("abcdef");
    assert_eq!(screen.lines()[2].trim_start(), "abc");
    screen.set_position(-1, -1);
    screen.write("unseen");
    screen.set_position(i32::MAX, i32::MAX);
    screen.write("unseen");
    assert_eq!(screen.lines().len(), 4);
}

#[test]
fn text_outside_the_display_changes_nothing() {
    let mut screen = written("A\nB\tC");
    let before = screen.lines();
    // The display has 18 rows and 53 columns.
    for [row, column] in [[0, 53], [0, 90], [18, 0], [30, 0], [-1, 60]] {
        screen.set_position(row, column);
        assert_eq!(screen.position(), [row, column]);
        screen.write("HELLO");
        assert_eq!(screen.lines(), before, "({row}, {column})");
    }
    screen.set_position(30, 0);
    screen.write("HELLO\nHELLO\n");
    assert_eq!(screen.lines(), before, "it does not scroll");
    screen.set_position(0, 90);
    screen.write("HELLO\n\tx");
    assert_eq!(screen.lines()[1], "B   x", "the next row is on the display");
}

#[test]
fn text_scrolls_above_the_menu() {
    let rows = |screen: &mut Screen| (0..20).for_each(|row| screen.write(&format!("\n{row}")));
    // 240 / 13 = 18 rows; with the menu 16.
    let mut screen = Screen::new([320, 240]);
    rows(&mut screen);
    let lines = screen.lines();
    assert_eq!((lines.len(), lines[0].as_str(), lines[17].as_str()), (19, "2", "19"));
    let mut screen = Screen::new([320, 240]);
    screen.set_menu_text(3, "END");
    rows(&mut screen);
    let lines = screen.lines();
    assert_eq!((lines.len(), lines[0].as_str(), lines[15].as_str()), (17, "4", "19"));
    assert_eq!(lines[16], " |  |  | END");
    screen.modes.is_scrolling = false;
    screen.write("\ntop");
    assert_eq!(screen.lines()[0], "top");
}

#[test]
fn pixels_scroll_with_the_text() {
    let mut screen = Screen::new([320, 240]);
    screen.fill_area([100, 13], [110, 25], RED);
    screen.set_position(17, 0);
    screen.write("\n");
    assert_eq!([screen.pixel(105, 0), screen.pixel(105, 12), screen.pixel(105, 13)], [RED, RED, BLACK]);
}

#[test]
fn glyphs_stay_within_their_cells() {
    let font = |family, size| Font { family, variation: Variation::Normal, size };
    for size in [Size::Tiny, Size::Normal, Size::Medium, Size::Large, Size::Huge] {
        let [column, row] = size.cell();
        for character in (' '..='~').chain("äÅ€".chars()) {
            let glyph = font(Family::Courier, size).glyph(character);
            assert_eq!((glyph.width, glyph.coverage.len()), (column, usize::from(column) * usize::from(row)));
            assert_eq!(glyph.coverage.iter().any(|part| *part > 60), character != ' ', "{character:?} {size:?}");
        }
        let advance = |character| font(Family::Helvetica, size).advance(character);
        assert!(advance('W') > advance('a') && advance('a') > advance('i'), "proportional");
    }
}

#[test]
fn the_rasteriser_draws_the_same_everywhere() {
    let glyph = Font { family: Family::Times, variation: Variation::Bold, size: Size::Huge }.glyph('R');
    let rows = glyph.coverage.chunks(glyph.width.into());
    let shades: String =
        rows.map(|row| row.iter().map(|part| format!("{part:02x}")).collect::<String>() + "\n").collect();
    insta::assert_snapshot!(shades);
}

#[test]
fn colours_and_modes_of_text() {
    // A full block covers its whole cell.
    let mut screen = Screen::new([320, 240]);
    screen.set_colours(RED, BLUE);
    screen.write("\u{2588} ");
    assert_eq!([screen.pixel(3, 6), screen.pixel(9, 6)], [RED, BLUE]);
    screen.set_position(0, 0);
    screen.modes = Modes { is_ink_inverse: true, is_paper_inverse: true, ..Modes::default() };
    screen.write("\u{2588} ");
    assert_eq!([screen.pixel(3, 6), screen.pixel(9, 6)], [[0, 255, 255], [255, 255, 0]]);
    screen.modes = Modes { is_transparent: true, ..Modes::default() };
    screen.fill_area([0, 0], [20, 20], WHITE);
    screen.set_position(0, 0);
    screen.write(". ");
    assert_eq!([screen.pixel(0, 0), screen.pixel(9, 6)], [WHITE, WHITE], "the dot stands on what was there");
    assert_eq!(screen.lines()[0], ".");
}

#[test]
fn drawing_over_text_removes_it() {
    let mut screen = written("one\ntwo\nthree");
    screen.fill_area([319, 25], [0, 13], BLACK);
    assert_eq!(screen.lines(), ["one", "", "three", ""]);
    screen.set_image_corner([0, 26]);
    assert_eq!(screen.show_image([12, 13], std::iter::repeat(RED)), 12 * 13);
    assert_eq!(screen.lines(), ["one", "", "  ree", ""]);
}

#[test]
fn images_appear_at_the_set_corner() {
    let mut screen = Screen::new([320, 240]);
    screen.set_image_corner([318, 238]);
    let image = (0..12).map(|index| [index + 1, 0, 0]);
    assert_eq!(screen.show_image([4, 3], image), 4, "what is outside is left out");
    assert_eq!([screen.pixel(318, 238), screen.pixel(319, 239)], [[1, 0, 0], [6, 0, 0]]);
    assert_eq!(screen.show_image([2, 2], [WHITE].into_iter()), 1, "an image that is too short");
}

#[test]
fn the_menu_covers_all_drawing() {
    let mut screen = Screen::new([320, 240]);
    screen.fill_area([0, 0], [319, 239], BLUE);
    assert_eq!(screen.pixel(5, 210), BLUE);
    screen.set_menu_text(0, "GO");
    screen.set_menu_colours(1, WHITE, RED);
    assert_eq!([screen.pixel(5, 210), screen.pixel(85, 210), screen.pixel(5, 207)], [RED, RED, BLUE]);
    screen.set_menu_shown(false);
    assert_eq!(screen.pixel(5, 210), BLUE);
}

#[test]
fn a_touch_of_a_menu_field_presses_its_key() {
    let screen = Screen::new([320, 240]);
    let keys = [[0, 208], [79, 239], [80, 220], [240, 220], [319, 239]].map(|point| screen.key_at(point));
    assert_eq!(keys, [Some(0), Some(0), Some(1), Some(3), Some(3)]);
    for point in [[0, 207], [-1, 220], [320, 220], [5, 240]] {
        assert_eq!(screen.key_at(point), None);
    }
    assert!((0..4).all(|index| screen.key_at(screen.key_centre(index)) == Some(index)));
    let odd = Screen::new([131, 99]);
    assert!((0..4).all(|index| odd.key_at(odd.key_centre(index)) == Some(index)));
}

#[test]
fn a_list_covers_the_text_and_its_lines_are_keys() {
    let line = |text: &str, key| Some(ListLine { entry: MenuLabel { text: text.into(), ink: WHITE, paper: RED }, key });
    let mut screen = written("below");
    assert!(!screen.set_list_line(1, line("no line above", 1)));
    assert!(screen.set_list_line(0, line("title", 7)) && screen.set_list_line(1, line("one", 16)));
    assert!(screen.set_list_line(2, line("two", 32)) && screen.set_list_line(1, line("ONE", 16)));
    assert_eq!(screen.lines(), ["title", "ONE", "two", ""]);
    assert_eq!([screen.pixel(310, 10), screen.pixel(310, 77), screen.pixel(310, 78)], [RED, BLACK, BLACK]);
    let keys = [[0, 0], [319, 25], [5, 26], [5, 77], [5, 78], [320, 30], [5, -1]].map(|at| screen.list_key_at(at));
    assert_eq!(keys, [7, 7, 16, 32, 0, 0, 0]);
    // (240 - 32) / 26
    assert_eq!(screen.max_list_lines(), 8);
    (3..8).for_each(|index| assert!(screen.set_list_line(index, line("", 0))));
    assert!(!screen.set_list_line(8, line("no room", 0)));
    assert!(screen.set_list_line(1, None));
    assert_eq!(screen.lines(), ["title", ""]);
    screen.set_list_shown(false);
    assert_eq!((screen.lines(), screen.list_key_at([5, 5])), (vec!["below".to_owned(), String::new()], 0));
}

#[test]
fn without_automatic_refresh_changes_appear_at_the_refresh() {
    let mut screen = written("a");
    screen.set_auto_refresh(false);
    screen.write("b");
    assert_eq!(screen.lines(), ["a", ""]);
    screen.refresh();
    assert_eq!(screen.lines(), ["ab", ""]);
    screen.write("c");
    screen.set_auto_refresh(false);
    assert_eq!(screen.lines(), ["ab", ""], "still held");
    screen.set_auto_refresh(true);
    assert_eq!(screen.lines(), ["abc", ""]);
}
