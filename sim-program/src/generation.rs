//! Chooses the generation of RoBIOS for which a program is compiled. The headers of both generations are called
//! `eyebot.h`, so the choice precedes the compilation: the user states it, or it follows from the functions that the
//! sources call.

use std::collections::BTreeSet;

use std::path::{Path, PathBuf};

use robios_sys::constant::Constant;
use robios_sys::{Robios6Call, Robios7Call, robios6, robios7};

use super::calls::calls_of;
use super::code::{begins_function, code_only, is_name};
use crate::files::read_regular;

/// A generation of the RoBIOS API.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Generation {
    /// RoBIOS 6: metres, radians, handles.
    Robios6,
    /// RoBIOS-7: millimetres, degrees, numbers.
    Robios7,
}

impl Generation {
    /// Both generations, the older one first.
    pub const ALL: [Self; 2] = [Self::Robios6, Self::Robios7];

    /// The generation with this number, as in `--api 7`.
    pub fn of_number(number: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|generation| generation.number() == number)
    }

    /// The generation's number, 6 or 7.
    pub fn number(self) -> u32 {
        match self {
            Self::Robios6 => 6,
            Self::Robios7 => 7,
        }
    }

    /// The generation's name: `RoBIOS 6`, `RoBIOS-7`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robios6 => "RoBIOS 6",
            Self::Robios7 => "RoBIOS-7",
        }
    }

    /// The other generation.
    pub fn other(self) -> Self {
        match self {
            Self::Robios6 => Self::Robios7,
            Self::Robios7 => Self::Robios6,
        }
    }

    /// Returns true if the generation has a function called `name`; functions of older headers are included.
    pub fn has_function(self, name: &str) -> bool {
        match self {
            Self::Robios6 => Robios6Call::from_name(name).is_some() || VARIANTS_OF_6.contains(&name),
            Self::Robios7 => Robios7Call::from_name(name).is_some() || VARIANTS_OF_7.contains(&name),
        }
    }

    /// The names of the generation's functions.
    pub fn functions(self) -> Vec<&'static str> {
        match self {
            Self::Robios6 => {
                Robios6Call::ALL.iter().map(|call| call.name()).chain(VARIANTS_OF_6.iter().copied()).collect()
            }
            Self::Robios7 => {
                Robios7Call::ALL.iter().map(|call| call.name()).chain(VARIANTS_OF_7.iter().copied()).collect()
            }
        }
    }

    /// Returns true if `name` is a constant or type of the generation's header that a program is unlikely to define:
    /// `QVGA_SIZE`, but not `RED`.
    pub fn has_constant(self, name: &str) -> bool {
        let is_distinctive = |constant: &Constant| constant.name == name && name.contains('_');
        match self {
            Self::Robios6 => {
                let constants = robios6::CONSTANTS.iter().chain(robios6::semantics::SEMANTICS);
                constants.chain(robios6::hdt_type::HDT_TYPES).any(is_distinctive) || TYPES_OF_6.contains(&name)
            }
            Self::Robios7 => {
                let is_size_name =
                    |size: &&str| name.strip_prefix(*size).is_some_and(|rest| SIZE_SUFFIXES_OF_7.contains(&rest));
                robios7::CONSTANTS.iter().any(is_distinctive)
                    || SIZES_OF_7.iter().any(is_size_name)
                    || TYPES_OF_7.contains(&name)
            }
        }
    }
}

/// Types and sizes of the header of RoBIOS 6.
const TYPES_OF_6: &[&str] = &[
    "BumpHandle",
    "IRHandle",
    "MotorHandle",
    "PSDHandle",
    "PositionType",
    "QuadHandle",
    "ServoHandle",
    "SpeedType",
    "VWHandle",
    "colimage",
    "imagecolumns",
    "imagerows",
    "meterPerSec",
    "radPerSec",
];

/// Variables and some constants of the header of RoBIOS-7, and the name of its header for C++.
const TYPES_OF_7: &[&str] = &[
    CPP_HEADER,
    "CAMHEIGHT",
    "CAMPIXELS",
    "CAMSIZE",
    "CAMWIDTH",
    "HELVETICA",
    "IP_HEIGHT",
    "IP_PIXELS",
    "IP_SIZE",
    "IP_WIDTH",
    "ITALICS",
];

/// Sizes of images in RoBIOS-7, and suffixes that form names of constants and types with them.
pub(crate) const SIZES_OF_7: &[&str] = &["QQVGA", "QVGA", "VGA", "CAM1MP", "CAMHD", "CAM5MP"];
const SIZE_SUFFIXES_OF_7: &[&str] = &["", "_X", "_Y", "_PIXELS", "_SIZE", "col", "gray"];

/// Alternative names of functions of RoBIOS 6. Source: `include/robios6/variants.h`.
const VARIANTS_OF_6: &[&str] = &["VWDriveReady"];

/// Functions of older headers of RoBIOS-7, which newer headers replace by other functions. Source:
/// `include/robios7/variants.h`.
const VARIANTS_OF_7: &[&str] = &[
    "LCDGetList",
    "LCDInit",
    "LCDList",
    "LCDListActiveItem",
    "LCDSetList",
    "MOTORPIDoff",
    "MTExit",
    "MTGetUID",
    "MTInit",
    "MTKill",
    "MTSleep",
    "MTSpawn",
    "SEMAInit",
    "SEMALock",
    "SEMAUnlock",
    "SERVODone",
    "SERVOWait",
    "SIMGetPose",
    "SIMLaserScan",
    "SIMSetPose",
    "VWDriveDone",
    "VWDriveReady",
    "VWDriveRemain",
    "VWDriveWait",
];

/// The generation that the user and the scene state for a program, before its sources are scanned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GenerationHint {
    /// Set by `--api` or the scene: overrides everything else.
    pub api: Option<Generation>,
    /// Generation of the simulator in whose dialect the sim file names the robot; used if the sources do not determine
    /// the generation.
    pub dialect: Option<Generation>,
}

/// The generation for which a program is built, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GenerationChoice {
    /// The generation.
    pub generation: Generation,
    /// Reason for the choice.
    pub reason: ChoiceReason,
}

/// Reasons for the choice of a generation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ChoiceReason {
    /// `--api` or the scene states it; the program calls these functions, which only the other generation has, and no
    /// function that only the stated one has. Empty otherwise.
    Stated(Vec<String>),
    /// The program calls these functions, which only this generation has.
    Calls(Vec<String>),
    /// Both generations have the functions called, but only the chosen one has these constants or types.
    Constants(Vec<String>),
    /// Both generations have the functions called, but the program does not compile for the other generation.
    Compiles,
    /// Both generations have the functions called, and the line of the sim file is written for this generation's
    /// simulator.
    Dialect,
    /// Both generations have the functions called, and nothing else decides.
    Default,
    /// The program calls no RoBIOS function.
    NoCalls,
}

impl std::fmt::Display for GenerationChoice {
    /// For example `RoBIOS-7 (VWStraight, VWWait)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (name, other) = (self.generation.name(), self.generation.other());
        match &self.reason {
            ChoiceReason::Stated(_) | ChoiceReason::NoCalls => f.write_str(name),
            ChoiceReason::Compiles => write!(f, "{name}, as it does not compile for {}", other.name()),
            ChoiceReason::Calls(calls) | ChoiceReason::Constants(calls) => {
                let more = if calls.len() > MAX_SHOWN { ", ..." } else { "" };
                write!(f, "{name} ({}{more})", calls[..calls.len().min(MAX_SHOWN)].join(", "))
            }
            ChoiceReason::Dialect => write!(f, "{name}, as the sim file is; its calls are in {} as well", other.name()),
            ChoiceReason::Default => {
                write!(f, "{name}; its calls are in {} as well, which `--api {}` chooses", other.name(), other.number())
            }
        }
    }
}

impl GenerationChoice {
    /// Message for the compilation of the program of `source`: `maze.c: RoBIOS-7 (VWStraight, VWWait)`. `None` if the
    /// choice makes no difference.
    pub fn remark(&self, source: &Path) -> Option<String> {
        (self.reason != ChoiceReason::NoCalls)
            .then(|| format!("{}: {self}", source.file_name().unwrap_or_default().display()))
    }
}

impl GenerationChoice {
    /// Returns true if the choice is a guess, which is dropped if the program compiles only for the other generation.
    pub fn is_guess(&self) -> bool {
        matches!(self.reason, ChoiceReason::Constants(_) | ChoiceReason::Dialect | ChoiceReason::Default)
    }

    /// The other generation, chosen because the program compiles only for it.
    pub fn switched(&self) -> Self {
        Self { generation: self.generation.other(), reason: ChoiceReason::Compiles }
    }
}

/// Maximum number of functions in a message.
pub(super) const MAX_SHOWN: usize = 3;

/// Reasons why no generation can be chosen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GenerationError {
    /// The sources call functions of both generations.
    #[error(
        "`{}` mixes two generations: {} of RoBIOS 6, whose devices have handles, and {} of RoBIOS-7, whose devices have none; {advice}",
        source_file.display(), of_6.join(", "), of_7.join(", ")
    )]
    Both {
        /// The first source.
        source_file: PathBuf,
        /// Functions called that only RoBIOS 6 has, with the places of their first calls.
        of_6: Vec<String>,
        /// Functions called that only RoBIOS-7 has, with the places of their first calls.
        of_7: Vec<String>,
        /// Change that the user must make.
        advice: String,
    },
    /// The sources include a pipe or a device, at which a compiler would hang.
    #[error("`{}`, which the program includes, is not a file", .0.display())]
    Include(PathBuf),
}

/// Chooses the generation for a program with these C or C++ sources, by the first rule that applies:
/// 1. the generation that `hint` states,
/// 2. the only generation that has the functions called,
/// 3. the only generation that has the constants and types used,
/// 4. the generation of the dialect,
/// 5. RoBIOS 6.
///
/// Headers of the program are scanned, too.
///
/// The functions called take precedence over the dialect: sim files in the dialect of one generation also name programs
/// of the other generation, which do not compile with the wrong header. Source: our choice.
///
/// If `folders` are given, whose paths must not contain links, only files in them are scanned.
///
/// # Errors
/// [`GenerationError`] if the program calls functions of both generations, or includes something that is not a file. A
/// source that cannot be read is reported by the compilation.
pub fn choose(
    sources: &[PathBuf],
    hint: GenerationHint,
    folders: Option<&[PathBuf]>,
) -> Result<GenerationChoice, GenerationError> {
    let choice = |generation, reason| Ok(GenerationChoice { generation, reason });
    let Names { calls, constants } = names_in_files(sources, folders)?;
    let only = |generation: Generation| -> Vec<String> {
        let is_only = |name: &&String| generation.has_function(name) && !generation.other().has_function(name);
        calls.iter().filter(is_only).cloned().collect()
    };
    if let Some(generation) = hint.api {
        // A program of both generations is wrong for the other one, too.
        let foreign = if only(generation).is_empty() { only(generation.other()) } else { Vec::new() };
        return choice(generation, ChoiceReason::Stated(foreign));
    }
    let (of_6, of_7) = (only(Generation::Robios6), only(Generation::Robios7));
    match (of_6.is_empty(), of_7.is_empty()) {
        (false, false) => {
            let source_file = sources.first().cloned().unwrap_or_default();
            let advice = advice(&of_6, &of_7, sources);
            let [of_6, of_7] =
                [of_6, of_7].map(|names| names.iter().map(|name| name_with_line(name, sources)).collect());
            Err(GenerationError::Both { source_file, of_6, of_7, advice })
        }
        (false, true) => choice(Generation::Robios6, ChoiceReason::Calls(of_6)),
        (true, false) => choice(Generation::Robios7, ChoiceReason::Calls(of_7)),
        (true, true) => match (generation_of_constants(&constants), hint.dialect) {
            (Some((generation, constants)), _) => choice(generation, ChoiceReason::Constants(constants)),
            (None, dialect) if !calls.iter().any(|name| Generation::Robios6.has_function(name)) => {
                choice(dialect.unwrap_or(Generation::Robios6), ChoiceReason::NoCalls)
            }
            (None, Some(dialect)) => choice(dialect, ChoiceReason::Dialect),
            (None, None) => choice(Generation::Robios6, ChoiceReason::Default),
        },
    }
}

/// Placeholder for the name of a handle.
const HANDLE: &str = "HANDLE";

/// Replacements of functions that only the other generation has: for RoBIOS-7, then for RoBIOS 6.
const REPLACEMENTS: [&[(&str, &str)]; 2] = [
    &[
        ("VWDriveStraight", "VWStraight(mm, mm/s)"),
        ("VWDriveTurn", "VWTurn(degrees, degrees/s)"),
        ("VWDriveCurve", "VWCurve(mm, degrees, mm/s)"),
        ("QUADRead", "ENCODERRead(number)"),
        ("QUADReset", "ENCODERReset(number)"),
        ("LCDPutString", "LCDPrintf(\"%s\", text)"),
        ("LCDPutInt", "LCDPrintf(\"%d\", number)"),
        ("LCDPutFloat", "LCDPrintf(\"%f\", number)"),
        ("LCDPutChar", "LCDPrintf(\"%c\", letter)"),
    ],
    &[
        ("VWStraight", "VWDriveStraight(HANDLE, metres, metres/s)"),
        ("VWTurn", "VWDriveTurn(HANDLE, radians, radians/s)"),
        ("VWCurve", "VWDriveCurve(HANDLE, metres, radians, metres/s)"),
        ("VWWait", "VWDriveWait(HANDLE)"),
        ("VWDone", "VWDriveDone(HANDLE)"),
        ("ENCODERRead", "QUADRead(HANDLE)"),
        ("ENCODERReset", "QUADReset(HANDLE)"),
    ],
];

/// Functions of RoBIOS 6 without a counterpart in RoBIOS-7, whose calls can be deleted.
const NEEDLESS_IN_7: &[&str] = &[
    "VWInit",
    "VWRelease",
    "VWStartControl",
    "VWStopControl",
    "PSDInit",
    "PSDRelease",
    "PSDStart",
    "PSDStop",
    "MOTORInit",
    "MOTORRelease",
    "SERVOInit",
    "SERVORelease",
    "QUADInit",
    "QUADRelease",
];

/// Functions of both generations that differ in more than the handle: name, call in RoBIOS 6, call in RoBIOS-7.
const CHANGED_FUNCTIONS: &[(&str, &str, &str)] = &[
    ("VWSetSpeed", "VWSetSpeed(handle, m/s, radians/s)", "VWSetSpeed(mm/s, degrees/s)"),
    ("VWGetSpeed", "VWGetSpeed(handle, &speed)", "VWGetSpeed(&mm_per_s, &degrees_per_s)"),
    ("VWSetPosition", "VWSetPosition(handle, metres, metres, radians)", "VWSetPosition(mm, mm, degrees)"),
    ("VWGetPosition", "VWGetPosition(handle, &position)", "VWGetPosition(&x, &y, &phi)"),
    ("VWDriveRemain", "VWDriveRemain(handle)", "VWDriveRemain()"),
];

/// Maximum number of clauses of an advice.
const MAX_CLAUSES: usize = 4;

/// A call of a function in a source.
struct CallSite<'a> {
    name: &'a str,
    /// Line of the call, as `4`, or as `map.c:4` in a program of several sources.
    place: String,
    /// The statement to delete; `None` if the call is not a statement on lines of its own.
    statement: Option<Statement>,
}

/// A statement that can be deleted.
struct Statement {
    /// The variable to which it assigns a handle.
    handle: Option<String>,
    /// Place of the variable's declaration, if on another line.
    declaration: Option<String>,
}

/// Advice on how to convert a program that calls functions of both generations to a single one, if possible to the
/// generation for which fewer calls change.
fn advice(of_6: &[String], of_7: &[String], sources: &[PathBuf]) -> String {
    let codes: Vec<String> = sources.iter().filter_map(|source| code_of(source)).collect();
    let changed: Vec<_> =
        CHANGED_FUNCTIONS.iter().filter(|(name, ..)| codes.iter().any(|code| has_call(code, name))).collect();
    if !changed.is_empty() {
        let notes = changed.iter().map(|(name, of_6, of_7)| {
            format!(
                "; `{name}` is `{of_6}` in {} and `{of_7}` in {}",
                Generation::Robios6.name(),
                Generation::Robios7.name()
            )
        });
        return format!("{GENERAL_ADVICE}{}", notes.collect::<String>());
    }
    let [of_6, of_7] = [of_6, of_7].map(|names| call_sites(names, sources));
    let (count_6, count_7) = (of_6.as_ref().map_or(0, Vec::len), of_7.as_ref().map_or(0, Vec::len));
    let to_7 = of_6.and_then(|calls| conversion_advice(&calls, Generation::Robios7, &codes));
    let to_6 = of_7.and_then(|calls| conversion_advice(&calls, Generation::Robios6, &codes));
    let (first, second) = if count_6 <= count_7 { (to_7, to_6) } else { (to_6, to_7) };
    first.or(second).unwrap_or_else(|| GENERAL_ADVICE.to_owned())
}

const GENERAL_ADVICE: &str =
    "write all of it for one of them: RoBIOS 6 has metres, m/s and radians, RoBIOS-7 mm, mm/s and degrees";

fn code_of(source: &Path) -> Option<String> {
    Some(code_only(&String::from_utf8_lossy(&read_regular(source).ok()?)))
}

/// The variable that stores the handle from the only call of `init`, if the variable is in scope in the whole program:
/// there is one source, and the variable is global or the source has a single function.
fn handle_of<'a>(init: &str, codes: &'a [String]) -> Option<&'a str> {
    let [code] = codes else { return None };
    let [offset] = calls_in(code, init)[..] else { return None };
    let left = code[..offset].trim_end().strip_suffix('=')?.trim_end();
    let name = left.rsplit(|c| !is_name(c)).next().filter(|name| !name.is_empty())?;
    let is_plain = !left[..left.len() - name.len()].trim_end().ends_with(['.', '>', '*', ']']);
    let is_global = |line: &str| line.starts_with("VWHandle ") && line.trim_end().ends_with(&format!(" {name};"));
    (is_plain && (code.lines().any(is_global) || code.lines().filter(|line| begins_function(line)).count() <= 1))
        .then_some(name)
}

/// Advice that converts `calls` to `generation`. `None` if one of the calls has no replacement there, if the changes
/// are many, or if they need a handle that the program does not have.
fn conversion_advice(calls: &[CallSite<'_>], generation: Generation, codes: &[String]) -> Option<String> {
    let replacements = REPLACEMENTS[usize::from(generation == Generation::Robios6)];
    let mut replaced: Vec<(&str, String, Vec<&str>)> = Vec::new();
    let mut deleted: Vec<&str> = Vec::new();
    let mut handles: Vec<String> = Vec::new();
    for &CallSite { name, ref place, ref statement } in calls {
        if let Some(&(_, replacement)) = replacements.iter().find(|(other, _)| *other == name) {
            let init = if replacement.starts_with("QUAD") { "QUADInit" } else { "VWInit" };
            let replacement = match generation {
                Generation::Robios6 => replacement.replace(HANDLE, handle_of(init, codes)?),
                Generation::Robios7 => replacement.to_owned(),
            };
            match replaced.iter_mut().find(|(other, _, _)| *other == name) {
                Some((_, _, places)) => {
                    places.push(place);
                    places.dedup();
                }
                None => replaced.push((name, replacement, vec![place.as_str()])),
            }
            continue;
        }
        let is_needless = generation == Generation::Robios7 && NEEDLESS_IN_7.contains(&name);
        let Statement { handle, declaration } = statement.as_ref().filter(|_| is_needless)?;
        deleted.extend(declaration.as_deref());
        deleted.push(place);
        handles.extend(handle.iter().map(|handle| match name.starts_with("VW") {
            true => format!(", and remove `{handle}` from every call"),
            false => format!(", and pass the number of the device, such as 1, for `{handle}`"),
        }));
    }
    if replaced.len() + usize::from(!deleted.is_empty()) + handles.len() > MAX_CLAUSES {
        return None;
    }
    let mut clauses: Vec<String> = Vec::new();
    if !deleted.is_empty() {
        clauses.push(format!("delete {}{}", lines_in_words(&deleted), handles.concat()));
    }
    clauses.extend(replaced.iter().map(|(name, replacement, places)| {
        format!("in {} write `{replacement}` for `{name}`", lines_in_words(places))
    }));
    Some(format!("to write it for {}, {}", generation.name(), clauses.join("; ")))
}

/// Lists places: `line 4`, `lines 4, 5 and 7`, `map.c:4 and map.c:5`.
fn lines_in_words(places: &[&str]) -> String {
    let word = match places {
        [place, ..] if place.contains(':') => "",
        [_] => "line ",
        _ => "lines ",
    };
    match places {
        [first @ .., last] if !first.is_empty() => format!("{word}{} and {last}", first.join(", ")),
        _ => format!("{word}{}", places.concat()),
    }
}

/// All calls of the functions `names` in `sources`, in the order of the text; `None` if a function has no call there,
/// or if a source declares it or has a method of its name.
fn call_sites<'a>(names: &'a [String], sources: &[PathBuf]) -> Option<Vec<CallSite<'a>>> {
    let mut sites = Vec::new();
    for source in sources {
        let code = code_of(source)?;
        let file = source.file_name()?.display().to_string();
        let place = |line: usize| if sources.len() == 1 { line.to_string() } else { format!("{file}:{line}") };
        let mut found: Vec<(usize, &str)> = Vec::new();
        for name in names {
            found.extend(calls_in(&code, name).into_iter().map(|offset| (offset, name.as_str())));
        }
        found.sort_unstable();
        for (offset, name) in found {
            let code_before = code[..offset].trim_end();
            let word = code_before.rsplit(|c| !is_name(c)).next().unwrap_or_default();
            let is_declared = !word.is_empty() && !["return", "else", "do"].contains(&word);
            if is_declared || code_before.ends_with(['.', '*', '&', '>']) || code_before.ends_with("::") {
                return None;
            }
            let line = code[..offset].matches('\n').count() + 1;
            sites.push(CallSite { name, place: place(line), statement: statement(&code, offset, name, place) });
        }
    }
    names.iter().all(|name| sites.iter().any(|site| site.name == name)).then_some(sites)
}

/// Positions of `name` before a `(` in `code`.
fn calls_in(code: &str, name: &str) -> Vec<usize> {
    let is_call = |offset: &usize| {
        !code[..*offset].ends_with(is_name) && code[*offset + name.len()..].trim_start().starts_with('(')
    };
    code.match_indices(name).map(|(offset, _)| offset).filter(is_call).collect()
}

fn has_call(code: &str, name: &str) -> bool {
    !calls_in(code, name).is_empty()
}

/// Parses the statement of the call of `name` at `offset`. Its line must be `CALL;`, `handle = CALL;` or `Type handle =
/// CALL;`, and follow a whole statement or a brace. `place` converts a line into the text of a place.
fn statement(code: &str, offset: usize, name: &str, place: impl Fn(usize) -> String) -> Option<Statement> {
    let start = code[..offset].rfind('\n').map_or(0, |end| end + 1);
    let call = code[offset + name.len()..].lines().next()?.trim().strip_suffix(';')?;
    let depths = call.char_indices().scan(0_i32, |depth, (index, letter)| {
        *depth += i32::from(letter == '(') - i32::from(letter == ')');
        Some((index, *depth))
    });
    let end = depths.skip_while(|(_, depth)| *depth > 0).map(|(index, _)| index).next()?;
    let is_alone = end + 1 == call.len() && !call.contains(['{', '}', ':', ';']);
    if !is_alone || !code[..start].trim_end().ends_with([';', '{', '}']) {
        return None;
    }
    let left = code[start..offset].trim();
    if left.is_empty() {
        return Some(Statement { handle: None, declaration: None });
    }
    let words: Vec<&str> = left.strip_suffix('=')?.split_whitespace().collect();
    let is_handle = name.ends_with("Init") && words.iter().all(|word| word.chars().all(is_name));
    match words.as_slice() {
        [kind, handle] if is_handle && !["else", "do", "return"].contains(kind) => {
            Some(Statement { handle: Some((*handle).to_owned()), declaration: None })
        }
        [handle] if is_handle => {
            let declares = |line: &str| {
                let words: Vec<&str> = line.trim().strip_suffix(';').unwrap_or_default().split_whitespace().collect();
                matches!(words.as_slice(), [kind, name] if (kind.ends_with("Handle") || *kind == "int") && name == handle)
            };
            let line = code.lines().position(declares)? + 1;
            Some(Statement { handle: Some((*handle).to_owned()), declaration: Some(place(line)) })
        }
        _ => None,
    }
}

/// The name of a function with the place of its first call in `sources`, if there is one: `` `VWInit` (maze.c:4)``.
fn name_with_line(name: &str, sources: &[PathBuf]) -> String {
    let place = sources.iter().find_map(|source| {
        let bytes = read_regular(source).ok()?;
        let text = String::from_utf8_lossy(&bytes);
        let line = calls_of(&text).called.get(name).copied()?;
        Some(format!(" ({}:{line})", source.file_name()?.display()))
    });
    format!("`{name}`{}", place.unwrap_or_default())
}

/// The only generation that has any of these constants, with the constants that it has. `None` if both generations have
/// some of them, or neither has any.
fn generation_of_constants(names: &BTreeSet<String>) -> Option<(Generation, Vec<String>)> {
    let only = |generation: Generation| -> Vec<String> {
        let is_only = |name: &&String| generation.has_constant(name) && !generation.other().has_constant(name);
        names.iter().filter(is_only).cloned().collect()
    };
    match Generation::ALL.map(only) {
        [of_6, of_7] if of_7.is_empty() && !of_6.is_empty() => Some((Generation::Robios6, of_6)),
        [of_6, of_7] if of_6.is_empty() && !of_7.is_empty() => Some((Generation::Robios7, of_7)),
        _ => None,
    }
}

/// Names that sources use and do not define.
struct Names {
    calls: BTreeSet<String>,
    constants: BTreeSet<String>,
}

/// The names in `sources` and in the program's headers that they include, except in files outside of `folders`.
///
/// # Errors
/// [`GenerationError::Include`].
fn names_in_files(sources: &[PathBuf], folders: Option<&[PathBuf]>) -> Result<Names, GenerationError> {
    let is_outside = |path: &PathBuf| {
        let is_in = |folders: &[PathBuf]| {
            path.canonicalize().is_ok_and(|path| folders.iter().any(|folder| path.starts_with(folder)))
        };
        folders.is_some_and(|folders| !is_in(folders))
    };
    let mut waiting: Vec<PathBuf> = sources.to_vec();
    let mut seen = BTreeSet::new();
    let (mut names, mut defined_names) =
        (Names { calls: BTreeSet::new(), constants: BTreeSet::new() }, BTreeSet::new());
    while let Some(path) = waiting.pop() {
        if !seen.insert(path.clone()) || is_outside(&path) {
            continue;
        }
        let Ok(bytes) = read_regular(&path) else { continue };
        let found = calls_of(&String::from_utf8_lossy(&bytes));
        names.calls.extend(found.called.into_keys());
        names.constants.extend(found.used);
        defined_names.extend(found.defined.into_iter().chain(found.other_definitions));
        let folder = path.parent().unwrap_or(Path::new(""));
        // A copy of RoBIOS's own header seems to call every function; the one for C++ belongs to RoBIOS-7.
        let (of_robios, includes): (Vec<_>, Vec<_>) =
            found.includes.iter().partition(|name| ["eyebot.h", CPP_HEADER].contains(&file_name(name)));
        if of_robios.iter().any(|name| file_name(name) == CPP_HEADER) {
            names.constants.insert(CPP_HEADER.to_owned());
        }
        for path in includes.into_iter().map(|name| folder.join(name)).filter(|path| !is_outside(path)) {
            match path.metadata() {
                Ok(metadata) if metadata.is_file() => waiting.extend(Some(path).filter(|path| !is_robios_header(path))),
                Ok(metadata) if !metadata.is_dir() => return Err(GenerationError::Include(path)),
                // The compiler finds it in another folder, or reports it.
                _ => {}
            }
        }
    }
    names.calls.retain(|name| !defined_names.contains(name));
    names.constants.retain(|name| !defined_names.contains(name));
    Ok(names)
}

/// The header that C++ programs include for RoBIOS-7.
const CPP_HEADER: &str = "eyebot++.h";

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Returns true if the file is a header of RoBIOS itself, of any version: it declares RoBIOS functions or defines many
/// of the constants, and does not wrap another header.
pub fn is_robios_header(path: &Path) -> bool {
    const MIN_CONSTANTS: usize = 8;
    let Ok(bytes) = read_regular(path) else { return false };
    let found = calls_of(&String::from_utf8_lossy(&bytes));
    let is_function = |name: &String| Generation::ALL.into_iter().any(|generation| generation.has_function(name));
    let is_constant = |name: &&String| Generation::ALL.into_iter().any(|generation| generation.has_constant(name));
    !found.is_wrapper
        && (found.declared.iter().any(is_function)
            || found.other_definitions.iter().filter(is_constant).count() >= MIN_CONSTANTS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The choice for a program of these files, as displayed.
    fn choice(files: &[(&str, &str)], hint: GenerationHint) -> Result<String, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).expect("a file"));
        let sources: Vec<PathBuf> = files
            .iter()
            .map(|(name, _)| folder.path().join(name))
            .filter(|path| path.extension() != Some("h".as_ref()))
            .collect();
        let choice = choose(&sources, hint, None).map_err(|error| error.to_string())?;
        Ok(choice.to_string())
    }

    fn choice_for(text: &str) -> String {
        choice(&[("maze.c", text)], GenerationHint::default()).expect("one generation")
    }

    const DIALECT_7: GenerationHint = GenerationHint { api: None, dialect: Some(Generation::Robios7) };

    #[test]
    fn functions_of_one_generation_determine_the_generation() {
        assert_eq!(choice_for("int main() { VWStraight(500, 200); VWWait(); }"), "RoBIOS-7 (VWStraight, VWWait)");
        assert_eq!(choice_for("void f() { vw = VWInit(VW_DRIVE, 1); LCDClear(); }"), "RoBIOS 6 (VWInit)");
        assert_eq!(
            choice_for("f(){ VWDone(); VWTurn(1,2); VWWait(); VWCurve(1,2,3); }"),
            "RoBIOS-7 (VWCurve, VWDone, VWTurn, ...)"
        );
        assert_eq!(choice_for("f(){ SIMGetPose(&x, &y, &p); }"), "RoBIOS-7 (SIMGetPose)");
    }

    #[test]
    fn files_outside_of_the_folders_are_not_scanned() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let folder = folder.path().canonicalize().expect("its path");
        std::fs::create_dir(folder.join("own")).expect("a folder");
        std::fs::write(folder.join("secret.c"), "f() { VWStraight(1, 2); }").expect("a file");
        std::os::unix::fs::symlink("../secret.c", folder.join("own/link.h")).expect("a link");
        std::os::unix::fs::symlink("../secret.c", folder.join("own/source.c")).expect("a link");
        let text = format!(
            "#include \"../secret.c\"\n#include \"link.h\"\n#include \"{}/secret.c\"\nint main() {{}}\n",
            folder.display()
        );
        std::fs::write(folder.join("own/a.c"), text).expect("a file");
        let sources = ["own/a.c", "own/source.c"].map(|name| folder.join(name));
        let reason_in = |folders| choose(&sources, GenerationHint::default(), folders).expect("one generation").reason;
        assert_eq!(reason_in(None), ChoiceReason::Calls(vec!["VWStraight".to_owned()]));
        let own_folder = [folder.join("own")];
        assert_eq!(reason_in(Some(&own_folder)), ChoiceReason::NoCalls);
        let whole_folder = [folder.clone()];
        assert_eq!(reason_in(Some(&whole_folder)), reason_in(None));
    }

    #[test]
    fn constants_determine_the_generation_if_functions_do_not() {
        let text = "int main() { BYTE img[QQVGA_SIZE]; CAMInit(QQVGA); LCDClear(); }";
        assert_eq!(choice_for(text), "RoBIOS-7 (QQVGA, QQVGA_SIZE)");
        assert_eq!(choice_for("int main() { image img; int i = imagerows; LCDClear(); }"), "RoBIOS 6 (imagerows)");
        let definitions = "enum { RED, QVGA };\n#define VGA 3\nint main() { int i = QVGA + VGA + RED; LCDClear(); }";
        assert!(choice_for(definitions).starts_with("RoBIOS 6; its calls are in RoBIOS-7 as well"));
        assert_eq!(choice_for("int main() { VWInit(VW_DRIVE, 1); CAMInit(QVGA); }"), "RoBIOS 6 (VWInit)");
        assert!(choice_for("#include \"eyebot++.h\"\nint main() { LCDClear(); }").starts_with("RoBIOS-7"));
    }

    #[test]
    fn calls_precede_the_dialect_and_api_precedes_both() {
        let six = [("maze.c", "f() { VWInit(1, 1); }")];
        assert_eq!(choice(&six, DIALECT_7).expect("6"), "RoBIOS 6 (VWInit)");
        let api = GenerationHint { api: Some(Generation::Robios7), dialect: Some(Generation::Robios6) };
        assert_eq!(choice(&six, api).expect("7"), "RoBIOS-7");
        let both = [("maze.c", "f() { LCDPrintf(\"VWInit()\"); /* VWStraight() */ KEYGet(); } // VWDone()")];
        assert_eq!(
            choice(&both, DIALECT_7).expect("7"),
            "RoBIOS-7, as the sim file is; its calls are in RoBIOS 6 as well"
        );
        let displayed = choice(&both, GenerationHint::default()).expect("6");
        assert_eq!(displayed, "RoBIOS 6; its calls are in RoBIOS-7 as well, which `--api 7` chooses");
        assert_eq!(choice(&[("a.c", "int main(void) { return 0; }")], DIALECT_7).expect("7"), "RoBIOS-7");
    }

    #[test]
    fn calls_of_both_generations_are_an_error_with_their_names() {
        let mixed =
            [("maze.c", "f() { VWInit(1, 1); }"), ("map.cpp", "// VWStraight()\ng() { VWStraight(1, 2); VWWait(); }")];
        let error = choice(&mixed, GenerationHint::default()).expect_err("two generations");
        assert!(error.contains("mixes two generations: `VWInit` (maze.c:1) of RoBIOS 6, "), "{error}");
        assert!(error.contains("`VWStraight` (map.cpp:2), `VWWait` (map.cpp:2) of RoBIOS-7, "), "{error}");
        assert!(error.ends_with(&format!("; {GENERAL_ADVICE}")), "{error}");
    }

    #[test]
    fn a_stated_generation_is_contradicted_only_by_functions_of_the_other_one_alone() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let source = folder.path().join("maze.c");
        let hint = GenerationHint { api: Some(Generation::Robios6), dialect: None };
        let reason = |text: &str| {
            std::fs::write(&source, text).expect("a file");
            choose(std::slice::from_ref(&source), hint, None).expect("the stated generation").reason
        };
        let foreign = ChoiceReason::Stated(vec!["VWStraight".to_owned()]);
        assert_eq!(reason("f() { VWStraight(1, 2); LCDClear(); }"), foreign);
        assert_eq!(reason("f() { VWInit(1, 1); VWStraight(1, 2); }"), ChoiceReason::Stated(Vec::new()));
    }

    /// The advice for a program of calls of both generations.
    fn advice_for(text: &str) -> String {
        let error = choice(&[("maze.c", text)], GenerationHint::default()).expect_err("two generations");
        error.rsplit_once("have none; ").expect("an advice").1.to_owned()
    }

    #[test]
    fn advice_names_the_lines_to_change() {
        let advice = advice_for;
        assert_eq!(
            advice("f() {\n  VWHandle vw = VWInit(1, 1); // VWRelease()\n  VWStraight(1, 2);\n}"),
            "to write it for RoBIOS-7, delete line 2, and remove `vw` from every call"
        );
        assert_eq!(
            advice("f() {\n  vw = VWInit(1, 1);\n  VWDriveStraight(vw, 1, 2);\n  VWWait();\n}"),
            "to write it for RoBIOS 6, in line 4 write `VWDriveWait(vw)` for `VWWait`"
        );
        assert_eq!(
            advice("f() {\n  int front;\n  VWWait();\n  front = PSDInit(1);\n  VWTurn(1, 2);\n}"),
            "to write it for RoBIOS-7, delete lines 2 and 4, and pass the number of the device, such as 1, for `front`"
        );
        assert_eq!(
            advice("f() {\n  VWHandle vw;\n  vw = VWInit(1, 1);\n  VWTurn(1, 2);\n}"),
            "to write it for RoBIOS-7, delete lines 2 and 3, and remove `vw` from every call"
        );
        assert_eq!(
            advice(
                "f() {\n  int ok; drive = VWInit(1, BUMPCheck(1));\n  VWWait();\n  if (1)\n    VWWait();\n  return VWWait();\n}"
            ),
            "to write it for RoBIOS 6, in lines 3, 5 and 6 write `VWDriveWait(drive)` for `VWWait`"
        );
        assert_eq!(advice("f() {\n  BUMPCheck(1);\n  LCDPixel(1, 2);\n}"), GENERAL_ADVICE);
        assert_eq!(
            advice(
                "VWHandle vw;\nvoid f() {\n  BUMPCheck(1); vw = VWInit(1, 2);\n}\nvoid g() {\n  VWTurn(1, 2);\n  VWWait();\n}"
            ),
            "to write it for RoBIOS 6, in line 6 write `VWDriveTurn(vw, radians, radians/s)` for `VWTurn`; in line 7 write \
             `VWDriveWait(vw)` for `VWWait`"
        );
        for without_handle in [
            "void f() {\n  BUMPCheck(1);\n  VWTurn(1, 2);\n}",
            "void f() {\n  BUMPCheck(1); VWHandle vw = VWInit(1, 2);\n}\nvoid g() {\n  VWTurn(1, 2);\n}",
            "void f() {\n  BUMPCheck(1); robot.vw = VWInit(1, 2);\n  VWTurn(1, 2);\n}",
            "void f() {\n  BUMPCheck(1);\n  ENCODERRead(1);\n}",
        ] {
            assert_eq!(advice(without_handle), GENERAL_ADVICE, "{without_handle}");
        }
        assert_eq!(
            advice("void f() {\n  VWHandle vw = VWInit(1, 1);\n  VWSetSpeed(vw, 100, 0);\n  VWWait();\n}"),
            format!(
                "{GENERAL_ADVICE}; `VWSetSpeed` is `VWSetSpeed(handle, m/s, radians/s)` in RoBIOS 6 and `VWSetSpeed(mm/s, degrees/s)` in RoBIOS-7"
            )
        );
    }

    #[test]
    fn only_statements_on_their_own_lines_are_deleted() {
        for line in [
            "if (KEYRead() == KEY1)\n VWStopControl(0);",
            "for (i = 0; i < 3; i++)\n psd[i] = PSDInit(i);",
            "x = 1;\n psd[i] = PSDInit(i);",
            "{ VWHandle vw = VWInit(1, 1);",
            "if (x) {\n } else VWStopControl(vw);",
            "switch (x) {\n case 1: VWStopControl(vw);",
            "x = 1;\n else vw = VWInit(1, 1);",
            "VWHandle vw =\n VWInit(1, 1);",
            "x = 1;\n VWInit(1,\n 1);",
            "x = 1;\n front = PSDInit(1), left = PSDInit(2);",
            "x = 1;\n int front = PSDInit(1), left = 3;",
            "x = 1;\n front = PSDInit(1);",
            "x = 1;\n VWStopControl(vw); go();",
            "x = 1;\n int ok = PSDStart(1, 1);",
            "x = 1;\n VWHandle vw = VWInit(1, 1);\n VWGetPosition(vw, &pos);",
        ] {
            // LCDPixel has no replacement in RoBIOS 6.
            let advice = advice_for(&format!("f()\n{{\n {line}\n LCDPixel(1, 2, 3);\n}}"));
            assert!(advice.starts_with(GENERAL_ADVICE), "{line}: {advice}");
        }
    }

    #[test]
    fn methods_and_many_changes_get_general_advice() {
        let class = "class Robot {\n int VWStraight(int mm) { return VWDriveStraight(vw, mm, 1); }\n};";
        let of_6 = choice_for(&format!("{class}\nf() {{ BUMPCheck(1); robot.VWStraight(3); }}"));
        assert_eq!(of_6, "RoBIOS 6 (BUMPCheck, VWDriveStraight)");
        let five = "VWStraight(1, 2); VWTurn(1, 2); VWCurve(1, 2, 3); VWWait(); VWDone();";
        assert_eq!(advice_for(&format!("f() {{ BUMPCheck(1); {five} }}")), GENERAL_ADVICE);
    }

    #[test]
    fn functions_and_headers_of_the_program_are_recognised() {
        let definition = "int VWWait(int ms)\n{\n return ms; }\nint main() { VWInit(1, 1); VWWait(3); }";
        assert_eq!(choice_for(definition), "RoBIOS 6 (VWInit)");
        let header = [
            ("maze.c", "#include \"eyebot.h\"\n#include \"go.h\"\nint main() { GO(3); }"),
            ("go.h", "#include \"maze.c\"\n#define GO(x) VWStraight(x, 100)\n"),
            ("eyebot.h", "int VWInit(int, int); int VWStraight(int, int);"),
        ];
        assert_eq!(choice(&header, GenerationHint::default()).expect("7"), "RoBIOS-7 (VWStraight)");
    }

    #[test]
    fn every_generation_has_its_functions() {
        for generation in Generation::ALL {
            assert!(generation.functions().iter().all(|name| generation.has_function(name)));
            assert_eq!(Generation::of_number(generation.number()), Some(generation));
        }
        assert!(Generation::Robios6.has_function("VWInit") && !Generation::Robios7.has_function("VWInit"));
        assert!(Generation::Robios7.has_function("VWStraight") && !Generation::Robios6.has_function("VWStraight"));
    }

    #[test]
    fn variants_are_those_of_the_header() {
        let header = robios_sys::c::HEADERS7.iter().find(|file| file.name == "variants.h").expect("a header").text;
        let calls = calls_of(header);
        let names: BTreeSet<String> = calls
            .called
            .into_keys()
            .chain(calls.declared)
            .chain(calls.defined)
            .chain(calls.other_definitions)
            .collect();
        let is_function =
            |name: &&String| name.chars().take(2).all(char::is_uppercase) && name.contains(char::is_lowercase);
        let missing: Vec<_> = names
            .iter()
            .filter(is_function)
            .filter(|name| !Generation::Robios7.has_function(name) && !is_internal_name(name))
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert!(VARIANTS_OF_7.iter().all(|name| names.contains(*name)));
    }

    /// Names that occur only in the header itself.
    fn is_internal_name(name: &str) -> bool {
        name.to_lowercase().starts_with("eyesim_") || name == "fct"
    }
}
