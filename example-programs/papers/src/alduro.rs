//! Gois and Hiller: local maps from sonar for the walking machine ALDURO, and the planner that walks by them.

mod ground;
mod picture;
mod survey;
mod walk;

use crate::page::Page;
use crate::run::Job;

/// Makes the page.
///
/// # Errors
/// A scene that does not run to its end.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    let source = "J. A. Morgado de Gois, M. Hiller: Implementation of a Sensor System for Obstacle Avoidance at a Four-Legged Robot";
    let mut page = Page::new("Maps of unstructured terrain from sonar", source);
    survey::add(job, &mut page)?;
    walk::add(job, &mut page)?;
    Ok(page)
}
