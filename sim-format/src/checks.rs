//! Validation of a scene's checks: existing bodies, unique names, areas of a limited size.

use std::collections::BTreeMap;

use sim_core::build;
use sim_core::scene::Bounds;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::spec::{BodyRef, CheckKind, CheckSpec, SceneSpec, SwarmMetric};

/// Maximum number of squares of an area. Our choice.
const MAX_SQUARES: f64 = 1e6;

/// Stores the folder of the file that contains the `checks` in those checks that run a program.
pub(super) fn set_folder(checks: &mut [CheckSpec], file_folder: &str) {
    for check in checks {
        if let CheckKind::Script { folder, .. } = &mut check.kind {
            file_folder.clone_into(folder);
        }
    }
}

/// Mistakes in the checks of a scene whose robots and objects are known.
pub(super) fn check(scene: &SceneSpec) -> Vec<Diagnostic> {
    let mut sink = Sink::new(&scene.file);
    let objects = build::movable_objects(scene).count();
    let mut names: BTreeMap<&str, u32> = BTreeMap::new();
    for check in &scene.checks {
        for body in check.kind.bodies() {
            let (is_known, expected) = match body {
                BodyRef::Robot(id) => {
                    let robots = scene.robots.len();
                    (scene.robots.iter().any(|robot| robot.id == id), expected_ids(robots, "robot"))
                }
                BodyRef::Object(id) => (id.index() < objects, expected_ids(objects, "movable object")),
            };
            if !is_known {
                let message = format!("check `{}` is about {body}, which the scene does not have", check.title());
                sink.error(Code::CheckBody, check.span, message, expected);
            }
        }
        if !check.name.is_empty()
            && let Some(line) = names.insert(&check.name, check.span.line)
        {
            let message = format!("the check of line {line} is named `{}`, too", check.name);
            sink.error(Code::CheckName, check.span, message, "each name once");
        }
        if let CheckKind::Coverage { area, cell, .. }
        | CheckKind::Swarm { metric: SwarmMetric::Coverage { area, cell, .. }, .. } = &check.kind
        {
            let size = match area {
                Some(corners) => {
                    let bounds = Bounds::of_points(corners.iter().copied());
                    bounds.max - bounds.min
                }
                None => scene.world.floor,
            };
            let squares = (size / *cell).ceil().element_product();
            if squares > MAX_SQUARES {
                let message = format!("the area has {squares:.0} squares");
                sink.error(Code::NumberRange, check.span, message, "at most a million: a greater `cell_mm`");
            }
        }
    }
    sink.finish()
}

/// Text such as `a number from 1 to 3: the scene has 3 robots`.
fn expected_ids(count: usize, noun: &str) -> String {
    match count {
        0 => format!("the scene has no {noun}"),
        1 => format!("1: the scene has one {noun}"),
        _ => format!("a number from 1 to {count}: the scene has {count} {noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::Code;
    use crate::{MemoryFiles, load_scene};

    #[test]
    fn areas_have_at_most_a_million_squares() {
        for kind in ["kind = \"coverage\"\nshare_percent = 50", "kind = \"swarm\"\nof = \"coverage\"\nmin = 0.5"] {
            let area = "width_mm = 100\ncell_mm = 1\narea_mm = [[0, 0], [1001, 1000]]";
            let robot = "[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500";
            let text = format!("[world]\nfloor_mm = [3000, 2000]\n{robot}\n[[check]]\n{kind}\n{area}\n");
            let files: MemoryFiles = [("a.scene.toml", &*text)].into_iter().collect();
            let codes: Vec<Code> = load_scene("a.scene.toml", &files).diagnostics.iter().map(|it| it.code).collect();
            assert_eq!(codes, [Code::NumberRange], "{kind}");
        }
    }
}
