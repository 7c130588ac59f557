//! PSD distance sensors, in continuous mode: a new sample every 60 ms.

use std::time::Duration;

use robios_sys::ByteBuffer;
use robios_sys::robios6::{FALSE, PSD_OUT_OF_RANGE, PSDHandle, TRUE};
use robios_sys::robios7::MAX_LIDAR_POINTS;

use crate::device::{Device, PsdAt};
use crate::robot::{locked, release, robios};
use crate::unit::Length;
use crate::{Error, Result, Robot};

/// Length of a measuring cycle.
const CYCLE: Duration = Duration::from_millis(60);

/// The sensors in use: RoBIOS starts all of them together and releases all of them together.
#[derive(Default)]
pub(crate) struct PsdState {
    /// Handle of each live [`Psd`]; several may share a handle.
    handles: Vec<PSDHandle>,
    is_measuring: bool,
}

impl PsdState {
    fn mask(&self) -> PSDHandle {
        self.handles.iter().fold(0, |mask, handle| mask | handle)
    }
}

/// A distance sensor that measures continuously; dropping the last one ends measuring.
#[derive(Debug)]
pub struct Psd {
    robot: Robot,
    at: PsdAt,
    handle: PSDHandle,
}

/// Polls every 10 ms, for a second at most. It is a macro because calls in a closure would be recorded with a location
/// in this file.
macro_rules! poll {
    ($robot:expr, $device:expr, $is_ready:expr) => {
        'poll: {
            for _ in 0..100 {
                if $is_ready {
                    break 'poll Ok(());
                }
                $robot.sleep(Duration::from_millis(10));
            }
            Err(Error::NoResult($device))
        }
    };
}

impl Robot {
    /// Initialises a distance sensor and waits for its first sample.
    ///
    /// [`psds`](Self::psds) starts several sensors at once, which is faster.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such sensor; [`Error::NoResult`] if no sample arrives.
    #[track_caller]
    pub fn psd(&self, at: PsdAt) -> Result<Psd> {
        let [psd] = self.psds([at])?;
        Ok(psd)
    }

    /// Initialises distance sensors and waits for their first samples, for 60 ms.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// fn look(robot: &Robot) -> Result {
    ///     let [left, right] = robot.psds([PsdAt::Left, PsdAt::Right])?;
    ///     match left.distance() {
    ///         Some(distance) if distance < 0.2.metres() => writeln!(robot.console(), "a wall at {distance:.2}"),
    ///         _ => writeln!(robot.console(), "free"),
    ///     }
    ///     assert_eq!(right.distance(), None);
    ///     Ok(())
    /// }
    /// # let fake = robios_api::fake::Fake::new()
    /// #     .psd(PsdAt::Left, |_| Some(0.1.metres()))
    /// #     .psd(PsdAt::Right, |_| None);
    /// # assert_eq!(fake.run(look).expect_finished().console(), "a wall at 0.10 m\n");
    /// ```
    ///
    /// # Errors
    /// [`Error::Unavailable`] names the first sensor that the robot does not have; [`Error::NoResult`] if no sample
    /// arrives.
    #[track_caller]
    pub fn psds<const N: usize>(&self, at: [PsdAt; N]) -> Result<[Psd; N]> {
        let mut psds = at.map(|at| Psd { robot: self.clone(), at, handle: 0 });
        let mut missing = None;
        // A loop, because calls in a closure would be recorded with a location in this file.
        for psd in &mut psds {
            psd.handle = robios!(self, PSDInit(psd.at.semantics()));
            if psd.handle == 0 {
                missing.get_or_insert(Error::Unavailable(Device::Psd(psd.at)));
            }
            locked(&self.0.common.psd).handles.push(psd.handle);
        }
        if let Some(missing) = missing {
            return Err(missing);
        }
        if let Some(first) = psds.first() {
            self.measure(Device::Psd(first.at))?;
        }
        Ok(psds)
    }

    /// Starts all sensors in use and waits for their first samples.
    #[track_caller]
    fn measure(&self, device: Device) -> Result {
        let was_measuring = std::mem::replace(&mut locked(&self.0.common.psd).is_measuring, true);
        if was_measuring {
            let _: i32 = robios!(self, PSDStop());
        }
        let mask = locked(&self.0.common.psd).mask();
        // Sensors that were measuring before finish their cycle first.
        poll!(self, device, robios!(self, PSDStart(mask, TRUE)) == 0)?;
        if was_measuring {
            // The available result does not include the new sensors yet.
            self.sleep(CYCLE);
        }
        poll!(self, device, robios!(self, PSDCheck()) != FALSE)
    }
}

impl Psd {
    /// Name of the sensor.
    pub fn at(&self) -> PsdAt {
        self.at
    }

    /// Distance measured in the last complete cycle; `None` if out of range.
    #[track_caller]
    pub fn distance(&self) -> Option<Length> {
        let distance_mm: i32 = robios!(&self.robot, PSDGet(self.handle));
        (distance_mm != PSD_OUT_OF_RANGE).then(|| Length::millimetres(distance_mm.into()))
    }

    /// Raw value measured in the last complete cycle: larger is nearer.
    #[track_caller]
    pub fn raw(&self) -> RawDistance {
        let raw: i32 = robios!(&self.robot, PSDGetRaw(self.handle));
        RawDistance(raw.clamp(0, 255) as u8)
    }

    /// Signal underlying the distance of the last complete cycle; `None` if nothing has been measured. An extension of
    /// this simulator.
    #[track_caller]
    pub fn signal(&self) -> Option<Signal> {
        Signal::from_robios(robios!(&self.robot, PSDGetSignal(self.handle)))
    }

    /// Time of the last complete cycle since the robot's start, to a hundredth of a second.
    #[track_caller]
    pub fn measured_at(&self) -> Duration {
        let hundredths: i32 = robios!(&self.robot, PSDGet(0));
        Duration::from_millis(10) * hundredths.max(0) as u32
    }
}

/// Raw output of a PSD sensor, 0 to 255, before its table converts it to a distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RawDistance(pub u8);

/// Signal from which a range sensor derives the distance. Reflectance sensor: its signal in 1/m. Sonar: the energy of
/// the echo, 1 for a perfect reflector 1 m ahead. Other sensors: 1 with an echo and 0 without.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Signal(pub f64);

impl Signal {
    /// Converts the result of `PSDGetSignal`; negative is none.
    pub(crate) fn from_robios(signal: f32) -> Option<Self> {
        (signal >= 0.0).then_some(Self(signal.into()))
    }
}

impl Robot {
    /// Scans once with the laser scanner and returns the distances of all points set in the robi file, `None` if out of
    /// range. The points go from left to right; the middle one is straight ahead. An extension of this simulator.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no scanner.
    #[track_caller]
    pub fn laser_scan(&self) -> Result<Vec<Option<Length>>> {
        let mut distances_mm = vec![0_i32; MAX_LIDAR_POINTS];
        let buffer = ByteBuffer { data: distances_mm.as_mut_ptr().cast(), len: distances_mm.len() };
        let points: i32 = robios!(self, LIDARScan(buffer));
        let points = usize::try_from(points).ok().ok_or(Error::Unavailable(Device::Lidar))?;
        distances_mm.truncate(points);
        let distance = |mm: i32| (mm != PSD_OUT_OF_RANGE).then(|| Length::millimetres(mm.into()));
        Ok(distances_mm.into_iter().map(distance).collect())
    }
}

impl Drop for Psd {
    fn drop(&mut self) {
        let is_last = {
            let mut state = locked(&self.robot.0.common.psd);
            if let Some(index) = state.handles.iter().position(|handle| *handle == self.handle) {
                state.handles.swap_remove(index);
            }
            state.handles.is_empty()
        };
        if is_last {
            locked(&self.robot.0.common.psd).is_measuring = false;
            release!(&self.robot, PSDRelease());
        }
    }
}
