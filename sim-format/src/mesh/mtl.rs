//! Wavefront MTL: lines `newmtl`, `Kd`, `d`, `Tr`, `map_Kd`. Our renderer does not use the other lines.

use std::collections::BTreeMap;

use super::mistakes::Mistakes;
use super::obj::{shortened, split_word};
use crate::line::{Line, lines};
use crate::spec::SpannedText;
use crate::{Code, Diagnostic};
use sim_core::scene::Material;

/// Maximum number of materials in a file.
const MAX_MATERIALS: usize = 10_000;

/// Options of `map_Kd` before the name of the image, with their maximum number of values.
const OPTIONS: [(&str, usize); 10] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
];

/// Material, with a reference to an image that is not yet read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) material: Material,
    pub(super) image: Option<SpannedText>,
}

/// Reads all materials of a file, by name; of materials with the same name, the first is used.
pub(super) fn read_mtl(file: &str, text: &str) -> (BTreeMap<String, MtlMaterial>, Vec<Diagnostic>) {
    let mut entries = BTreeMap::new();
    let mut mistakes = Mistakes::new(file);
    let mut current: Option<MtlMaterial> = None;
    for line in lines(text) {
        let (keyword, rest) = split_word(line.text.trim());
        if keyword == "newmtl" {
            add_entry(&mut entries, current.take());
            if entries.len() >= MAX_MATERIALS {
                let message = || format!("more than {MAX_MATERIALS} materials; the rest is left out");
                mistakes.warn(Code::MeshSize, &line, "a smaller file", message);
                break;
            }
            current =
                Some(MtlMaterial { material: Material { name: rest.to_owned(), ..Material::default() }, image: None });
        } else if let Some(entry) = &mut current {
            read_line(entry, &line, keyword, rest, &mut mistakes);
        }
    }
    add_entry(&mut entries, current);
    (entries, mistakes.finish())
}

fn add_entry(entries: &mut BTreeMap<String, MtlMaterial>, entry: Option<MtlMaterial>) {
    if let Some(entry) = entry {
        entries.entry(entry.material.name.clone()).or_insert(entry);
    }
}

fn read_line(entry: &mut MtlMaterial, line: &Line<'_>, keyword: &str, rest: &str, mistakes: &mut Mistakes) {
    let fraction = |word: &str| word.parse::<f32>().ok().filter(|x| x.is_finite()).map(|x| x.clamp(0.0, 1.0));
    let opacity = match keyword {
        "Kd" => {
            let channels: Vec<Option<f32>> = rest.split_whitespace().map(fraction).collect();
            // A single number applies to all three channels.
            match channels[..] {
                [Some(grey)] => entry.material.colour = [grey; 3],
                [Some(red), Some(green), Some(blue), ..] => entry.material.colour = [red, green, blue],
                _ => return warn_of_line(mistakes, line),
            }
            return;
        }
        "d" => fraction(rest.trim_start_matches("-halo").trim()),
        "Tr" => fraction(rest).map(|transparency| 1.0 - transparency),
        "map_Kd" => {
            let name = without_options(rest);
            entry.image = (!name.is_empty()).then(|| SpannedText { text: name.to_owned(), span: line.span() });
            if name.is_empty() {
                warn_of_line(mistakes, line);
            }
            return;
        }
        _ => return,
    };
    match opacity {
        // Exporters of robot models write 0 for opaque materials.
        Some(0.0) => entry.material.opacity = 1.0,
        Some(opacity) => entry.material.opacity = opacity,
        None => warn_of_line(mistakes, line),
    }
}

fn warn_of_line(mistakes: &mut Mistakes, line: &Line<'_>) {
    let expected = "`Kd RED GREEN BLUE`, `d OPACITY` or `Tr TRANSPARENCY` with numbers from 0 to 1, `map_Kd IMAGE`";
    mistakes.warn(Code::MtlLine, line, expected, || format!("`{}` is left out", shortened(line.text)));
}

/// The name of an image, which follows the options and may contain blanks.
fn without_options(mut rest: &str) -> &str {
    loop {
        let (word, remainder) = split_word(rest);
        let Some((_, max_values)) = OPTIONS.iter().find(|(option, _)| *option == word) else { return rest };
        rest = remainder;
        for index in 0..*max_values {
            let (word, remainder) = split_word(rest);
            // The value of an option with one value may be any word; several values are numbers.
            let is_value = index == 0 && *max_values == 1 || word.parse::<f32>().is_ok();
            if !is_value || remainder.is_empty() {
                break;
            }
            rest = remainder;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> BTreeMap<String, MtlMaterial> {
        let (entries, diagnostics) = read_mtl("a.mtl", text);
        assert_eq!(diagnostics, [], "{text}");
        entries
    }

    #[test]
    fn colours_opacity_and_images_are_read() {
        let entries =
            read("# x\nnewmtl Red one\nKa 1 1 1\nKd 1 0.5 0\nd 0.25\nmap_Kd -s 1 1 1 -clamp on my image.png\r\n");
        let entry = &entries["Red one"];
        assert_eq!((entry.material.colour, entry.material.opacity), ([1.0, 0.5, 0.0], 0.25));
        assert_eq!(entry.image.as_ref().map(|image| image.text.as_str()), Some("my image.png"));
        assert_eq!(read("newmtl a\nTr 0.75\n")["a"].material.opacity, 0.25);
        assert_eq!(read("newmtl a\nKd 0.5\n")["a"].material.colour, [0.5; 3]);
        assert_eq!(read("newmtl a\nd 0.0\n")["a"].material.opacity, 1.0, "what exporters write for solid");
        assert_eq!(read("newmtl a\nKd 2 -1 0\n")["a"].material.colour, [1.0, 0.0, 0.0]);
        assert_eq!(read("newmtl a\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n")["a"].material.colour, [1.0, 0.0, 0.0]);
        assert!(read("Kd 1 0 0\n").is_empty(), "no material is open");
    }

    #[test]
    fn unreadable_lines_keep_the_default() {
        for line in ["Kd", "Kd 1 2", "Kd a b c", "Kd NaN 0 0", "d", "d x", "Tr inf", "map_Kd", "map_Kd -s 1"] {
            let (entries, diagnostics) = read_mtl("a.mtl", &format!("newmtl a\n{line}\n"));
            let codes: Vec<_> = diagnostics.iter().map(|d| (d.code.name(), d.span.line)).collect();
            if line == "map_Kd -s 1" {
                continue;
            }
            assert_eq!(codes, [("mtl-line", 2)], "{line}");
            assert_eq!(entries["a"].material, Material { name: "a".into(), ..Material::default() }, "{line}");
        }
    }
}
