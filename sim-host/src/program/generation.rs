//! Which generation of RoBIOS a program is written for: both headers are called `eyebot.h`, so the functions that it calls tell.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use robios_sys::{Robios6Call, Robios7Call};

/// A generation of the RoBIOS API.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Generation {
    /// RoBIOS 6: metres, radians, handles.
    Robios6,
    /// RoBIOS-7: millimetres, degrees, numbers.
    Robios7,
}

impl Generation {
    /// That of a program with these sources: the one with more of the functions that only one of the two has; RoBIOS 6 where
    /// they do not tell.
    pub fn of_sources(sources: &[PathBuf]) -> Self {
        let texts: Vec<String> = sources
            .iter()
            .filter_map(|path| fs::read(path).ok())
            .map(|text| String::from_utf8_lossy(&text).into())
            .collect();
        let called: BTreeSet<&str> = texts.iter().flat_map(|text| identifiers(text)).collect();
        let of_6 = |name: &&&str| Robios6Call::from_name(name).is_some();
        let of_7 = |name: &&&str| Robios7Call::from_name(name).is_some();
        let only_6 = called.iter().filter(|name| of_6(name) && !of_7(name)).count();
        let only_7 = called.iter().filter(|name| of_7(name) && !of_6(name)).count();
        if only_7 > only_6 { Self::Robios7 } else { Self::Robios6 }
    }
}

fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}
