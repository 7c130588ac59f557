//! Generates C headers and parts of the C shim from the lists of functions and constants.

use std::fmt::Write as _;

use crate::abi;
use crate::constant::Constant;
use crate::robios6::{self, Robios6Call, Robios6Table, hdt_type, semantics};
use crate::robios7::{self, Robios7Call, Robios7Table};
use crate::support::{SupportCall, SupportTable};
use crate::table::{Family, Function, Parameter};

/// Input from which header and shim of one generation are generated.
struct Generation {
    /// Title in the header.
    title: &'static str,
    families: &'static [Family],
    functions: Vec<&'static Function>,
    constants: &'static [Constant],
    /// Headers that `eyebot.h` includes before its functions.
    includes: &'static [&'static str],
    /// Headers that `eyebot.h` includes after its functions.
    includes_after: &'static [&'static str],
}

/// Files that are generated from the lists: the path in the folder of this crate, and the text.
pub fn generated_files() -> [(&'static str, String); 7] {
    let (six, seven) = (generation6(), generation7());
    let support: Vec<_> = SupportCall::ALL.iter().map(|call| call.function()).collect();
    [
        ("include/robios6/eyebot.h", eyebot_header(&six)),
        ("include/robios6/hdt_sem.h", constant_header("HDT_SEM", "which device of its kind", semantics::SEMANTICS)),
        ("include/robios6/hdt.h", constant_header("HDT", "kinds of devices", hdt_type::HDT_TYPES)),
        ("include/robios7/eyebot.h", eyebot_header(&seven)),
        ("shim/abi.h", abi_header(&support, &six.functions, &seven.functions)),
        ("shim/robios6.c", shim_functions(&six)),
        ("shim/robios7.c", shim_functions(&seven)),
    ]
}

fn generation6() -> Generation {
    Generation {
        title: "RoBIOS 6",
        families: Robios6Call::FAMILIES,
        functions: Robios6Call::ALL.iter().map(|call| call.function()).collect(),
        constants: robios6::CONSTANTS,
        includes: &["types.h", "hdt_sem.h"],
        includes_after: &["variants.h"],
    }
}

fn generation7() -> Generation {
    Generation {
        title: "RoBIOS-7",
        families: Robios7Call::FAMILIES,
        functions: Robios7Call::ALL.iter().map(|call| call.function()).collect(),
        constants: robios7::CONSTANTS,
        includes: &["types.h"],
        includes_after: &["variants.h"],
    }
}

const NOTICE: &str = "Written from the lists of functions and constants of eyesim.";

/// C types of a kind of parameter or result.
struct CType {
    /// Type in the program's header.
    header: &'static str,
    /// Type in the tables.
    abi: &'static str,
}

impl CType {
    fn of(kind: &str) -> Self {
        let (header, abi) = match kind {
            "()" => ("void", "void"),
            "i32" => ("int", "int32_t"),
            "u32" => ("unsigned int", "uint32_t"),
            "i64" => ("long", "int64_t"),
            "u64" => ("unsigned long", "uint64_t"),
            "f32" => ("float", "float"),
            "f64" => ("double", "double"),
            "u8" | "Byte" => ("BYTE", "uint8_t"),
            "Char" => ("char", "uint8_t"),
            "Flag" => ("bool", "uint8_t"),
            "Color" => ("COLOR", "int32_t"),
            "Timer" => ("TIMER", "int32_t"),
            "Bool" => ("BOOL", "int32_t"),
            "Metre" => ("meter", "float"),
            "Radian" => ("radians", "float"),
            "MetrePerSecond" => ("meterPerSec", "float"),
            "RadianPerSecond" => ("radPerSec", "float"),
            "DeviceSemantics" => ("DeviceSemantics", "int32_t"),
            "TypeID" => ("TypeID", "int32_t"),
            "MotorHandle" => ("MotorHandle", "int32_t"),
            "QuadHandle" => ("QuadHandle", "int32_t"),
            "ServoHandle" => ("ServoHandle", "int32_t"),
            "PSDHandle" => ("PSDHandle", "int32_t"),
            "VWHandle" => ("VWHandle", "int32_t"),
            "BumpHandle" => ("BumpHandle", "int32_t"),
            "IRHandle" => ("IRHandle", "int32_t"),
            "TimerHandle" => ("TimerHandle", "int32_t"),
            "Task" => ("struct tcb *", "int32_t"),
            "Semaphore" => ("struct sem *", "int32_t"),
            "Text" => ("const char *", "struct eyesim_bytes"),
            "Bytes" => ("const BYTE *", "struct eyesim_bytes"),
            "OutBytes" => ("BYTE *", "struct eyesim_room"),
            "OutInts" => ("int *", "struct eyesim_room"),
            "OutFloats" => ("float *", "struct eyesim_room"),
            "Callback" => ("TimerFnc ", "struct eyesim_callback"),
            "In<Image>" => ("image *", "const void *"),
            "In<ColImage>" => ("colimage *", "const void *"),
            "In<BitImage>" => ("BYTE *", "const void *"),
            "In<RadioIOParameters>" => ("RadioIOParameters *", "const void *"),
            "InOut<ColImage>" => ("colimage *", "void *"),
            "InOut<Semaphore>" => ("struct sem *", "void *"),
            "Out<i32>" => ("int *", "void *"),
            "Out<f32>" => ("float *", "void *"),
            "Out<Byte>" | "Out<u8>" | "Out<MonoFrame>" | "Out<ColorFrame>" | "Out<BayerFrame>" => ("BYTE *", "void *"),
            "Out<Char>" | "Out<[u8; 16]>" => ("char *", "void *"),
            "Out<Image>" => ("image *", "void *"),
            "Out<ColImage>" => ("colimage *", "void *"),
            "Out<PositionType>" => ("PositionType *", "void *"),
            "Out<SpeedType>" => ("SpeedType *", "void *"),
            "Out<RadioIOParameters>" => ("RadioIOParameters *", "void *"),
            "Out<RadioStatus>" => ("RadioStatus *", "void *"),
            "Out<HDTEntry>" => ("HDT_entry_type *", "void *"),
            other => panic!("no C type is known for `{other}`: add it here"),
        };
        Self { header, abi }
    }
}

/// Declaration `type name`, without a blank after a star.
fn declared(kind: &str, name: &str) -> String {
    let blank = if kind.ends_with(['*', ' ']) { "" } else { " " };
    format!("{kind}{blank}{name}")
}

/// The prototype of a function in C, without a semicolon.
pub fn prototype(function: &Function) -> String {
    if let Some(prototype) = function.prototype {
        return prototype.to_owned();
    }
    let parameters: Vec<_> = function.parameters.iter().map(|p| declared(CType::of(p.kind).header, p.name)).collect();
    let parameters = if parameters.is_empty() { "void".to_owned() } else { parameters.join(", ") };
    format!("{}({parameters})", declared(CType::of(function.returns).header, function.name))
}

/// The doc of a function as a C comment.
fn comment(function: &Function, family: &Family) -> String {
    let mut text = String::new();
    for (index, line) in function.doc.iter().enumerate() {
        let start = if index == 0 { "/*" } else { " *" };
        writeln!(text, "{start}{line}").expect("a string takes every line");
    }
    let is_pointer = |p: &Parameter| CType::of(p.kind).header.contains('*');
    let is_callback = |p: &Parameter| p.kind == "Callback";
    let pointers = if function.parameters.iter().any(is_callback) {
        "The function is kept until the program ends."
    } else if function.parameters.iter().any(is_pointer) {
        "Pointers belong to the program and are not kept."
    } else {
        "No pointers."
    };
    writeln!(text, " * [any task of the robot]  {pointers}\n * Source: {}. */", family.source)
        .expect("a string takes every line");
    text
}

fn printf_attribute(function: &Function) -> &'static str {
    match function.name {
        "LCDPrintf" => " EYESIM_PRINTF(1, 2)",
        "LCDSetPrintf" => " EYESIM_PRINTF(3, 4)",
        _ => "",
    }
}

fn eyebot_header(generation: &Generation) -> String {
    let title = generation.title;
    let include = |headers: &[&str]| headers.iter().map(|name| format!("#include \"{name}\"\n")).collect::<String>();
    let mut text = format!(
        "/* {title} for robot programs.\n\
         \x20*\n\
         \x20* Every call takes effect, and takes its readings, at its end. Calls that wait say so; all others return immediately.\n\
         \x20* [any task of the robot] marks who may call a function: all may be called from timer functions too, where those\n\
         \x20* that wait are errors. No call keeps a pointer. Null pointers and wrong handles give the documented failure.\n\
         \x20*\n\
         \x20* {NOTICE} */\n\
         #ifndef EYESIM_EYEBOT_H\n#define EYESIM_EYEBOT_H\n\n{}\n",
        include(generation.includes)
    );
    text += &defines(generation.constants);
    text += "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for family in generation.families {
        writeln!(text, "\n/* ---- {}: {} ---- */", family.name, family.title).expect("a string takes every line");
        for function in generation.functions.iter().filter(|function| function.family == family.name) {
            let (comment, prototype) = (comment(function, family), prototype(function));
            write!(text, "\n{comment}{prototype}{};\n", printf_attribute(function)).expect("a string takes every line");
        }
    }
    text += "\n#ifdef __cplusplus\n}\n#endif\n";
    if !generation.includes_after.is_empty() {
        write!(text, "\n{}", include(generation.includes_after)).expect("a string takes every line");
    }
    text + "\n#endif\n"
}

fn constant_header(name: &str, title: &str, constants: &[Constant]) -> String {
    let lines = defines(constants);
    format!(
        "/* RoBIOS 6: {title}.\n * {NOTICE} */\n#ifndef EYESIM_{name}_H\n#define EYESIM_{name}_H\n\n{lines}\n#endif\n"
    )
}

fn defines(constants: &[Constant]) -> String {
    let mut text = String::new();
    for constant in constants {
        let value = match constant.value {
            value @ ..0 => format!("({value})"),
            value @ 0x1_0000.. => format!("{value:#08X}").replace("0X", "0x"),
            value => value.to_string(),
        };
        // Old programs define these two themselves.
        if let name @ ("TRUE" | "FALSE") = constant.name {
            writeln!(text, "#undef {name}").expect("a string takes every line");
        }
        let (name, doc) = (constant.name, constant.doc.concat().replace('`', ""));
        writeln!(text, "#define {name:<17} {value:>6} /*{doc} */").expect("a string takes every line");
    }
    text
}

fn abi_header(support: &[&Function], robios6: &[&Function], robios7: &[&Function]) -> String {
    let mut text = format!(
        "/* What crosses between a program's library and the host: see docs/abi.md.\n * {NOTICE} */\n\
         #ifndef EYESIM_ABI_H\n#define EYESIM_ABI_H\n\n#include <stddef.h>\n#include <stdint.h>\n\n\
         #define EYESIM_ABI_VERSION {}\n#define EYESIM_STOP 1\n#define EYESIM_EXIT_STOPPED INT32_MIN\n\
         #define EYESIM_EXIT_ABORTED {}\n#define EYESIM_LANGUAGE_C {}\n#define EYESIM_LANGUAGE_CPP {}\n\
         #define EYESIM_FLAG_VOID_MAIN {}\n#define EYESIM_CONSOLE_LINE {}\n#define EYESIM_CONSTRUCTORS {:#x}\n#define EYESIM_CONSTRUCTORS_SIZE {:#x}\n\n",
        abi::ABI_VERSION,
        abi::EXIT_ABORTED,
        abi::language::C,
        abi::language::CPP,
        abi::flag::VOID_MAIN,
        abi::CONSOLE_LINE,
        abi::CONSTRUCTOR_TAGS[0],
        abi::CONSTRUCTOR_TAGS[1],
    );
    text += "struct eyesim_bytes { const void *data; size_t len; };\n\
             struct eyesim_room { void *data; size_t len; };\n\
             struct eyesim_callback { int32_t (*code)(void *data); void *data; };\n\n";
    text += &table("eyesim_support", SupportTable::VERSION, support);
    text += &table("eyesim_robios6", Robios6Table::VERSION, robios6);
    text += &table("eyesim_robios7", Robios7Table::VERSION, robios7);
    text += "struct eyesim_host {\n    uint32_t size;\n    uint32_t abi;\n    const struct eyesim_support *support;\n    \
             const struct eyesim_robios6 *robios6;\n    const struct eyesim_robios7 *robios7;\n};\n\n\
             /* Where the program called the function that it is in: an address in its code, or file and line. */\n\
             struct eyesim_call_site {\n    const void *address;\n    const char *file;\n    size_t file_len;\n    \
             uint32_t line;\n};\n\n\
             /* A console stream: the text since the last end of a line. */\n\
             struct eyesim_console {\n    int32_t stream;\n    size_t used;\n    char *line;\n};\n\n\
             struct eyesim_program {\n    uint32_t size;\n    uint32_t abi;\n    uint32_t generation;\n    \
             uint32_t flags;\n    uint32_t language;\n    uint32_t support_size;\n    uint32_t robios_size;\n    \
             int (*run)(const struct eyesim_host *host, void *robot, int argc, const char *const *argv);\n    \
             const struct eyesim_call_site *call_site;\n    const struct eyesim_console *consoles;\n};\n\n#endif\n";
    text
}

fn table(name: &str, version: u32, functions: &[&Function]) -> String {
    let mut text = format!("/* Version {version}. */\nstruct {name} {{\n    uint32_t size;\n    uint32_t version;\n");
    for function in functions {
        let mut parameters = vec!["void *robot".to_owned()];
        parameters.extend(function.parameters.iter().map(|p| declared(CType::of(p.kind).abi, p.name)));
        parameters.push(format!("{} *result", CType::of(function.returns).abi));
        writeln!(text, "    int32_t (*{})({});", function.name, parameters.join(", "))
            .expect("a string takes every line");
    }
    text + "};\n\n"
}

fn shim_functions(generation: &Generation) -> String {
    let title = generation.title;
    let mut text = format!("/* The {title} functions as a program calls them; part of shim.c.\n * {NOTICE} */\n");
    for function in generation.functions.iter().filter(|function| function.prototype.is_none()) {
        let arguments: String = function.parameters.iter().map(|p| format!("{}, ", argument(p))).collect();
        let (prototype, name) = (prototype(function), function.name);
        let body = match CType::of(function.returns) {
            CType { abi: "void", .. } => format!("    ROBIOS({name}, {arguments}NULL);\n"),
            CType { abi, .. } => {
                format!("    {abi} result = 0;\n    ROBIOS({name}, {arguments}&result);\n    return result;\n")
            }
        };
        write!(text, "\nWEAK {prototype}\n{{\n{body}}}\n").expect("a string takes every line");
    }
    text
}

/// C expression with which the shim passes an argument to the host.
fn argument(parameter: &Parameter) -> String {
    let name = parameter.name;
    match parameter.kind {
        "Text" => format!("text_of({name})"),
        "Callback" => format!("callback_of({name})"),
        "Task" => format!("task_of({name})"),
        "Char" => format!("(uint8_t){name}"),
        _ => name.to_owned(),
    }
}
