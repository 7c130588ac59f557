//! Converts the devices of a robot type to the page's protocol.

use sim_core::build;
use sim_core::camera::Lens;
use sim_core::math;
use sim_core::pose::Pose3;
use sim_core::sensor::{Posture, RangeModel};
use sim_core::spec::{LIDAR, RobiSpec};
use sim_view::protocol::{self, Sensor, SensorKind};

use sim_core::device::camera;
use sim_core::device::range::Ranges;
use sim_core::device::servo::Servos;
use sim_core::device::switch;
use sim_core::time::Time;
use sim_host::record::mcap::scene::point;

/// Name of the camera among the devices of its robot.
pub const CAMERA: &str = switch::CAMERA;

/// All sensors of a robot of this type: range sensors first, in the order of the robot's own list.
pub fn sensors(robi: &RobiSpec) -> Vec<Sensor> {
    let joints = build::legs(robi).map_or_else(Vec::new, |legs| legs.standing_joints());
    let (links, angles) = (build::links(robi), Ranges::new(robi).joint_angles(&Servos::default(), &joints, Time::ZERO));
    let posture = Posture { links: &links, angles: &angles, ..Posture::default() };
    let names = robi.psds.iter().map(|psd| &psd.name).chain(robi.ranges.iter().map(|range| &range.name));
    let ranges = build::range_sensors(robi).into_iter().zip(names).map(|(sensor, name)| Sensor {
        name: name.clone(),
        kind: kind_of(&sensor.model),
        mount: Some(point(&sensor.world_from_sensor(&posture))),
        range_m: Some(sensor.model.limits()),
        half_angle_rad: if let RangeModel::Sonar(sonar) = sensor.model { sonar.half_angle } else { 0.0 },
    });
    let infrareds = robi.infrareds.iter().map(|infrared| Sensor {
        mount: Some(point(&Pose3::from_angles(infrared.position, 0.0, 0.0, infrared.angle))),
        range_m: Some([0.0, infrared.range]),
        ..sensor_without_geometry(&infrared.name, SensorKind::Infrared)
    });
    let lidar = robi.lidar.iter().map(|lidar| {
        let (mount, link) = build::scanner_mount(robi, lidar);
        Sensor {
            mount: Some(point(&posture.world_from(&mount, link))),
            range_m: Some([0.0, lidar.range]),
            half_angle_rad: 0.5 * lidar.sweep,
            ..sensor_without_geometry(LIDAR, SensorKind::Lidar)
        }
    });
    let bumpers = robi.bumpers.iter().map(|bumper| {
        let middle = 0.5 * (bumper.from + bumper.to);
        let body = Pose3::from_angles(glam::DVec3::ZERO, 0.0, 0.0, middle);
        let edge = Pose3 { position: 0.5 * robi.diameter * body.forward(), ..body };
        let half_angle_rad = 0.5 * (bumper.to - bumper.from).abs();
        Sensor {
            mount: Some(point(&edge)),
            half_angle_rad,
            ..sensor_without_geometry(&bumper.name, SensorKind::Bumper)
        }
    });
    let compass = robi.compass.iter().map(|compass| sensor_without_geometry(&compass.name, SensorKind::Compass));
    let encoders = robi.drive.motors.iter().filter_map(|motor| motor.encoder.as_ref());
    let encoders = encoders.map(|name| sensor_without_geometry(name, SensorKind::Encoder));
    let camera = camera(robi).into_iter().map(|camera| Sensor {
        mount: Some(camera.mount),
        half_angle_rad: 0.5 * camera.horizontal_rad,
        ..sensor_without_geometry(CAMERA, SensorKind::Camera)
    });
    ranges.chain(infrareds).chain(lidar).chain(bumpers).chain(compass).chain(encoders).chain(camera).collect()
}

fn sensor_without_geometry(name: &str, kind: SensorKind) -> Sensor {
    Sensor { name: name.to_owned(), kind, mount: None, range_m: None, half_angle_rad: 0.0 }
}

fn kind_of(model: &RangeModel) -> SensorKind {
    match model {
        RangeModel::Psd { .. } => SensorKind::Psd,
        RangeModel::Laser(_) => SensorKind::Laser,
        RangeModel::Ultrasonic(_) => SensorKind::Ultrasonic,
        RangeModel::Reflectance(_) => SensorKind::Reflectance,
        RangeModel::Sonar(_) => SensorKind::Sonar,
    }
}

/// The camera of a robot of this type, with its servos at rest.
pub fn camera(robi: &RobiSpec) -> Option<protocol::Camera> {
    let camera = robi.camera.as_ref()?;
    let mount = camera::mount(robi, camera, &Servos::default(), Time::ZERO);
    let [width, height] = camera::DEFAULT_SIZE.map(f64::from);
    let horizontal_rad = camera.lens.fov();
    let vertical_rad = match camera.lens {
        Lens::Pinhole { fov } => 2.0 * math::atan(math::tan(0.5 * fov) * height / width),
        Lens::Fisheye { fov } => fov * height / width,
    };
    Some(protocol::Camera { mount: point(&mount), horizontal_rad, vertical_rad })
}
