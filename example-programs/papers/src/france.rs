//! France et al. 1999: what proximity sensors on the leg of a walking robot tell of the ground.

use crate::page::Page;
use crate::run::Job;

/// Makes the page.
///
/// # Errors
/// A scene that does not run to its end.
pub fn run(_job: &Job) -> anyhow::Result<Page> {
    let source = "L. France, A. Girault, J-D. Gascuel, B. Espiau: Sensor Modeling for a Walking Robot Simulation, 1999";
    let mut page = Page::new("Sensors on a walking robot", source);
    page.text("Nothing of this paper is reproduced here yet.");
    Ok(page)
}
