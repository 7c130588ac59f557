//! The table of a robot's devices: maps the numbers of `hdt_sem.h` to the devices of the robi.
//!
//! A device has the number assigned by the robi or its companion, and the number that `hdt_sem.h` assigns to its name.
//! Source: RoBIOS 6 library, hardware description table; the precedence of these numbers is our choice.

use robios_sys::robios6::hdt_type::{
    HDT_BUMP, HDT_COMPASS, HDT_IR, HDT_IRTV, HDT_MOTOR, HDT_PSD, HDT_QUAD, HDT_SERVO, HDT_VW,
};
use robios_sys::robios6::semantics::SEMANTICS;
use sim_core::spec::RobiSpec;

/// Maximum device number in RoBIOS-7. Programs can address 4 motors, 6 PSDs and 14 servos; 31 is our choice.
pub const MAX_NUMBER: i32 = 31;

/// Name of a device of `hdt_sem.h` in the Rust library: `PsdAt::FrontLeft` for `PSD_FRONTLEFT`. Other devices have no
/// such name.
pub fn name_in_rust(name: &str) -> Option<String> {
    const KINDS: [(&str, &str); 6] = [
        ("PSD_", "PsdAt"),
        ("MOTOR_", "MotorAt"),
        ("QUAD_", "EncoderAt"),
        ("BUMP_", "BumperAt"),
        ("IR_", "InfraredAt"),
        ("SERVO", "ServoAt"),
    ];
    const WORDS: [(&str, &str); 13] = [
        ("FRONT", "Front"),
        ("BACK", "Back"),
        ("LEFT", "Left"),
        ("RIGHT", "Right"),
        ("DIAG", "Diagonal"),
        ("DRIVE", "Drive"),
        ("_STEER", "Steer"),
        ("_CAMERA", "Camera"),
        ("FL", "FrontLeft"),
        ("FR", "FrontRight"),
        ("BL", "BackLeft"),
        ("BR", "BackRight"),
        ("2", "2"),
    ];
    if !SEMANTICS.iter().any(|constant| constant.name == name) {
        return None;
    }
    let (kind, mut rest) = KINDS.iter().find_map(|(kind, rust)| Some((rust, name.strip_prefix(kind)?)))?;
    if rest.parse::<u32>().is_ok() {
        return Some(format!("{kind}::Servo{rest}"));
    }
    let mut rust_name = String::new();
    while !rest.is_empty() {
        let (word, remaining) = WORDS.iter().find_map(|(word, rust)| Some((rust, rest.strip_prefix(word)?)))?;
        rust_name.push_str(word);
        rest = remaining;
    }
    Some(format!("{kind}::{rust_name}"))
}

/// One device of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Device {
    /// Kind of the device, `HDT_MOTOR` and so on.
    pub kind: i32,
    /// Index among the devices of its kind, in the order of the robi.
    pub index: usize,
    /// Name of the device, such as `PSD_FRONT`.
    pub name: String,
    /// Numbers of the device from three sources: its line in the robi or companion, the companion's table `[hdt]`, and
    /// `hdt_sem.h`.
    numbers: [Option<i32>; 3],
}

impl Device {
    /// First number of the device; 0 if programs cannot refer to it.
    pub fn number(&self) -> i32 {
        self.numbers.iter().flatten().next().copied().unwrap_or(0)
    }

    /// Numbers given by robi or companion that programs of RoBIOS-7 can use.
    fn small_numbers(&self) -> impl Iterator<Item = i32> {
        self.numbers[..2].iter().flatten().copied().filter(|number| (1..=MAX_NUMBER).contains(number))
    }
}

/// All devices of a robot, grouped by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    devices: Vec<Device>,
}

impl Table {
    /// Devices that a robi describes; every robot has a driving interface and a receiver for a remote control.
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
        for servo in spec.all_servos() {
            table.add(spec, HDT_SERVO, servo.name, servo.id);
        }
        let psds = spec.psds.iter().map(|psd| (&psd.name, psd.id));
        for (name, id) in psds.chain(spec.ranges.iter().map(|range| (&range.name, range.id))) {
            table.add(spec, HDT_PSD, name, id);
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

    /// All devices of a kind, in order of their indices; 0 means any kind.
    pub fn of_kind(&self, kind: i32) -> impl Iterator<Item = &Device> {
        self.devices.iter().filter(move |device| kind == 0 || device.kind == kind)
    }

    /// Device of a kind (0 for any) with `number`; numbers of the robi take precedence over numbers of `hdt_sem.h`.
    pub fn find(&self, kind: i32, number: i32) -> Option<&Device> {
        (0..3).find_map(|index| self.of_kind(kind).find(|device| device.numbers[index] == Some(number)))
    }

    /// Device of a kind with RoBIOS-7's `number`, from 1 on.
    ///
    /// Numbers from 1 to [`MAX_NUMBER`] given by robi or companion come first, then the position of a device's name in
    /// `names`; the remaining devices have the remaining numbers, in the order of the robi.
    pub fn numbered(&self, kind: i32, number: i32, names: &[&str]) -> Option<&Device> {
        let index = |number: i32| usize::try_from(number).ok()?.checked_sub(1);
        let unnumbered = || self.of_kind(kind).filter(|device| device.small_numbers().next().is_none());
        let assigned = |number: i32| {
            let by_number = self.of_kind(kind).find(|device| device.small_numbers().any(|small| small == number));
            let name = index(number).and_then(|index| names.get(index).copied());
            by_number.or_else(|| unnumbered().find(|device| Some(device.name.as_str()) == name))
        };
        let remaining = || unnumbered().filter(|device| !names.contains(&device.name.as_str()));
        if let Some(device) = assigned(number) {
            return Some(device);
        }
        // A device takes at most two numbers: beyond this bound every device has one already.
        if index(number)? > 3 * self.devices.len() {
            return None;
        }
        remaining().nth((1..number).filter(|number| assigned(*number).is_none()).count())
    }

    /// Name of device `index` of a kind; empty if there is none.
    pub fn name(&self, kind: i32, index: usize) -> &str {
        self.of_kind(kind).find(|device| device.index == index).map_or("", |device| &device.name)
    }

    fn add(&mut self, spec: &RobiSpec, kind: i32, name: &str, id: Option<i32>) {
        self.add_at(spec, kind, self.of_kind(kind).count(), name, id);
    }

    fn add_at(&mut self, spec: &RobiSpec, kind: i32, index: usize, name: &str, id: Option<i32>) {
        let companion_number = spec.hdt.iter().find(|(device, _)| device == name).map(|(_, number)| *number);
        let header_number =
            SEMANTICS.iter().find(|constant| constant.name == name).map(|constant| constant.value as i32);
        self.devices.push(Device {
            kind,
            index,
            name: name.to_owned(),
            numbers: [id, companion_number, header_number],
        });
    }
}

#[cfg(test)]
mod tests {
    use sim_format::{read_companion, read_robi};

    use super::*;

    /// Names of PSDs 0 to 4 of a robi with these lines.
    fn psds(lines: &str, companion: &str) -> [Option<String>; 5] {
        let robi = format!("name A\ndiameter 200\n{lines}wheel 100 3600 1000 100\ndrive DIFFERENTIAL_DRIVE A B C D\n");
        let (mut spec, _) = read_robi("a.robi", &robi);
        assert!(read_companion("a.toml", companion, &mut spec).is_empty());
        let table = Table::new(&spec);
        [0, 1, 2, 3, 4]
            .map(|number| table.numbered(HDT_PSD, number, &["PSD_FRONT", "PSD_LEFT"]).map(|device| device.name.clone()))
    }

    #[test]
    fn devices_have_their_names_in_rust() {
        let library = include_str!("../../../robios-api/src/device.rs");
        let (_, names) = library.split_once("names! {\n").expect("the names");
        let (names, _) = names.split_once("\n}\n").expect("their end");
        let (mut kind, mut count) = ("", 0);
        for line in names.lines().map(str::trim) {
            kind = line.strip_suffix(" {").unwrap_or(kind);
            for (rust, name) in line.split(',').filter_map(|pair| pair.trim().split_once(" = ")) {
                assert_eq!(name_in_rust(name), Some(format!("{kind}::{rust}")), "{name}");
                count += 1;
            }
        }
        let named_count = SEMANTICS.iter().filter(|constant| name_in_rust(constant.name).is_some()).count();
        assert_eq!((count, named_count), (65, 65));
    }

    #[test]
    fn device_names_outside_the_header_have_no_name_in_rust() {
        for name in [
            "PSD_1", "IR_12", "MOTOR_2", "SERVO0", "SERVO01", "SERVO17", "SERVO99", "SERVO", "PSD_", "PSD_FL",
            "PSD_TOP",
        ] {
            assert_eq!(name_in_rust(name), None, "{name}");
        }
    }

    #[test]
    fn a_sensor_of_the_companion_does_not_take_the_number_of_a_psd() {
        // Regression: a laser with a number hid all PSDs without one, and a laser without a number had none at all.
        let some = |name: &str| Some(name.to_owned());
        let robi = "psd PSD_FRONT -200 0 0 0 0\n";
        let numbered = psds(robi, "[[laser]]\nname = \"LASER\"\nid = 3\n");
        assert_eq!(numbered, [None, some("PSD_FRONT"), None, some("LASER"), None]);
        let unnumbered =
            psds(robi, "[[laser]]\nname = \"A\"\n[[sonar]]\nname = \"B\"\n[[laser]]\nname = \"C\"\nid = 2\n");
        assert_eq!(unnumbered, [None, some("PSD_FRONT"), some("C"), some("A"), some("B")]);
    }

    #[test]
    fn numbers_out_of_range_name_no_device() {
        let (table, names) = (Table::default(), ["PSD_FRONT"]);
        let found = [i32::MIN, -1, 0, 9999, i32::MAX].map(|number| table.numbered(HDT_PSD, number, &names));
        assert_eq!(found, [None; 5]);
    }

    #[test]
    fn robi_numbers_precede_known_names_which_precede_other_devices() {
        let some = |name: &str| Some(name.to_owned());
        let by_id = psds("psd PSD_LEFT 1 0 0 0 0\npsd PSD_FRONT 3 0 0 0 0\npsd PSD_BACK -212 0 0 0 0\n", "");
        assert_eq!(by_id, [None, some("PSD_LEFT"), some("PSD_BACK"), some("PSD_FRONT"), None]);
        let by_name = psds("psd PSD_BACK -212 0 0 0 0\npsd PSD_LEFT -205 0 0 0 0\npsd PSD_FRONT -200 0 0 0 0\n", "");
        assert_eq!(by_name, [None, some("PSD_FRONT"), some("PSD_LEFT"), some("PSD_BACK"), None]);
        let by_place = psds("psd PSD_A -212 0 0 0 0\npsd PSD_B -205 0 0 0 0\n", "");
        assert_eq!(by_place, [None, some("PSD_A"), some("PSD_B"), None, None]);
        let by_companion = psds("psd PSD_A -212 0 0 0 0\npsd PSD_B -205 0 0 0 0\n", "[hdt]\nPSD_A = 4\n");
        assert_eq!(by_companion, [None, some("PSD_B"), None, None, some("PSD_A")]);
    }
}
