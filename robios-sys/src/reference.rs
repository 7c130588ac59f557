//! Reference pages of both generations, generated from the lists of functions and constants and from the examples of
//! each family.
//!
//! The doc of a function has a fixed order: sentences that describe what it does; one clause for each parameter,
//! `name: text.`, or `name, name: text.`; `Returns ...`. A parameter without a clause is described by its type.

use std::fmt::Write as _;

use crate::c::{self, prototype};
use crate::constant::Constant;
use crate::python::{self, Form};
use crate::robios6::{self, Robios6Call};
use crate::robios7::{self, Robios7Call};
use crate::table::{Family, Function};

/// A generated page or a source of an example: a path below `docs`, and its text.
pub type Page = (&'static str, String);

/// The reference pages. `example` reads the text of a file below `docs/examples`, such as `robios7/vw.py`.
///
/// # Errors
/// Errors of `example`.
pub fn pages<E>(mut example: impl FnMut(&str) -> Result<String, E>) -> Result<[Page; 2], E> {
    let six: Vec<_> = Robios6Call::ALL.iter().map(|call| call.function()).collect();
    let seven: Vec<_> = Robios7Call::ALL.iter().map(|call| call.function()).collect();
    let mut text6 = BEGIN6.to_owned();
    families(
        &mut text6,
        Robios6Call::FAMILIES,
        &six,
        |_| None,
        |family| Ok(fenced("c", &example(&format!("robios6/{family}.c"))?)),
    )?;
    text6 += &constants(&[
        ("Constants", robios6::CONSTANTS),
        ("Kinds of devices, in `hdt.h`", robios6::hdt_type::HDT_TYPES),
        ("Devices, in `hdt_sem.h`", robios6::semantics::SEMANTICS),
    ]);
    text6 += &variants(c::VARIANTS6);
    let mut text7 = BEGIN7.to_owned();
    families(&mut text7, Robios7Call::FAMILIES, &seven, python::form, |family| {
        let c = fenced("c", &example(&format!("robios7/{family}.c"))?);
        Ok(c + "\n" + &fenced("python", &example(&format!("robios7/{family}.py"))?))
    })?;
    text7 += &constants(&[("Constants", robios7::CONSTANTS)]);
    text7 += &variants(c::VARIANTS7);
    Ok([("reference-robios6.md", text6), ("reference-robios7.md", text7)])
}

/// The parts of a function's doc.
#[derive(Debug, PartialEq, Eq)]
pub struct Description {
    /// Sentences that describe what the function does; lists contain only the first one.
    pub text: Vec<String>,
    /// The parameters in the order of the C prototype: name, and text without the final full stop.
    pub parameters: Vec<(String, Option<String>)>,
    /// The result, without `Returns` and the final full stop.
    pub result: Option<String>,
}

/// Splits the doc of `function` into its parts.
pub fn describe(function: &Function) -> Description {
    let names = parameter_names(&prototype(function));
    let doc = function.doc.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    let mut description = Description {
        text: Vec::new(),
        parameters: names.iter().map(|name| (name.clone(), None)).collect(),
        result: None,
    };
    let mut clause: Vec<String> = Vec::new();
    for sentence in doc.trim_end_matches('.').split(". ") {
        if let Some(result) = sentence.strip_prefix("Returns ") {
            description.result = Some(result.to_owned());
        } else if let Some(result) = &mut description.result {
            *result += &format!(". {sentence}");
        } else if let Some((described, text)) = clause_of(sentence, &names) {
            for (name, parameter_text) in &mut description.parameters {
                if described.contains(&name.as_str()) {
                    *parameter_text = Some(text.to_owned());
                }
            }
            clause = described.iter().map(|name| (*name).to_owned()).collect();
        } else if clause.is_empty() {
            description.text.push(format!("{sentence}."));
        } else {
            for (_, parameter_text) in description.parameters.iter_mut().filter(|(name, _)| clause.contains(name)) {
                *parameter_text = parameter_text.take().map(|text| format!("{text}. {sentence}"));
            }
        }
    }
    for (name, parameter_text) in &mut description.parameters {
        let kind = function.parameters.iter().find(|parameter| parameter.name == name).map(|parameter| parameter.kind);
        *parameter_text = parameter_text.take().or_else(|| kind.and_then(kind_description).map(str::to_owned));
    }
    description
}

/// The parameters that a sentence of the form `name, name: text` describes, and the text.
fn clause_of<'a>(sentence: &'a str, names: &[String]) -> Option<(Vec<&'a str>, &'a str)> {
    let (head, text) = sentence.split_once(": ")?;
    let described: Vec<&str> = head.split(", ").collect();
    described.iter().all(|name| names.iter().any(|known| known == name)).then_some((described, text))
}

/// Names of the parameters of a prototype in C.
fn parameter_names(prototype: &str) -> Vec<String> {
    let (_, list) = prototype.split_once('(').expect("a prototype has parameters");
    let list = list.strip_suffix(')').expect("a prototype ends in a bracket");
    let named = list.split(',').map(str::trim).filter(|part| !["", "void", "...", "EYESIM_ANY"].contains(part));
    named
        .map(|part| match part.split_once("(*") {
            Some((_, name)) => name.split(')').next().unwrap_or_default().to_owned(),
            None => {
                let part = part.split('[').next().unwrap_or_default();
                part.rsplit([' ', '*']).next().unwrap_or_default().to_owned()
            }
        })
        .collect()
}

/// Description of a parameter that follows from its type.
fn kind_description(kind: &str) -> Option<&'static str> {
    Some(match kind {
        "VWHandle" => "handle of `VWInit`",
        "PSDHandle" => "handle of `PSDInit`",
        "ServoHandle" => "handle of `SERVOInit`",
        "MotorHandle" => "handle of `MOTORInit`",
        "QuadHandle" => "handle of `QUADInit`",
        "BumpHandle" => "handle of `BUMPInit`",
        "IRHandle" => "handle of `IRInit`",
        "TimerHandle" | "Timer" => "timer of `OSAttachTimer`",
        "Task" => "task of `OSSpawn`; 0 is the current one",
        "Semaphore" => "semaphore of `OSSemInit`",
        "Color" => "colour `0xRRGGBB`, or a constant such as `RED`",
        "In<Image>" => "grey image to read, 82 x 62 bytes",
        "Out<Image>" => "grey image to write, 82 x 62 bytes",
        "In<ColImage>" => "colour image to read, 82 x 62 x 3 bytes",
        "Out<ColImage>" => "colour image to write, 82 x 62 x 3 bytes",
        "Out<MonoFrame>" => "4800 bytes to write",
        "Out<ColorFrame>" => "14400 bytes to write",
        "Out<BayerFrame>" => "19200 bytes to write",
        _ => return None,
    })
}

/// Appends a section for each family and its functions.
fn families<E>(
    page: &mut String,
    families: &[Family],
    functions: &[&Function],
    python: fn(&str) -> Option<Form>,
    mut example: impl FnMut(&str) -> Result<String, E>,
) -> Result<(), E> {
    for family in families {
        let of_family = functions.iter().filter(|function| function.family == family.name);
        write!(page, "\n## {}: {}\n\nSource: {}.\n", family.name, family.title, family.source).expect("a string");
        write!(page, "\n### Example of {}\n\n{}", family.name, example(&family.name.to_lowercase())?)
            .expect("a string");
        of_family.for_each(|function| *page += &section(function, python(function.name)));
    }
    Ok(())
}

fn section(function: &Function, python: Option<Form>) -> String {
    let Description { text, parameters, result } = describe(function);
    let mut page = format!("\n### {}\n\n```c\n{};\n```\n\n", function.name, prototype(function));
    writeln!(page, "{}\n", text.join(" ")).expect("a string");
    for (name, text) in &parameters {
        writeln!(page, "- `{name}`: {}.", text.as_deref().unwrap_or("see above")).expect("a string");
    }
    match result {
        Some(result) => writeln!(page, "- **Result:** {result}.").expect("a string"),
        None => page += "- **Result:** none.\n",
    }
    if let Some(python) = python {
        writeln!(
            page,
            "- **Python:** `{}`{}",
            python.signature,
            python.note.map_or(String::new(), |it| format!(". {it}"))
        )
        .expect("a string");
    }
    page
}

fn fenced(language: &str, text: &str) -> String {
    format!("```{language}\n{}\n```\n", text.trim_end())
}

fn constants(lists: &[(&str, &[Constant])]) -> String {
    let mut page = String::new();
    for (title, list) in lists {
        write!(page, "\n## {title}\n\n| constant | value | meaning |\n|---|---|---|\n").expect("a string");
        for Constant { name, value, doc } in *list {
            let value =
                if *value >= 0x1_0000 { format!("{value:#08X}").replace("0X", "0x") } else { value.to_string() };
            writeln!(page, "| `{name}` | {value} | {} |", doc.concat().trim()).expect("a string");
        }
    }
    page
}

/// The declarations of `variants.h`, which are not in the list.
fn variants(header: &str) -> String {
    let (_, declarations) = header.split_once("extern \"C\" {\n#endif\n").expect("the header's declarations");
    let end = declarations.find("#ifdef __cplusplus").expect("their end");
    let declarations = declarations[..end].split("/* ---- the same name").next().unwrap_or_default();
    format!(
        "\n## Other names\n\n`eyebot.h` declares these, too, for programs of other years.\n\n{}",
        fenced("c", declarations.trim())
    )
}

const BEGIN6: &str = "\
# Reference of RoBIOS 6

All functions of RoBIOS 6 in C, with parameters, units and results. Lengths of drives are in metres, angles in radians, distances of sensors
in millimetres, times in hundredths of a second. Handles are one bit each and can be OR-ed; 0 is not a handle. Null pointers, wrong handles and
numbers out of range give the documented result and change nothing. [robios6.md](robios6.md) describes what the simulator does in each
call, and [dialects.md](dialects.md) the differences from RoBIOS-7. There is no RoBIOS 6 in Python; in Rust the crate `robios-api` has these
functions as methods ([rust-programs.md](rust-programs.md)).

`cargo run -p robios-sys --bin generate` writes this page from the lists of functions. Each family begins with an example;
[examples](examples/README.md) says how to run all of them.
";

const BEGIN7: &str = "\
# Reference of RoBIOS-7

All functions of RoBIOS-7 in C and Python, with parameters, units and results. Lengths are in millimetres, angles in degrees, times in
milliseconds; devices have numbers from 1. Null pointers and numbers out of range give the documented result and change nothing. In Python a
function returns what C writes through pointers, unless the program passes something to write to ([python.md](python.md)).
[robios7.md](robios7.md) describes what the simulator does in each call, and [dialects.md](dialects.md) the differences from RoBIOS 6. In
Rust the crate `robios-api` has these functions as methods ([rust-programs.md](rust-programs.md)).

`cargo run -p robios-sys --bin generate` writes this page from the lists of functions. Each family begins with an example in C and the same
one in Python; [examples](examples/README.md) says how to run all of them.
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_and_every_result_is_described() {
        let six = Robios6Call::ALL.iter().map(|call| call.function());
        let mut missing = Vec::new();
        for function in six.chain(Robios7Call::ALL.iter().map(|call| call.function())) {
            let description = describe(function);
            let undescribed =
                description.parameters.iter().filter(|(_, text)| text.is_none()).map(|(name, _)| name.as_str());
            let mut missing_parts: Vec<&str> = undescribed.collect();
            if description.text.is_empty() {
                missing_parts.push("a sentence");
            }
            if description.result.is_none() && function.returns != "()" {
                missing_parts.push("`Returns`");
            }
            if !missing_parts.is_empty() {
                missing.push(format!("{} of {}: {}", function.name, function.family, missing_parts.join(", ")));
            }
        }
        assert!(missing.is_empty(), "{missing:#?}");
    }

    #[test]
    fn doc_is_split_into_its_parts() {
        let function = Robios6Call::VWDriveTurn.function();
        let description = describe(function);
        assert_eq!(
            description.text[0],
            "Turns on the spot; starts at the end of the call, replaces a drive in progress and does not wait."
        );
        assert_eq!(description.parameters[0], ("handle".to_owned(), Some("handle of `VWInit`".to_owned())));
        assert_eq!(description.parameters[2], ("w_radps".to_owned(), Some("rate in rad/s, > 0".to_owned())));
        assert_eq!(description.result.as_deref(), Some("0, or -1 if handle is invalid"));
        assert_eq!(parameter_names("int LCDSetPrintf(int row, const char *format, ...)"), ["row", "format"]);
        assert_eq!(
            parameter_names("struct tcb *OSSpawn(const char *name, void (*code)(void), int n)"),
            ["name", "code", "n"]
        );
        assert_eq!(parameter_names("int LEGGetLink(int leg, float pose[6])"), ["leg", "pose"]);
    }
}
