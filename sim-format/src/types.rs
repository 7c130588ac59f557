//! Registry of robot and object types by name: built-in types and types that a sim file loads.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::code::Code;
use super::diagnostic::Sink;
use super::load::{Files, Loader};
use super::spec::{ObjectType, RobiSpec, SceneFormat, SimSpec, SpannedText};
use super::{Severity, Span, builtin, line, path, sim, world};

/// Type of a robot or of an object.
#[derive(Clone, Debug)]
pub(super) enum LoadedType {
    Robot(Arc<RobiSpec>),
    Object(Arc<ObjectType>),
}

impl LoadedType {
    fn name(&self) -> &str {
        match self {
            LoadedType::Robot(robi) => &robi.name,
            LoadedType::Object(object) => &object.name,
        }
    }

    fn file(&self) -> &str {
        match self {
            LoadedType::Robot(robi) => &robi.file,
            LoadedType::Object(object) => &object.file,
        }
    }
}

/// Types of a scene by name.
pub(super) struct Types {
    by_name: BTreeMap<String, KnownType>,
    /// Names by their lower-case form.
    by_lower_case: BTreeMap<String, Vec<String>>,
    /// Lines that would load the types in nearby files, by the names of the types; filled at the first unknown type.
    nearby: Option<BTreeMap<String, String>>,
    /// References to files of types that do not exist, which is already reported.
    missing: Vec<SpannedText>,
    format: SceneFormat,
}

struct KnownType {
    kind: LoadedType,
    /// Span of the reference that loads the type; `None` for a built-in type.
    loaded_at: Option<Span>,
}

impl Types {
    /// Registers the built-in types and the types of `sim`. Built-in names are reserved. Of several types with the same
    /// name, only one is registered: an inline type before types of files, otherwise the first one.
    pub(super) fn load(loader: &mut Loader<'_>, sim: &SimSpec, folder: &str) -> Self {
        let mut types = Self {
            by_name: BTreeMap::new(),
            by_lower_case: BTreeMap::new(),
            nearby: None,
            missing: Vec::new(),
            format: sim.format,
        };
        let robots = builtin::ROBOTS.iter().filter_map(|name| builtin::robot(name)).map(LoadedType::Robot);
        let objects = builtin::OBJECTS.iter().filter_map(|name| builtin::object(name)).map(LoadedType::Object);
        for kind in robots.chain(objects) {
            types.add(kind, None);
        }
        let robots = sim.robot_types.iter().map(|path| (path, true));
        let mut references: Vec<(&SpannedText, bool)> =
            robots.chain(sim.object_types.iter().map(|path| (path, false))).collect();
        references.sort_by_key(|(path, _)| path.span);
        let mut sink = Sink::new(&sim.file);
        for (robi, span) in &sim.inline.robot_types {
            types.register(&mut sink, LoadedType::Robot(Arc::new(robi.clone())), *span);
        }
        for (object, span) in &sim.inline.object_types {
            types.register(&mut sink, LoadedType::Object(Arc::new(object.clone())), *span);
        }
        for (path, is_robot) in references {
            let kind = if is_robot {
                loader.robot_type(&sim.file, folder, path).map(LoadedType::Robot)
            } else {
                loader.object_type(&sim.file, folder, path).map(LoadedType::Object)
            };
            match kind {
                Some(kind) => types.register(&mut sink, kind, path.span),
                None => types.missing.push(path.clone()),
            }
        }
        for (robi, span) in &sim.inline.robot_types {
            types.register(&mut sink, LoadedType::Robot(Arc::new(robi.clone())), *span);
        }
        for (object, span) in &sim.inline.object_types {
            types.register(&mut sink, LoadedType::Object(Arc::new(object.clone())), *span);
        }
        loader.diagnostics.extend(sink.finish());
        types
    }

    fn register(&mut self, sink: &mut Sink, kind: LoadedType, span: Span) {
        let name = kind.name();
        let is_reserved = builtin::ROBOTS.iter().chain(&builtin::OBJECTS).any(|entry| entry.eq_ignore_ascii_case(name));
        let entry = self.by_name.get(name);
        let message = match entry.map(|entry| (entry.kind.file(), entry.loaded_at)) {
            _ if is_reserved => format!("`{}` is a type named `{name}`, but that name is built in", kind.file()),
            // A second line loads the same file.
            Some((file, _)) if file == kind.file() => return,
            Some((file, _)) => format!("`{}` is a type named `{name}`, but so is `{file}` above", kind.file()),
            None => return self.add(kind, Some(span)),
        };
        let message = message + "; it is left out";
        sink.warn(Code::SimTypeTwice, span, message, "each name once, and none of the built-in ones");
    }

    fn add(&mut self, kind: LoadedType, loaded_at: Option<Span>) {
        let name = kind.name().to_owned();
        self.by_lower_case.entry(name.to_lowercase()).or_default().push(name.clone());
        self.by_name.insert(name, KnownType { kind, loaded_at });
    }

    /// Type named by `reference`. Warns if the name differs in case or the type is loaded only further below.
    pub(super) fn find(&self, sink: &mut Sink, reference: &SpannedText) -> Option<LoadedType> {
        let mut entry = self.by_name.get(&reference.text);
        if entry.is_none()
            && let Some([name]) = self.by_lower_case.get(&reference.text.to_lowercase()).map(Vec::as_slice)
        {
            entry = self.by_name.get(name);
            // EyeSim VR reads the names of its built-in types case-insensitively.
            if entry.is_some_and(|entry| entry.loaded_at.is_some()) {
                let message = format!("`{}` is loaded as `{name}`: upper and lower case differ", reference.text);
                sink.warn(Code::SimTypeCase, reference.span, message, "the name as the type's file has it");
            }
        }
        let entry = entry?;
        if let Some(loaded) =
            entry.loaded_at.filter(|loaded| self.format == SceneFormat::Sim && loaded.start > reference.span.start)
        {
            let message = format!("`{}` is loaded only further below, in line {}", reference.text, loaded.line);
            sink.warn(
                Code::SimTypeBelow,
                reference.span,
                message,
                "the line that loads a type above those that use it",
            );
        }
        Some(entry.kind.clone())
    }

    /// Reports that no type has the name in `reference`, with a suggestion.
    pub(super) fn report_unknown(
        &mut self,
        loader: &Loader<'_>,
        sink: &mut Sink,
        severity: Severity,
        folder: &str,
        reference: &SpannedText,
    ) {
        let name = &reference.text;
        let missing = self.missing_file_of(name);
        let message = match &missing {
            None => format!("there is no type `{name}`"),
            Some((file, true)) => format!("there is no type `{name}`, since {file} is not found"),
            Some((file, false)) => format!("there is no type `{name}`; it may be in {file}, which is not found"),
        };
        let expected = match self.format {
            SceneFormat::Sim => {
                "LabBot, S4, Mako, Can, Soccer, Crate, Golf, or the name of a type that a line above loads"
            }
            SceneFormat::Toml => {
                "LabBot, S4, Mako, Can, Soccer, Crate, Golf, a file, or the name of a type of the scene"
            }
        };
        let suggestion = match missing {
            // Types with similar names are not the one that is meant.
            Some((_, true)) => self.nearby_line(loader, folder, name),
            _ => self.suggestion(loader, folder, name),
        };
        sink.report(severity, Code::SimTypeUnknown, reference.span, message, expected).suggestion = suggestion;
    }

    /// Description of the missing file that would define the type `name`, and true if its name shows this.
    fn missing_file_of(&self, name: &str) -> Option<(String, bool)> {
        let of_name = self.missing.iter().find(|file| path::stem(&file.text).eq_ignore_ascii_case(name));
        let file = of_name.or(self.missing.first())?;
        Some((format!("`{}` of line {}", file.text, file.span.line), of_name.is_some()))
    }

    fn suggestion(&mut self, loader: &Loader<'_>, folder: &str, name: &str) -> Option<String> {
        let mut kinds = self.by_name.values().map(|known| &known.kind);
        if let Some(kind) = kinds.find(|kind| path::stem(kind.file()).eq_ignore_ascii_case(name)) {
            return Some(format!("write `{}`, the name that `{}` gives to the type", kind.name(), kind.file()));
        }
        self.nearby_line(loader, folder, name).or_else(|| {
            if self.format == SceneFormat::Sim && world::KEYWORDS.contains(&name) {
                return Some(sim::OF_WORLD.to_owned());
            }
            let names = self.by_name.keys().map(String::as_str).chain(sim::KEYWORDS);
            line::nearest(name, names).map(|name| format!("write `{name}`"))
        })
    }

    /// Suggestion to load the type `name` from a file nearby.
    fn nearby_line(&mut self, loader: &Loader<'_>, folder: &str, name: &str) -> Option<String> {
        let nearby = self.nearby.get_or_insert_with(|| find_nearby(loader, folder));
        let line = nearby.get(name)?;
        Some(match self.format {
            SceneFormat::Sim => format!("load it above with `{line}`"),
            SceneFormat::Toml => format!("name its file: `{}`", line.split_once(' ').map_or("", |(_, file)| file)),
        })
    }
}

/// Folders of an EyeSim tree, above the folder of the sim file, that are searched for types. Other folders are not
/// searched, since they may contain anything, such as a million files.
const TREE_FOLDERS: [&str; 7] = ["worlds", "objects", "robots", "robis", "Worlds", "Objects", "Robots"];
/// Number of folder levels above the sim file's folder at which the search begins.
const LEVELS_ABOVE: usize = 2;
/// Depth of the search below the sim file's folder, and below the folders of the tree.
const DEPTH_BELOW: usize = 2;
/// Maximum numbers of folder entries, and of files, that the search reads.
const MAX_ENTRIES: usize = 2000;
const MAX_FILES: usize = 200;

/// Lines that would load the types in the files near `folder`, by the names of the types.
fn find_nearby(loader: &Loader<'_>, folder: &str) -> BTreeMap<String, String> {
    let mut lines = BTreeMap::new();
    let mut files = 0;
    visit_nearby(loader.files, folder, DEPTH_BELOW, |relative, name| {
        let (keyword, read): (_, fn(&str, &str) -> String) = match path::extension(name).as_str() {
            "esobj" => ("object", |file, text| super::read_esobj(file, text).0.name),
            "robi" => ("robi", |file, text| super::read_robi(file, text).0.name),
            _ => return true,
        };
        files += 1;
        if let Ok(bytes) = loader.files.read(&path::join(folder, relative)) {
            let type_name = read(name, &super::decode(&bytes).0);
            let quoted = if relative.contains(' ') { format!("\"{relative}\"") } else { relative.to_owned() };
            lines.entry(type_name).or_insert_with(|| format!("{keyword} {quoted}"));
        }
        files < MAX_FILES
    });
    lines
}

/// Paths, relative to `folder`, of files near `folder` that have the name `wanted` in either case. Only folders directly
/// below the searched ones are read, since this search is part of loading correct scenes.
pub(super) fn files_nearby(files: &dyn Files, folder: &str, wanted: &str) -> Vec<String> {
    let mut found = Vec::new();
    visit_nearby(files, folder, 1, |relative, name| {
        if name.eq_ignore_ascii_case(wanted) {
            found.push(relative.to_owned());
        }
        found.len() < MAX_FILES
    });
    found
}

/// Calls `visit` with the relative path and the name of each entry of the folders near `folder`, down to `depth` levels
/// below them, until it returns false.
fn visit_nearby(files: &dyn Files, folder: &str, depth: usize, mut visit: impl FnMut(&str, &str) -> bool) {
    let mut entries = 0;
    // Folders relative to the sim file's folder, with a slash at the end; the last is searched first.
    let tree = (1..=LEVELS_ABOVE).rev().flat_map(|up| TREE_FOLDERS.map(|name| format!("{}{name}/", "../".repeat(up))));
    let mut folders: Vec<(String, usize)> =
        tree.chain([String::new()]).map(|relative_folder| (relative_folder, depth)).collect();
    while let Some((relative_folder, depth)) = folders.pop() {
        let mut names = files.list(&path::join(folder, &relative_folder));
        names.sort_unstable();
        for name in names {
            entries += 1;
            if entries > MAX_ENTRIES {
                return;
            }
            if path::extension(&name).is_empty() && depth > 0 {
                folders.push((format!("{relative_folder}{name}/"), depth - 1));
            }
            if !visit(&format!("{relative_folder}{name}"), &name) {
                return;
            }
        }
    }
}
