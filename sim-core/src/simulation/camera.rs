//! Camera operations of a robot: view, exposure, image processing, recording.

use std::sync::Arc;

use super::Robot;
use crate::camera::{Label, Picture, Scenery, View};
use crate::device::camera::{self, CameraError, Exposure, READ_OUT, Setting};
use crate::device::switch::SensorId;
use crate::pose::Pose3;
use crate::record::{Digest, Event};
use crate::time::Time;
use crate::world::World;

impl Robot {
    /// View of the robot's camera at `at`, with the camera's settings, or with the default settings if the camera is
    /// off. If `size` is given, it is the size of the image.
    ///
    /// # Errors
    /// [`CameraError`] if the robot has no camera, or the view is invalid.
    pub fn camera_view(&mut self, at: Time, size: Option<[u32; 2]>) -> Result<View, CameraError> {
        let Self { motion, spec, devices, .. } = self;
        let camera = spec.camera.as_ref().ok_or_else(|| CameraError::Absent(spec.file.clone()))?;
        let setting = devices.camera.setting.unwrap_or_default();
        let robot_from_camera = camera::mount(spec, camera, &devices.servos, at);
        let world_from_camera = Pose3::from_planar(&motion.pose(at), motion.lift(at)).then(&robot_from_camera);
        let lens = camera::zoomed(camera.lens, setting.zoom);
        Ok(View::new(world_from_camera, lens, size.unwrap_or(setting.size))?)
    }

    /// Number of samples along each side of a pixel of the robot's camera.
    pub fn camera_samples(&self) -> u32 {
        self.spec.camera.as_ref().map_or(1, |camera| camera.samples)
    }

    /// Setting of the robot's camera.
    ///
    /// # Errors
    /// [`CameraError`] if the camera is off or the robot has none.
    pub fn camera_setting(&self) -> Result<Setting, CameraError> {
        match self.spec.camera {
            None => Err(CameraError::Absent(self.spec.file.clone())),
            Some(_) => self.devices.camera.setting.ok_or(CameraError::Off),
        }
    }

    /// Takes a colour image: red, green and blue of each pixel.
    ///
    /// # Errors
    /// [`CameraError`] if there is no image; the state is unchanged then.
    pub fn take_colour(&mut self, world: &World, scenery: &Arc<Scenery>) -> Result<Picture<[u8; 3]>, CameraError> {
        let (exposure, mut picture) = self.expose(world, scenery, self.camera_setting()?.size)?;
        self.devices.camera.develop(exposure.number, &mut picture);
        let greys: Vec<u8> = picture.pixels().iter().map(|rgb| camera::grey(*rgb)).collect();
        self.keep_image(exposure, &greys, ("colour", picture.size(), picture.pixels().as_flattened()));
        Ok(picture)
    }

    /// Takes a grey image: see [`camera::grey`].
    ///
    /// # Errors
    /// [`CameraError`] if there is no image; the state is unchanged then.
    pub fn take_grey(&mut self, world: &World, scenery: &Arc<Scenery>) -> Result<Picture<[u8; 1]>, CameraError> {
        let Setting { size, levels, .. } = self.camera_setting()?;
        let (exposure, picture) = self.expose(world, scenery, size)?;
        let mut picture = Picture::new(size, picture.pixels().iter().map(|rgb| [camera::grey(*rgb)]).collect());
        levels.grey(picture.pixels_mut());
        self.devices.camera.add_errors(exposure.number, &mut picture);
        let bytes = picture.pixels().as_flattened();
        self.keep_image(exposure, bytes, ("grey", size, bytes));
        Ok(picture)
    }

    /// Takes a raw image of `size` through a Bayer filter: rows of green and blue alternate with rows of red and green.
    ///
    /// # Errors
    /// [`CameraError`] if there is no image; the state is unchanged then.
    pub fn take_bayer(
        &mut self,
        world: &World,
        scenery: &Arc<Scenery>,
        size: [u32; 2],
    ) -> Result<Picture<[u8; 1]>, CameraError> {
        self.camera_setting()?;
        let (exposure, mut picture) = self.expose(world, scenery, size)?;
        self.devices.camera.develop(exposure.number, &mut picture);
        let filtered = |(row, pixels): (usize, &[[u8; 3]])| -> Vec<[u8; 1]> {
            let channels = if row.is_multiple_of(2) { [1, 2] } else { [0, 1] };
            pixels.iter().zip(channels.into_iter().cycle()).map(|(pixel, channel)| [pixel[channel]]).collect()
        };
        let picture = Picture::new(size, picture.rows().enumerate().flat_map(filtered).collect());
        let bytes = picture.pixels().as_flattened();
        self.keep_image(exposure, bytes, ("bayer", size, bytes));
        Ok(picture)
    }

    /// Depth of each pixel of the last image, m along the pixel's line of sight; infinite for the sky.
    ///
    /// # Errors
    /// [`CameraError`] if there is no image.
    pub fn take_depth(&mut self) -> Result<Picture<f32>, CameraError> {
        self.camera_setting()?;
        let own_id = Some(self.id);
        self.devices.camera.render_last(f32::INFINITY, |renderer, still, view| renderer.depth(still, view, own_id))
    }

    /// Label of each pixel of the last image.
    ///
    /// # Errors
    /// [`CameraError`] if there is no image.
    pub fn take_labels(&mut self) -> Result<Picture<Label>, CameraError> {
        self.camera_setting()?;
        let own_id = Some(self.id);
        self.devices.camera.render_last(Label::Sky, |renderer, still, view| renderer.labels(still, view, own_id))
    }

    /// Records an event for the last image, or for its depths or labels. `form` names which of these, and the hash of
    /// `bytes` is recorded.
    pub fn record_frame(&mut self, form: &str, [width_px, height_px]: [u32; 2], bytes: &[u8]) {
        let Some(&Exposure { number: frame, at, .. }) = self.devices.camera.last() else { return };
        let hash = Digest(*blake3::hash(bytes).as_bytes()).to_string();
        self.record(Event::Image { frame, form, width_px, height_px, exposed_s: at.seconds(), hash: &hash });
    }

    /// Exposes and renders the next image, with `size` pixels.
    fn expose(
        &mut self,
        world: &World,
        scenery: &Arc<Scenery>,
        size: [u32; 2],
    ) -> Result<(Exposure, Picture<[u8; 3]>), CameraError> {
        let at = (self.now - READ_OUT).max(Time::ZERO);
        let [view, exposed] = [self.camera_view(at, None)?, self.camera_view(at, Some(size))?];
        let samples = self.camera_samples();
        let is_dark = !self.devices.switches.is_on(SensorId::Camera);
        let still = scenery.pose_at(world, at);
        let mut picture = self.devices.camera.renderer().colour(&still, &exposed, Some(self.id), samples);
        if is_dark {
            picture.pixels_mut().fill([0; 3]);
        }
        let (number, poses) = (self.devices.camera.number_at(Time::NEVER), still.poses().to_vec());
        Ok((Exposure { number, at, view, scenery: Arc::clone(scenery), poses, is_dark }, picture))
    }

    /// Counts and records an image. `levels` are its grey levels, for the automatic brightness; the tuple contains its
    /// form, size and bytes.
    fn keep_image(&mut self, exposure: Exposure, levels: &[u8], (form, size, bytes): (&str, [u32; 2], &[u8])) {
        self.devices.camera.adapt_brightness(levels);
        self.devices.camera.record(exposure);
        self.record_frame(form, size, bytes);
    }
}
