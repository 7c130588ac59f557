//! Functions that a scene forbids to its programs: their calls fail as documented, have no effect and are recorded.

use robios_sys::{Robios6Call, Robios7Call, SupportCall};

use super::call::Call;
use super::cost;
use crate::record::log::Pattern;

/// Set of forbidden functions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Forbidden {
    /// Flags indexed by [`Call::robios_number`]; empty if no function is forbidden.
    functions: Box<[bool]>,
}

impl Forbidden {
    /// The functions of both generations that match one of `patterns`.
    pub fn new<'p>(patterns: impl Iterator<Item = &'p str>) -> Self {
        let patterns: Vec<Pattern> = patterns.flat_map(Pattern::parse_list).collect();
        if patterns.is_empty() {
            return Self::default();
        }
        Self { functions: names().map(|name| patterns.iter().any(|pattern| pattern.matches(name))).collect() }
    }

    /// Returns true if no function is forbidden.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Returns true if `call` is forbidden; services of the language runtime never are.
    pub fn contains(&self, call: Call) -> bool {
        call.robios_number()
            .and_then(|number| self.functions.get(usize::from(number)))
            .is_some_and(|is_forbidden| *is_forbidden)
    }
}

/// Names of all functions in the order of their numbers.
fn names() -> impl Iterator<Item = &'static str> {
    Robios6Call::ALL.iter().map(|call| call.name()).chain(Robios7Call::ALL.iter().map(|call| call.name()))
}

/// Patterns of `text` that match no function, each with the name or pattern that was probably meant. An empty text is
/// also such a pattern.
pub fn mistakes(text: &str) -> Vec<(String, Option<String>)> {
    unmatched(text, &names().collect::<Vec<_>>())
}

/// Like [`mistakes`], for patterns that may also match services of the language runtime.
pub fn mistakes_with_services(text: &str) -> Vec<(String, Option<String>)> {
    unmatched(text, &names().chain(SupportCall::ALL.iter().map(|call| call.name())).collect::<Vec<_>>())
}

fn unmatched(text: &str, names: &[&str]) -> Vec<(String, Option<String>)> {
    let patterns = Pattern::parse_list(text);
    if patterns.is_empty() {
        return vec![(text.to_owned(), None)];
    }
    let unknown = patterns.into_iter().filter(|pattern| !names.iter().any(|name| pattern.matches(name)));
    unknown.map(|pattern| (pattern.to_string(), suggestion(&pattern.to_string()))).collect()
}

/// The function, or the pattern of a family of functions, with the most similar name.
fn suggestion(pattern: &str) -> Option<String> {
    let Some(prefix) = pattern.strip_suffix('*') else {
        let similar = cost::SECTIONS.iter().find_map(|section| cost::most_similar(section, pattern));
        return similar.map(str::to_owned);
    };
    let prefix = prefix.to_uppercase();
    let families = Robios7Call::FAMILIES.iter().chain(Robios6Call::FAMILIES).map(|family| family.name);
    let by_distance = families.map(|family| (strsim::osa_distance(&prefix, family), family));
    let nearest = by_distance.min_by_key(|(edits, _)| *edits).filter(|(edits, family)| edits * 2 < family.len());
    nearest.map(|(_, family)| format!("{family}*"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_forbid_functions_of_both_generations() {
        let forbidden = Forbidden::new(["SIM*", "VWSetPosition, osexecute"].into_iter());
        for call in [
            Robios7Call::SIMSetRobot.into(),
            Robios7Call::SIMGetRobotCount.into(),
            Robios7Call::OSExecute.into(),
            Robios7Call::VWSetPosition.into(),
            Robios6Call::VWSetPosition.into(),
        ] {
            assert!(forbidden.contains(call), "{call:?}");
        }
        for call in [Robios7Call::VWSetSpeed.into(), Call::from(Robios6Call::OSWait)] {
            assert!(!forbidden.contains(call), "{call:?}");
        }
        assert!(!forbidden.contains(robios_sys::SupportCall::console.into()) && !forbidden.is_empty());
        assert!(
            Forbidden::new(std::iter::empty()).is_empty() && !Forbidden::default().contains(Robios6Call::OSWait.into())
        );
    }

    #[test]
    fn patterns_without_a_match_are_reported() {
        let mistake = |text: &str, suggestion: Option<&str>| vec![(text.to_owned(), suggestion.map(str::to_owned))];
        assert_eq!(mistakes("SIM*"), []);
        assert_eq!(mistakes("simsetrobot,*Wait"), []);
        assert_eq!(mistakes("SIN*"), mistake("SIN*", Some("SIM*")));
        assert_eq!(mistakes("SIMSetRobt"), mistake("SIMSetRobt", Some("SIMSetRobot")));
        assert_eq!(mistakes("OSWait, printf"), mistake("printf", Some("LCDPrintf")));
        assert_eq!(mistakes(" , "), mistake(" , ", None));
    }
}
