//! The cost table: how much virtual time each RoBIOS call takes.
//!
//! A table is TOML with one section a generation of the API and entries `function = microseconds`. A name that ends in `*`
//! stands for all functions that begin so; the longest name that fits counts. `costs.toml`, compiled in, has an entry for
//! every function; the user's own table goes before it as a whole.

use std::collections::BTreeMap;

use robios_sys::Robios6Call as Call;
use sim_core::format::{CostEntry, CostTable};
use sim_core::time::Time;
use toml::Spanned;

/// The table that is compiled in.
const DEFAULT: &str = include_str!("costs.toml");

/// Name of the section for RoBIOS 6.
const ROBIOS6: &str = "robios6";

/// Sections that a table may have.
const SECTIONS: [&str; 2] = [ROBIOS6, "robios7"];

/// Greatest cost: an hour, in microseconds.
const MAX_COST_US: i64 = 3_600_000_000;

/// How much virtual time each call takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Costs {
    /// By [`robios_sys::Robios6Call::index`].
    robios6: Box<[Time]>,
}

/// What is wrong with a cost table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CostError {
    /// Not TOML of the form of a table.
    #[error("{0}")]
    Syntax(String),
    /// A section of no known generation.
    #[error("line {line}: unknown section `{name}`, expected `robios6` or `robios7`")]
    Section {
        /// Line from 1.
        line: usize,
        /// The name.
        name: String,
    },
    /// An entry that fits no function.
    #[error("line {line}: unknown function `{name}`{}", suggestion.as_ref().map(|name| format!(", did you mean `{name}`?")).unwrap_or_default())]
    Function {
        /// Line from 1.
        line: usize,
        /// The name.
        name: String,
        /// The function with the most similar name.
        suggestion: Option<&'static str>,
    },
    /// A cost that is none.
    #[error("line {line}: `{name}` must cost 1 to 3600000000 us, in whole microseconds")]
    Cost {
        /// Line from 1.
        line: usize,
        /// The entry.
        name: String,
    },
}

/// One section: costs by name or pattern.
type Section = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

impl Costs {
    /// The table that is compiled in, with the entries of the user's `table` before it.
    ///
    /// # Errors
    /// The first [`CostError`] of the user's table.
    pub fn with(table: &str) -> Result<Self, CostError> {
        Ok(Self::with_entries(&parse(table)?))
    }

    /// The table that is compiled in, with the entries of a scene's `table` before it.
    ///
    /// # Errors
    /// The first entry that fits no function.
    pub fn of_table(table: &CostTable) -> Result<Self, CostError> {
        if let Some((_, error)) = mistakes(table).next() {
            return Err(error);
        }
        let of_robios6 = table.entries.iter().filter(|entry| entry.generation == ROBIOS6);
        Ok(Self::with_entries(&of_robios6.map(|entry| (entry.function.clone(), entry.cost)).collect()))
    }

    fn with_entries(own: &BTreeMap<String, Time>) -> Self {
        let mut costs = Self::default();
        for call in Call::ALL {
            if let Some(cost) = find(own, call.name()) {
                costs.robios6[call.index()] = cost;
            }
        }
        costs
    }

    /// What `call` costs.
    pub fn of(&self, call: Call) -> Time {
        self.robios6[call.index()]
    }
}

impl Default for Costs {
    /// The table that is compiled in.
    fn default() -> Self {
        // A test reads the compiled-in table, so 1 us for what it does not have is never seen.
        let table = parse(DEFAULT).unwrap_or_default();
        let cost = |call: &Call| find(&table, call.name()).unwrap_or(Time(1));
        Self { robios6: Call::ALL.iter().map(cost).collect() }
    }
}

/// The entries of a scene's table that fit no function.
pub fn mistakes(table: &CostTable) -> impl Iterator<Item = (&CostEntry, CostError)> {
    let of_robios6 = table.entries.iter().filter(|entry| entry.generation == ROBIOS6);
    of_robios6.filter_map(|entry| Some((entry, unknown_function(&entry.function, entry.span.line as usize)?)))
}

/// The error of an entry in `line` whose `name` fits no function.
fn unknown_function(name: &str, line: usize) -> Option<CostError> {
    let is_known = Call::ALL.iter().any(|call| fits(name, call.name()));
    let error = || CostError::Function { line, name: name.to_owned(), suggestion: most_similar(name) };
    (!is_known).then(error)
}

/// The entries for RoBIOS 6, by name or pattern.
fn parse(table: &str) -> Result<BTreeMap<String, Time>, CostError> {
    let line_of = |place: usize| 1 + table.as_bytes()[..place].iter().filter(|byte| **byte == b'\n').count();
    let sections: BTreeMap<Spanned<String>, Section> =
        toml::from_str(table).map_err(|error| CostError::Syntax(error.to_string().trim_end().to_owned()))?;
    let mut entries = BTreeMap::new();
    for (name, section) in &sections {
        if !SECTIONS.contains(&name.get_ref().as_str()) {
            return Err(CostError::Section { line: line_of(name.span().start), name: name.get_ref().clone() });
        }
        for (function, cost) in section {
            let (line, name_of) = (line_of(function.span().start), function.get_ref().clone());
            let micros = cost.get_ref().as_integer().filter(|micros| (1..=MAX_COST_US).contains(micros));
            let Some(micros) = micros else { return Err(CostError::Cost { line, name: name_of }) };
            if name.get_ref() == ROBIOS6 {
                if let Some(error) = unknown_function(&name_of, line) {
                    return Err(error);
                }
                entries.insert(name_of, Time(micros));
            }
        }
    }
    Ok(entries)
}

/// The entry whose name fits best.
fn find(entries: &BTreeMap<String, Time>, function: &str) -> Option<Time> {
    let exact = entries.get(function);
    let pattern = || entries.iter().filter(|(name, _)| fits(name, function)).max_by_key(|(name, _)| name.len());
    exact.or_else(|| pattern().map(|(_, cost)| cost)).copied()
}

/// True if the name of an entry means `function`.
fn fits(name: &str, function: &str) -> bool {
    name.strip_suffix('*').map_or(name == function, |beginning| function.starts_with(beginning))
}

/// The function whose name is at most a third of its letters away from `name`.
pub fn most_similar(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let similar = Call::ALL.iter().map(|call| (strsim::osa_distance(&name, &call.name().to_lowercase()), call.name()));
    similar.min_by_key(|(edits, _)| *edits).filter(|(edits, call)| *edits * 3 <= call.len()).map(|(_, call)| call)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compiled_in_table_has_every_function() {
        let table = parse(DEFAULT).unwrap();
        for call in Call::ALL {
            assert!(find(&table, call.name()).is_some_and(|cost| cost >= Time(1)), "{}", call.name());
        }
    }

    #[test]
    fn the_users_entries_go_before_as_a_whole() {
        let costs = Costs::with("[robios6]\n\"PSD*\" = 7\nPSDGet = 8\n\"VWDrive*\" = 9\n").unwrap();
        assert_eq!(
            [Call::PSDGet, Call::PSDStart, Call::VWDriveWait, Call::VWInit].map(|call| costs.of(call)),
            [Time(8), Time(7), Time(9), Costs::default().of(Call::VWInit)]
        );
        assert_eq!(Costs::with("").unwrap(), Costs::default());
        assert!(Costs::with("[robios7]\nVWStraight = 3\n").is_ok());
    }

    #[test]
    fn mistakes_in_tables() {
        for (table, message) in [
            ("[robios6]\nPSDget = 5\n", "line 2: unknown function `PSDget`, did you mean `PSDGet`?"),
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
