//! A robot program that ends in the way that its argument names: for tests that load it.

use robios_api::prelude::*;

robios_api::program!(main);

fn main(robot: &Robot) -> Result<(), String> {
    let _last_words = LastWords(robot.clone());
    let kind = robot.arguments().first().map(String::as_str);
    match kind {
        None => Ok(()),
        Some("panic") => panic!("out of cheese"),
        Some("error") => Err("the battery is flat".to_owned()),
        Some("loop") => loop {
            let _ = robot.key();
        },
        Some("wait") => {
            robot.wait_for_key(Key::Key4);
            Ok(())
        }
        Some("panic-in-timer") => {
            let _timer = robot.every(100.millis(), |_| panic!("tick")).map_err(|error| error.to_string())?;
            robot.sleep(1.seconds());
            Ok(())
        }
        Some(other) => Err(format!("unknown way `{other}`")),
    }
}

/// Makes calls while the program unwinds.
struct LastWords(Robot);

impl Drop for LastWords {
    fn drop(&mut self) {
        writeln!(self.0.console(), "bye");
    }
}
