//! Gois and Hiller: local maps from sonar for the walking machine ALDURO, and the planner that uses them.

mod comparison;
mod fusion;
mod ground;
mod picture;
mod planner;
mod ridge;
mod survey;
mod walk;

pub(crate) use self::comparison::on_two_threads;
use crate::page::Page;
use crate::run::Job;

/// Number of random terrains on which the robot walks.
const WALKS: usize = 20;
/// Number of training and of held-out terrains in a comparison.
const COMPARED: usize = 40;

/// Makes the page of the walks of section 5, over `terrains` terrains (20 by default).
///
/// # Errors
/// If a scene does not run to its end.
pub fn run(job: &Job, terrains: Option<usize>) -> anyhow::Result<Page> {
    let source = "J. A. Morgado de Gois, M. Hiller: Implementation of a Sensor System for Obstacle Avoidance at a Four-Legged Robot";
    let mut page = Page::new("A walk over unstructured terrain", source);
    walk::add(job, &mut page, terrains.unwrap_or(WALKS))?;
    Ok(page)
}

/// Makes the page that compares maps of sections 3 and 4, with `terrains` training terrains and as many held-out ones
/// (40 by default).
///
/// # Errors
/// If a scene does not run to its end, or a search does not enclose the optimum.
pub fn fusion(job: &Job, terrains: Option<usize>) -> anyhow::Result<Page> {
    comparison::page(job, terrains.unwrap_or(COMPARED))
}

/// Recomputes a row of the published map errors from the published settings (`docs/papers/fusion-settings.csv`).
///
/// # Errors
/// If a table lacks settings for a method, or a scene does not run to its end.
pub fn fusion_sample(job: &Job, settings: &str) -> anyhow::Result<String> {
    comparison::sample(job, settings)
}

/// Makes the page that compares the planner's equations, over `terrains` terrains (40 by default).
///
/// # Errors
/// If a scene does not run to its end.
pub fn planner(job: &Job, terrains: Option<usize>) -> anyhow::Result<Page> {
    planner::page(job, terrains.unwrap_or(COMPARED))
}
