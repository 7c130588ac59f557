//! Fonts of the display: outlines of DejaVu, rasterised by `ab_glyph` into cells of whole pixels.
//!
//! Glyphs are cached for all robots. Coverage uses only additions, multiplications and square roots of `f32`, so that
//! it is the same on every machine.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};

use ab_glyph::{Font as _, FontRef, GlyphId, PxScale, ScaleFont as _, point};
use parking_lot::Mutex;

/// A family of fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Family {
    /// Helvetica, drawn with DejaVu Sans.
    Helvetica,
    /// Times, drawn with DejaVu Serif.
    Times,
    /// Courier, drawn with DejaVu Sans Mono; each character is as wide as a column.
    Courier,
}

/// A variation of a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variation {
    /// Upright.
    Normal,
    /// Bold.
    Bold,
    /// Slanted.
    Italics,
}

/// A text size, with its number for `LCDSetFontSize`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Size {
    /// 8: cells of 5 x 9 pixels.
    Tiny,
    /// 12: cells of 6 x 13 pixels.
    Normal,
    /// 14: cells of 7 x 15 pixels.
    Medium,
    /// 18: cells of 9 x 20 pixels.
    Large,
    /// 24: cells of 12 x 26 pixels.
    Huge,
}

impl Size {
    /// Size with this number for `LCDSetFontSize`.
    pub fn from_number(number: i32) -> Option<Self> {
        match number {
            8 => Some(Self::Tiny),
            12 => Some(Self::Normal),
            14 => Some(Self::Medium),
            18 => Some(Self::Large),
            24 => Some(Self::Huge),
            _ => None,
        }
    }

    /// Width of a column and height of a row in pixels, the same for every font.
    pub fn cell(self) -> [u8; 2] {
        match self {
            Self::Tiny => [5, 9],
            Self::Normal => [6, 13],
            Self::Medium => [7, 15],
            Self::Large => [9, 20],
            Self::Huge => [12, 26],
        }
    }
}

/// Family, variation and size of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Font {
    /// Family.
    pub family: Family,
    /// Variation.
    pub variation: Variation,
    /// Size.
    pub size: Size,
}

/// A character as pixels: as wide as its advance and as high as its font's cell.
#[derive(Debug, PartialEq, Eq)]
pub struct Glyph {
    /// Distance to the next character in pixels.
    pub width: u8,
    /// Coverage of each pixel, rows from the top.
    pub coverage: Box<[u8]>,
}

impl Font {
    /// Glyph of a character; a box for a character that the font lacks.
    pub fn glyph(self, character: char) -> Arc<Glyph> {
        let face = &FACES[&(self.family, self.variation)];
        let id = face.glyph_id(character);
        let mut glyphs = GLYPHS.lock();
        Arc::clone(glyphs.entry((self, id)).or_insert_with(|| Arc::new(self.rasterise(face, id))))
    }

    /// Distance to the next character in pixels.
    pub fn advance(self, character: char) -> u8 {
        match self.family {
            Family::Courier => self.size.cell()[0],
            _ => self.glyph(character).width,
        }
    }

    fn rasterise(self, face: &FontRef<'_>, id: GlyphId) -> Glyph {
        let [column, height] = self.size.cell();
        let scaled_face = face.as_scaled(f32::from(height));
        let advance = scaled_face.h_advance(id);
        let (width, scale) = match self.family {
            // The glyph is squeezed to the width of the column.
            Family::Courier => {
                let squeeze = if advance > 0.0 { f32::from(column) / advance } else { 1.0 };
                (column, PxScale { x: f32::from(height) * squeeze, y: f32::from(height) })
            }
            _ => (advance.round().clamp(0.0, 255.0) as u8, PxScale::from(f32::from(height))),
        };
        let baseline = scaled_face.ascent().round();
        let mut coverage = vec![0; usize::from(width) * usize::from(height)];
        if let Some(outline) = face.outline_glyph(id.with_scale_and_position(scale, point(0.0, baseline))) {
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, part| {
                let (x, y) = (x as i32 + corner.x as i32, y as i32 + corner.y as i32);
                if (0..i32::from(width)).contains(&x) && (0..i32::from(height)).contains(&y) {
                    coverage[y as usize * usize::from(width) + x as usize] = (part.min(1.0) * 255.0 + 0.5) as u8;
                }
            });
        }
        Glyph { width, coverage: coverage.into() }
    }
}

type Glyphs = BTreeMap<(Font, GlyphId), Arc<Glyph>>;
type Faces = BTreeMap<(Family, Variation), FontRef<'static>>;

static FACES: LazyLock<Faces> = LazyLock::new(|| {
    use Family::{Courier, Helvetica, Times};
    use Variation::{Bold, Italics, Normal};
    [
        ((Helvetica, Normal), dejavu::sans::regular()),
        ((Helvetica, Bold), dejavu::sans::bold()),
        ((Helvetica, Italics), dejavu::sans::oblique()),
        ((Times, Normal), dejavu::serif::regular()),
        ((Times, Bold), dejavu::serif::bold()),
        ((Times, Italics), dejavu::serif::italic()),
        ((Courier, Normal), dejavu::sans_mono::regular()),
        ((Courier, Bold), dejavu::sans_mono::bold()),
        ((Courier, Italics), dejavu::sans_mono::oblique()),
    ]
    .into_iter()
    .map(|(key, data)| (key, FontRef::try_from_slice(data).unwrap_or_else(|error| panic!("embedded font: {error}"))))
    .collect()
});

/// Cache of the glyphs drawn for any robot; a font has at most some thousands.
static GLYPHS: LazyLock<Mutex<Glyphs>> = LazyLock::new(Mutex::default);
