//! Maps a room with seven ultrasonic sensors, by lines between neighbouring readings (Wu et al. 2013).

use robios_api::prelude::*;

robios_api::program!(main);

fn main(_robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    Ok(())
}
