//! Conversion of the page's actions into actions of the simulation.

use sim_core::record::Action;
use sim_view::protocol;

/// Converts an action of the page's protocol into an action of the simulation.
pub fn action_from_page(action: protocol::Action) -> Action {
    use protocol::Action as Page;
    match action {
        Page::Press { robot, key } => Action::Press { robot, key },
        Page::Type { robot, line } => Action::Type { robot, line },
        Page::PlaceRobot { robot, x_m, y_m, phi_rad } => Action::PlaceRobot { robot, x_m, y_m, phi_rad },
        Page::PlaceObject { object, x_m, y_m, phi_rad } => Action::PlaceObject { object, x_m, y_m, phi_rad },
        Page::SetNoise { robot, parameter, value } => Action::SetNoise { robot, parameter, value },
        Page::SwitchSensor { robot, sensor, on } => Action::SwitchSensor { robot, sensor, on },
        Page::AddRobot { kind, program_of, x_m, y_m, phi_rad } => {
            Action::AddRobot { kind, program_of, x_m, y_m, phi_rad }
        }
        Page::RemoveRobot { robot } => Action::RemoveRobot { robot },
        Page::AddObject { kind, x_m, y_m, phi_rad } => Action::AddObject { kind, x_m, y_m, phi_rad },
        Page::RemoveObject { object } => Action::RemoveObject { object },
        Page::End {} => Action::End {},
    }
}
