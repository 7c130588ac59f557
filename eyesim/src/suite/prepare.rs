//! Preparation of a suite: its programs are built once, before the first case.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::Suite;
use super::case::{Case, PrepareError, Session};
use super::row::{CaseResult, Row};

/// The built programs of a suite's cases.
pub struct Preparation {
    /// The session with the programs, inherited by each forked worker.
    pub session: Session,
    prepared: BTreeMap<Key, Prepared>,
}

/// Scene, and settings on which its programs may depend.
type Key = (PathBuf, Vec<String>);

enum Prepared {
    /// The programs are built; true if they may share a process with other cases.
    Built(bool),
    /// Unknown, because the scene cannot be read with the seed of the case that was tried.
    Unknown,
    /// A program cannot be built.
    Failed(Box<CaseResult>),
}

impl Preparation {
    /// Builds the programs of `cases`.
    pub fn of<'c>(suite: &Suite, cases: impl Iterator<Item = &'c Case>, mut session: Session) -> Self {
        let mut prepared = BTreeMap::new();
        for case in cases {
            prepared.entry(key(case)).or_insert_with(|| match session.prepare(suite, case) {
                Ok(may_share) => Prepared::Built(may_share),
                Err(PrepareError::Scene) => Prepared::Unknown,
                Err(PrepareError::Programs(result)) => Prepared::Failed(result),
            });
        }
        session.end_building();
        Self { session, prepared }
    }

    /// Returns true if the case may share a process with other cases.
    pub fn may_share(&self, case: &Case) -> bool {
        matches!(self.prepared.get(&key(case)), Some(Prepared::Built(true)))
    }

    /// The result of a case whose programs cannot be built.
    pub fn failure(&self, suite: &Suite, case: &Case) -> Option<CaseResult> {
        let Some(Prepared::Failed(result)) = self.prepared.get(&key(case)) else { return None };
        let Row { message, details, .. } = result.row.clone();
        let row = Row { message, details, ..super::case::row_of(suite, case) };
        Some(CaseResult { row, ..(**result).clone() })
    }
}

fn key(case: &Case) -> Key {
    let settings = case.options.settings.iter().map(ToString::to_string);
    // A setting of `robot` replaces whole tables of robots, which may contain programs.
    let program_settings = settings.filter(|setting| setting.contains("program") || setting.starts_with("robot="));
    (case.scene.clone(), program_settings.collect())
}
