//! The cost table: virtual time that each RoBIOS call takes.
//!
//! A table is TOML with one section per generation of the API and entries `function = microseconds`. A name that ends
//! in `*` matches all functions with that prefix; the longest matching name wins. `costs.toml`, compiled in, has an
//! entry for every function; any matching entry of the user's table takes precedence over it.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use robios_sys::{Robios6Call, Robios7Call};
use sim_core::spec::{CostEntry, CostTable};
use sim_core::time::Time;
use toml::Spanned;

use super::call::Call;

/// The table that is compiled in.
const DEFAULT: &str = include_str!("costs.toml");

/// Name of the section for RoBIOS 6.
const ROBIOS6: &str = "robios6";

/// Name of the section for RoBIOS-7.
const ROBIOS7: &str = "robios7";

/// Sections that a table may have.
pub const SECTIONS: [&str; 2] = [ROBIOS6, ROBIOS7];

/// Functions of the generation of `section`.
fn functions(section: &str) -> impl Iterator<Item = Call> {
    let calls6 = if section == ROBIOS6 { Robios6Call::ALL } else { &[] };
    let calls7 = if section == ROBIOS7 { Robios7Call::ALL } else { &[] };
    calls6.iter().map(|call| Call::from(*call)).chain(calls7.iter().map(|call| Call::from(*call)))
}

/// Maximum cost: one hour, in microseconds.
const MAX_COST_US: i64 = 3_600_000_000;

/// Virtual time that each call takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Costs {
    /// Costs indexed by [`Call::robios_number`].
    costs: Box<[Time]>,
}

/// Error in a cost table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CostError {
    /// The text is not TOML, or does not have the structure of a cost table.
    #[error("{0}")]
    Syntax(String),
    /// A section does not name a known generation.
    #[error("line {line}: unknown section `{name}`, expected `robios6` or `robios7`")]
    CostSection {
        /// Line number, from 1.
        line: usize,
        /// The name.
        name: String,
    },
    /// An entry matches no function.
    #[error("line {line}: unknown function `{name}`{}", suggestion.as_ref().map(|name| format!(", did you mean `{name}`?")).unwrap_or_default())]
    Function {
        /// Line number, from 1.
        line: usize,
        /// The name.
        name: String,
        /// The function with the most similar name.
        suggestion: Option<&'static str>,
    },
    /// A cost is out of range or not an integer.
    #[error("line {line}: `{name}` must cost 1 to 3600000000 us, in whole microseconds")]
    Cost {
        /// Line number, from 1.
        line: usize,
        /// The entry.
        name: String,
    },
}

/// One section: costs by name or pattern.
type CostSection = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

impl Costs {
    /// The compiled-in table, overridden by the entries of the user's `table`.
    ///
    /// # Errors
    /// The first [`CostError`] of the user's table.
    pub fn with(table: &str) -> Result<Self, CostError> {
        Ok(Self::with_entries(&parse(table)?))
    }

    /// The compiled-in table, overridden by the entries of a scene's `table`.
    ///
    /// # Errors
    /// The first entry that matches no function.
    pub fn of_table(table: &CostTable) -> Result<Self, CostError> {
        if let Some((_, error)) = mistakes(table).next() {
            return Err(error);
        }
        let mut entries = Entries::new();
        for entry in &table.entries {
            entries.entry(entry.generation.clone()).or_default().insert(entry.function.clone(), entry.cost);
        }
        Ok(Self::with_entries(&entries))
    }

    fn with_entries(user_entries: &Entries) -> Self {
        let mut costs = Self::default();
        for (section, entries) in user_entries {
            for call in functions(section) {
                if let (Some(cost), Some(number)) = (find(entries, call.name()), call.robios_number()) {
                    costs.costs[usize::from(number)] = cost;
                }
            }
        }
        costs
    }

    /// Cost of a call. A service of the language runtime costs 1 us, so that a loop that waits for a point in time
    /// ends.
    #[inline]
    pub fn of(&self, call: impl Into<Call>) -> Time {
        call.into().robios_number().map_or(Time(1), |number| self.costs[usize::from(number)])
    }
}

impl Default for Costs {
    /// The table that is compiled in, read once in a process.
    fn default() -> Self {
        static COMPILED_IN: LazyLock<Costs> = LazyLock::new(Costs::compiled_in);
        COMPILED_IN.clone()
    }
}

impl Costs {
    fn compiled_in() -> Self {
        // A test checks that the compiled-in table is complete, so the 1 us for missing entries never applies.
        let table = parse(DEFAULT).unwrap_or_default();
        let cost = |section: &str, call: Call| {
            table.get(section).and_then(|entries| find(entries, call.name())).unwrap_or(Time(1))
        };
        let costs = SECTIONS.iter().flat_map(|section| functions(section).map(move |call| (section, call)));
        Self { costs: costs.map(|(section, call)| cost(section, call)).collect() }
    }
}

/// Entries of a scene's table that match no function, each with its error.
pub fn mistakes(table: &CostTable) -> impl Iterator<Item = (&CostEntry, CostError)> {
    let mistake = |entry: &CostEntry| unknown_function(&entry.generation, &entry.function, || entry.span.line as usize);
    table.entries.iter().filter_map(move |entry| Some((entry, mistake(entry)?)))
}

/// The error of an entry in `line` of `section`, if `name` matches no function.
fn unknown_function(section: &str, name: &str, line: impl Fn() -> usize) -> Option<CostError> {
    let is_known = functions(section).any(|call| matches_function(name, call.name()));
    let error = || CostError::Function { line: line(), name: name.to_owned(), suggestion: most_similar(section, name) };
    (!is_known).then(error)
}

/// Entries by section, and by name or pattern.
type Entries = BTreeMap<String, BTreeMap<String, Time>>;

fn parse(table: &str) -> Result<Entries, CostError> {
    let line_of = |start: usize| 1 + table.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count();
    let sections: BTreeMap<Spanned<String>, CostSection> =
        toml::from_str(table).map_err(|error| CostError::Syntax(error.to_string().trim_end().to_owned()))?;
    let mut entries = Entries::new();
    for (section, section_entries) in &sections {
        let name = section.get_ref();
        if !SECTIONS.contains(&name.as_str()) {
            return Err(CostError::CostSection { line: line_of(section.span().start), name: name.clone() });
        }
        let cost_by_name = entries.entry(name.clone()).or_default();
        for (function, cost) in section_entries {
            let (start, function) = (function.span().start, function.get_ref());
            let micros = cost.get_ref().as_integer().filter(|micros| (1..=MAX_COST_US).contains(micros));
            let Some(micros) = micros else {
                return Err(CostError::Cost { line: line_of(start), name: function.clone() });
            };
            if let Some(error) = unknown_function(name, function, || line_of(start)) {
                return Err(error);
            }
            cost_by_name.insert(function.clone(), Time(micros));
        }
    }
    Ok(entries)
}

/// Cost of `function` by its own entry, or by the longest matching pattern.
fn find(entries: &BTreeMap<String, Time>, function: &str) -> Option<Time> {
    let mut pattern = function.to_owned();
    let mut cost_of_prefix = |length| {
        pattern.truncate(length);
        pattern.push('*');
        let cost = entries.get(&pattern);
        pattern.pop();
        cost
    };
    let exact = entries.get(function);
    exact.or_else(|| (0..=function.len()).rev().find_map(&mut cost_of_prefix)).copied()
}

/// Returns true if the name or pattern of an entry matches `function`.
fn matches_function(name: &str, function: &str) -> bool {
    name.strip_suffix('*').map_or(name == function, |prefix| function.starts_with(prefix))
}

/// Returns true if a function of either generation has this name.
pub fn is_function(name: &str) -> bool {
    SECTIONS.iter().any(|section| functions(section).any(|call| call.name() == name))
}

/// The function of a section with the name closest to `name`, if at most a third of its letters differ.
pub fn most_similar(section: &str, name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let similar =
        functions(section).map(|call| (strsim::osa_distance(&name, &call.name().to_lowercase()), call.name()));
    similar.min_by_key(|(edits, _)| *edits).filter(|(edits, call)| *edits * 3 <= call.len()).map(|(_, call)| call)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_cost_table_has_every_function() {
        let table = parse(DEFAULT).unwrap();
        for section in SECTIONS {
            for call in functions(section) {
                assert!(find(&table[section], call.name()).is_some_and(|cost| cost >= Time(1)), "{}", call.name());
            }
        }
    }

    #[test]
    fn user_entries_take_precedence_over_all_compiled_in_entries() {
        let costs = Costs::with("[robios6]\n\"PSD*\" = 7\nPSDGet = 8\n\"VWDrive*\" = 9\n").unwrap();
        assert_eq!(
            [Robios6Call::PSDGet, Robios6Call::PSDStart, Robios6Call::VWDriveWait, Robios6Call::VWInit]
                .map(|call| costs.of(call)),
            [Time(8), Time(7), Time(9), Costs::default().of(Robios6Call::VWInit)]
        );
        assert_eq!(Costs::with("").unwrap(), Costs::default());
        let seven = Costs::with("[robios7]\nPSDGet = 3\n").unwrap();
        assert_eq!(seven.of(Robios7Call::PSDGet), Time(3));
        assert_eq!(seven.of(Robios6Call::PSDGet), Costs::default().of(Robios6Call::PSDGet));
    }

    #[test]
    fn errors_in_tables() {
        for (table, message) in [
            ("[robios6]\nPSDget = 5\n", "line 2: unknown function `PSDget`, did you mean `PSDGet`?"),
            ("[robios7]\nVWInit = 5\n", "line 2: unknown function `VWInit`, did you mean `VWWait`?"),
            ("[robios6]\n\n\"Foo*\" = 5\n", "line 3: unknown function `Foo*`"),
            ("[robios6]\nPSDGet = 0\n", "line 2: `PSDGet` must cost 1 to 3600000000 us, in whole microseconds"),
            ("[robios6]\nPSDGet = 1.5\n", "line 2: `PSDGet` must cost 1 to 3600000000 us, in whole microseconds"),
            ("\n[robios8]\n", "line 2: unknown section `robios8`, expected `robios6` or `robios7`"),
        ] {
            assert_eq!(Costs::with(table).unwrap_err().to_string(), message);
        }
        assert!(matches!(Costs::with("[robios6"), Err(CostError::Syntax(_))));
    }
}
