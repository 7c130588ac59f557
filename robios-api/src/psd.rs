//! PSD distance sensors, in continuous mode: a new value every 60 ms.

use std::time::Duration;

use robios_sys::ByteRoom;
use robios_sys::robios6::{FALSE, PSD_OUT_OF_RANGE, PSDHandle, TRUE};

use crate::device::{Device, PsdAt};
use crate::robot::{locked, release, robios};
use crate::unit::Length;
use crate::{Error, Result, Robot};

/// Most points of a scan.
const MAX_POINTS: usize = 65_536;

/// Length of a measuring cycle.
const CYCLE: Duration = Duration::from_millis(60);

/// The sensors in use: RoBIOS starts all of them together and releases all of them together.
#[derive(Default)]
pub(crate) struct PsdState {
    /// One element for each living [`Psd`], which may share a handle.
    handles: Vec<PSDHandle>,
    is_measuring: bool,
}

impl PsdState {
    fn mask(&self) -> PSDHandle {
        self.handles.iter().fold(0, |mask, handle| mask | handle)
    }
}

/// A distance sensor that measures on and on; the last one that is dropped ends measuring.
#[derive(Debug)]
pub struct Psd {
    robot: Robot,
    at: PsdAt,
    handle: PSDHandle,
}

impl Robot {
    /// Makes a distance sensor ready and waits for its first value.
    ///
    /// Several are faster started together: [`psds`](Self::psds).
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such sensor; [`Error::NoResult`] if it does not measure.
    #[track_caller]
    pub fn psd(&self, at: PsdAt) -> Result<Psd> {
        let [psd] = self.psds([at])?;
        Ok(psd)
    }

    /// Makes distance sensors ready and waits for their first values, 60 ms.
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
    /// [`Error::Unavailable`] names the first sensor that the robot does not have; [`Error::NoResult`] if they do not
    /// measure.
    #[track_caller]
    pub fn psds<const N: usize>(&self, at: [PsdAt; N]) -> Result<[Psd; N]> {
        let mut missing = None;
        let psds = at.map(|at| {
            let handle: PSDHandle = robios!(self, PSDInit(at.semantics()));
            if handle == 0 {
                missing.get_or_insert(Error::Unavailable(Device::Psd(at)));
            }
            locked(&self.0.common.psd).handles.push(handle);
            Psd { robot: self.clone(), at, handle }
        });
        if let Some(missing) = missing {
            return Err(missing);
        }
        if let Some(first) = psds.first() {
            self.measure(Device::Psd(first.at))?;
        }
        Ok(psds)
    }

    /// Starts all sensors in use and waits for their first values.
    #[track_caller]
    fn measure(&self, device: Device) -> Result {
        let was_measuring = std::mem::replace(&mut locked(&self.0.common.psd).is_measuring, true);
        if was_measuring {
            let _: i32 = robios!(self, PSDStop());
        }
        let mask = locked(&self.0.common.psd).mask();
        // What was measuring before ends its cycle first.
        self.poll(device, || robios!(self, PSDStart(mask, TRUE)) == 0)?;
        if was_measuring {
            // There is a result already, but not of the new sensors.
            self.sleep(CYCLE);
        }
        self.poll(device, || robios!(self, PSDCheck()) != FALSE)
    }

    /// Asks every 10 ms, for a second at most.
    #[track_caller]
    fn poll(&self, device: Device, mut is_ready: impl FnMut() -> bool) -> Result {
        for _ in 0..100 {
            if is_ready() {
                return Ok(());
            }
            self.sleep(Duration::from_millis(10));
        }
        Err(Error::NoResult(device))
    }
}

impl Psd {
    /// Which sensor it is.
    pub fn at(&self) -> PsdAt {
        self.at
    }

    /// The distance that the last complete cycle has measured; `None` if nothing was within range.
    #[track_caller]
    pub fn distance(&self) -> Option<Length> {
        let distance_mm: i32 = robios!(&self.robot, PSDGet(self.handle));
        (distance_mm != PSD_OUT_OF_RANGE).then(|| Length::millimetres(distance_mm.into()))
    }

    /// The raw value that the last complete cycle has measured: larger is nearer.
    #[track_caller]
    pub fn raw(&self) -> RawDistance {
        let raw: i32 = robios!(&self.robot, PSDGetRaw(self.handle));
        RawDistance(raw.clamp(0, 255) as u8)
    }

    /// What the distance of the last complete cycle was made of; `None` if nothing has been measured. A function of this
    /// simulator.
    #[track_caller]
    pub fn signal(&self) -> Option<Signal> {
        Signal::from_robios(robios!(&self.robot, PSDGetSignal(self.handle)))
    }

    /// When the last complete cycle has measured, since the robot's start, to a hundredth of a second.
    #[track_caller]
    pub fn measured_at(&self) -> Duration {
        let hundredths: i32 = robios!(&self.robot, PSDGet(0));
        Duration::from_millis(10) * hundredths.max(0) as u32
    }
}

/// What a PSD sensor gives before its table turns it to a distance, 0 to 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RawDistance(pub u8);

/// What the distance of a range sensor is made of: of a reflectance sensor its signal, in 1/m; of a sonar the energy of the
/// echo, of which a perfect reflector 1 m ahead returns 1; of others 1 with an echo and 0 without.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Signal(pub f64);

impl Signal {
    /// The answer of `PSDGetSignal`: negative for none.
    pub(crate) fn from_robios(signal: f32) -> Option<Self> {
        (signal >= 0.0).then_some(Self(signal.into()))
    }
}

impl Robot {
    /// Scans once with the laser scanner: the distances of all points that the robi file says, from left to right, the middle
    /// one straight ahead; `None` where nothing is within range. A function of this simulator.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no scanner.
    #[track_caller]
    pub fn laser_scan(&self) -> Result<Vec<Option<Length>>> {
        let mut distances_mm = vec![0_i32; MAX_POINTS];
        let room = ByteRoom { data: distances_mm.as_mut_ptr().cast(), len: distances_mm.len() };
        let points: i32 = robios!(self, LIDARScan(room));
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
