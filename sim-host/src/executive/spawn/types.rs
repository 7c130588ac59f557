//! The types of which robots and movable objects can be added to a run, by their names.

use std::sync::Arc;

use sim_core::build;
use sim_core::spec::{ObjectType, RobiSpec, SceneSpec};
use sim_format::builtin;

/// What can be added to a run: the types of its scene, then those that are built in.
pub struct Types {
    robots: Vec<(String, Arc<RobiSpec>)>,
    objects: Vec<(String, Arc<ObjectType>)>,
}

impl Types {
    /// Those of a run of `scene`.
    pub fn of(scene: &SceneSpec) -> Self {
        let robis = scene.robots.iter().map(|robot| &robot.robi);
        let robis = robis.map(|robi| (robi.name.as_str(), robi.file.as_str(), Arc::clone(robi)));
        let built_in = builtin::ROBOTS.iter().filter_map(|name| Some((*name, *name, Arc::new(builtin::robot(name)?))));
        let robots = named(robis.chain(built_in));
        let kinds = build::movable(scene).map(|object| &object.kind);
        let kinds = kinds.map(|kind| (kind.name.as_str(), kind.file.as_str(), Arc::clone(kind)));
        let built_in =
            builtin::OBJECTS.iter().filter_map(|name| Some((*name, *name, Arc::new(builtin::object(name)?))));
        Self { robots, objects: named(kinds.chain(built_in)) }
    }

    /// Names of the types of robots.
    pub fn robots(&self) -> Vec<String> {
        names(&self.robots)
    }

    /// Names of the types of movable objects.
    pub fn objects(&self) -> Vec<String> {
        names(&self.objects)
    }

    /// The type of robots of this name.
    ///
    /// # Errors
    /// In words, when there is none.
    pub fn robot(&self, name: &str) -> Result<Arc<RobiSpec>, String> {
        find(&self.robots, "robots", name)
    }

    /// The type of movable objects of this name.
    ///
    /// # Errors
    /// In words, when there is none.
    pub fn object(&self, name: &str) -> Result<Arc<ObjectType>, String> {
        find(&self.objects, "movable objects", name)
    }
}

/// Types by their names, each once; where another one has the name already, by its file.
fn named<'a, T>(all: impl Iterator<Item = (&'a str, &'a str, Arc<T>)>) -> Vec<(String, Arc<T>)> {
    let mut types: Vec<(String, Arc<T>)> = Vec::new();
    let mut known: Vec<(String, String)> = Vec::new();
    for (name, file, kind) in all {
        let both = (name.to_owned(), file.to_owned());
        if known.contains(&both) {
            continue;
        }
        known.push(both);
        let is_free = |word: &&str| types.iter().all(|(taken, _)| taken != word);
        if let Some(word) = [name, file].into_iter().find(is_free) {
            types.push((word.to_owned(), kind));
        }
    }
    types
}

fn names<T>(types: &[(String, Arc<T>)]) -> Vec<String> {
    types.iter().map(|(name, _)| name.clone()).collect()
}

fn find<T>(types: &[(String, Arc<T>)], what: &str, name: &str) -> Result<Arc<T>, String> {
    let found = types.iter().find(|(known, _)| known == name).map(|(_, kind)| Arc::clone(kind));
    found.ok_or_else(|| format!("there is no type of {what} `{name}`, accepted: {}", names(types).join(", ")))
}
