//! Links, poses in space and range sensors in tables of TOML: the same words in a companion and in a scene.

use std::collections::BTreeMap;

use super::Span;
use super::code::Code;
use super::line::{self, Quantity};
use super::spec::{
    Axis, BODY, LinkSpec, MAX_SONARS_ON_BUS, MountSpec, PathRef, RangeSpec, RobiSpec, Surface, TurnSpec,
};
use super::table::{Reader, Section};
use sim_core::build;
use sim_core::sensor::{Echo, PAPER_SIGMA, RangeModel, SideLobes, Sonar};

/// Names that a message lists at most.
const MAX_LISTED: usize = 32;

/// Most links of a robot: none needs a tenth of them.
const MAX_LINKS: usize = 256;
/// Greatest number of a bus: a robot has more than one microcontroller for its sonars, but hardly a hundred.
const MAX_BUS: i64 = 100;
/// Most rays of a sonar's fan.
const MAX_RAYS: i64 = 4096;
/// Sonars whose values are known.
const PRESETS: [&str; 1] = ["SRF08"];
const AXES: [&str; 3] = ["x", "y", "z"];
const ROLL: Quantity = Quantity::angle("roll");
pub(super) const PITCH: Quantity = Quantity::angle("pitch");
const YAW: Quantity = Quantity::angle("yaw");

/// The word for a kind of range sensor: its table in TOML.
pub(super) fn model_name(model: &RangeModel) -> &'static str {
    match model {
        RangeModel::Psd { .. } => "psd",
        RangeModel::Laser(_) => "laser",
        RangeModel::Ultrasonic(_) => "ultrasonic",
        RangeModel::Reflectance(_) => "reflectance",
        RangeModel::Sonar(_) => "sonar",
    }
}

impl Reader<'_> {
    /// `surface = { reflectivity = 0.8, specular = 0.5 }`
    pub(super) fn surface(&mut self, mut section: Section<'_, '_>) -> Surface {
        let mut surface = Surface::default();
        let share = |name| Quantity::number(name, 0.0, 1.0);
        self.set(&mut section, "reflectivity", &share("reflectivity"), &mut surface.reflectivity);
        self.set(&mut section, "specular", &share("specular share"), &mut surface.specular);
        self.unknown_keys(&section);
        surface
    }

    /// The link that something sits on, if it is not the body. Whether there is one of this name shows at the end.
    pub(super) fn on(&mut self, section: &mut Section<'_, '_>) -> Option<PathRef> {
        self.reference(section, "on").filter(|link| link.text != BODY)
    }

    /// Reads a pose in space into `mount`.
    pub(super) fn mount(&mut self, section: &mut Section<'_, '_>, mount: &mut MountSpec) {
        if section.has("on") {
            mount.on = self.on(section);
        } else {
            section.get("on");
        }
        self.set(section, "x_mm", &Quantity::coordinate("x"), &mut mount.position.x);
        self.set(section, "y_mm", &Quantity::coordinate("y"), &mut mount.position.y);
        self.set(section, "z_mm", &Quantity::coordinate("z"), &mut mount.position.z);
        self.set(section, "roll_deg", &ROLL, &mut mount.roll);
        self.set(section, "pitch_deg", &PITCH, &mut mount.pitch);
        self.set(section, "yaw_deg", &YAW, &mut mount.yaw);
    }

    /// The links.
    pub(super) fn links(&mut self, parent: &mut Section<'_, '_>, robi: &mut RobiSpec) {
        let sections = self.sections(parent, "link");
        if sections.len() > MAX_LINKS {
            let message = format!("the robot has {} links", sections.len());
            let span = self.key_span(parent, "link");
            self.sink.error(Code::NumberRange, span, message, format!("at most {MAX_LINKS} links"));
            return;
        }
        for section in sections {
            robi.links.extend(self.link(section));
        }
    }

    /// `[[link]]`
    fn link(&mut self, mut section: Section<'_, '_>) -> Option<LinkSpec> {
        let name = self.required_reference(&mut section, "name");
        let mut mount = MountSpec::default();
        self.mount(&mut section, &mut mount);
        let servo = self.reference(&mut section, "servo");
        if section.has("axis") && !section.has("servo") {
            self.missing(&section, "servo");
        }
        let axis = match self.choice(&mut section, "axis", &AXES) {
            Some(0) => Axis::X,
            Some(1) => Axis::Y,
            _ => Axis::Z,
        };
        self.unknown_keys(&section);
        let turn = servo.map(|servo| TurnSpec { axis, servo });
        Some(LinkSpec { name: name?.text, mount, turn, span: section.span })
    }

    /// The range sensors beside the PSDs.
    pub(super) fn ranges(&mut self, parent: &mut Section<'_, '_>, robi: &mut RobiSpec) {
        for section in self.sections(parent, "laser") {
            robi.ranges.extend(self.echo(section, Echo::LASER, RangeModel::Laser));
        }
        for section in self.sections(parent, "ultrasonic") {
            robi.ranges.extend(self.echo(section, Echo::ULTRASONIC, RangeModel::Ultrasonic));
        }
        for section in self.sections(parent, "reflectance") {
            robi.ranges.extend(self.echo(section, Echo::REFLECTANCE, RangeModel::Reflectance));
        }
        for section in self.sections(parent, "sonar") {
            robi.ranges.extend(self.sonar(section));
        }
    }
}

impl Reader<'_> {
    /// A sensor of one ray with the values of `usual` for what it does not say.
    fn echo(&mut self, mut section: Section<'_, '_>, usual: Echo, model: fn(Echo) -> RangeModel) -> Option<RangeSpec> {
        let incidence = Quantity::angle("greatest incidence").within(0.0, 90.0);
        let mut echo = usual;
        self.limits(&mut section, &mut echo.min, &mut echo.max);
        self.set(&mut section, "incidence_deg", &incidence, &mut echo.incidence);
        self.range(section, model(echo))
    }

    fn sonar(&mut self, mut section: Section<'_, '_>) -> Option<RangeSpec> {
        // The one preset is what a sonar has that does not say.
        self.choice(&mut section, "preset", &PRESETS);
        let mut sonar = Sonar::srf08();
        self.limits(&mut section, &mut sonar.min, &mut sonar.max);
        let half_angle = Quantity::angle("half of the beam's angle").within(0.1, 90.0);
        self.set(&mut section, "half_angle_deg", &half_angle, &mut sonar.half_angle);
        self.set(&mut section, "threshold", &Quantity::number("threshold", 0.0, 1e9), &mut sonar.threshold);
        if let Some(rays) = self.integer(&mut section, "rays", 1, MAX_RAYS) {
            sonar.rays = rays as u32;
        }
        if let Some(lobes) = self.section(&mut section, "side_lobes") {
            sonar.side_lobes = self.side_lobes(lobes);
        }
        let bus = self.integer(&mut section, "bus", 1, MAX_BUS).map_or(1, |bus| bus as u32);
        let range = self.range(section, RangeModel::Sonar(sonar))?;
        Some(RangeSpec { bus: Some(bus), ..range })
    }

    fn side_lobes(&mut self, mut section: Section<'_, '_>) -> Option<SideLobes> {
        let angle = Quantity::angle("angle of the side lobes").within(0.0, 90.0);
        let half_width = Quantity::angle("half of the side lobes' width").within(0.01, 90.0);
        let angle = self.required(&mut section, "angle_deg", &angle);
        let half_width = self.required(&mut section, "half_width_deg", &half_width);
        let gain = self.required(&mut section, "gain", &Quantity::number("gain of the side lobes", 0.0, 1.0));
        self.unknown_keys(&section);
        Some(SideLobes { angle: angle?, half_width: half_width?, gain: gain? })
    }

    /// Least and greatest distance. Two that leave nothing between them are reported and change nothing.
    fn limits(&mut self, section: &mut Section<'_, '_>, min: &mut f64, max: &mut f64) {
        let low = self.number(section, "min_mm", &Quantity::length("least distance")).unwrap_or(*min);
        let high = self.number(section, "max_mm", &Quantity::size("greatest distance")).unwrap_or(*max);
        if low < high {
            (*min, *max) = (low, high);
            return;
        }
        let key = if section.has("min_mm") { "min_mm" } else { "max_mm" };
        let [low, high] = [low, high].map(sim_core::unit::mm_from_metres);
        let message = format!("the least distance, {low} mm, is not below the greatest, {high} mm");
        let span = self.key_span(section, key);
        self.sink.error(Code::RobiRange, span, message, "`min_mm` below `max_mm`");
    }

    /// What all range sensors have besides their model.
    fn range(&mut self, mut section: Section<'_, '_>, model: RangeModel) -> Option<RangeSpec> {
        let (name, id) = self.device(&mut section);
        let mut mount = MountSpec::default();
        self.mount(&mut section, &mut mount);
        let [mut sigma, mut mean] = [PAPER_SIGMA, 0.0];
        self.set(&mut section, "sigma", &Quantity::number("standard deviation", 0.0, 1e3), &mut sigma);
        self.set(&mut section, "mean", &Quantity::number("mean", -1e3, 1e3), &mut mean);
        self.unknown_keys(&section);
        Some(RangeSpec { name: name?, id, mount, model, sigma, mean, bus: None, span: section.span })
    }
}

/// What is left to say once all devices of a robot type are known.
impl Reader<'_> {
    /// Reports devices that a program could not tell apart, and links and servos that there are not; sensors whose link is
    /// not there sit on the body.
    pub(super) fn settle_devices(&mut self, robi: &mut RobiSpec) {
        self.doubles(robi);
        self.buses(robi);
        self.turned_by(robi);
        let names = self.link_names(robi);
        let mut links = std::mem::take(&mut robi.links);
        for link in &mut links {
            self.known_link(&mut link.mount.on, &names);
        }
        self.circles(&mut links, &names);
        robi.links = links;
        let mounts = robi.ranges.iter_mut().map(|range| &mut range.mount.on);
        let psds = robi.psds.iter_mut().map(|psd| &mut psd.on);
        let lidar = robi.lidar.iter_mut().map(|lidar| &mut lidar.mount.on);
        for on in psds.chain(mounts).chain(lidar) {
            self.known_link(on, &names);
        }
    }

    /// Reports each bus with more sonars than it has addresses, at the first that finds none.
    fn buses(&mut self, robi: &RobiSpec) {
        let mut sonars: BTreeMap<u32, usize> = BTreeMap::new();
        for range in &robi.ranges {
            let Some(bus) = range.bus else { continue };
            let count = sonars.entry(bus).or_default();
            *count += 1;
            if *count == MAX_SONARS_ON_BUS + 1 {
                let message = format!("`{}` is the {count}th sonar on bus {bus}", range.name);
                let expected = format!("at most {MAX_SONARS_ON_BUS} sonars on a bus");
                let suggestion = format!("give it and those behind it another one: `bus = {}`", bus + 1);
                self.sink.error(Code::SonarBus, range.span, message, expected).suggestion = Some(suggestion);
            }
        }
    }

    /// Servos that turn links and are not there.
    fn turned_by(&mut self, robi: &mut RobiSpec) {
        let servos: Vec<String> = robi.all_servos().into_iter().map(|servo| servo.name.to_owned()).collect();
        for link in &mut robi.links {
            let Some(turn) = link.turn.take_if(|turn| !servos.contains(&turn.servo.text)) else { continue };
            let message =
                format!("link `{}` is turned by `{}`, a servo that the robot has not", link.name, turn.servo.text);
            let known: Vec<&str> = servos.iter().map(String::as_str).take(MAX_LISTED).collect();
            let expected = match known.as_slice() {
                [] => "a table `[[servo]]` of this name".to_owned(),
                known => format!("one of {}, or a table `[[servo]]` of this name", known.join(", ")),
            };
            let nearest = line::nearest(&turn.servo.text, servos.iter().map(String::as_str));
            let suggestion = nearest.map(|name| format!("write `{name}`"));
            self.sink.error(Code::LinkServo, turn.servo.span, message, expected).suggestion = suggestion;
        }
    }

    /// Place of each link by its name, beyond all others for those of legs; the second of one name is reported.
    fn link_names(&mut self, robi: &RobiSpec) -> BTreeMap<String, usize> {
        let mut names: BTreeMap<String, usize> = BTreeMap::new();
        for (index, link) in robi.links.iter().enumerate() {
            let expected = "each name once, and none of them `body`";
            if link.name == BODY {
                let message = "a link cannot be named `body`: that is the robot's body";
                self.sink.error(Code::LinkTwice, link.span, message, expected);
            } else if let Some(first) = names.get(&link.name) {
                let line = robi.links[*first].span.line;
                let message = format!("a second link named `{}`; the first is in line {line}", link.name);
                self.sink.error(Code::LinkTwice, link.span, message, expected);
            } else {
                names.insert(link.name.clone(), index);
            }
        }
        for spec in robi.legs.iter().flat_map(|legs| &legs.legs) {
            let parts = build::leg(spec);
            let mut is_known = false;
            for (part, _) in parts.parts() {
                is_known |= names.insert(format!("{}.{part}", spec.name.text), usize::MAX).is_some();
            }
            if is_known {
                let message = format!("the links of leg `{}` are named as those of another", spec.name.text);
                self.sink.error(Code::LinkTwice, spec.name.span, message, "each name once");
            }
        }
        names
    }

    /// Reports a link that is not there, and puts what was to sit on it onto the body.
    fn known_link(&mut self, on: &mut Option<PathRef>, names: &BTreeMap<String, usize>) {
        let Some(wanted) = on.take_if(|wanted| !names.contains_key(&wanted.text)) else { return };
        let known = || [BODY].into_iter().chain(names.keys().map(String::as_str));
        let message = format!("there is no link `{}`", wanted.text);
        let expected = format!("one of {}", known().take(MAX_LISTED).collect::<Vec<_>>().join(", "));
        let suggestion = line::nearest(&wanted.text, known()).map(|name| format!("write `{name}`"));
        self.sink.error(Code::LinkUnknown, wanted.span, message, expected).suggestion = suggestion;
    }

    /// Reports links that hang on each other in a circle, each circle once, and cuts it.
    fn circles(&mut self, links: &mut [LinkSpec], names: &BTreeMap<String, usize>) {
        let count = links.len();
        let parent = |link: &LinkSpec| {
            let on = link.mount.on.as_ref().and_then(|on| names.get(&on.text).copied());
            on.filter(|place| *place < count)
        };
        // By link from which start it was first reached.
        let mut reached: Vec<Option<usize>> = vec![None; links.len()];
        for start in 0..links.len() {
            let mut at = Some(start);
            while let Some(link) = at.filter(|link| reached[*link].is_none()) {
                reached[link] = Some(start);
                at = parent(&links[link]);
            }
            let Some(closing) = at.filter(|link| reached[*link] == Some(start)) else { continue };
            let mut circle = vec![format!("`{}`", links[closing].name)];
            let mut at = parent(&links[closing]);
            while let Some(link) = at.filter(|link| *link != closing) {
                circle.push(format!("`{}`", links[link].name));
                at = parent(&links[link]);
            }
            circle.truncate(MAX_LISTED);
            let message = match circle.as_slice() {
                [one] => format!("link {one} sits on itself"),
                several => format!("links {} sit on each other in a circle", several.join(", ")),
            };
            let on = links[closing].mount.on.take();
            let span = on.map_or(Span::default(), |on| on.span);
            self.sink.error(Code::LinkCycle, span, message, "links that lead to `body`");
        }
    }
}
