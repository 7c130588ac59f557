//! Finds a ball by its colour, drives to it and stops in front of it.
//!
//! A pixel belongs to the ball if it has the ball's hue and is saturated: brown has the hue of orange, but a lower
//! saturation. Pixels are counted by column, so that single pixels coloured by noise do not matter: the ball is the run
//! of adjacent columns with the most ball pixels, where each column has at least two. The width of the run gives the
//! distance of the ball.
//!
//! Optional argument: the hue, 0 to 255: `follow-ball 65`.

use robios_api::robios7::prelude::*;
use robios_api::robios7::{ColorImage, GrayImage, ImageSize, Lcd};

robios_api::program!(main);

/// The hue of orange.
const ORANGE: u8 = 65;
/// Maximum difference from the wanted hue.
const HUE_TOLERANCE: u8 = 10;
const MIN_SATURATION: u8 = 175;
/// The hue of darker, nearly black pixels is arbitrary.
const MIN_INTENSITY: u8 = 25;

const RADIUS: Length = Length::metres(0.05);
/// Distance from the camera to the ball's centre at which the robot stops.
const STOP: Length = Length::metres(0.13);
const SPEED: Speed = Speed::metres_per_second(0.25);
/// Turn rate of the search, and maximum turn rate.
const TURN: TurnRate = TurnRate::degrees_per_second(60.0);
/// Time of a full turn at [`TURN`], 6 s, and a margin.
const FULL_TURN_TIME: Duration = Duration::from_millis(6700);

const SIZE: ImageSize = ImageSize::QQVGA;
/// Focal length in pixels, of a camera with a field of view of 60 degrees: half of the width over the tangent of 30
/// degrees.
const FOCAL_PX: f64 = 80.0 / 0.577_350_269;

/// The columns of the image that the ball fills.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    left: u16,
    right: u16,
}

impl Ball {
    /// Finds the run of adjacent columns with the most pixels of the ball.
    fn find(mask: &GrayImage) -> Option<Self> {
        let columns = mask.size().columns();
        let mut counts = vec![0; usize::from(columns)];
        for row in mask.bytes().chunks(counts.len()) {
            for (count, pixel) in counts.iter_mut().zip(row) {
                *count += u32::from(*pixel);
            }
        }
        let mut best = (0, None);
        let mut run: Option<(u32, Ball)> = None;
        for (column, count) in (0..columns).zip(counts) {
            run = (count >= 2).then(|| {
                let (pixels, ball) = run.unwrap_or((0, Ball { left: column, right: column }));
                (pixels + count, Ball { right: column, ..ball })
            });
            if let Some((pixels, ball)) = run.filter(|(pixels, _)| *pixels > best.0) {
                best = (pixels, Some(ball));
            }
        }
        best.1
    }

    /// Distance of the ball's centre from the camera.
    fn distance(self) -> Length {
        let half_width = f64::from(self.right - self.left + 1) / 2.0;
        RADIUS * ((half_width * half_width + FOCAL_PX * FOCAL_PX).sqrt() / half_width)
    }

    /// Direction of the ball, positive to the left.
    fn direction(self) -> Angle {
        // Both lengths are in pixels: only their ratio counts.
        let offset_px = (f64::from(SIZE.columns() - 1) - f64::from(self.left + self.right)) / 2.0;
        Angle::towards(Length::metres(FOCAL_PX), Length::metres(offset_px))
    }
}

/// The pixels that have the colour of the ball: 1, all others 0.
fn mask_of([hue, saturation, intensity]: &[GrayImage; 3], wanted: u8) -> GrayImage {
    let mut mask = GrayImage::new(hue.size());
    let pixels = hue.bytes().iter().zip(saturation.bytes()).zip(intensity.bytes());
    for (is_ball, ((hue, saturation), intensity)) in mask.bytes_mut().iter_mut().zip(pixels) {
        *is_ball = u8::from(
            hue.abs_diff(wanted) <= HUE_TOLERANCE && *saturation >= MIN_SATURATION && *intensity >= MIN_INTENSITY,
        );
    }
    mask
}

/// Shows the camera image at the left and the pixels of the ball at the right.
fn show(lcd: Lcd<'_>, image: &ColorImage, mask: &GrayImage, ball: Option<Ball>) -> Result {
    lcd.image(Pixel { x: 0, y: 0 }, image);
    lcd.binary_image(Pixel { x: SIZE.columns().into(), y: 0 }, mask);
    let Some(ball) = ball else {
        return write!(lcd.at(10, 0), "{:30}", "looking around");
    };
    for x in [ball.left, ball.right].map(i32::from) {
        lcd.line(Pixel { x, y: 0 }, Pixel { x, y: i32::from(SIZE.rows()) - 1 }, Color::GREEN);
    }
    let (distance, direction) = (ball.distance().as_millimetres(), ball.direction().as_degrees());
    write!(lcd.at(10, 0), "ball at {distance:4.0} mm, {direction:3.0} degrees  ")
}

/// Drives up to 0.7 m ahead but leaves 0.3 m free in front; backs up 0.1 m if there is less.
fn move_on(robot: &Robot) -> Result {
    let room = robot.psd(PsdAt::Front)?.distance().map_or(0.7.metres(), |free| free - 0.3.metres());
    let distance = if room < Length::ZERO { -0.1.metres() } else { room.min(0.7.metres()) };
    let drive = robot.drive();
    drive.straight(distance, SPEED)?;
    while !drive.is_done() && drive.stall().is_none() {
        robot.sleep(50.millis());
    }
    Ok(())
}

fn main(robot: &Robot) -> Result {
    let target_hue = robot.arguments().first().and_then(|hue| hue.parse().ok()).unwrap_or(ORANGE);
    let (drive, lcd, camera) = (robot.drive(), robot.lcd(), robot.camera(SIZE)?);
    // Direction of the search: 1 to the left, -1 to the right, where the ball was last seen.
    let (mut last_seen, mut search_sign) = (robot.now(), 1.0);
    loop {
        let image = camera.color()?;
        let mask = mask_of(&robot.images().to_hsi(&image), target_hue);
        let ball = Ball::find(&mask);
        show(lcd, &image, &mask, ball)?;
        if drive.stall().is_some() {
            drive.straight(-0.15.metres(), SPEED)?.wait()?;
            drive.turn(60.degrees() * search_sign, TURN)?.wait()?;
            move_on(robot)?;
        } else if let Some(ball) = ball {
            if ball.distance() <= STOP {
                break;
            }
            last_seen = robot.now();
            search_sign = if ball.direction() < Angle::ZERO { -1.0 } else { 1.0 };
            let (forward, turn) = steer(ball);
            drive.set_speed(forward, turn)?;
        } else {
            if robot.now() - last_seen > FULL_TURN_TIME {
                move_on(robot)?;
                last_seen = robot.now();
            }
            drive.set_speed(Speed::ZERO, TURN * search_sign)?;
        }
    }
    drive.stop()?;
    write!(lcd.at(12, 0), "there")
}

/// Speed and turn rate towards a ball: slower near the ball, so that the robot stops in front of it.
fn steer(ball: Ball) -> (Speed, TurnRate) {
    let forward = Speed::metres_per_second((ball.distance() - STOP).as_metres() + 0.04);
    let turn = TurnRate::degrees_per_second(2.0 * ball.direction().as_degrees());
    (forward.min(SPEED), turn.max(-TURN).min(TURN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(pixels: &[(usize, usize)]) -> GrayImage {
        let mut mask = GrayImage::new(SIZE);
        for (column, row) in pixels {
            mask.bytes_mut()[row * usize::from(SIZE.columns()) + column] = 1;
        }
        mask
    }

    #[test]
    fn the_ball_is_the_run_of_columns_with_most_pixels() {
        let square = |left: usize, size: usize| (0..size * size).map(move |i| (left + i % size, 50 + i / size));
        let pixels: Vec<_> = square(20, 3).chain(square(100, 5)).chain(square(140, 4)).collect();
        assert_eq!(Ball::find(&mask(&pixels)), Some(Ball { left: 100, right: 104 }));
    }

    #[test]
    fn single_pixels_are_not_a_ball() {
        assert_eq!(Ball::find(&mask(&[(3, 5), (4, 90), (159, 119)])), None);
    }

    #[test]
    fn width_and_position_give_distance_and_direction() {
        // Tangents at 30 degrees: the ball fills the image.
        let near = Ball { left: 0, right: 159 };
        assert!((near.distance() - 0.1.metres()).abs() < 1.millimetres(), "{:?}", near.distance());
        assert!(near.direction().abs() < 1e-9.radians());
        let left = Ball { left: 0, right: 0 };
        assert!((left.direction() - 30.degrees()).abs() < 0.5.degrees(), "{:?}", left.direction());
    }

    #[test]
    fn brown_is_not_orange() {
        let image = |level| {
            let mut image = GrayImage::new(ImageSize::new(1, 1));
            image.bytes_mut()[0] = level;
            image
        };
        let is_ball = |hsi: [u8; 3]| mask_of(&hsi.map(image), ORANGE).bytes() == [1];
        assert!(is_ball([66, 217, 133]) && is_ball([60, 200, 30]));
        assert!(!is_ball([64, 116, 110]), "the crate");
        assert!(!is_ball([85, 217, 133]), "yellow");
        assert!(!is_ball([66, 255, 3]), "black");
    }
}
