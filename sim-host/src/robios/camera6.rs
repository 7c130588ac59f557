//! The camera of RoBIOS 6: images of 80 x 60, at the rate of the camera.
//!
//! It supports the settings of all cameras of the EyeBot: lens and levels of the QuickCam, frame rate of the EyeCam.
//! Source: RoBIOS 6 library, camera; `docs/robios6.md` describes our choices where the source is silent.

use robios_sys::robios6::{
    AUTOBRIGHTNESS, BayerFrame, ColImage, ColorFrame, FALSE, FPS0_46875, FPS60, IMAGE_COLUMNS, IMAGE_ROWS, INITERROR,
    Image, MonoFrame, NOAUTOBRIGHTNESS, NOCAM, NORMAL, TELE, WIDE,
};
use robios_sys::{Out, OutFloats, OutInts, Robios6Call as Call};
use sim_core::camera::Picture;
use sim_core::device::camera::{CameraError, Setting};
use sim_core::device::level::Levels;
use sim_core::time::Time;
use sim_core::world::World;

use super::caller::Poll;
use super::camera::{self, ImageUnavailable};
use super::robot::{Robot, WaitReason};

/// Camera version that `CAMInit` returns: an EyeCam with colour.
pub const VERSION: i32 = 17;

/// Columns and rows of an image without its border.
const SIZE: [u32; 2] = [IMAGE_COLUMNS as u32 - 2, IMAGE_ROWS as u32 - 2];

/// Columns and rows of an image through the colour filter.
const BAYER_SIZE: [u32; 2] = [2 * SIZE[0], 2 * SIZE[1]];

/// Period of the fastest rate, 1/60 s, in sixtieths of a microsecond.
const FASTEST_PERIOD_60THS_US: i64 = 1_000_000;

/// Camera settings of RoBIOS 6 beyond those in [`Setting`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// The frame rate, `FPS60` to `FPS0_46875`; `None` if images are available at any time.
    rate: Option<i32>,
    /// The last `CAMSet` set the frame rate.
    was_rate_set_last: bool,
}

/// `CAMInit`
pub fn init(robot: &mut Robot, mode: i32) -> i32 {
    if robot.spec.camera.is_none() {
        let error = CameraError::Absent(robot.spec.file.clone());
        return camera::refuse_call(robot, Call::CAMInit, NOCAM, error);
    }
    let zoom = match mode {
        NORMAL => 1.0,
        WIDE => 0.5,
        TELE => 2.0,
        _ => return robot.refuse_call(Call::CAMInit, INITERROR, |_| "it takes NORMAL, WIDE or TELE".to_owned()),
    };
    robot.devices.camera.switch_on(Setting { size: SIZE, zoom, levels: Levels::default() });
    robot.robios.camera6 = Settings::default();
    VERSION
}

/// `CAMRelease`
pub fn release(robot: &mut Robot) -> i32 {
    match robot.camera_setting() {
        Ok(_) => {
            robot.devices.camera.switch_off();
            0
        }
        Err(error) => camera::refuse_call(robot, Call::CAMRelease, -1, error),
    }
}

/// `CAMGetFrame`
pub fn frame(robot: &mut Robot, world: &World, buffer: &mut Out<Image>) -> Poll<i32> {
    deliver(robot, Call::CAMGetFrame, buffer, |robot| {
        let picture = camera::take_grey(robot, world)?;
        Ok(bordered(&picture, [0]).map(|row| row.map(|[level]| level)))
    })
}

/// `CAMGetColFrame`
pub fn colour_frame(robot: &mut Robot, world: &World, buffer: &mut Out<ColImage>, convert: i32) -> Poll<i32> {
    deliver(robot, Call::CAMGetColFrame, buffer, |robot| {
        if convert == FALSE {
            return Ok(bordered(&camera::take_colour(robot, world)?, [0; 3]));
        }
        // The grey image is at the start of the buffer, the only part that the shim copies.
        let picture = camera::take_grey(robot, world)?;
        let grey = bordered(&picture, [0]);
        let mut buffer: ColImage = [[[0; 3]; IMAGE_COLUMNS]; IMAGE_ROWS];
        let bytes = buffer.as_flattened_mut().as_flattened_mut();
        bytes[..IMAGE_COLUMNS * IMAGE_ROWS].copy_from_slice(grey.as_flattened().as_flattened());
        Ok(buffer)
    })
}

/// `CAMGetFrameMono`
pub fn mono_frame(robot: &mut Robot, world: &World, buffer: &mut Out<MonoFrame>) -> Poll<i32> {
    deliver(robot, Call::CAMGetFrameMono, buffer, |robot| {
        Ok(first_bytes(camera::take_grey(robot, world)?.pixels().as_flattened()))
    })
}

/// `CAMGetFrameColor`, `CAMGetFrameRGB`
pub fn rgb_frame(robot: &mut Robot, world: &World, call: Call, buffer: &mut Out<ColorFrame>) -> Poll<i32> {
    deliver(robot, call, buffer, |robot| Ok(first_bytes(camera::take_colour(robot, world)?.pixels().as_flattened())))
}

/// `CAMGetFrameBayer`
pub fn bayer_frame(robot: &mut Robot, world: &World, buffer: &mut Out<BayerFrame>) -> Poll<i32> {
    deliver(robot, Call::CAMGetFrameBayer, buffer, |robot| {
        Ok(first_bytes(camera::take_bayer(robot, world, BAYER_SIZE)?.pixels().as_flattened()))
    })
}

/// `CAMSet`
pub fn set(robot: &mut Robot, numbers: [i32; 3]) -> i32 {
    if let Err(error) = robot.camera_setting() {
        return camera::refuse_call(robot, Call::CAMSet, -1, error);
    }
    let Settings { rate, was_rate_set_last } = &mut robot.robios.camera6;
    if let [FPS60..=FPS0_46875, 0, 0] = numbers {
        *rate = Some(numbers[0]);
        *was_rate_set_last = true;
        return 0;
    }
    let [Ok(first), Ok(second), Ok(third)] = numbers.map(u8::try_from) else {
        return robot.refuse_call(Call::CAMSet, -1, |_| {
            "it takes three numbers of 0 to 255, or a frame rate, FPS60 to FPS0_46875, with two zeros".to_owned()
        });
    };
    *was_rate_set_last = false;
    if let Some(setting) = &mut robot.devices.camera.setting {
        setting.levels.numbers = [first, second, third];
    }
    0
}

/// `CAMGet`
pub fn get(robot: &mut Robot, out: [&mut Out<i32>; 3]) -> i32 {
    let setting = match robot.camera_setting() {
        Ok(setting) => setting,
        Err(error) => return camera::refuse_call(robot, Call::CAMGet, -1, error),
    };
    if out.iter().any(|number| number.is_null()) {
        return robot.fail_call(Call::CAMGet, -1);
    }
    let numbers = match robot.robios.camera6 {
        Settings { rate: Some(rate), was_rate_set_last: true } => [rate, 0, 0],
        _ => setting.levels.numbers.map(i32::from),
    };
    out.into_iter().zip(numbers).for_each(|(out, number)| out.set(number));
    0
}

/// `CAMMode`
pub fn set_mode(robot: &mut Robot, mode: i32) -> i32 {
    if let Err(error) = robot.camera_setting() {
        return camera::refuse_call(robot, Call::CAMMode, -1, error);
    }
    let is_automatic = match mode {
        AUTOBRIGHTNESS => true,
        NOAUTOBRIGHTNESS => false,
        _ => {
            let accepted = "it takes AUTOBRIGHTNESS or NOAUTOBRIGHTNESS";
            return robot.refuse_call(Call::CAMMode, -1, |_| accepted.to_owned());
        }
    };
    if let Some(setting) = &mut robot.devices.camera.setting {
        setting.levels.is_automatic = is_automatic;
    }
    0
}

/// `CAMGetDepth`
pub fn depth(robot: &mut Robot, mm: &mut OutFloats) -> i32 {
    camera::store_depth(robot, Call::CAMGetDepth, -1, mm)
}

/// `CAMGetLabels`
pub fn labels(robot: &mut Robot, labels: &mut OutInts) -> i32 {
    camera::store_labels(robot, Call::CAMGetLabels, -1, labels)
}

/// Waits until the camera has an image, then stores the result of `take_image`.
fn deliver<T>(
    robot: &mut Robot,
    call: Call,
    buffer: &mut Out<T>,
    take_image: impl FnOnce(&mut Robot) -> Result<T, ImageUnavailable>,
) -> Poll<i32> {
    let image = match robot.camera_setting() {
        Ok(_) if buffer.is_null() => Err(ImageUnavailable::Null),
        Ok(_) => {
            let due = robot.robios.camera6.rate.map_or(robot.now, |rate| next_frame(rate, robot.now));
            if due > robot.now {
                return Poll::Pending { at: due, reason: WaitReason::Time(due) };
            }
            take_image(robot)
        }
        Err(error) => Err(error.into()),
    };
    Poll::Ready(match image {
        Ok(frame) => {
            buffer.set(frame);
            0
        }
        Err(error) => camera::refuse_call(robot, call, -1, error),
    })
}

/// Time of the first image at or after `now`, rounded up to a microsecond, in a sequence of this rate that begins at
/// time 0.
fn next_frame(rate: i32, now: Time) -> Time {
    let period = FASTEST_PERIOD_60THS_US << (rate - FPS60);
    // The time of image n, rounded up, is not before `now` if and only if n periods exceed `now` - 1.
    let number = (60 * (now.0 - 1)).div_euclid(period) + 1;
    Time((number * period).div_euclid(60) + i64::from((number * period).rem_euclid(60) > 0))
}

/// Adds a border to a picture.
fn bordered<T: Copy>(picture: &Picture<T>, border: T) -> [[T; IMAGE_COLUMNS]; IMAGE_ROWS] {
    let mut image = [[border; IMAGE_COLUMNS]; IMAGE_ROWS];
    for (row, pixels) in image[1..].iter_mut().zip(picture.rows()) {
        row[1..=pixels.len()].copy_from_slice(pixels);
    }
    image
}

/// The first `N` bytes as an array.
fn first_bytes<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|index| bytes[index])
}

#[cfg(test)]
mod tests {
    use robios_sys::robios6::{FPS15, FPS30};

    use super::*;

    #[test]
    fn images_are_due_at_multiples_of_their_period() {
        let next = |rate, now| next_frame(rate, Time(now)).0;
        assert_eq!([0, 1, 16_667, 16_668, 33_334].map(|now| next(FPS60, now)), [0, 16_667, 16_667, 33_334, 33_334]);
        assert_eq!(next(FPS30, 1), 33_334);
        assert_eq!(next(FPS15, 66_668), 133_334);
        assert_eq!(next(FPS0_46875, 1), 2_133_334);
        // The rate does not drift: at 60 images a second, image 3,600 is due after exactly one minute.
        assert_eq!(next(FPS60, 59_999_999), 60_000_000);
    }

    #[test]
    fn a_bordered_picture_begins_at_row_1_and_column_1() {
        let pixels: Vec<u32> = (0..80 * 60).collect();
        let image = bordered(&Picture::new(SIZE, pixels), u32::MAX);
        assert_eq!([image[1][1], image[1][80], image[60][80]], [0, 79, 4799]);
        assert_eq!([image[0][5], image[61][5], image[5][0], image[5][81]], [u32::MAX; 4]);
    }
}
