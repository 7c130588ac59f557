//! TypeScript types of the page, generated from the types of the protocol.

use std::collections::BTreeMap;
use std::path::Path;

use ts_rs::{TS, TypeVisitor};

use super::{Message, PROTOCOL, Recording, Request};

/// Declarations by name.
#[derive(Default)]
struct Types(BTreeMap<String, String>);

impl TypeVisitor for Types {
    fn visit<T: TS + 'static + ?Sized>(&mut self) {
        // Types of other crates have no output path.
        if T::output_path().is_none() || self.0.contains_key(&T::ident()) {
            return;
        }
        let docs = T::docs().unwrap_or_default();
        self.0.insert(T::ident(), format!("{docs}export {}\n", T::decl()));
        T::visit_dependencies(self);
        T::visit_generics(self);
    }
}

fn declarations() -> String {
    let mut types = Types::default();
    types.visit::<Message>();
    types.visit::<Request>();
    types.visit::<Recording>();
    let types: Vec<_> = types.0.into_values().collect();
    format!(
        "// Messages between server and page, generated from `sim-view/src/protocol`:\n\
         // INSTA_UPDATE=always cargo test -p sim-view typescript\n\n\
         /** Version of the protocol. */\nexport const PROTOCOL = {PROTOCOL};\n\n{}",
        tidy(&types.join("\n"))
    )
}

/// Joins the comment marks of a one-line comment with its text, and indents fields.
fn tidy(types: &str) -> String {
    let mut tidied = String::new();
    let mut lines = types.lines().map(str::trim_end).peekable();
    let mut indent = "";
    while let Some(line) = lines.next() {
        let text = match line {
            "/**" => lines.next().unwrap_or_default(),
            _ => line,
        };
        tidied.push_str(indent);
        match (line, lines.peek()) {
            ("/**", Some(&" */")) => {
                lines.next();
                tidied.push_str(&format!("/** {} */", text.trim_start_matches([' ', '*'])));
            }
            ("/**", _) => tidied.push_str(&format!("/**\n{indent}{text}")),
            _ => tidied.push_str(text),
        }
        tidied.push('\n');
        indent = match line {
            _ if line.ends_with('{') || line.ends_with(',') => "  ",
            _ if line.ends_with(';') => "",
            _ => indent,
        };
    }
    tidied
}

#[test]
fn typescript() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("page/src/protocol/index.ts");
    let generated = declarations();
    assert!(!generated.contains("bigint"), "JavaScript has no integers of 64 bits");
    if std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, &generated).unwrap();
    }
    let current = std::fs::read_to_string(&path).unwrap();
    assert!(
        current == generated,
        "`{}` differs from the types of the protocol: INSTA_UPDATE=always writes it",
        path.display()
    );
}
