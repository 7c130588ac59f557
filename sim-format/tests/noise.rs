//! Noise profiles: reading, mistakes, and printing with round trip.

use std::collections::BTreeMap;

use proptest::prelude::*;
use sim_core::RobotId;
use sim_core::drive::DriveKind;
use sim_core::noise::{Profile, RangeKind, RangeNoise};
use sim_core::spec::{NoiseRef, NoiseSection, Preset};
use sim_format::print::{print_noise, print_scene};
use sim_format::{
    Code, Diagnostic, FileError, Files, LEVELS, PRESETS, Severity, content, is_noise, load_noise, load_scene, preset,
    preset_text, read_noise, read_scene,
};

/// Every key of every section with a valid number.
const ALL: &str = r#"
base = "mild"
[psd]
sigma_mm = 1.5
sigma_percent = 0.7
sigma_per_m = 0.05
bias_mm = -3
bias_sigma_mm = 4
step_mm = 10
outlier = 0.01
dropout = 0.02
drift_mm = -7
drift_s = 30
[laser]
device = 1
[ultrasonic]
device = 0.5
[reflectance]
device = 2
[sonar]
step_mm = 3
[lidar]
sigma_percent = 3.3
[compass]
sigma_deg = 1
bias_deg = -2
bias_sigma_deg = 3
step_deg = 5
[camera]
blur = 0.7
sigma = 4
salt_and_pepper = 0.1
salt = 0.3
hundreds_and_thousands = 0.2
[drive]
left_percent = 1.1
right_percent = -0.7
diameter_sigma_percent = 0.3
slip_percent = 5
slip_sigma_percent = 2
v_sigma_mm_s = 3
v_sigma_percent = 7
omega_sigma_deg_s = 11
omega_sigma_percent = 13
[odometry]
v_sigma_mm_s = 1
v_sigma_percent = 2
omega_sigma_deg_s = 3
omega_sigma_percent = 4
step_mm = 5
step_deg = 6
[sensor.PSD_FRONT]
sigma_mm = 99
device = 0
[sensor."a name"]
dropout = 1
"#;

fn reported(text: &str) -> Vec<Diagnostic> {
    read_noise("p.toml", text).1
}

#[test]
fn a_profile_sets_every_parameter() {
    let (spec, diagnostics) = read_noise("p.toml", ALL);
    assert_eq!(diagnostics, []);
    assert_eq!(Some(&spec.base), preset("mild").as_ref());
    let profile = spec.profile();
    let psd = RangeNoise {
        sigma: 0.0015,
        sigma_share: 0.7 / 100.0,
        sigma_per_m: 0.05,
        bias: -0.003,
        bias_sigma: 0.004,
        step: 0.01,
        outlier: 0.01,
        dropout: 0.02,
        drift: -0.007,
        drift_time: 30.0,
        device: 0.0,
    };
    assert_eq!(profile.range(RangeKind::Psd, "PSD_LEFT"), psd);
    assert_eq!(profile.range(RangeKind::Psd, "PSD_FRONT"), RangeNoise { sigma: 0.099, ..psd });
    assert_eq!(profile.range(RangeKind::Psd, "a name"), RangeNoise { dropout: 1.0, ..psd });
    let laser = profile.range(RangeKind::Laser, "x");
    assert_eq!((laser.device, laser.sigma), (1.0, 0.0));
    assert_eq!(profile.range(RangeKind::Laser, "PSD_FRONT").device, 0.0, "a sensor of that name of any kind");
    let sonar = profile.range(RangeKind::Sonar, "x");
    assert_eq!((sonar.step, sonar.sigma), (0.003, 0.002), "the rest is that of the preset");
    let radians = sim_core::unit::radians_from_degrees;
    assert_eq!(profile.compass.bias, radians(-2.0));
    assert_eq!((profile.camera.blur, profile.camera.salt, profile.camera.sigma), (0.7, 0.3, 4.0));
    let drive = profile.motion.imperfection(DriveKind::Differential, 1, RobotId(1));
    assert_eq!((drive.slip, drive.slip_deviation), (0.05, 0.02));
    assert_eq!((drive.command.speed, drive.command.turn_share), (0.003, 0.13));
    assert_eq!((drive.odometry.speed_share, drive.odometry.turn), (0.02, radians(3.0)));
    assert_eq!((drive.resolution.length, drive.resolution.angle), (0.005, radians(6.0)));
    assert_eq!(drive.check(), Ok(()));
}

#[test]
fn presets_have_no_mistakes_and_increasing_noise() {
    let mut before = BTreeMap::new();
    for name in PRESETS {
        let text = preset_text(name).expect("a text");
        let (spec, diagnostics) = read_noise(name, text);
        assert_eq!((diagnostics, spec.base), (Vec::new(), Preset::default()), "{name}");
        assert_eq!(
            preset(name).map(|preset| (preset.name, preset.entries.to_vec())),
            Some((name, spec.entries.clone()))
        );
        assert!(is_noise("a.toml", text));
        let found: BTreeMap<(NoiseSection, &str), f64> =
            spec.entries.iter().map(|entry| ((entry.section.clone(), entry.key), entry.value)).collect();
        // `course` has errors of its own.
        for (key, value) in before.iter().filter(|_| LEVELS.contains(&name)) {
            assert!(found.get(key).is_some_and(|found| found >= value), "{name}: {key:?} is less than before");
        }
        before = found;
    }
    assert!(NoiseRef::Preset(Preset::default()).profile().is_none());
    assert!(preset("mild").map(NoiseRef::Preset).and_then(|noise| noise.profile()).is_some());
    assert!(NoiseRef::Profile(read_noise("p.toml", "base = \"none\"").0.into()).profile().is_none());
}

#[test]
fn each_mistake_is_reported_with_its_location_and_what_is_expected() {
    let text = "base = \"reel\"\n[psd]\nsigma_mm = -1\nsigma_percent = nan\nbias_mm = inf\nsgima_mm = 3\noutlier = 1.5\n\
                dropout = \"often\"\ndrift_s = 0\n[pds]\n[sensor]\nPSD_LEFT = 3\n[sensor.A]\nstep_mm = 1e300\n[laser]\ndevise = 1\n";
    let diagnostics = reported(text);
    let found: Vec<(Severity, Code, u32, u32)> =
        diagnostics.iter().map(|d| (d.severity, d.code, d.span.line, d.span.column)).collect();
    let (error, warning) = (Severity::Error, Severity::Warning);
    let expected = [
        (error, Code::TomlChoice, 1, 8),
        (error, Code::NumberRange, 3, 12),
        (error, Code::NumberRange, 4, 17),
        (error, Code::NumberRange, 5, 11),
        (warning, Code::TomlKey, 6, 1),
        (error, Code::NumberRange, 7, 11),
        (error, Code::TomlType, 8, 11),
        (error, Code::NumberRange, 9, 11),
        (warning, Code::TomlKey, 10, 2),
        (error, Code::TomlType, 12, 12),
        (error, Code::NumberRange, 14, 11),
        (warning, Code::TomlKey, 16, 1),
    ];
    assert_eq!(found, expected, "{diagnostics:#?}");
    let suggestions: Vec<&str> = diagnostics.iter().filter_map(|d| d.suggestion.as_deref()).collect();
    assert_eq!(suggestions, ["write `real`", "write `sigma_mm`", "write `psd`", "write `device`"]);
    assert!(diagnostics.iter().all(|d| !d.expected.is_empty()));
    assert_eq!(diagnostics[0].expected, "one of none, mild, real, harsh, course");
    assert_eq!(diagnostics[1].expected, "a number in mm from 0 to 1000000");
    assert_eq!(reported("[psd]\ndevice = 1\n")[0].code, Code::TomlKey, "a PSD has no noise of its own");
    let codes = |text| reported(text).iter().map(|d| (d.code, d.span.line, d.span.column)).collect::<Vec<_>>();
    assert_eq!(codes("[psd\n"), [(Code::TomlSyntax, 1, 5)]);
    assert_eq!(codes(""), [(Code::NoiseEmpty, 1, 1)]);
    assert_eq!(codes("# none\n"), [(Code::NoiseEmpty, 1, 1)]);
    assert_eq!(codes("base = \"none\"\n"), []);
}

#[test]
fn the_page_names_every_key_and_its_example_has_no_mistakes() {
    let page = include_str!("../../docs/noise.md");
    let (_, example) = page.split_once("```toml\n").expect("an example");
    let (example, _) = example.split_once("```").expect("an end of it");
    let (spec, diagnostics) = read_noise("p.toml", example);
    assert_eq!((diagnostics, spec.entries.len()), (Vec::new(), 3));
    for key in ALL.lines().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key) {
        assert!(page.contains(&format!("`{key}`")), "`{key}` has no row");
    }
}

#[test]
fn an_invalid_value_keeps_the_value_of_the_base() {
    let (spec, _) = read_noise("p.toml", "base = \"real\"\n[psd]\nsigma_mm = -1\nstep_mm = 7\n");
    let psd = spec.profile().range(RangeKind::Psd, "");
    assert_eq!((psd.sigma, psd.step), (0.001, 0.007));
}

#[test]
fn profiles_are_distinguished_from_other_tables() {
    assert!(is_noise("lab.noise.toml", ""));
    assert!(is_noise("lab.toml", "base = \"none\"\n[psd]\n"));
    assert!(!is_noise("lab.toml", "[psd]\n"));
    assert!(!is_noise("lab.robi", "base = 3"));
}

/// Files of a test.
struct Written(BTreeMap<&'static str, &'static str>);

impl Files for Written {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        self.0.get(path).map(|text| text.as_bytes().to_vec()).ok_or(FileError::Missing)
    }

    fn list(&self, _: &str) -> Vec<String> {
        self.0.keys().map(|name| (*name).to_owned()).collect()
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

const WORLD: &str = "[world]\nfloor_mm = [4000, 4000]\n";

fn sigma(noise: &Option<NoiseRef>) -> f64 {
    let profile = noise.as_ref().and_then(NoiseRef::profile).unwrap_or_default();
    profile.range(RangeKind::Psd, "").sigma
}

#[test]
fn noise_of_a_robot_precedes_that_of_its_scene_and_files_are_read_once() {
    let scene = format!(
        "{WORLD}[scene]\nnoise = \"lab.toml\"\n\
         [[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n\
         [[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 500\nnoise = \"none\"\n\
         [[robot]]\ntype = \"S4\"\nx_mm = 1500\ny_mm = 500\nnoise = {{ base = \"real\", psd = {{ sigma_mm = 77 }} }}\n\
         [[robot]]\ntype = \"S4\"\nx_mm = 2000\ny_mm = 500\nnoise = \"lab.toml\"\n"
    );
    let scene: &'static str = scene.leak();
    let files =
        Written(BTreeMap::from([("a.scene.toml", scene), ("lab.toml", "base = \"mild\"\n[psd]\nsigma_mm = 5\n")]));
    let loaded = load_scene("a.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    let found: Vec<f64> = loaded.scene.robots.iter().map(|robot| sigma(&robot.noise)).collect();
    assert_eq!(found, [0.005, 0.0, 0.077, 0.005]);
    let inputs: Vec<&str> = loaded.inputs.iter().map(|input| input.path.as_str()).collect();
    assert_eq!(inputs, ["a.scene.toml", "lab.toml"]);
}

#[test]
fn a_profile_that_is_missing_or_wrong_is_an_error_of_the_scene() {
    let of = |noise: &str, profile: &'static str| {
        let scene: &'static str =
            format!("{WORLD}[scene]\nnoise = {noise}\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n").leak();
        let files = Written(BTreeMap::from([("a.scene.toml", scene), ("lab.toml", profile)]));
        let reported = load_scene("a.scene.toml", &files).diagnostics;
        reported.into_iter().map(|d| (d.code, d.file, d.span.line)).collect::<Vec<_>>()
    };
    assert_eq!(of("\"lab.toml\"", "[psd]\nsigma_mm = -1\n"), [(Code::NumberRange, "lab.toml".into(), 2)]);
    assert_eq!(of("\"lob.toml\"", ""), [(Code::FileMissing, "a.scene.toml".into(), 4)]);
    assert_eq!(of("\"milde\"", ""), [(Code::TomlChoice, "a.scene.toml".into(), 4)]);
    assert_eq!(of("3", ""), [(Code::TomlType, "a.scene.toml".into(), 4)]);
    assert_eq!(of("{ psd = { sigma_mm = -1 } }", ""), [(Code::NumberRange, "a.scene.toml".into(), 4)]);
    assert!(load_noise("nowhere.toml", &Written(BTreeMap::new())).0.is_none());
}

#[test]
fn printed_profiles_read_back() {
    let (spec, _) = read_noise("p.toml", ALL);
    let text = print_noise(&spec);
    let (again, diagnostics) = read_noise("p.toml", &text);
    assert_eq!(diagnostics, [], "{text}");
    assert_eq!(content::noise(&again), content::noise(&spec), "{text}");
    let scene = format!(
        "{WORLD}[scene]\nnoise = \"real\"\n[[robot]]\ntype = \"S4\"\nnoise = \"x/lab.toml\"\n[[robot]]\ntype = \"S4\"\nnoise = {{ base = \"mild\", sensor = {{ A = {{ bias_mm = -0.1 }} }} }}\n"
    );
    let (sim, diagnostics) = read_scene("a.scene.toml", &scene);
    assert_eq!(diagnostics, []);
    let (again, _) = read_scene("a.scene.toml", &print_scene(&sim));
    assert_eq!(content::sim(&again), content::sim(&sim), "{}", print_scene(&sim));
}

proptest! {
    #[test]
    fn numbers_of_any_size_read_back(
        numbers in prop::collection::vec((0_usize..4, 0.0..1.0_f64, -12..0_i32), 1..6),
        name in "[A-Za-z0-9_ .\"]{1,12}",
    ) {
        let keys = ["sigma_mm", "sigma_percent", "sigma_per_m", "dropout"];
        let lines: BTreeMap<&str, f64> =
            numbers.iter().map(|(key, digits, power)| (keys[*key], digits * 10_f64.powi(*power))).collect();
        let lines: String = lines.iter().map(|(key, value)| format!("{key} = {value:?}\n")).collect();
        let name = name.replace('"', "\\\"");
        let (spec, diagnostics) = read_noise("p.toml", &format!("[sensor.\"{name}\"]\n{lines}"));
        prop_assert!(diagnostics.is_empty(), "{:?}", diagnostics);
        let text = print_noise(&spec);
        prop_assert_eq!(content::noise(&read_noise("p.toml", &text).0), content::noise(&spec), "{}", text);
    }

    #[test]
    fn arbitrary_text_gives_finite_numbers(text in "(base|psd|sensor|\\[|\\]|=|\\.|\"|real|sigma_mm|1e9|-1|nan|\\{|\\}|,|\n| ){0,40}") {
        let (spec, _) = read_noise("p.toml", &text);
        let Profile { ranges, .. } = spec.profile();
        prop_assert!(ranges.iter().all(|range| range.sigma.is_finite() && range.sigma >= 0.0));
    }
}

#[test]
fn reported_values_can_be_set_and_are_reported_again() {
    let profile = preset("harsh").expect("a preset").profile();
    let parameters = profile.parameters();
    let mut other = Profile::default();
    for parameter in &parameters {
        assert_eq!(other.set_parameter(&parameter.name(), parameter.value), Ok(()), "{parameter:?}");
    }
    assert_eq!(other.parameters(), parameters);
    assert!((other.compass.sigma - profile.compass.sigma).abs() < 1e-15);
    let of = |name: &str| parameters.iter().find(|it| it.name() == name).expect("a parameter").clone();
    assert_eq!((of("psd.sigma_mm").value, of("psd.sigma_mm").unit), (5.0, "mm"));
    assert_eq!((of("compass.sigma_deg").value, of("compass.sigma_deg").range), (3.0, [0.0, 360.0]));
    assert_eq!((of("drive.v_sigma_percent").value, of("radio.packet_loss").value), (30.0, 0.1));
}
