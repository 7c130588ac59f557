//! Gois and Hiller: local maps from sonar for the walking machine ALDURO, and the planner that uses them.

mod ground;
mod picture;
mod survey;
mod walk;

use crate::page::Page;
use crate::run::Job;

/// Number of random terrains in each study.
const TERRAINS: usize = 20;

/// Makes the page.
///
/// # Errors
/// A scene that does not run to its end.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    run_over(job, TERRAINS, TERRAINS)
}

/// Makes the page of so many surveys and walks, at least one of each.
///
/// # Errors
/// A scene that does not run to its end.
pub fn run_over(job: &Job, surveys: usize, walks: usize) -> anyhow::Result<Page> {
    let source = "J. A. Morgado de Gois, M. Hiller: Implementation of a Sensor System for Obstacle Avoidance at a Four-Legged Robot";
    let mut page = Page::new("Maps of unstructured terrain from sonar", source);
    survey::add(job, &mut page, surveys)?;
    walk::add(job, &mut page, walks)?;
    Ok(page)
}
