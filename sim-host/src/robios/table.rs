//! The table of a robot's devices: which number of `hdt_sem.h` means which device of the robi.
//!
//! A device answers to the number that the robi or its companion gives it, and to the number that `hdt_sem.h` gives to its
//! name. Source: RoBIOS 6 library, hardware description table; the order of these is our choice.

use robios_sys::robios6::hdt_type::{
    HDT_BUMP, HDT_COMPASS, HDT_IR, HDT_IRTV, HDT_MOTOR, HDT_PSD, HDT_QUAD, HDT_SERVO, HDT_VW,
};
use robios_sys::robios6::semantics::SEMANTICS;
use sim_core::format::{JointSpec, RobiSpec};

/// One device of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// Its kind, `HDT_MOTOR` and so on.
    pub kind: i32,
    /// Its place among the devices of its kind, in the order of the robi.
    pub index: usize,
    /// Its name, `PSD_FRONT`.
    pub name: String,
    /// Numbers that it answers to: of its line in the robi or companion, of the companion's table, of `hdt_sem.h`.
    numbers: [Option<i32>; 3],
}

impl Device {
    /// The number that comes first, 0 for a device that no program can ask for.
    pub fn number(&self) -> i32 {
        self.numbers.iter().flatten().next().copied().unwrap_or(0)
    }
}

/// All devices of a robot, by kinds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    devices: Vec<Device>,
}

impl Table {
    /// The devices that a robi describes; every robot has a driving interface and a receiver for a remote control.
    pub fn new(spec: &RobiSpec) -> Self {
        let mut table = Self::default();
        for motor in &spec.drive.motors {
            table.add(spec, HDT_MOTOR, &motor.motor, None);
        }
        for (index, motor) in spec.drive.motors.iter().enumerate() {
            if let Some(encoder) = &motor.encoder {
                table.add_at(spec, HDT_QUAD, index, encoder, None);
            }
        }
        for (name, id) in servos(spec) {
            table.add(spec, HDT_SERVO, name, id);
        }
        for psd in &spec.psds {
            table.add(spec, HDT_PSD, &psd.name, psd.id);
        }
        for bumper in &spec.bumpers {
            table.add(spec, HDT_BUMP, &bumper.name, bumper.id);
        }
        for infrared in &spec.infrareds {
            table.add(spec, HDT_IR, &infrared.name, infrared.id);
        }
        table.add(spec, HDT_VW, "VW_DRIVE", None);
        if let Some(compass) = &spec.compass {
            table.add(spec, HDT_COMPASS, &compass.name, compass.id);
        }
        table.add(spec, HDT_IRTV, "IRTV", None);
        table
    }

    /// All devices of a kind, in order of their indices; of any kind for 0.
    pub fn of_kind(&self, kind: i32) -> impl Iterator<Item = &Device> {
        self.devices.iter().filter(move |device| kind == 0 || device.kind == kind)
    }

    /// The device of a kind (0: any) that answers to `number`; the robi's own numbers go before those of `hdt_sem.h`.
    pub fn find(&self, kind: i32, number: i32) -> Option<&Device> {
        (0..3).find_map(|place| self.of_kind(kind).find(|device| device.numbers[place] == Some(number)))
    }

    /// Name of device `index` of a kind; empty if there is none.
    pub fn name(&self, kind: i32, index: usize) -> &str {
        self.of_kind(kind).find(|device| device.index == index).map_or("", |device| &device.name)
    }

    fn add(&mut self, spec: &RobiSpec, kind: i32, name: &str, id: Option<i32>) {
        self.add_at(spec, kind, self.of_kind(kind).count(), name, id);
    }

    fn add_at(&mut self, spec: &RobiSpec, kind: i32, index: usize, name: &str, id: Option<i32>) {
        let own = spec.hdt.iter().find(|(device, _)| device == name).map(|(_, number)| *number);
        let header = SEMANTICS.iter().find(|constant| constant.name == name).map(|constant| constant.value as i32);
        self.devices.push(Device { kind, index, name: name.to_owned(), numbers: [id, own, header] });
    }
}

/// Name and number of each servo: the steering first, then those of the companion, then the camera's.
fn servos(spec: &RobiSpec) -> Vec<(&str, Option<i32>)> {
    let camera = spec.camera.iter().flat_map(|camera| [&camera.pan, &camera.tilt]);
    let joints = camera.filter_map(|joint| match joint {
        JointSpec::Servo { name, .. } => Some(name.as_str()),
        JointSpec::Fixed(_) => None,
    });
    let companion = |name: &str| spec.servos.iter().find(|servo| servo.name == name).and_then(|servo| servo.id);
    let names = spec.drive.steering.as_deref().into_iter();
    let names = names.chain(spec.servos.iter().map(|servo| servo.name.as_str())).chain(joints);
    let mut servos: Vec<(&str, Option<i32>)> = Vec::new();
    for name in names {
        if servos.iter().all(|(known, _)| *known != name) {
            servos.push((name, companion(name)));
        }
    }
    servos
}
