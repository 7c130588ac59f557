//! The module `eye` of robot programs in Python, generated from the lists and `python/runtime.py`.

use std::sync::LazyLock;

use crate::constant::Constant;
use crate::robios6::Robios6Call;
use crate::robios7::{CONSTANTS, Robios7Call};
use crate::support::SupportCall;
use crate::table::{Function, Parameter};

/// Hand-written part of the module, with placeholders for the generated parts.
const RUNTIME: &str = include_str!("../python/runtime.py");

/// The module `eye`: constants and functions of RoBIOS-7, and the child's side of the protocol. As a script it runs the
/// program whose path is its argument.
pub fn eye() -> String {
    let support = SupportCall::ALL.iter().map(|call| (0, call.index(), call.function()));
    let robios7 = Robios7Call::ALL.iter().map(|call| (7, call.index(), call.function()));
    let mut calls = String::new();
    for (list, number, function) in support.chain(robios7) {
        let name = if list == 0 { format!("_support_{}", function.name) } else { format!("_{}", function.name) };
        let kinds: String = function.parameters.iter().map(|parameter| format_letter(parameter.kind)).collect();
        let result = format_letter(function.returns);
        calls += &format!("{name} = (\"{}\", {list}, {number}, \"{kinds}\", \"{result}\")\n", function.name);
    }
    let generated = Robios7Call::ALL.iter().map(|call| call.function()).filter(|function| is_generated(function));
    let functions: Vec<String> = generated.map(definition).collect();
    let names = Robios6Call::ALL.iter().map(|call| call.function().name);
    let robios6_only: Vec<&str> = names.filter(|name| Robios7Call::from_name(name).is_none()).collect();
    RUNTIME
        .replace("# @CONSTANTS@", CONSTANTS.iter().map(constant).collect::<String>().trim_end())
        .replace("# @ROBIOS6@", &robios6_only.join("\n"))
        .replace("# @CALLS@", calls.trim_end())
        .replace("# @FUNCTIONS@", functions.join("\n\n\n").trim_end())
}

/// Form of a function in Python.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    /// The call, such as `PSDGet(psd)`.
    pub signature: String,
    /// Difference from the form in C, such as another result; `None` if there is none.
    pub note: Option<String>,
}

/// The form of the RoBIOS-7 function `name` in the module [`eye`]; `None` if the module has no function of this name.
pub fn form(name: &str) -> Option<Form> {
    static EYE: LazyLock<String> = LazyLock::new(eye);
    let start = format!("\ndef {name}(");
    let (_, rest) = EYE.split_once(&start)?;
    let (parameters, rest) = rest.split_once("):\n")?;
    let doc =
        rest.trim_start().strip_prefix("\"\"\"").and_then(|doc| doc.split_once("\"\"\"")).map_or("", |(doc, _)| doc);
    let function = Robios7Call::from_name(name).map(|call| call.function())?;
    let outs: Vec<&str> = function
        .parameters
        .iter()
        .filter(|parameter| parameter.kind.starts_with("Out<"))
        .map(|parameter| parameter.name)
        .collect();
    let note = match is_generated(function) {
        true if outs.is_empty() => None,
        true => Some(format!("The result is `{}`.", outs.join(", "))),
        false => Some(doc.split_whitespace().collect::<Vec<_>>().join(" ")),
    };
    Some(Form { signature: format!("{name}({parameters})"), note })
}

/// Returns true for a function whose form in Python is generated from the list; the others are in `runtime.py`.
fn is_generated(function: &Function) -> bool {
    let hand_written = [
        "LCDPrintf",
        "LCDSetPrintf",
        "LCDImageSize",
        "LCDImageStart",
        "IPSetSize",
        "KEYReadXY",
        "SERSend",
        "LIDARSet",
        "RADIOSend",
        "RADIOCheck",
        "SIMGetRobot",
        "SIMSetRobot",
        "SIMGetObject",
        "SIMSetObject",
        "LEGGetJoint",
        "LEGGetHeight",
    ];
    let is_sized = |kind: &str| ["OutBytes", "OutInts", "OutFloats"].contains(&kind);
    !hand_written.contains(&function.name)
        && function.parameters.iter().all(|parameter| !is_sized(parameter.kind) && parameter.name != "width_px")
}

fn constant(constant: &Constant) -> String {
    let value =
        if constant.value >= 0x1_0000 { format!("{:#08X}", constant.value) } else { constant.value.to_string() };
    format!("{} = {}\n", constant.name, value.replace("0X", "0x"))
}

/// Definition of a generated function in Python.
fn definition(function: &Function) -> String {
    let is_out = |kind: &str| kind.starts_with("Out<");
    let (outs, inputs): (Vec<&Parameter>, Vec<&Parameter>) =
        function.parameters.iter().partition(|parameter| is_out(parameter.kind));
    let optional: Vec<String> = outs.iter().map(|out| format!("{}=None", out.name)).collect();
    let names: Vec<&str> = inputs.iter().map(|input| input.name).collect();
    let signature = names.iter().copied().chain(optional.iter().map(String::as_str)).collect::<Vec<_>>().join(", ");
    let values: Vec<&str> = function
        .parameters
        .iter()
        .map(|parameter| if is_out(parameter.kind) { "None" } else { parameter.name })
        .collect();
    let name = function.name;
    let call = format!("_call({})", [&[format!("_{name}").as_str()], &values[..]].concat().join(", "));
    let body = match (outs.is_empty(), function.returns) {
        (true, "()") => call,
        (true, _) => format!("return {call}[0]"),
        (false, _) => {
            let targets: Vec<&str> = outs.iter().map(|out| out.name).collect();
            format!("return _out(\"{name}\", {call}, {})", targets.join(", "))
        }
    };
    let doc = function.doc.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n    ");
    // Values that C writes through pointers are returned instead of the status, unless the program passes ctypes values
    // for them.
    let doc = if outs.is_empty() { doc } else { doc.split(" Returns ").next().unwrap_or_default().to_owned() };
    format!("def {name}({signature}):\n    \"\"\"{doc}\"\"\"\n    {body}")
}

/// Letter of the format in which the runtime packs a parameter or a result of this type.
fn format_letter(kind: &str) -> &'static str {
    match kind {
        "()" => "",
        "i32" | "Color" | "Timer" => "i",
        "u32" => "I",
        "u8" | "Char" | "Flag" => "B",
        "f32" => "f",
        "f64" => "d",
        "i64" => "q",
        "u64" => "Q",
        "Text" => "t",
        "Bytes" => "b",
        "Out<i32>" => "o",
        "Out<u8>" => "O",
        "Out<f32>" => "e",
        "OutBytes" => "r",
        "OutInts" => "R",
        "OutFloats" => "F",
        "Callback" => "k",
        other => panic!("no form in Python is known for `{other}`: add it here and in runtime.py"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_function_is_in_the_module_once() {
        let eye = eye();
        for call in Robios7Call::ALL {
            let definition = format!("\ndef {}(", call.name());
            assert_eq!(eye.matches(&definition).count(), 1, "{}", call.name());
        }
    }
}
