//! The pages of docs/formats/codes/: one per code of the registry, with one example that has the mistake and one that
//! does not.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use sim_core::build::MeshSource;
use sim_format::map::load_scenarios;
use sim_format::suite::load_suite;
use sim_format::{
    Code, Diagnostic, FileError, Files, MeshReader, Severity, load_object, load_robi, load_scene, load_world,
};

/// Codes that a text alone cannot cause: they require bytes that are not UTF-8, an image, a folder, thousands of lines
/// or robots, a program, a conversion or the functions of RoBIOS.
const WITHOUT_EXAMPLE: [Code; 19] = [
    Code::CheckFunction,
    Code::CheckProgram,
    Code::ConvertKind,
    Code::ConvertLost,
    Code::ConvertMaze,
    Code::CostFunction,
    Code::FileEncoding,
    Code::FileMore,
    Code::FileUnreadable,
    Code::FolderEmpty,
    Code::ForbidFunction,
    Code::MazBytes,
    Code::MeshSize,
    Code::ProgramGeneration,
    Code::ProgramMissing,
    Code::SceneCount,
    Code::TerrainColour,
    Code::TextureFormat,
    Code::TextureSize,
];

/// Files that examples may refer to.
const FOLDER: [(&str, &str); 9] = [
    ("room.pgm", "P2\n3 2\n255\n0 255 255\n0 255 255\n"),
    ("small.map", "type octile\nheight 2\nwidth 3\nmap\n...\n...\n"),
    ("room.scene.toml", "[world]\nfile = \"field.wld\"\n\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n"),
    ("wedge.obj", "mtllib wedge.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"),
    ("wedge.mtl", "newmtl red\nKd 1 0 0\n"),
    ("cross.maz", " _____\n|U _  |\n|_____|\n"),
    ("sign.esObj", "name StopSign\nmass 2 0 0 0\ncollider capsule 0 7500 0 150 14200 y\nscale 0.025\n"),
    ("field.wld", "floor 2000 2000\n0 0 2000 0\n2000 0 2000 2000\n2000 2000 0 2000\n0 2000 0 0\n"),
    (
        "S4.robi",
        "diameter 186\npsd PSD_FRONT 1 60 0 30 0\nwheel 54 3600 1100 90\n\
         drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n",
    ),
];

/// In-memory folder of texts.
struct Folder(BTreeMap<String, String>);

impl Files for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        self.0.get(path).map(|text| text.as_bytes().to_vec()).ok_or(FileError::Missing)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        if folder.is_empty() { self.0.keys().cloned().collect() } else { Vec::new() }
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

/// Example on a page: the kind of file, and its text.
#[derive(Debug)]
struct Example {
    kind: String,
    text: String,
}

impl Example {
    /// Diagnostics of the example, read as a file of its kind beside [`FOLDER`].
    fn diagnostics(&self) -> Vec<Diagnostic> {
        let name = format!("example.{}", self.kind);
        let folder = FOLDER.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        let mut files = Folder(folder.collect());
        files.0.insert(name.clone(), self.text.clone());
        match self.kind.as_str() {
            "sim" | "scene.toml" => load_scene(&name, &files).diagnostics,
            "suite.toml" => load_suite(&name, &files).loaded.diagnostics,
            "wld" | "maz" | "num" | "txt" | "map" | "pgm" | "yaml" | "world" => load_world(&name, &files).diagnostics,
            "scen" => load_scenarios(&name, &files).1.diagnostics,
            "esObj" => load_object(&name, &files).1.diagnostics,
            "robi" => load_robi(&name, &files).1.diagnostics.into_iter().chain(looks(&name, &files)).collect(),
            "obj" => {
                let robi = files.0["S4.robi"].clone() + &format!("model {name}\n");
                files.0.insert("example.robi".to_owned(), robi);
                looks("example.robi", &files)
            }
            "mtl" => {
                let mesh = files.0["wedge.obj"].replace("wedge.mtl", &name);
                files.0.insert("example.obj".to_owned(), mesh);
                files.0.insert("example.robi".to_owned(), files.0["S4.robi"].clone() + "model example.obj\n");
                looks("example.robi", &files)
            }
            "toml" => {
                let robi = files.0["S4.robi"].clone();
                files.0.insert("example.robi".to_owned(), robi);
                load_robi("example.robi", &files).1.diagnostics
            }
            other => panic!("no reader for examples tagged `{other}`"),
        }
    }
}

/// Diagnostics of the mesh of a robot type.
fn looks(robi: &str, files: &dyn Files) -> Vec<Diagnostic> {
    let mut reader = MeshReader::new(files);
    load_robi(robi, files).0.and_then(|robi| reader.robot(&robi));
    reader.finish().0
}

/// Page of a code: the lines before the examples, and the examples.
struct Page {
    text: &'static str,
    wrong: Option<Example>,
    right: Option<Example>,
}

impl Page {
    fn of(code: Code) -> Self {
        let text = code.page();
        let [wrong, right] = ["wrong", "right"].map(|role| example(text, role));
        Self { text, wrong, right }
    }

    /// Severities that the page's third line allows.
    fn severities(&self) -> Vec<Severity> {
        let line = self.text.lines().nth(2).unwrap_or_default();
        let stated = line.split("**").nth(1).unwrap_or_default();
        let severities = [("error", Severity::Error), ("warning", Severity::Warning)];
        stated
            .split(" or ")
            .filter_map(|word| severities.iter().find(|(name, _)| *name == word).map(|severities| severities.1))
            .collect()
    }

    /// Codes that the page lists as accompanying its own, in a line `Along with it: [CODE](CODE.md).`
    fn along(&self) -> BTreeSet<&str> {
        let line = self.text.lines().find_map(|line| line.strip_prefix("Along with it: ")).unwrap_or_default();
        line.split('[').skip(1).filter_map(|rest| rest.split_once(']')).map(|(code, _)| code).collect()
    }

    /// Defects of the page's examples for `code`.
    fn complaints(&self, code: Code) -> Vec<String> {
        let (Some(wrong), Some(right)) = (&self.wrong, &self.right) else {
            return vec!["the page has no example fenced as ```KIND wrong, or none as ```KIND right".to_owned()];
        };
        let reported = wrong.diagnostics();
        let mut complaints = Vec::new();
        if !reported.iter().any(|diagnostic| diagnostic.code == code) {
            complaints.push(format!("it is not reported for\n{}", wrong.text));
        }
        let along = self.along();
        let belongs = |diagnostic: &Diagnostic| match diagnostic.code == code {
            true => self.severities().contains(&diagnostic.severity),
            false => along.contains(diagnostic.code.name()),
        };
        let others = reported.iter().filter(|diagnostic| !belongs(diagnostic));
        complaints
            .extend(others.map(|diagnostic| format!("another mistake or severity in the wrong example: {diagnostic}")));
        complaints.extend(
            right.diagnostics().iter().map(|diagnostic| format!("a mistake in the right example: {diagnostic}")),
        );
        complaints
    }
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/formats/codes")
}

/// The block of `text` that is fenced as "```KIND ROLE".
fn example(text: &str, role: &str) -> Option<Example> {
    let mut blocks = text.split("\n```").skip(1).step_by(2).filter_map(|block| {
        let (tag, body) = block.split_once('\n')?;
        let (kind, tagged) = tag.split_once(' ')?;
        (tagged == role).then(|| Example { kind: kind.to_owned(), text: format!("{body}\n") })
    });
    let first = blocks.next();
    assert!(blocks.next().is_none(), "one example that is {role}");
    first
}

#[test]
fn the_pages_are_those_of_the_registry() {
    let entries = fs::read_dir(folder()).expect("the folder of pages");
    let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a readable name"));
    let pages: BTreeSet<String> = names.collect();
    let codes: BTreeSet<String> = Code::ALL.iter().map(|code| format!("{code}.md")).collect();
    assert_eq!(pages, codes, "docs/formats/codes/ has one page for each code, and no other");
}

#[test]
fn every_page_agrees_with_the_registry() {
    for code in Code::ALL {
        let page = Page::of(*code);
        let mut lines = page.text.lines();
        assert_eq!(lines.next(), Some(format!("# {code}").as_str()));
        assert_eq!(lines.next(), Some(""), "{code}");
        let line = lines.next().unwrap_or_default();
        assert!(!page.severities().is_empty(), "{code}: `{line}` does not begin with **error** or **warning**");
        assert_eq!(line.split_once(": ").map(|(_, meaning)| meaning), Some(code.meaning()), "{code}");
        assert!(page.text.lines().count() > 4, "{code}: a page says why it matters");
        assert!(page.text.contains("\nSee ["), "{code}: a page says where to read on");
    }
}

#[test]
fn examples_have_the_mistake_and_no_other() {
    let mut wrong = Vec::new();
    for code in Code::ALL.iter().filter(|code| !WITHOUT_EXAMPLE.contains(code)) {
        wrong.extend(Page::of(*code).complaints(*code).into_iter().map(|complaint| format!("{code}: {complaint}")));
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn codes_without_an_example_are_the_listed_ones() {
    for code in WITHOUT_EXAMPLE {
        let page = Page::of(code);
        assert!(page.wrong.is_none() && page.right.is_none(), "{code} has an example: take it from the list");
    }
}
