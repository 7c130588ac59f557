//! Camera functions that both generations share: they take images, convert depths and labels to the numbers of
//! programs, and give the reason for a missing image.
//!
//! The camera itself is [`sim_core::device::camera`]; `camera6.rs` and `camera7.rs` pass its images to programs.
//! Source: RoBIOS 6 and RoBIOS-7 library, camera.

use std::sync::Arc;

use robios_sys::robios7::{CAM_BODY, CAM_FLOOR, CAM_SKY, CAM_WALL};
use robios_sys::{OutFloats, OutInts};
use sim_core::camera::{Label, Picture, Scenery};
use sim_core::device::camera::{CameraError, Exposure};
use sim_core::simulation::{self, Placeable};
use sim_core::unit::mm_from_metres;
use sim_core::world::World;

use super::call::Call;
use super::ground_truth::{EntityNumbers, NumberedObject};
use super::robot::Robot;
use crate::record::frame::{Frame, Frames, Pixels};
use crate::scenery::LazyScenery;

/// Scenery that a robot's camera sees, and destination of its images.
#[derive(Default)]
pub struct CameraOutput {
    /// Everything that cameras can see.
    pub scenery: Arc<LazyScenery>,
    /// Destination of all images, scans and layers of programs, if the user wants them.
    pub frames: Option<Arc<Frames>>,
}

/// Reason why a call returns no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageUnavailable {
    /// The buffer is null.
    #[error("the buffer for the image is null")]
    Null,
    /// The camera returns no image.
    #[error("{}", camera_error_text(.0))]
    Camera(CameraError),
}

impl From<CameraError> for ImageUnavailable {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}

fn camera_error_text(error: &CameraError) -> String {
    match error {
        CameraError::Absent(file) => format!(
            "`{file}` has no camera; its line in a robi file is `camera X Y Z PAN TILT`, its table in a companion `[camera]`"
        ),
        CameraError::Off => "the camera is off until `CAMInit`".to_owned(),
        CameraError::NotTaken => "it refers to the last image, and none has been taken since `CAMInit`".to_owned(),
        error => error.to_string(),
    }
}

/// Takes a colour image.
pub(super) fn take_colour(robot: &mut Robot, world: &World) -> Result<Picture<[u8; 3]>, ImageUnavailable> {
    let picture = take_image(robot, |robot, scenery| robot.take_colour(world, scenery))?;
    publish(robot, picture.size(), Pixels::Colour(picture.pixels().as_flattened()));
    Ok(picture)
}

/// Takes a grey image: the mean of red, green and blue, rounded down.
pub(super) fn take_grey(robot: &mut Robot, world: &World) -> Result<Picture<[u8; 1]>, ImageUnavailable> {
    let picture = take_image(robot, |robot, scenery| robot.take_grey(world, scenery))?;
    publish(robot, picture.size(), Pixels::Grey(picture.pixels().as_flattened()));
    Ok(picture)
}

/// Takes an image of `size` through the sensor's colour filter.
pub(super) fn take_bayer(
    robot: &mut Robot,
    world: &World,
    size: [u32; 2],
) -> Result<Picture<[u8; 1]>, ImageUnavailable> {
    let picture = take_image(robot, |robot, scenery| robot.take_bayer(world, scenery, size))?;
    publish(robot, size, Pixels::Bayer(picture.pixels().as_flattened()));
    Ok(picture)
}

/// Takes an image. The scenery is built lazily, and only for a camera that is on.
fn take_image<T>(
    robot: &mut Robot,
    expose: impl FnOnce(&mut simulation::Robot, &Arc<Scenery>) -> Result<T, CameraError>,
) -> Result<T, ImageUnavailable> {
    robot.camera_setting()?;
    let scenery = robot.robios.camera_output.scenery.get();
    Ok(expose(&mut robot.state, &scenery)?)
}

/// Depth of each pixel of the last image in mm along the line of sight; infinite for the sky.
fn take_depth(robot: &mut Robot) -> Result<Vec<f32>, ImageUnavailable> {
    let picture = robot.take_depth()?;
    let depth = mm_of_depth(&picture);
    record_and_publish(robot, picture.size(), Pixels::Depth(&depth));
    Ok(depth)
}

/// Number of the body that each pixel of the last image shows.
fn take_labels(robot: &mut Robot) -> Result<Vec<i32>, ImageUnavailable> {
    let picture = robot.take_labels()?;
    let labels = numbers_of_labels(&picture, &robot.robios.entity_numbers);
    record_and_publish(robot, picture.size(), Pixels::Labels(&labels));
    Ok(labels)
}

/// `CAMGetDepth` of either generation.
pub(super) fn store_depth(robot: &mut Robot, call: impl Into<Call>, failure: i32, mm: &mut OutFloats) -> i32 {
    let depth = if mm.is_null() { Err(ImageUnavailable::Null) } else { take_depth(robot) };
    match depth {
        Ok(depth) => {
            mm.set(&depth);
            0
        }
        Err(error) => refuse_call(robot, call, failure, error),
    }
}

/// `CAMGetLabels` of either generation.
pub(super) fn store_labels(robot: &mut Robot, call: impl Into<Call>, failure: i32, numbers: &mut OutInts) -> i32 {
    let labels = if numbers.is_null() { Err(ImageUnavailable::Null) } else { take_labels(robot) };
    match labels {
        Ok(labels) => {
            numbers.set(&labels);
            0
        }
        Err(error) => refuse_call(robot, call, failure, error),
    }
}

/// Refuses a call that returns no image.
pub(super) fn refuse_call(
    robot: &mut Robot,
    call: impl Into<Call>,
    answer: i32,
    error: impl Into<ImageUnavailable>,
) -> i32 {
    let error = error.into();
    robot.refuse_call(call, answer, |_| error.to_string())
}

/// Converts depths in metres to the mm that programs get.
pub fn mm_of_depth(depth: &Picture<f32>) -> Vec<f32> {
    depth.pixels().iter().map(|metres| mm_from_metres(f64::from(*metres)) as f32).collect()
}

/// Converts labels to the numbers that programs get; bodies are numbered among all robots and objects.
pub fn numbers_of_labels(labels: &Picture<Label>, entity_numbers: &EntityNumbers) -> Vec<i32> {
    // Index of each movable object among all objects; an `ObjectId` counts only movable objects.
    let movable: Vec<usize> = (0..entity_numbers.objects.len())
        .filter(|index| matches!(entity_numbers.objects[*index], NumberedObject::Movable(_)))
        .collect();
    let object = |index: usize| CAM_BODY + (entity_numbers.robots + 1 + index) as i32;
    let spawned = |entity: Placeable| CAM_BODY + entity_numbers.spawned_number(entity).unwrap_or_default();
    let number = |label: &Label| match label {
        Label::Sky => CAM_SKY,
        Label::Ground => CAM_FLOOR,
        Label::Wall(_) => CAM_WALL,
        Label::Fixed(index) => object(*index as usize),
        Label::Object(id) => match movable.get(id.index()) {
            Some(index) => object(*index),
            None => spawned(Placeable::Object(*id)),
        },
        Label::Robot(id) if id.index() < entity_numbers.robots => CAM_BODY + id.0 as i32,
        Label::Robot(id) => spawned(Placeable::Robot(*id)),
    };
    labels.pixels().iter().map(number).collect()
}

/// Records depths or labels of the last image and passes them to the destination of images, if there is one.
fn record_and_publish(robot: &mut Robot, size: [u32; 2], pixels: Pixels<'_>) {
    robot.record_frame(pixels.form(), size, &pixels.bytes());
    publish(robot, size, pixels);
}

/// Passes the last image, or its depths or labels, to the destination of images, if there is one.
fn publish(robot: &Robot, size: [u32; 2], pixels: Pixels<'_>) {
    if let (Some(frames), Some(exposure)) = (&robot.robios.camera_output.frames, robot.devices.camera.last()) {
        let Exposure { number, at, .. } = *exposure;
        frames.write(robot.id, &Frame { number, exposed: at, size, pixels });
    }
}

#[cfg(test)]
mod tests {
    use sim_core::{ObjectId, RobotId};

    use super::*;

    #[test]
    fn labels_are_converted_to_the_numbers_of_bodies() {
        let objects = vec![
            NumberedObject::Movable(ObjectId(1)),
            NumberedObject::Fixed(sim_core::pose::Pose::default()),
            NumberedObject::Movable(ObjectId(2)),
        ];
        let entity_numbers = EntityNumbers { robots: 2, objects, ..EntityNumbers::default() };
        let labels = [
            Label::Sky,
            Label::Ground,
            Label::Wall(7),
            Label::Robot(RobotId(2)),
            Label::Object(ObjectId(1)),
            Label::Fixed(1),
            Label::Object(ObjectId(2)),
        ];
        let picture = Picture::new([7, 1], labels.to_vec());
        assert_eq!(numbers_of_labels(&picture, &entity_numbers), [0, 1, 2, 12, 13, 14, 15]);
    }
}
