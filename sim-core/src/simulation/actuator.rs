//! Commands to individual motors and servos.

use super::Robot;
use crate::device::servo::steering_from_position;
use crate::drive::Command;
use crate::record::Event;
use crate::world::World;

impl Robot {
    /// Turns servo `index` of [`RobiSpec::all_servos`](crate::spec::RobiSpec::all_servos) to a position of 0 to 255.
    /// The steering servo of an Ackermann drive also steers. Returns true for a steering servo.
    ///
    /// # Panics
    /// If the servo does not exist.
    pub fn turn_servo(&mut self, world: &World, index: usize, position: u8) -> bool {
        let device = self.spec.all_servos()[index].name.to_owned();
        self.devices.servos.turn(index, position, self.now);
        self.record(Event::Servo { device: &device, position: position.into() });
        let is_steering = self.spec.drive.steering.as_ref() == Some(&device);
        if is_steering {
            let angle = steering_from_position(position) * self.motion.model().max_steering;
            // The command is never rejected: the angle is finite, and only a drive that steers has a steering servo.
            let _ = self.command(world, Command::Steer(angle));
        }
        is_steering
    }

    /// Sets the motors with these indices to a percentage of the wheels' maximum rate, -100 to 100. Other motors keep
    /// their commanded rates; indices without a motor are ignored.
    pub fn set_motors(&mut self, world: &World, motors: impl IntoIterator<Item = usize>, percent: i32) {
        let rate = f64::from(percent) / 100.0 * self.motion.model().max_wheel_rate;
        for wheel in motors {
            let Some(motor) = self.spec.drive.motors.get(wheel) else { continue };
            self.journal.record(self.now, &Event::Motor { device: &motor.motor, percent });
            // A motor that drives no wheel of this drive has no effect.
            let _ = self.command(world, Command::Wheel { wheel, rate });
        }
    }
}
