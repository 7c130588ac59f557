//! The camera of a robot in TOML: that of a type in place, and what a companion says on top of a robi.

use super::code::Code;
use super::line::Quantity;
use super::spec::{CameraSpec, JointSpec, Lens, MAX_FIELD_OF_VIEW_DEG, MAX_SAMPLES, RobiSpec};
use super::table::{Reader, Section};

const PLACE: [Quantity; 3] = [
    Quantity::coordinate("x of the camera"),
    Quantity::coordinate("y of the camera"),
    Quantity::coordinate("z of the camera"),
];
const ANGLE: Quantity = Quantity::angle("angle of the camera");
const FIELD_OF_VIEW: Quantity = Quantity::angle("field of view").within(1.0, MAX_FIELD_OF_VIEW_DEG);
const FISHEYE: Quantity = Quantity::angle("field of view").within(1.0, 360.0);

/// Most pixels of an image's side.
const MAX_PIXELS: i64 = 65_536;

impl Reader<'_> {
    /// The camera that a classic robi cannot describe, or changes to that of the robi.
    pub(super) fn camera(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let camera = robi.camera.get_or_insert_with(|| CameraSpec::new(section.span));
        self.set(&mut section, "x_mm", &PLACE[0], &mut camera.position.x);
        self.set(&mut section, "y_mm", &PLACE[1], &mut camera.position.y);
        self.set(&mut section, "z_mm", &PLACE[2], &mut camera.position.z);
        self.joint(&mut section, "pan_deg", "pan_servo", &mut camera.pan);
        self.joint(&mut section, "tilt_deg", "tilt_servo", &mut camera.tilt);
        camera.image = self.image(&mut section).or(camera.image);
        if let Some(fov) = self.number(&mut section, "fov_deg", &FIELD_OF_VIEW) {
            camera.lens = Lens::Pinhole { fov };
        }
        if let Some(fov) = self.number(&mut section, "fisheye_deg", &FISHEYE) {
            self.exclude(&mut section, "fisheye_deg", &["fov_deg"]);
            camera.lens = Lens::Fisheye { fov };
        }
        if let Some(samples) = self.integer(&mut section, "samples", 1, i64::from(MAX_SAMPLES)) {
            camera.samples = samples as u32;
        }
        self.unknown_keys(&section);
    }

    /// A fixed `angle`, or a `servo` that turns the camera.
    fn joint(
        &mut self,
        section: &mut Section<'_, '_>,
        angle: &'static str,
        servo: &'static str,
        joint: &mut JointSpec,
    ) {
        if let Some(fixed) = self.number(section, angle, &ANGLE) {
            *joint = JointSpec::Fixed(fixed);
        }
        let Some(mut servo_section) = self.section(section, servo) else { return };
        self.exclude(section, servo, &[angle]);
        let name = self.required_reference(&mut servo_section, "name").map(|name| name.text);
        let end = Quantity::angle("end of the servo").within(-360.0, 360.0);
        let from = self.required(&mut servo_section, "from_deg", &end);
        let to = self.required(&mut servo_section, "to_deg", &end);
        self.unknown_keys(&servo_section);
        if let (Some(name), Some(from), Some(to)) = (name, from, to) {
            *joint = JointSpec::Servo { name, from, to };
        }
    }

    /// `image_px = [WIDTH, HEIGHT]`.
    fn image(&mut self, section: &mut Section<'_, '_>) -> Option<[u32; 2]> {
        let items = self.array(section, "image_px", "an array of 2 integers")?;
        if items.len() != 2 {
            let span = self.key_span(section, "image_px");
            let message = format!("`image_px` has {} values", items.len());
            self.sink.error(Code::TomlType, span, message, "an array of 2 integers");
            return None;
        }
        let width = self.as_integer("image_px", &items[0], 1, MAX_PIXELS);
        let height = self.as_integer("image_px", &items[1], 1, MAX_PIXELS);
        Some([width? as u32, height? as u32])
    }
}
