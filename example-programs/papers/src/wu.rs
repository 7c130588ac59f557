//! Wu et al. 2013: grid maps from seven ultrasonic sectors.

use crate::page::Page;
use crate::run::Job;

/// Makes the page.
///
/// # Errors
/// A scene that does not run to its end.
pub fn run(_job: &Job) -> anyhow::Result<Page> {
    let source = "J. Wu et al.: Environmental Modeling Based on Ultrasonic Ranging, 2013";
    let mut page = Page::new("Grid maps from seven ultrasonic sectors", source);
    page.text("Nothing of this paper is reproduced here yet.");
    Ok(page)
}
