//! World files of every kind: detects the kind of a file by extension and content, and reads maps of other programs as
//! worlds.
//!
//! The foreign kinds are occupancy grids of ROS, images, maps of MovingAI and worlds of Gazebo. `maze` reads mazes,
//! `world` reads EyeSim's worlds.

mod grid;
mod movingai;
mod netpbm;
mod print;
mod sdf;
mod yaml;

pub use grid::{Cell, Grid};
pub use movingai::{Scenario, read_scenarios};
pub(crate) use print::{image_file, map_yaml, suite_of_scenarios};

use crate::code::Code;
use crate::diagnostic::Sink;
use crate::load::{Files, InputFile, Loaded, Loader};
use crate::maze::{self, CellRules};
use crate::mesh::{GreyImage, read_grey};
use crate::spec::{DEFAULT_CELL, SceneSpec, SpannedText, WorldKind, WorldSpec};
use crate::unit::mm_from_metres;
use crate::{FileError, Span, line, path, read_maze_with, read_world};
use netpbm::{Image, is_netpbm, read_netpbm};
use yaml::MapSpec;

/// Default side of the pixels of an image without a `map.yaml`, in metres: the value that map servers write.
pub const DEFAULT_RESOLUTION: f64 = 0.05;

/// Extensions of files that are worlds, in lower case.
pub const WORLD_EXTENSIONS: [&str; 11] =
    ["wld", "maz", "maze", "num", "map", "yaml", "yml", "pgm", "pbm", "world", "sdf"];

/// Kind of a world file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorldFormat {
    /// Lines that describe walls, `.wld`.
    Walls,
    /// A maze, in one of the formats of maze files.
    Maze(maze::MazeFormat),
    /// A `map.yaml` with its image.
    RosMap,
    /// The image of a map without a `map.yaml`.
    Image,
    /// A map of the MovingAI benchmarks.
    MovingAi,
    /// A world of Gazebo.
    Sdf,
}

impl WorldFormat {
    /// Kind of the file `path` with these `bytes`; `stated` applies if neither path nor content determines the kind.
    pub(crate) fn of(path: &str, bytes: &[u8], stated: WorldKind) -> Self {
        let text = || String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).into_owned();
        let is_xml = || text().trim_start_matches('\u{feff}').trim_start().starts_with('<');
        match path::extension(path).as_str() {
            "yaml" | "yml" => Self::RosMap,
            "pgm" | "pbm" => Self::Image,
            "sdf" => Self::Sdf,
            "world" if is_xml() => Self::Sdf,
            "wld" => Self::Walls,
            "map" if movingai::is_map(&text()) => Self::MovingAi,
            "maz" | "maze" | "num" | "map" | "txt" => Self::Maze(maze::format_of(bytes)),
            _ if is_netpbm(bytes) => Self::Image,
            _ if is_xml() => Self::Sdf,
            _ => match stated {
                WorldKind::World => Self::Walls,
                WorldKind::Maze => Self::Maze(maze::format_of(bytes)),
            },
        }
    }

    /// Returns true if a scene can state the size of the cells of files with this extension.
    pub(crate) fn may_have_cells(path: &str) -> bool {
        matches!(path::extension(path).as_str(), "maz" | "maze" | "num" | "map" | "txt" | "pgm" | "pbm")
    }
}

/// Reads the world file `path` with all files that it refers to.
pub(crate) fn read_world_file(
    loader: &mut Loader<'_>,
    path: &str,
    bytes: Vec<u8>,
    stated: WorldKind,
    rules: CellRules,
) -> WorldSpec {
    let format = WorldFormat::of(path, &bytes, stated);
    let (world, note) = match format {
        WorldFormat::Walls => {
            let text = loader.decode_input(path, bytes);
            let (world, diagnostics) = read_world(path, &text);
            loader.diagnostics.extend(diagnostics);
            (world, None)
        }
        WorldFormat::Maze(maze::MazeFormat::Drawing) => {
            let text = loader.decode_input(path, bytes);
            let (world, diagnostics) = read_maze_with(path, &text, rules);
            loader.diagnostics.extend(diagnostics);
            (world, None)
        }
        WorldFormat::Maze(maze_format) => {
            let (world, diagnostics, note) = if maze_format == maze::MazeFormat::Binary {
                loader.inputs.push(InputFile { path: path.to_owned(), bytes: bytes.clone() });
                maze::read_maze_bytes(path, &bytes, rules)
            } else {
                let text = loader.decode_input(path, bytes);
                maze::read_maze_text(path, &text, maze_format, rules)
            };
            loader.diagnostics.extend(diagnostics);
            (world, note)
        }
        WorldFormat::Sdf => {
            let text = loader.decode_input(path, bytes);
            let mut sink = Sink::new(path);
            let (world, note) = sdf::read_sdf(&mut sink, path, &text);
            loader.diagnostics.extend(sink.finish());
            (world, Some(note))
        }
        WorldFormat::RosMap | WorldFormat::Image | WorldFormat::MovingAi => {
            match read_grid(loader, path, bytes, format, rules) {
                Some(grid) => world_from_grid(loader, path, &grid),
                None => (WorldSpec { file: path.to_owned(), ..WorldSpec::default() }, None),
            }
        }
    };
    loader.notes.extend(note.map(|note| format!("{path}: {note}")));
    world
}

/// The world of a grid, and a note on its interpretation.
fn world_from_grid(loader: &mut Loader<'_>, path: &str, grid: &Grid) -> (WorldSpec, Option<String>) {
    let Some((world, offset)) = grid.world(path) else {
        let mut sink = Sink::new(path);
        let message = format!("the map has more than {} walls", grid::MAX_WALLS);
        let expected = "a map with less noise: the border of each single cell is up to four walls";
        sink.error(Code::MapSize, Span::default(), message, expected);
        loader.diagnostics.extend(sink.finish());
        return (WorldSpec { file: path.to_owned(), ..WorldSpec::default() }, None);
    };
    let [columns, rows] = grid.size;
    let mut note = format!(
        "{columns} x {rows} cells of {} mm: {} free, {} occupied, {} unknown; {} walls",
        rounded_mm(grid.cell),
        grid.count(Cell::Free),
        grid.count(Cell::Occupied),
        grid.count(Cell::Unknown),
        world.walls.len(),
    );
    note.push_str(&origin_note(offset));
    (world, Some(note))
}

/// Text of a note with the position of the origin of a file's frame in the world; empty at the world's origin.
pub(crate) fn origin_note(offset: glam::DVec2) -> String {
    let [x, y] = offset.to_array().map(rounded_mm);
    if x == 0.0 && y == 0.0 {
        return String::new();
    }
    format!("; (0, 0) of the file is at ({x}, {y}) mm of the world")
}

/// A length in millimetres, rounded to a micrometre.
pub(crate) fn rounded_mm(metres: f64) -> f64 {
    (mm_from_metres(metres) * 1e3).round() / 1e3 + 0.0
}

/// Reads the grid of the file `path`, whose `format` must have a grid; `None`, with an error, if it cannot be read.
pub(crate) fn read_grid(
    loader: &mut Loader<'_>,
    path: &str,
    bytes: Vec<u8>,
    format: WorldFormat,
    rules: CellRules,
) -> Option<Grid> {
    let mut sink = Sink::new(path);
    let grid = match format {
        WorldFormat::MovingAi => {
            let text = loader.decode_input(path, bytes);
            movingai::read_map(&mut sink, &text, rules.cell.unwrap_or(DEFAULT_CELL))
        }
        WorldFormat::Image => {
            let spec = MapSpec::of_image(rules.cell.unwrap_or(DEFAULT_RESOLUTION));
            let image = read_image(&mut sink, &bytes, &spec);
            loader.inputs.push(InputFile { path: path.to_owned(), bytes });
            image.map(|image| spec.grid(&image))
        }
        _ => {
            let text = loader.decode_input(path, bytes);
            let spec = yaml::read_map_yaml(&mut sink, &text);
            loader.diagnostics.extend(std::mem::replace(&mut sink, Sink::new(path)).finish());
            spec.and_then(|spec| {
                let (image_path, bytes) = loader.find(path, path::folder_of(path), &spec.image)?;
                sink = Sink::new(&image_path);
                let image = read_image(&mut sink, &bytes, &spec);
                loader.inputs.push(InputFile { path: image_path, bytes });
                image.map(|image| spec.grid(&image))
            })
        }
    };
    loader.diagnostics.extend(sink.finish());
    grid
}

/// Decodes the image of a map.
fn read_image(sink: &mut Sink, bytes: &[u8], spec: &MapSpec) -> Option<Image> {
    let is_not_netpbm = matches!(bytes, [0x89, b'P', b'N', b'G', ..] | [0xff, 0xd8, ..] | [b'B', b'M', ..]);
    if !is_not_netpbm {
        return read_netpbm(sink, bytes);
    }
    // map_server averages the opacity with the colours only in this mode.
    match read_grey(bytes, spec.mode == yaml::Mode::Trinary) {
        Ok(GreyImage { size, levels, white, max_grey, is_transparent }) => {
            Some(Image { size, levels, white, max_grey, is_transparent })
        }
        Err(message) => {
            sink.error(Code::MapImage, Span::default(), message, "a pgm, pbm, png, bmp or jpg image");
            None
        }
    }
}

/// Reads the scenarios of a `.scen` and compares their lengths with the shortest paths on their maps. The scene of the
/// result is empty.
pub fn load_scenarios(file: &str, files: &dyn Files) -> (Vec<Scenario>, Loaded) {
    let mut loader = Loader::new(files);
    let scene = SceneSpec { file: file.to_owned(), ..SceneSpec::default() };
    let Some(text) = loader.read_root(file) else { return (Vec::new(), loader.finish(scene)) };
    let (scenarios, diagnostics) = read_scenarios(file, &text);
    loader.diagnostics.extend(diagnostics);
    let mut maps: Vec<&str> = scenarios.iter().map(|scenario| scenario.map.as_str()).collect();
    maps.sort_unstable();
    maps.dedup();
    for map in maps {
        let map_scenarios: Vec<Scenario> = scenarios.iter().filter(|scenario| scenario.map == map).cloned().collect();
        let Some((map_path, bytes)) = find_map(&mut loader, file, map, map_scenarios[0].span) else { continue };
        let Some(grid) = read_grid(&mut loader, &map_path, bytes, WorldFormat::MovingAi, CellRules::default()) else {
            continue;
        };
        let mut sink = Sink::new(file);
        let matching = movingai::check_lengths(&mut sink, &grid, &map_scenarios);
        loader.diagnostics.extend(sink.finish());
        let count = map_scenarios.len();
        loader.notes.push(format!("{file}: {matching} of {count} lengths are those of shortest paths on `{map_path}`"));
    }
    (scenarios, loader.finish(scene))
}

/// Finds the map of a scenario: at its stated path, otherwise beside the scenarios.
pub(crate) fn find_map(loader: &mut Loader<'_>, file: &str, map: &str, span: Span) -> Option<(String, Vec<u8>)> {
    let folder = path::folder_of(file);
    let beside = path::join(folder, path::file_name(map));
    let named = path::candidates(map, folder, loader.files.home());
    for path in named.iter().chain([&beside]) {
        match loader.files.read(path) {
            Ok(bytes) => return Some((path.clone(), bytes)),
            Err(FileError::Missing) => {}
            Err(_) => break,
        }
    }
    loader.find(file, folder, &SpannedText { text: map.to_owned(), span })
}

/// Span of `length` bytes from `index` in a file that may not be text. It is empty unless all bytes up to its end are
/// UTF-8 without a byte order mark.
fn span_of_bytes(bytes: &[u8], index: usize, length: usize) -> Span {
    let end = (index + length).min(bytes.len());
    let Ok(text) = std::str::from_utf8(&bytes[..end]) else { return Span::default() };
    if text.starts_with('\u{feff}') || !text.is_char_boundary(index) {
        return Span::default();
    }
    let starts = line::line_starts(text);
    let number = starts.partition_point(|start| *start <= index);
    let line_text = &text[starts[number - 1]..index];
    Span { start: index, end, line: number as u32, column: line_text.chars().count() as u32 + 1 }
}

/// Text ` at byte N` for a location without a line; empty for other locations.
fn byte_suffix(bytes: &[u8], index: usize) -> String {
    if span_of_bytes(bytes, index, 0).line > 0 { String::new() } else { format!(" at byte {index}") }
}
