//! Checks of the links, buses and servos of a robot type. These checks run after all devices are read.

use std::collections::BTreeMap;

use super::Span;
use super::code::Code;
use super::line;
use super::spec::{BODY, LinkSpec, MAX_SONARS_ON_BUS, RobiSpec, SpannedText};
use super::table::Reader;
use sim_core::build;

/// Maximum number of names listed in a message.
const MAX_LISTED: usize = 32;

impl Reader {
    /// Reports devices that a program could not distinguish, buses with too many sonars, references to missing links
    /// and servos, and cycles of links. Moves sensors and links on a missing link to the body, makes links with a
    /// missing servo rigid, and breaks cycles.
    pub(super) fn check_devices(&mut self, robi: &mut RobiSpec) {
        self.report_duplicates(robi);
        self.check_buses(robi);
        self.check_servos_of_links(robi);
        let names = self.link_names(robi);
        let mut links = std::mem::take(&mut robi.links);
        for link in &mut links {
            self.check_link(&mut link.mount.link, &names);
        }
        self.break_cycles(&mut links, &names);
        robi.links = links;
        let mounts = robi.ranges.iter_mut().map(|range| &mut range.mount.link);
        let psds = robi.psds.iter_mut().map(|psd| &mut psd.link);
        let lidar = robi.lidar.iter_mut().map(|lidar| &mut lidar.mount.link);
        for mount_link in psds.chain(mounts).chain(lidar) {
            self.check_link(mount_link, &names);
        }
    }

    /// Reports each bus with more sonars than addresses, at the first sonar without an address.
    fn check_buses(&mut self, robi: &RobiSpec) {
        let mut sonars: BTreeMap<u32, usize> = BTreeMap::new();
        for range in &robi.ranges {
            let Some(bus) = range.bus else { continue };
            let count = sonars.entry(bus).or_default();
            *count += 1;
            if *count == MAX_SONARS_ON_BUS + 1 {
                let message = format!("`{}` is the {count}th sonar on bus {bus}", range.name);
                let expected = format!("at most {MAX_SONARS_ON_BUS} sonars on a bus");
                let suggestion = format!("give it and the sonars after it another bus: `bus = {}`", bus + 1);
                self.sink.error(Code::SonarBus, range.span, message, expected).suggestion = Some(suggestion);
            }
        }
    }

    /// Reports links with a missing servo, and makes them rigid.
    fn check_servos_of_links(&mut self, robi: &mut RobiSpec) {
        let servos: Vec<String> = robi.all_servos().into_iter().map(|servo| servo.name.to_owned()).collect();
        for link in &mut robi.links {
            let Some(joint) = link.joint.take_if(|joint| !servos.contains(&joint.servo.text)) else { continue };
            let message = format!(
                "link `{}` refers to the servo `{}`, which the robot does not have",
                link.name, joint.servo.text
            );
            let names: Vec<&str> = servos.iter().map(String::as_str).take(MAX_LISTED).collect();
            let expected = match names.as_slice() {
                [] => "a table `[[servo]]` of this name".to_owned(),
                names => format!("one of {}, or a table `[[servo]]` of this name", names.join(", ")),
            };
            let nearest = line::nearest(&joint.servo.text, servos.iter().map(String::as_str));
            let suggestion = nearest.map(|name| format!("write `{name}`"));
            self.sink.error(Code::LinkServo, joint.servo.span, message, expected).suggestion = suggestion;
        }
    }

    /// Maps the name of each link to its index, or to `usize::MAX` for a link of a leg; reports duplicate names.
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
            let mut is_duplicate = false;
            for (part, _) in parts.parts() {
                is_duplicate |= names.insert(format!("{}.{part}", spec.name.text), usize::MAX).is_some();
            }
            if is_duplicate {
                let message = format!("leg `{}` has a link with the name of another link", spec.name.text);
                self.sink.error(Code::LinkTwice, spec.name.span, message, "each name once");
            }
        }
        names
    }

    /// Reports a missing link, and moves the device or link mounted on it to the body.
    fn check_link(&mut self, mount_link: &mut Option<SpannedText>, names: &BTreeMap<String, usize>) {
        let Some(unknown) = mount_link.take_if(|unknown| !names.contains_key(&unknown.text)) else { return };
        let link_names = || [BODY].into_iter().chain(names.keys().map(String::as_str));
        let message = format!("there is no link `{}`", unknown.text);
        let expected = format!("one of {}", link_names().take(MAX_LISTED).collect::<Vec<_>>().join(", "));
        let suggestion = line::nearest(&unknown.text, link_names()).map(|name| format!("write `{name}`"));
        self.sink.error(Code::LinkUnknown, unknown.span, message, expected).suggestion = suggestion;
    }

    /// Reports cycles of links, each cycle once, and breaks them.
    fn break_cycles(&mut self, links: &mut [LinkSpec], names: &BTreeMap<String, usize>) {
        let count = links.len();
        let parent = |link: &LinkSpec| {
            let index = link.mount.link.as_ref().and_then(|link| names.get(&link.text).copied());
            index.filter(|index| *index < count)
        };
        // For each link, the first `start` whose chain of parents contains the link.
        let mut first_start: Vec<Option<usize>> = vec![None; links.len()];
        for start in 0..links.len() {
            let mut current = Some(start);
            while let Some(link) = current.filter(|link| first_start[*link].is_none()) {
                first_start[link] = Some(start);
                current = parent(&links[link]);
            }
            let Some(closing) = current.filter(|link| first_start[*link] == Some(start)) else { continue };
            let mut cycle = vec![format!("`{}`", links[closing].name)];
            let mut current = parent(&links[closing]);
            while let Some(link) = current.filter(|link| *link != closing) {
                cycle.push(format!("`{}`", links[link].name));
                current = parent(&links[link]);
            }
            cycle.truncate(MAX_LISTED);
            let message = match cycle.as_slice() {
                [one] => format!("link {one} is mounted on itself"),
                several => format!("links {} are mounted on each other in a cycle", several.join(", ")),
            };
            let mount_link = links[closing].mount.link.take();
            let span = mount_link.map_or(Span::default(), |mount_link| mount_link.span);
            self.sink.error(Code::LinkCycle, span, message, "links that lead to `body`");
        }
    }
}
