//! Scenes of our own form, and their JSON schema.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::Serialize;
use toml::{Table, Value};

use super::legs::{leg_form, legs_form};
use super::looks::{light_form, sky_form};
use super::noise::noise_form;
use super::number::{degrees, heading, mm, shortest};
use super::{sensor, terrain, text};
use crate::read_maze;
use crate::scene::default_wheelbase;
use crate::scene::form::{
    ArcForm, BodyForm, CameraForm, ColliderForm, CompassForm, CostsForm, DriveForm, DriveKindForm, GenerationsForm,
    InfraredForm, InputForm, JointForm, LayoutForm, LcdForm, LetterForm, LidarForm, MarkerForm, MediumForm, ModelForm,
    MotorForm, ObjectForm, ObjectTypeForm, PsdForm, RadioForm, RobotForm, RobotTypeForm, RunForm, SceneForm,
    SerialForm, SerialWord, ServoForm, SettingsForm, SolidForm, StartForm, WallForm, WheelForm, WorldForm,
    WorldKindForm,
};
use crate::spec::{
    CameraSpec, Collider, CostEntry, CostsRef, DEFAULT_FIELD_OF_VIEW, DEFAULT_MICROPHONE, DEFAULT_SAMPLES,
    DEFAULT_VOLTAGE, DEFAULT_WALL_HEIGHT, InfraredSpec, InputSpec, JointSpec, Layout, LcdSpec, Lens, LidarSpec,
    LooksSpec, ModelSpec, ObjectLine, ObjectType, PsdSpec, RobiSpec, RobotLine, RunSpec, SerialLine, SimSpec, Solid,
    StartRef, WorldKind, WorldSpec,
};
use sim_core::drive::DriveKind;
use sim_core::radio::{Medium, Model};
use sim_core::sensor::{Echo, RangeModel};
use sim_core::time::Time;

/// The text of a scene. All that a spec can say has its place in it.
///
/// Lines whose type only a loaded file tells to be a robot or an object are taken for robots.
pub fn print_scene(sim: &SimSpec) -> String {
    // Serialising plain structs cannot fail.
    text::document(&Table::try_from(scene_form(sim)).unwrap_or_default())
}

/// The JSON schema of [`print_scene`]'s texts, from which editors complete.
pub fn scene_schema() -> String {
    let schema = schemars::schema_for!(SceneForm);
    serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
}

pub(super) fn point(point: DVec2) -> [f64; 2] {
    point.to_array().map(mm)
}

pub(super) fn place(place: DVec3) -> [f64; 3] {
    place.to_array().map(mm)
}

/// A value that is left out where it is the default.
pub(super) fn unless<T: PartialEq>(value: T, default: T) -> Option<T> {
    (value != default).then_some(value)
}

fn scene_form(sim: &SimSpec) -> SceneForm {
    let files =
        sim.robot_types.iter().map(|path| RobotTypeForm { file: Some(path.text.clone()), ..Default::default() });
    let robot_type = files.chain(sim.inline.robot_types.iter().map(|(robi, _)| robot_type_form(robi))).collect();
    let files =
        sim.object_types.iter().map(|path| ObjectTypeForm { file: Some(path.text.clone()), ..Default::default() });
    let object_type = files.chain(sim.inline.object_types.iter().map(|(object, _)| object_form(object))).collect();
    let run = run_form(&sim.run);
    let settings = SettingsForm { beams: sim.settings.shows_beams, trace: sim.settings.shows_trace };
    SceneForm {
        scene: (run != RunForm::default()).then_some(run),
        world: world_of(sim),
        settings: (settings.beams || settings.trace).then_some(settings),
        radio: unless(radio_form(&sim.radio), RadioForm::default()),
        robot_type,
        object_type,
        robot: sim.robots.iter().chain(&sim.named).map(robot_form).collect(),
        object: sim.objects.iter().map(object_line).collect(),
        marker: sim
            .markers
            .iter()
            .map(|marker| {
                let [red, green, blue, opacity] = marker.colour;
                let [x_mm, y_mm] = point(marker.position);
                let (colour, opacity) = (unless([red, green, blue], [255, 0, 0]), unless(opacity, 255));
                MarkerForm { x_mm, y_mm, colour, opacity }
            })
            .collect(),
    }
}

fn run_form(run: &RunSpec) -> RunForm {
    let costs = run.costs.as_ref().map(|costs| match costs {
        CostsRef::File(path) => CostsForm::File(path.text.clone()),
        CostsRef::Table(table) => {
            let of = |generation: &str| {
                let entries = table.entries.iter().filter(|entry| entry.generation == generation);
                // Costs of more than an hour are refused by the reader.
                let entry = |entry: &CostEntry| (entry.function.clone(), entry.cost.0 as u32);
                entries.map(entry).collect::<BTreeMap<String, u32>>()
            };
            CostsForm::Table(GenerationsForm { robios6: of("robios6"), robios7: of("robios7") })
        }
    });
    let until = |micros: i64| shortest(micros as f64 / 1e6, |seconds| Time::from_seconds_ceil(seconds).0 == micros);
    RunForm {
        // The reader gives no larger one: TOML has none.
        seed: run.seed.and_then(|seed| i64::try_from(seed).ok()),
        slot_ms: run.slot.map(milliseconds),
        until_s: run.until.map(|time| until(time.0)),
        costs,
        api: run.api,
        noise: run.noise.as_ref().map(noise_form),
    }
}

fn radio_form(radio: &Model) -> RadioForm {
    let usual = Model::default();
    RadioForm {
        medium: match radio.medium {
            Medium::Free => None,
            Medium::Aloha => Some(MediumForm::Aloha),
            Medium::TokenRing => Some(MediumForm::TokenRing),
        },
        baud: unless(radio.baud, usual.baud),
        latency_ms: unless(radio.latency, usual.latency).map(milliseconds),
        range_mm: radio.range.map(mm),
        line_of_sight: radio.line_of_sight,
    }
}

/// A time of at most an hour.
fn milliseconds(time: Time) -> f64 {
    shortest(time.0 as f64 / 1e3, |ms| (ms * 1e3).round() as i64 == time.0)
}

fn world_of(sim: &SimSpec) -> WorldForm {
    match (&sim.inline.world, &sim.world) {
        (Some(world), _) => world_form(world),
        (None, Some(line)) => {
            let extension = crate::path::extension(&line.path.text);
            let kind = match (line.kind, extension.as_str()) {
                (WorldKind::Maze, "maz" | "maze") | (WorldKind::World, "wld") => None,
                (WorldKind::Maze, _) => Some(WorldKindForm::Maze),
                (WorldKind::World, _) => Some(WorldKindForm::World),
            };
            let form = WorldForm { file: Some(line.path.text.clone()), kind, ..WorldForm::default() };
            with_looks(form, &line.looks)
        }
        (None, None) => WorldForm::default(),
    }
}

/// The world in place: drawn where it is a maze that a drawing gives back, else by its walls.
pub(super) fn world_form(world: &WorldSpec) -> WorldForm {
    let texture = world.texture.as_ref().map(|texture| texture.text.clone());
    let surface = world.surface.map(sensor::explicit_surface);
    let terrain = world.terrain.as_ref().map(|terrain| terrain::terrain_form(terrain, world.floor));
    if let Some(maze) = super::print_maze(world).ok().filter(|maze| is_drawing(world, maze)) {
        let form = WorldForm { maze: Some(maze), texture, surface, terrain, ..WorldForm::default() };
        return with_looks(form, &world.looks);
    }
    let wall = world.walls.iter().map(|wall| WallForm {
        from_mm: point(wall.from),
        to_mm: point(wall.to),
        thickness_mm: unless(wall.thickness, 0.0).map(mm),
        height_mm: unless(wall.height, DEFAULT_WALL_HEIGHT).map(mm),
        colour: wall.colour,
        surface: wall.surface.map(sensor::explicit_surface),
    });
    let start = world.starts.iter().map(|start| StartForm {
        x_mm: mm(start.pose.position.x),
        y_mm: mm(start.pose.position.y),
        heading_deg: unless(heading(start.pose.heading), 0.0),
        letter: start.letter.and_then(letter_form),
    });
    let form = WorldForm {
        floor_mm: Some(point(world.floor)),
        texture,
        surface,
        terrain,
        cell_mm: world.cell.map(mm),
        wall: wall.collect(),
        start: start.collect(),
        object: world.objects.iter().map(object_line).collect(),
        ..WorldForm::default()
    };
    with_looks(form, &world.looks)
}

fn with_looks(form: WorldForm, looks: &LooksSpec) -> WorldForm {
    WorldForm { colour: looks.colour, light: light_form(&looks.light), sky: sky_form(&looks.sky), ..form }
}

/// Whether reading `maze` gives `world` back, but for what stands beside the drawing.
fn is_drawing(world: &WorldSpec, maze: &str) -> bool {
    let mut read = read_maze(&world.file, maze).0;
    read.texture.clone_from(&world.texture);
    read.terrain.clone_from(&world.terrain);
    read.surface = world.surface;
    read.looks = world.looks;
    crate::same::world(&read) == crate::same::world(world)
}

fn letter_form(letter: char) -> Option<LetterForm> {
    Some(match letter {
        'S' => LetterForm::S,
        'U' => LetterForm::U,
        'R' => LetterForm::R,
        'D' => LetterForm::D,
        'L' => LetterForm::L,
        _ => return None,
    })
}

fn robot_form(line: &RobotLine) -> RobotForm {
    let mut form = RobotForm {
        kind: line.kind.written().text.clone(),
        program: line.program.as_ref().map(|program| program.text.clone()),
        arguments: line.arguments.clone(),
        api: line.api,
        noise: line.noise.as_ref().map(noise_form),
        id: line.id.map(|id| id.0),
        ..RobotForm::default()
    };
    match line.start {
        StartRef::Next => {}
        StartRef::Pose(pose) => {
            form.x_mm = Some(mm(pose.position.x));
            form.y_mm = Some(mm(pose.position.y));
            form.heading_deg = unless(heading(pose.heading), 0.0);
        }
        StartRef::Letter { letter, heading } => {
            form.start = letter_form(letter);
            form.heading_deg = heading.map(degrees);
        }
        StartRef::Many { count, layout } => {
            form.count = Some(count);
            form.layout = Some(layout_form(&layout));
        }
    }
    form
}

fn layout_form(layout: &Layout) -> LayoutForm {
    match *layout {
        Layout::Starts => LayoutForm::Starts {},
        Layout::Line { from, to, heading } => {
            LayoutForm::Line { from_mm: point(from), to_mm: point(to), heading_deg: unless(degrees(heading), 0.0) }
        }
        Layout::Grid { from, spacing, columns, heading } => LayoutForm::Grid {
            from_mm: point(from),
            spacing_mm: point(spacing),
            columns,
            heading_deg: unless(degrees(heading), 0.0),
        },
        Layout::Circle { centre, radius, first, facing } => LayoutForm::Circle {
            centre_mm: point(centre),
            radius_mm: mm(radius),
            first_deg: unless(degrees(first), 0.0),
            facing_deg: unless(degrees(facing), 0.0),
        },
        Layout::Random { area, clearance, heading } => LayoutForm::Random {
            from_mm: area.map(|[from, _]| point(from)),
            to_mm: area.map(|[_, to]| point(to)),
            clearance_mm: unless(mm(clearance), 0.0),
            heading_deg: heading.map(degrees),
        },
    }
}

fn object_line(line: &ObjectLine) -> ObjectForm {
    ObjectForm {
        kind: line.kind.written().text.clone(),
        x_mm: mm(line.pose.position.x),
        y_mm: mm(line.pose.position.y),
        heading_deg: unless(heading(line.pose.heading), 0.0),
        friction: line.friction,
    }
}

fn model_form(model: &ModelSpec) -> ModelForm {
    ModelForm {
        file: model.path.text.clone(),
        offset_mm: unless(model.offset, DVec3::ZERO).map(place),
        turns_deg: unless(model.turns, DVec3::ZERO).map(|turns| turns.to_array().map(degrees)),
    }
}

fn collider_form(collider: &Collider) -> ColliderForm {
    let at = |centre: DVec3| unless(centre, DVec3::ZERO).map(place);
    match *collider {
        Collider::Box { centre, size } => ColliderForm::Box { centre_mm: at(centre), size_mm: place(size) },
        Collider::Sphere { centre, radius } => ColliderForm::Sphere { centre_mm: at(centre), radius_mm: mm(radius) },
        Collider::Capsule { centre, radius, height, axis } => ColliderForm::Capsule {
            centre_mm: at(centre),
            radius_mm: mm(radius),
            height_mm: mm(height),
            axis: Some(sensor::axis_form(axis)),
        },
        Collider::Cylinder { centre, radius, height } => {
            ColliderForm::Cylinder { centre_mm: at(centre), radius_mm: mm(radius), height_mm: mm(height) }
        }
    }
}

/// A robot type in place.
pub(crate) fn robot_type_form(robi: &RobiSpec) -> RobotTypeForm {
    RobotTypeForm {
        file: None,
        name: Some(robi.name.clone()),
        diameter_mm: Some(mm(robi.diameter)),
        max_speed_mm_per_s: Some(mm(robi.max_speed)),
        max_turn_deg_per_s: Some(degrees(robi.max_turn)),
        axis_mm: unless(mm(robi.axis_offset), 0.0),
        centre_of_mass_mm: unless(robi.centre_of_mass, DVec3::ZERO).map(place),
        model: robi.model.as_ref().map(model_form),
        collider: robi.colliders.iter().map(collider_form).collect(),
        body: Some(BodyForm { mass_kg: Some(robi.mass), traction: Some(robi.traction) }),
        wheel: Some(WheelForm {
            diameter_mm: Some(mm(robi.wheel.diameter)),
            max_rate_deg_per_s: Some(degrees(robi.wheel.max_rate)),
            ticks_per_turn: Some(robi.wheel.ticks_per_turn),
            track_mm: Some(mm(robi.wheel.track)),
        }),
        drive: Some(drive_form(robi)),
        surface: sensor::surface_form(robi.surface),
        link: robi.links.iter().map(sensor::link_form).collect(),
        legs: robi.legs.as_ref().map(legs_form).filter(|form| !form.is_usual()),
        leg: robi.legs.iter().flat_map(|legs| &legs.legs).map(leg_form).collect(),
        psd: robi.psds.iter().map(psd_form).collect(),
        laser: sensor::echo_forms(&robi.ranges, Echo::LASER, |model| match model {
            RangeModel::Laser(echo) => Some(echo),
            _ => None,
        }),
        ultrasonic: sensor::echo_forms(&robi.ranges, Echo::ULTRASONIC, |model| match model {
            RangeModel::Ultrasonic(echo) => Some(echo),
            _ => None,
        }),
        reflectance: sensor::echo_forms(&robi.ranges, Echo::REFLECTANCE, |model| match model {
            RangeModel::Reflectance(echo) => Some(echo),
            _ => None,
        }),
        sonar: robi.ranges.iter().filter_map(sensor::sonar_form).collect(),
        camera: robi.camera.as_ref().map(camera_form),
        lidar: robi.lidar.as_ref().map(lidar_form),
        infrared: robi.infrareds.iter().map(infrared_form).collect(),
        bumper: robi.bumpers.iter().map(arc_form).collect(),
        servo: robi
            .servos
            .iter()
            .map(|servo| ServoForm {
                name: servo.name.clone(),
                id: servo.id,
                from_deg: Some(degrees(servo.from)),
                to_deg: Some(degrees(servo.to)),
            })
            .collect(),
        compass: robi.compass.as_ref().map(|compass| CompassForm {
            name: Some(compass.name.clone()),
            id: compass.id,
            north_deg: unless(degrees(compass.north), 0.0),
        }),
        lcd: unless(robi.lcd, LcdSpec::default())
            .map(|lcd| LcdForm { width_px: Some(lcd.width), height_px: Some(lcd.height) }),
        input: input_form(&robi.inputs),
        serial: robi.serials.iter().map(|serial| (serial.interface.to_string(), serial_form(&serial.line))).collect(),
        hdt: robi.hdt.iter().cloned().collect(),
    }
}

fn psd_form(psd: &PsdSpec) -> PsdForm {
    let [x_mm, y_mm, z_mm] = place(psd.position).map(|place| unless(place, 0.0));
    PsdForm {
        name: psd.name.clone(),
        id: psd.id,
        on: psd.on.as_ref().map(|on| on.text.clone()),
        x_mm,
        y_mm,
        z_mm,
        angle_deg: unless(degrees(psd.angle), 0.0),
        pitch_deg: unless(degrees(psd.pitch), 0.0),
        range_mm: Some(mm(psd.range)),
    }
}

fn infrared_form(infrared: &InfraredSpec) -> InfraredForm {
    let [x_mm, y_mm, z_mm] = place(infrared.position).map(|place| unless(place, 0.0));
    let angle_deg = unless(degrees(infrared.angle), 0.0);
    let range_mm = Some(mm(infrared.range));
    InfraredForm { name: infrared.name.clone(), id: infrared.id, x_mm, y_mm, z_mm, angle_deg, range_mm }
}

fn lidar_form(lidar: &LidarSpec) -> LidarForm {
    let usual = LidarSpec::new(lidar.span);
    LidarForm {
        mount: sensor::mount_form(&lidar.mount, &usual.mount),
        range_mm: unless(lidar.range, usual.range).map(mm),
        points: Some(lidar.points),
        tilt_deg: unless(degrees(lidar.tilt), 0.0),
        sweep_deg: Some(degrees(lidar.sweep)),
    }
}

/// An arc whose end the reader finds again: counter-clockwise from its beginning, within -360 to 360.
fn arc_form(bumper: &crate::spec::BumperSpec) -> ArcForm {
    use std::f64::consts::TAU;
    let from_deg = degrees(bumper.from);
    let reads_back = |to_deg: f64| {
        let mut to = sim_core::unit::radians_from_degrees(to_deg);
        while to <= bumper.from {
            to += TAU;
        }
        to == bumper.to
    };
    let near = sim_core::unit::degrees_from_radians(bumper.to);
    let candidates = [near, near - 360.0].map(|near| shortest(near, reads_back));
    let good = candidates.into_iter().find(|to| reads_back(*to) && (-360.0..=360.0).contains(to));
    let to_deg = good.unwrap_or(if near > 360.0 { near - 360.0 } else { near });
    ArcForm { name: bumper.name.clone(), id: bumper.id, from_deg, to_deg }
}

fn drive_form(robi: &RobiSpec) -> DriveForm {
    let drive = &robi.drive;
    let motor = drive.motors.iter().map(|it| MotorForm { name: it.motor.clone(), encoder: it.encoder.clone() });
    DriveForm {
        kind: Some(match drive.kind {
            DriveKind::Differential => DriveKindForm::Differential,
            DriveKind::Ackermann => DriveKindForm::Ackermann,
            DriveKind::Omni => DriveKindForm::Omni,
            DriveKind::Legged => DriveKindForm::Legged,
        }),
        motor: motor.collect(),
        steering: drive.steering.clone(),
        wheelbase_mm: unless(drive.wheelbase, default_wheelbase(robi)).map(mm),
        max_steer_deg: Some(degrees(drive.max_steer)),
        wheel_lag_ms: unless(shortest(drive.wheel_lag * 1e3, |ms| ms / 1e3 == drive.wheel_lag), 0.0),
    }
}

fn camera_form(camera: &CameraSpec) -> CameraForm {
    let [x_mm, y_mm, z_mm] = place(camera.position).map(|place| unless(place, 0.0));
    let joint = |joint: &JointSpec| match joint {
        JointSpec::Fixed(angle) => (unless(degrees(*angle), 0.0), None),
        JointSpec::Servo { name, from, to } => {
            (None, Some(JointForm { name: name.clone(), from_deg: degrees(*from), to_deg: degrees(*to) }))
        }
    };
    let ((pan_deg, pan_servo), (tilt_deg, tilt_servo)) = (joint(&camera.pan), joint(&camera.tilt));
    let (fov_deg, fisheye_deg) = match camera.lens {
        Lens::Pinhole { fov } => (unless(fov, DEFAULT_FIELD_OF_VIEW).map(degrees), None),
        Lens::Fisheye { fov } => (None, Some(degrees(fov))),
    };
    let (image_px, samples) = (camera.image, unless(camera.samples, DEFAULT_SAMPLES));
    CameraForm { x_mm, y_mm, z_mm, pan_deg, pan_servo, tilt_deg, tilt_servo, image_px, fov_deg, fisheye_deg, samples }
}

fn input_form(input: &InputSpec) -> Option<InputForm> {
    (*input != InputSpec::default()).then(|| InputForm {
        analog: input.analog.iter().map(|(channel, value)| (channel.to_string(), *value)).collect(),
        latch: input.latches.iter().map(|(number, value)| (number.to_string(), *value)).collect(),
        digital: input.digital.iter().map(|(number, value)| (number.to_string(), *value)).collect(),
        voltage_v: unless(input.voltage, DEFAULT_VOLTAGE),
        microphone: unless(input.microphone, DEFAULT_MICROPHONE),
        parallel_data: unless(input.parallel_data, 0),
        parallel_status: unless(input.parallel_status, 0),
    })
}

fn serial_form(line: &SerialLine) -> SerialForm {
    match line {
        SerialLine::Loopback => SerialForm::Word(SerialWord::Loopback),
        SerialLine::File { path, .. } => SerialForm::File { file: path.text.clone() },
    }
}

/// An object type in place.
pub(crate) fn object_form(object: &ObjectType) -> ObjectTypeForm {
    ObjectTypeForm {
        file: None,
        name: Some(object.name.clone()),
        model: object.model.as_ref().map(model_form),
        scale_mm: unless(mm(object.scale), 1000.0),
        collider: object.colliders.iter().map(collider_form).collect(),
        mass_kg: Some(object.mass),
        centre_of_mass_mm: unless(object.centre_of_mass, DVec3::ZERO).map(place),
        fixed: object.is_fixed,
        friction: Some(object.friction),
        rolling: object.rolling,
        restitution: Some(object.restitution),
        colour: object.colour,
        surface: sensor::surface_form(object.surface),
        solid: matches!(object.solid, Solid::Mesh(_)).then_some(SolidForm::Mesh),
        buoyancy_m3: unless(object.buoyancy, 0.0),
    }
}

/// The texts of `[[robot_type]]`, `[[object_type]]` and `[world]` sections.
pub(crate) fn section<T: Serialize>(key: &str, form: T) -> String {
    let value = Value::try_from(form).unwrap_or(Value::Table(Table::new()));
    let value = if key == "world" { value } else { Value::Array(vec![value]) };
    text::document(&Table::from_iter([(key.to_owned(), value)]))
}
