//! The camera of RoBIOS-7: images of any size, in colour or grey.
//!
//! Source: RoBIOS-7 library, camera. As in EyeSim VR, an image may be larger than the maximum size in the robi.

use robios_sys::robios7::{CAM5MP, RESOLUTIONS};
use robios_sys::{OutBytes, OutFloats, OutInts, Robios7Call as Call};
use sim_core::device::camera::{CameraError, Setting};
use sim_core::world::World;

use super::camera::{self, ImageUnavailable};
use super::image7::is_resolution;
use super::robot::Robot;

/// Maximum width and height of an image in pixels.
const MAX_SIDE: i32 = 4096;

/// `CAMInit`; the program's side translates a resolution to its size. After a failure the camera is off: the program
/// may have set another size.
pub fn init(robot: &mut Robot, resolution: i32, [width, height]: [i32; 2]) -> i32 {
    if robot.spec.camera.is_none() {
        let error = CameraError::Absent(robot.spec.file.clone());
        return camera::refuse_call(robot, Call::CAMInit, 1, error);
    }
    let max_pixels = RESOLUTIONS.iter().find(|(_, number, ..)| *number == CAM5MP).map_or(0, |(_, _, x, y)| x * y);
    let is_size = [width, height].iter().all(|side| (1..=MAX_SIDE).contains(side));
    if !is_resolution(resolution) || !is_size || width as usize * height as usize > max_pixels {
        robot.devices.camera.switch_off();
        return robot.refuse_call(Call::CAMInit, 1, |_| {
            format!(
                "it takes QQVGA, QVGA, VGA, CAM1MP, CAMHD, CAM5MP, or CUSTOM with a CAMWIDTH and CAMHEIGHT of 1 to {MAX_SIDE} \
                 and no more pixels than CAM5MP has"
            )
        });
    }
    let size = [width as u32, height as u32];
    robot.devices.camera.switch_on(Setting { size, ..Setting::default() });
    0
}

/// `CAMRelease`
pub fn release(robot: &mut Robot) -> i32 {
    if robot.devices.camera.switch_off() { 0 } else { refuse_while_off(robot, Call::CAMRelease) }
}

/// `CAMGet`
pub fn get(robot: &mut Robot, world: &World, buffer: &mut OutBytes) -> i32 {
    if buffer.is_null() {
        return camera::refuse_call(robot, Call::CAMGet, 1, ImageUnavailable::Null);
    }
    match camera::take_colour(robot, world) {
        Ok(picture) => {
            buffer.set(picture.pixels().as_flattened());
            0
        }
        Err(error) => camera::refuse_call(robot, Call::CAMGet, 1, error),
    }
}

/// `CAMGetGray`
pub fn get_grey(robot: &mut Robot, world: &World, buffer: &mut OutBytes) -> i32 {
    if buffer.is_null() {
        return camera::refuse_call(robot, Call::CAMGetGray, 1, ImageUnavailable::Null);
    }
    match camera::take_grey(robot, world) {
        Ok(picture) => {
            buffer.set(picture.pixels().as_flattened());
            0
        }
        Err(error) => camera::refuse_call(robot, Call::CAMGetGray, 1, error),
    }
}

/// `CAMGetDepth`
pub fn depth(robot: &mut Robot, mm: &mut OutFloats) -> i32 {
    camera::store_depth(robot, Call::CAMGetDepth, 1, mm)
}

/// `CAMGetLabels`
pub fn labels(robot: &mut Robot, labels: &mut OutInts) -> i32 {
    camera::store_labels(robot, Call::CAMGetLabels, 1, labels)
}

/// Refuses a call that requires the camera to be on.
fn refuse_while_off(robot: &mut Robot, call: Call) -> i32 {
    let error = robot.camera_setting().err().unwrap_or(CameraError::Off);
    camera::refuse_call(robot, call, 1, error)
}
