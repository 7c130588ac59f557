//! Walks on two legs towards an obstacle and computes the profile of the ground (France et al. 1999).

use robios_api::prelude::*;

robios_api::program!(main);

fn main(_robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    Ok(())
}
