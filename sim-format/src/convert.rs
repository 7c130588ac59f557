//! Conversion between file formats: scenes between `.sim` and TOML; worlds, mazes and types to sections of TOML and
//! back.

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::load::{Files, Loaded, Loader, load_with_spec};
use super::map::{self, Cell, DEFAULT_RESOLUTION, Grid, WorldFormat, load_scenarios};
use super::print::{self, Printed};
use super::spec::{
    CheckKind, DEFAULT_CELL, Dialect, Layout, LooksSpec, ObjectLine, RobotLine, RobotSpec, SceneFormat, SceneSpec,
    SimSpec, SpannedText, StartRef, StartSpec, TypeRef, WorldKind, WorldLine, WorldSpec,
};
use sim_core::RobotId;
use sim_core::pose::Pose;

use super::suite::SUITE_EXTENSION;
use super::{
    CellRules, Overrides, Span, decode, load_object, load_robi, load_scene, load_world_with, path, read_scene,
    read_sim, scene,
};
use sim_core::unit;

/// Generation of a program for which neither its calls nor the scene determine one.
const DEFAULT_GENERATION: u32 = 6;

/// A file that a conversion writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Path of the file.
    pub path: String,
    /// Content of the file: text, except for the images of maps.
    pub bytes: Vec<u8>,
}

impl Output {
    /// The content as text; bytes that are not UTF-8 are replaced.
    pub fn text(&self) -> String {
        decode(&self.bytes).0
    }
}

/// Result of a conversion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Converted {
    /// The requested file, then the files that it refers to. Empty if there are errors.
    pub outputs: Vec<Output>,
    /// Mistakes in the source, and a warning for each property that the target format cannot represent.
    pub diagnostics: Vec<Diagnostic>,
    /// The source and all files that it refers to.
    pub inputs: Vec<super::InputFile>,
    /// Notes on the interpretation of maps and mazes of other programs, a line each.
    pub notes: Vec<String>,
}

/// Values that a conversion takes from its caller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConvertOptions {
    /// Seed with which random values of a scene are drawn, instead of the scene's seed.
    pub seed: Option<u64>,
    /// Side of the cells of a source that is a maze, a map of MovingAI or an image, in metres, which overrides the
    /// file.
    pub maze_cell: Option<f64>,
    /// Side of the cells of a map that is made from walls, in metres.
    pub map_cell: Option<f64>,
}

/// Robot or movable object in a running world.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveEntity {
    /// Number of the robot or of the movable object.
    pub number: u32,
    /// Name of its type.
    pub kind: String,
    /// Current pose.
    pub pose: Pose,
}

/// Text of the scene `from` in TOML, with the state of a run.
///
/// Robots and movable objects are placed at their current poses. Spawned ones are included, removed ones are not. A
/// spawned robot has no program. Robots are renumbered without gaps.
///
/// References are relative to the scene's folder. Objects placed by the world's file stay at their original poses.
///
/// # Errors
/// The diagnostics, if the scene cannot be read.
pub fn print_current_scene(
    from: &str,
    files: &dyn Files,
    robots: &[LiveEntity],
    objects: &[LiveEntity],
) -> Result<String, Vec<Diagnostic>> {
    let loaded = load_scene(from, files);
    if loaded.has_errors() {
        return Err(loaded.diagnostics);
    }
    let mut sim = {
        let options = ConvertOptions::default();
        Conversion { from, to: from, files, options, sink: Sink::new(from), outputs: Vec::new() }.read_source()
    };
    sort_named_lines(&mut sim, &loaded.scene);
    if sim.world.is_none() && sim.inline.world.is_none() {
        sim.inline.world = Some(loaded.scene.world.clone());
    }
    // Robot numbers must be contiguous.
    let ids = (0..).map(RobotId::from_index);
    let lines =
        ids.zip(robots).map(|(id, robot)| RobotLine { id: Some(id), ..line_of_robot(robot, &sim, &loaded.scene) });
    sim.robots = lines.collect();
    place_objects(&mut sim, &loaded.scene, objects);
    Ok(print::print_scene(&sim))
}

/// Scene line of a robot at its current pose.
fn line_of_robot(robot: &LiveEntity, sim: &SimSpec, scene: &SceneSpec) -> RobotLine {
    let spec = scene.robots.iter().find(|spec| spec.id == RobotId(robot.number));
    let line = spec.and_then(|spec| sim.robots.iter().find(|line| line.span == spec.span)).cloned();
    let line = line.unwrap_or_else(|| RobotLine { kind: type_named(&robot.kind), ..RobotLine::default() });
    RobotLine { start: StartRef::Pose(robot.pose), ..line }
}

/// Sets the movable objects in a scene's lines to their current poses; removes and adds lines.
fn place_objects(sim: &mut SimSpec, scene: &SceneSpec, objects: &[LiveEntity]) {
    let mut number = scene.objects.iter().filter(|object| !object.kind.is_fixed).count() as u32;
    let scene_count = number;
    // The world's objects come first. Their spans refer to another file and may equal those of lines, so matching
    // starts at the end.
    let mut lines: Vec<usize> = (0..sim.objects.len()).collect();
    let mut removed = Vec::new();
    for spec in scene.objects.iter().rev() {
        let index = lines.iter().rposition(|line| sim.objects[*line].span == spec.span);
        let line = index.map(|index| lines.remove(index));
        if spec.kind.is_fixed {
            continue;
        }
        match (line, objects.iter().find(|object| object.number == number)) {
            (Some(line), Some(live)) => sim.objects[line].pose = live.pose,
            (Some(line), None) => removed.push(line),
            (None, _) => {}
        }
        number -= 1;
    }
    removed.into_iter().for_each(|line| drop(sim.objects.remove(line)));
    let spawned = objects.iter().filter(|object| object.number > scene_count);
    let line =
        |object: &LiveEntity| ObjectLine { kind: type_named(&object.kind), pose: object.pose, ..ObjectLine::default() };
    sim.objects.extend(spawned.map(line));
}

fn type_named(kind: &str) -> TypeRef {
    TypeRef::Name(SpannedText { text: kind.to_owned(), span: Span::default() })
}

/// Kind of file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileFormat {
    Sim,
    Scene,
    World,
    Maze,
    Robi,
    Object,
    /// A world or maze of another program, which is only read.
    Foreign,
    /// An occupancy grid of ROS or its image.
    Map,
    /// Scenarios of MovingAI, which are only read.
    Scenarios,
}

impl FileFormat {
    fn of(name: &str) -> Option<Self> {
        Some(match path::extension(name).as_str() {
            "sim" => FileFormat::Sim,
            "toml" => FileFormat::Scene,
            "wld" => FileFormat::World,
            "maz" | "maze" => FileFormat::Maze,
            "robi" => FileFormat::Robi,
            "esobj" => FileFormat::Object,
            "yaml" | "yml" | "pgm" | "pbm" => FileFormat::Map,
            "map" | "world" | "sdf" | "num" | "txt" => FileFormat::Foreign,
            "scen" => FileFormat::Scenarios,
            _ => return None,
        })
    }
}

/// Converts the file `from` to one named `to`, whose extension selects the format.
///
/// References are rewritten for the folder of `to`; both names must be relative to the working folder or both absolute.
/// Writes no files.
pub fn convert(from: &str, to: &str, files: &dyn Files) -> Converted {
    convert_with(from, to, ConvertOptions::default(), files, &|_, _| None)
}

/// Function that returns the generation of the RoBIOS API, 6 or 7, of a robot's program, if the program determines it.
pub type GenerationOf<'a> = dyn Fn(&SceneSpec, &RobotSpec) -> Option<u32> + 'a;

/// Converts like [`convert`]. A scene in TOML states the generations that `generation_of` returns. For all other
/// programs it states the dialect of the sim file, which applies only if a program does not determine its generation.
///
/// Random values and positions of a scene are drawn with the seed of the `options`, which the result then contains,
/// otherwise with the scene's seed.
pub fn convert_with(
    from: &str,
    to: &str,
    options: ConvertOptions,
    files: &dyn Files,
    generation_of: &GenerationOf<'_>,
) -> Converted {
    let (Some(source), Some(target)) = (FileFormat::of(from), FileFormat::of(to)) else {
        let name = if FileFormat::of(from).is_none() { from } else { to };
        let expected = "a name that ends in .sim, .toml, .wld, .maz, .robi, .esObj, .yaml, .pgm or .pbm, or a source in .map, .scen, .world, .num or .txt";
        let message = "the extension of the file name is unknown or missing";
        return Converted::rejected(Code::FileKind, name, message, expected);
    };
    let mut conversion = Conversion { from, to, files, options, sink: Sink::new(from), outputs: Vec::new() };
    let loaded = match (source, target) {
        (FileFormat::Sim | FileFormat::Scene, FileFormat::Sim | FileFormat::Scene) => {
            conversion.convert_scene(target, generation_of)
        }
        (_, FileFormat::Foreign | FileFormat::Scenarios) => {
            let message = format!("files like `{to}` are read, but not written");
            let expected = "a target in .wld, .maz, .toml, .yaml, .pgm or .pbm";
            return Converted::rejected(Code::ConvertKind, to, &message, expected);
        }
        (FileFormat::Scenarios, FileFormat::Scene) => conversion.convert_scenarios(),
        (FileFormat::Sim, FileFormat::Map) => conversion.convert_scene_to_map(),
        (FileFormat::Scene, FileFormat::Map) if conversion.is_scene() => conversion.convert_scene_to_map(),
        (
            FileFormat::World | FileFormat::Maze | FileFormat::Foreign | FileFormat::Map,
            FileFormat::World | FileFormat::Maze | FileFormat::Scene | FileFormat::Map,
        ) => conversion.convert_world(target),
        (FileFormat::Robi, FileFormat::Robi | FileFormat::Scene) => conversion.convert_robi(target),
        (FileFormat::Object, FileFormat::Object | FileFormat::Scene) => conversion.convert_object(target),
        (FileFormat::Scene, _) => conversion.convert_part_of_scene(target),
        _ => {
            let message = format!("`{from}` cannot become `{to}`: they hold different things");
            let expected = "scenes to scenes (.sim, .scene.toml) and maps, worlds and maps to worlds and maps, types to types, scenarios to .suite.toml";
            return Converted::rejected(Code::ConvertKind, from, &message, expected);
        }
    };
    let Conversion { sink, outputs, .. } = conversion;
    let mut diagnostics = loaded.diagnostics;
    diagnostics.extend(sink.finish());
    let outputs = if super::has_errors(&diagnostics) { Vec::new() } else { outputs };
    Converted { outputs, diagnostics, inputs: loaded.inputs, notes: loaded.notes }
}

impl Converted {
    fn rejected(code: Code, file: &str, message: &str, expected: &str) -> Self {
        let mut sink = Sink::new(file);
        sink.error(code, Span::default(), message, expected);
        Self { diagnostics: sink.finish(), ..Self::default() }
    }
}

struct Conversion<'a> {
    from: &'a str,
    to: &'a str,
    files: &'a dyn Files,
    options: ConvertOptions,
    /// Mistakes, and warnings about properties that the target cannot represent.
    sink: Sink,
    outputs: Vec<Output>,
}

impl Conversion<'_> {
    fn convert_scene(&mut self, target: FileFormat, generation_of: &GenerationOf<'_>) -> Loaded {
        let seed = self.options.seed;
        let (loaded, mut sim) = load_with_spec(self.from, Overrides { seed, ..Overrides::default() }, self.files);
        if loaded.has_errors() {
            return loaded;
        }
        sim.run.seed = seed.or(sim.run.seed);
        if seed.is_some() || !sim.drawn.is_empty() {
            fix_random_positions(&mut sim, &loaded.scene);
            if target == FileFormat::Scene {
                keep_paths(&mut sim);
            }
        }
        self.rewrite_references(&mut sim);
        sort_named_lines(&mut sim, &loaded.scene);
        if sim.world.is_none() && sim.inline.world.is_none() {
            sim.inline.world = Some(loaded.scene.world.clone());
        }
        let printed = if target == FileFormat::Sim {
            self.write_inline(&mut sim);
            let mut printed = print::print_sim(&sim, &loaded.scene);
            printed.lost.extend(lost_generations(&sim, &loaded.scene, generation_of));
            printed
        } else {
            let lost = if sim.format == SceneFormat::Sim {
                set_generations(&mut sim, &loaded.scene, generation_of)
            } else {
                Vec::new()
            };
            Printed { text: print::print_scene(&sim), lost }
        };
        self.write(self.to.to_owned(), printed);
        loaded
    }

    /// Parses the text of the source, but none of the files that it refers to.
    fn read_source(&self) -> SimSpec {
        let text = self.files.read(self.from).map_or(String::new(), |bytes| decode(&bytes).0);
        let read = if FileFormat::of(self.from) == Some(FileFormat::Scene) { read_scene } else { read_sim };
        read(self.from, &text).0
    }

    /// Moves the inline parts of a scene into files beside the target, since a sim file can only refer to files.
    fn write_inline(&mut self, sim: &mut SimSpec) {
        let inline = std::mem::take(&mut sim.inline);
        if let Some(world) = inline.world {
            let (extension, kind, printed) = match print::print_maze(&world).ok().filter(|_| world.cell.is_some()) {
                Some(text) => {
                    let lost = print::lost_in_maze(&world);
                    ("maz", WorldKind::Maze, Printed { text, lost })
                }
                None => ("wld", WorldKind::World, print::print_world(&world)),
            };
            let path = self.write_beside("", extension, printed);
            sim.world = Some(WorldLine { kind, path, cell: None, looks: LooksSpec::default() });
        }
        for (robi, span) in inline.robot_types {
            let companion = print::print_companion(&robi);
            let part = self.part_of(&robi.name, "robi");
            if !companion.is_empty() {
                self.write_beside(&part, "toml", Printed { text: companion, lost: Vec::new() });
            }
            let path = self.write_beside(&part, "robi", print::print_robi(&robi));
            sim.robot_types.push(SpannedText { span, ..path });
        }
        for (object, span) in inline.object_types {
            let part = self.part_of(&object.name, "esObj");
            let path = self.write_beside(&part, "esObj", print::print_esobj(&object));
            sim.object_types.push(SpannedText { span, ..path });
        }
    }

    /// Part of the name of the file with the type `name`, such as `-My_Bot`; with a number if an output has that name.
    fn part_of(&self, name: &str, extension: &str) -> String {
        let part = format!("-{}", safe_file_name(name));
        let is_free = |part: &String| {
            let path = path::join(path::folder_of(self.to), &self.name_beside(part, extension)).to_lowercase();
            self.outputs.iter().all(|output| output.path.to_lowercase() != path)
        };
        let mut numbered = (2_u32..).map(|number| format!("{part}-{number}"));
        if is_free(&part) { part } else { numbered.find(is_free).unwrap_or_default() }
    }

    /// Name of a file beside the target, named after the target.
    fn name_beside(&self, part: &str, extension: &str) -> String {
        let stem = path::stem(self.to);
        format!("{}{part}.{extension}", stem.strip_suffix(".scene").unwrap_or(stem))
    }

    /// Adds an output file beside the target, named after the target.
    fn write_beside(&mut self, part: &str, extension: &str, printed: Printed) -> SpannedText {
        let name = self.name_beside(part, extension);
        self.write(path::join(path::folder_of(self.to), &name), printed);
        SpannedText { text: name, span: Span::default() }
    }

    fn write(&mut self, path: String, printed: Printed) {
        for property in printed.lost {
            let message = format!("`{path}` has no place for {property}");
            self.sink.warn(
                Code::ConvertLost,
                Span::default(),
                message,
                "a format that can represent it, such as .scene.toml",
            );
        }
        self.outputs.push(Output { path, bytes: printed.text.into_bytes() });
    }

    /// Rules for the size of the cells of the source.
    fn cell_rules(&self) -> CellRules {
        CellRules { dialect: None, cell: self.options.maze_cell }
    }

    fn convert_world(&mut self, target: FileFormat) -> Loaded {
        if target == FileFormat::Map
            && let Some((grid, loaded)) = self.source_grid()
        {
            // If source and target are grids, the cells are copied without a conversion to walls.
            grid.iter().for_each(|grid| self.write_grid(grid));
            return loaded;
        }
        let loaded = load_world_with(self.from, self.cell_rules(), self.files);
        let mut world = loaded.scene.world.clone();
        world.texture.iter_mut().for_each(|texture| self.rewrite_path(texture));
        if target == FileFormat::Maze && self.source_grid().is_some() {
            let expected = "a target in .wld, .toml, .yaml, .pgm or .pbm";
            self.sink.error(Code::ConvertMaze, Span::default(), "a map of occupied cells is not a maze", expected);
        } else if !loaded.has_errors() {
            self.write_world(&world, target);
        }
        loaded
    }

    /// The grid of the source; `None` if the source is not a grid.
    fn source_grid(&self) -> Option<(Option<Grid>, Loaded)> {
        let bytes = self.files.read(self.from).ok()?;
        let format = WorldFormat::of(self.from, &bytes, WorldKind::World);
        if !matches!(format, WorldFormat::RosMap | WorldFormat::Image | WorldFormat::MovingAi) {
            return None;
        }
        let mut loader = Loader::new(self.files);
        let grid = map::read_grid(&mut loader, self.from, bytes, format, self.cell_rules());
        Some((grid, loader.finish(SceneSpec::default())))
    }

    /// Returns true if the source is a whole scene, not only a part of a scene.
    fn is_scene(&self) -> bool {
        self.files.read(self.from).is_ok_and(|bytes| scene::is_scene(self.from, &decode(&bytes).0))
    }

    /// Converts a scene to a map in which all cells that the robots can reach are free.
    fn convert_scene_to_map(&mut self) -> Loaded {
        let overrides =
            Overrides { seed: self.options.seed, maze_cell: self.options.maze_cell, ..Overrides::default() };
        let loaded = load_with_spec(self.from, overrides, self.files).0;
        if !loaded.has_errors() {
            let mut world = loaded.scene.world.clone();
            let starts =
                loaded.scene.robots.iter().map(|robot| StartSpec { pose: robot.start, ..StartSpec::default() });
            world.starts.extend(starts);
            if !loaded.scene.objects.is_empty() {
                let message = format!("a map has no place for {} objects", loaded.scene.objects.len());
                self.sink.warn(
                    Code::ConvertLost,
                    Span::default(),
                    message,
                    "a format that can represent it, such as .scene.toml",
                );
            }
            self.write_map(&world);
        }
        loaded
    }

    /// Writes the map of a world of walls.
    fn write_map(&mut self, world: &WorldSpec) {
        let cell = self.options.map_cell.unwrap_or(DEFAULT_RESOLUTION);
        let Some(grid) = Grid::of_world(world, cell) else {
            let message = format!("a map with cells of {} mm has too many cells", unit::mm_from_metres(cell));
            self.sink.error(Code::MapSize, Span::default(), message, "at most 67,108,864 cells: `--map-cell MM`");
            return;
        };
        self.write_grid(&grid);
    }

    /// Writes a grid as a `map.yaml` with its image, or as only an image.
    fn write_grid(&mut self, grid: &Grid) {
        let extension = path::extension(self.to);
        let is_bitmap = extension == "pbm";
        let image = map::image_file(grid, is_bitmap);
        if matches!(extension.as_str(), "yaml" | "yml") {
            let name = format!("{}.pgm", path::stem(self.to));
            let text = map::map_yaml(grid, &name);
            self.outputs.push(Output { path: self.to.to_owned(), bytes: text.into_bytes() });
            self.outputs.push(Output { path: path::join(path::folder_of(self.to), &name), bytes: image });
            return;
        }
        let is_moved = grid.origin != Pose::default();
        let unknown = grid.count(Cell::Unknown);
        let losses = [
            (is_moved, "the origin of the map".to_owned()),
            (is_bitmap && unknown > 0, format!("{unknown} unknown cells, which are black as occupied ones")),
        ];
        let lost = losses.into_iter().filter(|(applies, _)| *applies).map(|(_, property)| property).collect();
        self.write(self.to.to_owned(), Printed { text: String::new(), lost });
        if let Some(output) = self.outputs.last_mut() {
            output.bytes = image;
        }
    }

    /// Writes a suite whose cases are the scenarios of one map, and its scene.
    fn convert_scenarios(&mut self) -> Loaded {
        let (scenarios, loaded) = load_scenarios(self.from, self.files);
        if !self.to.to_lowercase().ends_with(SUITE_EXTENSION) {
            let expected = "a target that ends in .suite.toml";
            self.sink.error(Code::ConvertKind, Span::default(), "scenarios become a suite", expected);
            return loaded;
        }
        let Some(first) = scenarios.first().filter(|_| !loaded.has_errors()) else { return loaded };
        if let Some(other) = scenarios.iter().find(|scenario| scenario.map != first.map) {
            let message = format!("the scenarios are of several maps, `{}` and `{}`", first.map, other.map);
            self.sink.error(Code::ConvertKind, other.span, message, "scenarios of one map");
            return loaded;
        }
        let Some(map) = loaded.inputs.get(1).map(|input| input.path.as_str()) else { return loaded };
        let map = path::relative(path::folder_of(self.to), map);
        let cell = self.options.maze_cell.unwrap_or(DEFAULT_CELL);
        let stem = self.to[..self.to.len() - SUITE_EXTENSION.len()].to_owned();
        let scene = format!("{stem}.scene.toml");
        let [scene_text, suite] = map::suite_of_scenarios(&scenarios, &map, path::file_name(&scene), cell);
        self.outputs.push(Output { path: self.to.to_owned(), bytes: suite.into_bytes() });
        self.outputs.push(Output { path: scene, bytes: scene_text.into_bytes() });
        loaded
    }

    fn write_world(&mut self, world: &WorldSpec, target: FileFormat) {
        let printed = match target {
            FileFormat::Map => return self.write_map(world),
            FileFormat::World => print::print_world(world),
            FileFormat::Maze => match print::print_maze(world) {
                Ok(text) => Printed { text, lost: print::lost_in_maze(world) },
                Err(reason) => {
                    let expected = "walls along a grid of cells, and the target `.wld` otherwise";
                    self.sink.error(Code::ConvertMaze, Span::default(), reason.to_string(), expected);
                    return;
                }
            },
            _ => {
                let mut sim = SimSpec { format: SceneFormat::Toml, ..SimSpec::default() };
                sim.inline.world = Some(world.clone());
                Printed { text: print::print_scene(&sim), lost: Vec::new() }
            }
        };
        self.write(self.to.to_owned(), printed);
    }

    fn convert_robi(&mut self, target: FileFormat) -> Loaded {
        let (robi, loaded) = load_robi(self.from, self.files);
        if let Some(mut robi) = robi {
            self.rewrite_robi(&mut robi);
            self.write_robi(&robi, target);
        }
        loaded
    }

    fn write_robi(&mut self, robi: &super::RobiSpec, target: FileFormat) {
        if target == FileFormat::Scene {
            let text = print::section("robot_type", robi);
            return self.write(self.to.to_owned(), Printed { text, lost: Vec::new() });
        }
        self.write(self.to.to_owned(), print::print_robi(robi));
        let companion = print::print_companion(robi);
        if !companion.is_empty() {
            let path = path::with_extension(self.to, "toml");
            self.write(path, Printed { text: companion, lost: Vec::new() });
        }
    }

    fn convert_object(&mut self, target: FileFormat) -> Loaded {
        let (object, loaded) = load_object(self.from, self.files);
        if let Some(mut object) = object {
            object.model.iter_mut().for_each(|model| self.rewrite_path(&mut model.path));
            self.write_object(&object, target);
        }
        loaded
    }

    fn write_object(&mut self, object: &super::ObjectType, target: FileFormat) {
        let printed = if target == FileFormat::Scene {
            Printed { text: print::section("object_type", object), lost: Vec::new() }
        } else {
            print::print_esobj(object)
        };
        self.write(self.to.to_owned(), printed);
    }

    /// Converts the only inline world or type of a TOML file.
    fn convert_part_of_scene(&mut self, target: FileFormat) -> Loaded {
        let mut loaded = Loaded::default();
        let text = match self.files.read(self.from) {
            Ok(bytes) => decode(&bytes).0,
            Err(_) => {
                // Reports why the file cannot be read.
                return load_scene(self.from, self.files);
            }
        };
        let (mut sim, diagnostics) = read_scene(self.from, &text);
        // A file with only types is not a complete scene, but sufficient here.
        let is_scene = scene::has_scene_key(&text);
        let is_scattered = |world: &WorldSpec| {
            let walls = world.walls.iter().any(|wall| wall.scatter.is_some());
            walls || world.objects.iter().any(|line| line.scatter.is_some())
        };
        if is_scene && (!sim.drawn.is_empty() || sim.inline.world.as_ref().is_some_and(is_scattered)) {
            // Random values depend on the whole scene: they are drawn until everything has its place.
            let overrides = Overrides { seed: self.options.seed, ..Overrides::default() };
            (loaded, sim) = load_with_spec(self.from, overrides, self.files);
            fix_random_positions(&mut sim, &loaded.scene);
        } else {
            loaded.diagnostics.extend(diagnostics.into_iter().filter(|it| is_scene || it.code != Code::TomlMissing));
            loaded.inputs.push(super::InputFile { path: self.from.to_owned(), bytes: text.into_bytes() });
        }
        self.rewrite_references(&mut sim);
        match (target, sim.inline.robot_types.as_slice(), sim.inline.object_types.as_slice()) {
            (FileFormat::World | FileFormat::Maze | FileFormat::Map, ..) if sim.inline.world.is_some() => {
                let world = sim.inline.world.clone().unwrap_or_default();
                self.write_world(&world, target);
            }
            (FileFormat::Robi, [(robi, _)], _) => self.write_robi(robi, target),
            (FileFormat::Object, _, [(object, _)]) => self.write_object(object, target),
            _ => {
                let message = format!("`{}` does not contain exactly one inline description of this kind", self.from);
                let expected = "a `[world]` with walls or a maze, one `[[robot_type]]` or one `[[object_type]]`";
                self.sink.error(Code::ConvertKind, Span::default(), message, expected);
            }
        }
        loaded
    }

    /// Rewrites all references of a scene for the folder of the target.
    fn rewrite_references(&self, sim: &mut SimSpec) {
        sim.world.iter_mut().for_each(|line| self.rewrite_path(&mut line.path));
        sim.robot_types.iter_mut().chain(&mut sim.object_types).for_each(|path| self.rewrite_path(path));
        for line in sim.robots.iter_mut().chain(&mut sim.named) {
            self.rewrite_type(&mut line.kind);
            line.program.iter_mut().for_each(|program| self.rewrite_program(program));
            line.noise.iter_mut().for_each(|noise| self.rewrite_noise(noise));
        }
        sim.objects.iter_mut().for_each(|line| self.rewrite_type(&mut line.kind));
        for check in &mut sim.checks {
            if let CheckKind::Script { program, .. } = &mut check.kind {
                self.rewrite_path(program);
            }
        }
        if let Some(world) = &mut sim.inline.world {
            world.texture.iter_mut().for_each(|texture| self.rewrite_path(texture));
            world.terrain.iter_mut().filter_map(|terrain| terrain.path_mut()).for_each(|path| self.rewrite_path(path));
            world.objects.iter_mut().for_each(|line| self.rewrite_type(&mut line.kind));
        }
        sim.inline.robot_types.iter_mut().for_each(|(robi, _)| self.rewrite_robi(robi));
        let objects = sim.inline.object_types.iter_mut().flat_map(|(object, _)| &mut object.model);
        objects.for_each(|model| self.rewrite_path(&mut model.path));
        if let Some(super::CostsRef::File(path)) = &mut sim.run.costs {
            self.rewrite_path(path);
        }
        sim.run.noise.iter_mut().for_each(|noise| self.rewrite_noise(noise));
    }

    fn rewrite_noise(&self, noise: &mut super::NoiseRef) {
        if let super::NoiseRef::File(path) = noise {
            self.rewrite_path(path);
        }
    }

    fn rewrite_robi(&self, robi: &mut super::RobiSpec) {
        robi.model.iter_mut().for_each(|model| self.rewrite_path(&mut model.path));
        for serial in &mut robi.serials {
            if let super::SerialLine::File { path, .. } = &mut serial.line {
                self.rewrite_path(path);
            }
        }
    }

    fn rewrite_type(&self, kind: &mut TypeRef) {
        if let TypeRef::File(path) = kind {
            self.rewrite_path(path);
        }
    }

    /// Rewrites the reference to a program, which may be a list of files with commas between them.
    fn rewrite_program(&self, program: &mut SpannedText) {
        let is_file = !program.text.contains(',') || self.place_of(&program.text).is_some();
        let parts =
            if is_file { vec![program.text.as_str()] } else { program.text.split(',').map(str::trim).collect() };
        program.text = parts.into_iter().map(|part| self.rewritten(part)).collect::<Vec<_>>().join(",");
    }

    fn rewrite_path(&self, reference: &mut SpannedText) {
        reference.text = self.rewritten(&reference.text);
    }

    /// The reference `text` in a file in the target's folder. It does not change if it is absolute, begins with
    /// `%sim%`, or is found only in the working folder or the installation. A reference whose file is found elsewhere
    /// near the source becomes the path of that file.
    fn rewritten(&self, text: &str) -> String {
        let (source_folder, target_folder) = (path::folder_of(self.from), path::folder_of(self.to));
        let place = self.place_of(text);
        if source_folder == target_folder || place.is_some_and(|place| place > 0) {
            return text.to_owned();
        }
        let exists =
            |path: &String| self.files.list(path::folder_of(path)).iter().any(|name| name == path::file_name(path));
        let elsewhere = || path::relocated_candidates(text, source_folder, None).into_iter().find(exists);
        match place.map_or_else(elsewhere, |_| None) {
            Some(found) => path::relative(target_folder, &found),
            None => path::moved(text, source_folder, target_folder),
        }
    }

    /// Index in [`path::candidates`] of the path at which the file of the reference `text` is; otherwise of a path at
    /// which a file has the same name apart from case and extension, such as the source of a program.
    fn place_of(&self, text: &str) -> Option<usize> {
        let candidates = path::candidates(text, path::folder_of(self.from), self.files.home());
        let stem = |name: &str| path::stem(name).to_lowercase();
        let is_same = |name: &str, wanted: &str| name == wanted;
        let is_similar = |name: &str, wanted: &str| stem(name) == stem(wanted);
        let place = |is_meant: &dyn Fn(&str, &str) -> bool| {
            let has_file = |path: &String| {
                self.files.list(path::folder_of(path)).iter().any(|name| is_meant(name, path::file_name(path)))
            };
            candidates.iter().position(has_file)
        };
        place(&is_same).or_else(|| place(&is_similar))
    }
}

/// Sets the dialect, and the generations that `generation_of` returns, in a scene that was read from a sim file.
/// Returns descriptions of what the scene cannot express.
fn set_generations(sim: &mut SimSpec, scene: &SceneSpec, generation_of: &GenerationOf<'_>) -> Vec<String> {
    let is_vr = scene.robots.iter().any(|robot| robot.dialect == Some(7));
    let default_dialect = if is_vr { Dialect::Vr2023 } else { Dialect::Classic };
    if !scene.robots.is_empty() {
        sim.run.dialect.get_or_insert(default_dialect);
    }
    let generations: Vec<Option<u32>> = scene.robots.iter().map(|robot| generation_of(scene, robot)).collect();
    if let Some(first) = generations.first().copied().flatten()
        && generations.iter().all(|generation| *generation == Some(first))
    {
        sim.run.api = Some(first);
        return Vec::new();
    }
    let mut lost = Vec::new();
    for (robot, generation) in scene.robots.iter().zip(generations) {
        let line = sim.robots.iter_mut().find(|line| line.span == robot.span);
        line.into_iter().for_each(|line| line.api = generation);
        let is_other = robot.dialect != sim.run.dialect.map(Dialect::generation);
        if is_other && generation.is_none() && robot.program.is_some() {
            lost.push(lost_generation(robot));
        }
    }
    lost
}

/// Descriptions of the programs whose generation changes in a sim file, since only the dialect of a line determines it.
fn lost_generations(sim: &SimSpec, scene: &SceneSpec, generation_of: &GenerationOf<'_>) -> Vec<String> {
    let is_lost = |robot: &&RobotSpec| {
        let line = sim.robots.iter().find(|line| line.span == robot.span);
        let written = if line.is_some_and(print::is_classic) { 6 } else { 7 };
        let depends_on_dialect = || {
            // A program that takes no stated generation, such as one in Python, takes none from the dialect either.
            let stated = RobotSpec { api: Some(written), ..(*robot).clone() };
            generation_of(scene, robot).is_none() && generation_of(scene, &stated).is_some()
        };
        robot.dialect.unwrap_or(DEFAULT_GENERATION) != written && depends_on_dialect()
    };
    scene.robots.iter().filter(is_lost).map(lost_generation).collect()
}

fn lost_generation(robot: &RobotSpec) -> String {
    let number = robot.dialect.unwrap_or(DEFAULT_GENERATION);
    format!("that the program of {} is of RoBIOS {number} where its calls do not tell", robot.id)
}

/// Replaces random positions with those that were drawn.
fn fix_random_positions(sim: &mut SimSpec, scene: &SceneSpec) {
    if let Some(world) = &mut sim.inline.world {
        world.walls.clone_from(&scene.world.walls);
    }
    let robots = std::mem::take(&mut sim.robots).into_iter().flat_map(|line| {
        let StartRef::Many { layout: Layout::Random(_), .. } = line.start else { return vec![line] };
        let placed = scene.robots.iter().filter(|robot| {
            let number = robot.line.strip_prefix(&line.path).and_then(|rest| rest.strip_prefix('.'));
            robot.line == line.path || number.is_some_and(|number| number.parse::<u32>().is_ok())
        });
        let single = |robot: &RobotSpec| RobotLine {
            id: Some(robot.id),
            start: StartRef::Pose(robot.start),
            path: robot.line.clone(),
            ..line.clone()
        };
        placed.map(single).collect()
    });
    sim.robots = robots.collect();
    let world = sim.inline.world.iter_mut().flat_map(|world| &mut world.objects);
    for line in sim.objects.iter_mut().chain(world).filter(|line| line.scatter.is_some()) {
        if let Some(placed) = scene.objects.iter().find(|object| object.line == line.path) {
            (line.pose, line.scatter) = (placed.pose, None);
        }
    }
}

/// Names lines such that their paths stay the same: requirements refer to the paths.
fn keep_paths(sim: &mut SimSpec) {
    let robots = sim.robots.iter_mut().map(|line| (&line.path, &mut line.name));
    name_by_path("robot.", robots);
    name_by_path("object.", sim.objects.iter_mut().map(|line| (&line.path, &mut line.name)));
}

/// Names each line by the last part of its path, unless this is the line's number in its list.
fn name_by_path<'l>(list: &str, lines: impl Iterator<Item = (&'l String, &'l mut Option<String>)>) {
    for ((path, name), number) in lines.zip(1..) {
        let key = path.strip_prefix(list).unwrap_or_default();
        if !key.is_empty() && key != format!("{number}") {
            *name = Some(key.to_owned());
        }
    }
}

/// Sorts lines that name a loaded type into robots and objects, by the kind of the type.
fn sort_named_lines(sim: &mut SimSpec, scene: &SceneSpec) {
    for line in std::mem::take(&mut sim.named) {
        let is_object = scene.objects.iter().any(|object| object.span == line.span);
        match line.start {
            StartRef::Pose(pose) if is_object => {
                sim.objects.push(ObjectLine { kind: line.kind, pose, span: line.span, ..ObjectLine::default() });
            }
            _ if scene.robots.iter().any(|robot| robot.span == line.span) => sim.robots.push(line),
            // Line of an unknown type, already reported.
            _ => {}
        }
    }
    sim.robots.sort_by_key(|line: &RobotLine| line.span);
    sim.objects.sort_by_key(|line| line.span);
}

/// Replaces characters of a name that are unsafe in a file name.
fn safe_file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::load::FileError;
    use super::*;

    /// File system with one scene: two robot lines and one object.
    struct OneScene;

    impl Files for OneScene {
        fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
            match path {
                "a.sim" => Ok(b"world a.wld\nS4 100 200 0 p.c\nS4 500 200 90\nCan 700 300 0\nCan 700 600 0\n".to_vec()),
                "a.wld" => Ok(b"floor 2000 1000\n".to_vec()),
                _ => Err(FileError::Missing),
            }
        }

        fn list(&self, _: &str) -> Vec<String> {
            vec!["a.sim".into(), "a.wld".into()]
        }

        fn home(&self) -> Option<&str> {
            None
        }
    }

    fn live_entity(number: u32, kind: &str, x: f64) -> LiveEntity {
        LiveEntity { number, kind: kind.into(), pose: Pose::new(x, 0.25, 0.5) }
    }

    #[test]
    fn current_scene_has_live_poses() {
        let robots = [live_entity(1, "S4", 0.75), live_entity(3, "LabBot", 1.5)];
        let objects = [live_entity(2, "Can", 0.4), live_entity(3, "Can", 1.75)];
        let text = print_current_scene("a.sim", &OneScene, &robots, &objects).expect("a scene");
        let (sim, diagnostics) = read_scene("b.scene.toml", &text);
        assert_eq!(diagnostics, [], "{text}");
        let summary = |line: &RobotLine| {
            let StartRef::Pose(pose) = line.start else { panic!("a pose") };
            let program = line.program.as_ref().map(|program| program.text.clone());
            (line.id, line.kind.written().text.clone(), (pose.position.x * 1000.0).round(), program)
        };
        let written: Vec<_> = sim.robots.iter().chain(&sim.named).map(summary).collect();
        let expected = [
            (Some(RobotId(1)), "S4".to_owned(), 750.0, Some("p.c".to_owned())),
            (Some(RobotId(2)), "LabBot".to_owned(), 1500.0, None),
        ];
        assert_eq!(written, expected, "{text}");
        let positions: Vec<f64> = sim.objects.iter().map(|line| (line.pose.position.x * 1000.0).round()).collect();
        assert_eq!(positions, [400.0, 1750.0], "the first has gone, the third has come: {text}");
    }

    #[test]
    fn unreadable_scene_gives_diagnostics() {
        assert!(!print_current_scene("b.sim", &OneScene, &[], &[]).expect_err("there is none").is_empty());
    }
}
