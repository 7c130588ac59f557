//! Printing of worlds as `.wld`.

use std::fmt::Write;

use super::LOOKS;
use super::Printed;
use super::number::{heading, written, written_mm};
use super::sim::quoted;
use crate::spec::{DEFAULT_WALL_HEIGHT, LooksSpec, WallSpec, WorldSpec};

/// Text of a world file. All walls are in the world frame; there are no `push` lines.
pub fn print_world(world: &WorldSpec) -> Printed {
    let mut out = Printed::default();
    let [width, height] = world.floor.to_array().map(written_mm);
    let _ = writeln!(out.text, "floor {width} {height}");
    if let Some(texture) = &world.texture {
        match quoted(&texture.text) {
            _ if !world.texture_is_turned => {
                out.lost.push(format!("the texture `{}`, which a .wld would turn by 180 degrees", texture.text));
            }
            Some(word) => drop(writeln!(out.text, "floor_texture {word}")),
            None => out.lost.push(format!("the texture `{}`", texture.text)),
        }
    }
    if let Some(depth) = world.water {
        let _ = writeln!(out.text, "water {}", written_mm(depth));
    }
    for start in &world.starts {
        let [x, y] = start.pose.position.to_array().map(written_mm);
        let _ = writeln!(out.text, "position {x} {y} {}", written(heading(start.pose.heading)));
    }
    world.walls.iter().for_each(|wall| wall_line(&mut out.text, wall));
    let letters = world.starts.iter().filter(|start| start.letter.is_some()).count();
    let lost_properties = [
        (world.cell.is_some(), "the size of the maze's cells".to_owned()),
        (letters > 0, format!("the letters of {letters} starts")),
        (world.surface.is_some(), "the surface of floor and walls".to_owned()),
        (world.walls.iter().any(|wall| wall.surface.is_some()), "the surfaces of single walls".to_owned()),
        (world.terrain.is_some(), "the terrain".to_owned()),
        (world.looks != LooksSpec::default(), LOOKS.to_owned()),
        (!world.objects.is_empty(), format!("{} objects", world.objects.len())),
    ];
    out.lost.extend(lost_properties.into_iter().filter(|(is_lost, _)| *is_lost).map(|(_, property)| property));
    out
}

fn wall_line(text: &mut String, wall: &WallSpec) {
    let ends = [wall.from.x, wall.from.y, wall.to.x, wall.to.y].map(written_mm);
    let _ = write!(text, "{}", ends.join(" "));
    if wall.thickness != 0.0 || wall.height.total_cmp(&DEFAULT_WALL_HEIGHT).is_ne() || wall.colour.is_some() {
        let _ = write!(text, " {} {}", written_mm(wall.thickness), written_mm(wall.height));
    }
    if let Some([red, green, blue]) = wall.colour {
        let _ = write!(text, " {red} {green} {blue}");
    }
    text.push('\n');
}
