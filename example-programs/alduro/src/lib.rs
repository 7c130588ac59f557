//! Walks over unstructured terrain on four legs, by a local map from sonar (Gois and Hiller).

use robios_api::prelude::*;

robios_api::program!(main);

fn main(_robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    Ok(())
}
