//! Removes source positions from specs, to compare the content of two texts.

use std::sync::Arc;

use super::Span;
use super::spec::{
    CostsRef, Dialect, ModelSpec, NoiseRef, NoiseSpec, ObjectLine, ObjectType, PositionRef, RobiSpec, RobotLine,
    SceneSpec, SensorShape, SerialLine, SimSpec, SpannedText, TypeRef, WorldSpec,
};

/// Content of a scene, independent of the paths of its files.
pub fn scene(scene: &SceneSpec) -> SceneSpec {
    let mut scene = SceneSpec { file: String::new(), folder: String::new(), ..scene.clone() };
    scene.world = world(&scene.world);
    for robot in &mut scene.robots {
        robot.robi = Arc::new(robi(&robot.robi));
        robot.program.iter_mut().for_each(clear_span);
        robot.noise.iter_mut().for_each(clear_noise_spans);
        robot.span = Span::default();
        robot.line.clear();
        // The dialect is only a hint at the generation of a program. It is not compared, because formats state it
        // differently.
        robot.dialect = None;
    }
    for placed in &mut scene.objects {
        placed.kind = Arc::new(object(&placed.kind));
        placed.span = Span::default();
        placed.line.clear();
    }
    scene.markers.iter_mut().for_each(|marker| marker.span = Span::default());
    match &mut scene.run.costs {
        Some(CostsRef::File(path)) => clear_span(path),
        Some(CostsRef::Table(table)) => {
            table.file.clear();
            table.entries.iter_mut().for_each(|entry| entry.span = Span::default());
            table.entries.sort_by(|a, b| (&a.generation, &a.function).cmp(&(&b.generation, &b.function)));
        }
        None => {}
    }
    scene.run.noise.iter_mut().for_each(clear_noise_spans);
    // Only the dialect of 2018 has effects besides this hint.
    scene.run.dialect = scene.run.dialect.filter(|dialect| *dialect == Dialect::Vr2018);
    scene
}

/// Content of a scene's text, without the files that it refers to.
pub fn sim(sim: &SimSpec) -> SimSpec {
    let mut sim = SimSpec { file: String::new(), ..sim.clone() };
    sim.world.iter_mut().for_each(|line| clear_span(&mut line.path));
    sim.robot_types.iter_mut().chain(&mut sim.object_types).for_each(clear_span);
    sim.wall_paths.clear();
    sim.robots.iter_mut().chain(&mut sim.named).for_each(|line: &mut RobotLine| {
        clear_type_span(&mut line.kind);
        line.program.iter_mut().for_each(clear_span);
        line.noise.iter_mut().for_each(clear_noise_spans);
        line.span = Span::default();
        line.path.clear();
    });
    sim.objects.iter_mut().for_each(clear_object_location);
    sim.markers.iter_mut().for_each(|marker| marker.span = Span::default());
    sim.faults.iter_mut().for_each(|fault| fault.span = Span::default());
    sim.reachable.iter_mut().for_each(|requirement| {
        requirement.span = Span::default();
        for point in [&mut requirement.from, &mut requirement.to] {
            if let PositionRef::Start(path) = point {
                clear_span(path);
            }
        }
    });
    sim.inline.world = sim.inline.world.as_ref().map(world);
    sim.inline.robot_types.iter_mut().for_each(|entry| *entry = (robi(&entry.0), Span::default()));
    sim.inline.object_types.iter_mut().for_each(|entry| *entry = (object(&entry.0), Span::default()));
    let run = SceneSpec { run: sim.run, ..SceneSpec::default() };
    sim.run = scene(&run).run;
    sim
}

/// Content of a world.
pub fn world(world: &WorldSpec) -> WorldSpec {
    let mut world = WorldSpec { file: String::new(), ..world.clone() };
    world.texture.iter_mut().for_each(clear_span);
    if let Some(terrain) = &mut world.terrain {
        terrain.path_mut().into_iter().for_each(clear_span);
        terrain.span = Span::default();
        (terrain.mesh, terrain.field) = (None, None);
    }
    world.walls.iter_mut().for_each(|wall| wall.span = Span::default());
    world.starts.iter_mut().for_each(|start| start.span = Span::default());
    world.objects.iter_mut().for_each(clear_object_location);
    world
}

/// Content of a robot type.
pub fn robi(robi: &RobiSpec) -> RobiSpec {
    let mut robi = RobiSpec { file: String::new(), ..robi.clone() };
    robi.model.iter_mut().for_each(clear_model_span);
    if let Some(legs) = &mut robi.legs {
        legs.gaits.iter_mut().for_each(|gait| gait.span = Span::default());
        for leg in &mut legs.legs {
            leg.span = Span::default();
            clear_span(&mut leg.name);
        }
    }
    for link in &mut robi.links {
        link.span = Span::default();
        link.mount.link.iter_mut().for_each(clear_span);
        link.joint.iter_mut().for_each(|turn| clear_span(&mut turn.servo));
    }
    for psd in &mut robi.psds {
        psd.span = Span::default();
        psd.link.iter_mut().for_each(clear_span);
    }
    for range in &mut robi.ranges {
        range.span = Span::default();
        range.mount.link.iter_mut().for_each(clear_span);
    }
    robi.camera.iter_mut().for_each(|device| device.span = Span::default());
    if let Some(lidar) = &mut robi.lidar {
        lidar.span = Span::default();
        lidar.mount.link.iter_mut().for_each(clear_span);
    }
    robi.infrareds.iter_mut().for_each(|device| device.span = Span::default());
    robi.bumpers.iter_mut().for_each(|device| device.span = Span::default());
    robi.servos.iter_mut().for_each(|device| device.span = Span::default());
    robi.compass.iter_mut().for_each(|device| device.span = Span::default());
    for serial in &mut robi.serials {
        if let SerialLine::File { path, bytes } = &mut serial.line {
            clear_span(path);
            *bytes = Arc::default();
        }
    }
    robi
}

/// Content of a noise profile.
pub fn noise(noise: &NoiseSpec) -> NoiseSpec {
    let mut noise = NoiseSpec { file: String::new(), ..noise.clone() };
    noise.entries.iter_mut().for_each(|entry| entry.span = Span::default());
    noise
}

/// Content of an object type.
pub fn object(object: &ObjectType) -> ObjectType {
    let mut object = ObjectType { file: String::new(), ..object.clone() };
    object.model.iter_mut().for_each(clear_model_span);
    if let SensorShape::Mesh(mesh) = &mut object.sensor_shape {
        *mesh = None;
    }
    object
}

fn clear_span(path: &mut SpannedText) {
    path.span = Span::default();
}

fn clear_noise_spans(noise: &mut NoiseRef) {
    match noise {
        NoiseRef::Preset(_) => {}
        NoiseRef::File(path) => clear_span(path),
        NoiseRef::Profile(spec) => *spec = Arc::new(self::noise(spec)),
    }
}

fn clear_model_span(model: &mut ModelSpec) {
    clear_span(&mut model.path);
}

fn clear_type_span(kind: &mut TypeRef) {
    match kind {
        TypeRef::File(path) | TypeRef::Name(path) => clear_span(path),
    }
}

fn clear_object_location(line: &mut ObjectLine) {
    clear_type_span(&mut line.kind);
    line.span = Span::default();
    line.path.clear();
}
