//! Effects of RoBIOS calls: one file per family of functions, based on models of the devices.
//!
//! `robios6` and `robios7` map each call to a function of a family. These functions change a [`robot::Robot`] at the
//! call's end and do not depend on threads and slots. The pages `docs/robios6.md` and `docs/robios7.md` document their
//! return values.
#![forbid(unsafe_code)]

#[macro_use]
mod method;

pub mod audio;
pub mod bump;
pub mod call;
pub mod caller;
pub mod camera;
pub mod camera6;
mod camera7;
pub mod compass;
pub mod console;
pub mod cost;
mod display;
mod display7;
pub mod flow;
pub mod forbidden;
pub mod ground_truth;
pub mod handle;
mod hdt;
pub mod hint;
pub mod image;
mod image7;
pub mod input;
pub mod ir;
pub mod irtv;
pub mod key;
pub mod latch;
pub mod layer;
pub mod lcd;
mod leg;
pub mod lidar;
pub mod motor;
mod motor7;
mod multitasking;
pub mod os;
mod os7;
pub mod panel;
pub mod picture;
mod pnm;
mod port7;
pub mod psd;
mod psd7;
pub mod radio;
mod radio6;
mod radio7;
mod robios6;
mod robios7;
pub mod robot;
pub mod screen;
pub mod serial;
pub mod servo;
mod servo7;
pub mod storage;
pub mod support;
pub mod table;
pub mod task;
#[cfg(test)]
mod tests;
pub mod timer;
mod unit7;
pub mod vw;
mod vw7;

use std::borrow::Cow;
use std::fmt::Display;
use std::sync::Arc;

use robios_sys::robios6::semantics::SEMANTICS;
use robios_sys::{Robios6Call as Call6, Robios7Call as Call7};
use sim_core::drive::{Command, CommandError};
use sim_core::record::Event;
use sim_core::spec::{Dialect, RobiSpec};
use sim_core::world::World;

use call::Call;
use hint::Mistake;
use panel::{Panel, PanelRef};
use robot::Robot;
use screen::Screen;

/// State that RoBIOS keeps for a robot's program: handles, settings, displays, keys, files.
#[derive(Default)]
pub struct Robios {
    /// Table in which programs look up devices.
    pub table: Arc<table::Table>,
    /// Variables and clock of the system.
    pub os: os::Os,
    /// The display of a program of RoBIOS 6.
    pub lcd: lcd::Lcd,
    /// The colour display; `None` for a program of RoBIOS 6.
    pub screen: Option<Box<Screen>>,
    /// Loudspeaker and microphone.
    pub audio: audio::Audio,
    /// PSD distance sensors that the program has opened.
    pub psds: handle::Handles,
    /// Motors that the program drives individually.
    pub motors: handle::Handles,
    /// Encoders that the program has opened.
    pub quads: handle::Handles,
    /// Servos.
    pub servos: servo::Servos,
    /// Scenery that the camera sees, and destination of images.
    pub camera_output: camera::CameraOutput,
    /// Camera settings of a program of RoBIOS 6.
    pub camera6: camera6::Settings,
    /// The driving interface.
    pub vw: vw::Vw,
    /// Bumpers.
    pub bumpers: bump::Bumpers,
    /// Infrared proximity sensors.
    pub infrareds: handle::Handles,
    /// True between `COMPASSInit` and `COMPASSRelease`.
    pub has_compass: bool,
    /// Layers that the program shows in the window.
    pub layers: layer::Layers,
    /// Latches and parallel port.
    pub latches: latch::Latches,
    /// Serial interfaces.
    pub serial: serial::Serial,
    /// Digital lines and analog recordings of RoBIOS-7.
    pub ports: port7::Ports,
    /// The radio.
    pub radio: radio::Radio,
    /// Files.
    pub storage: storage::Storage,
    /// Settings of the receiver for a remote control, while it is on.
    pub irtv: Option<irtv::Settings>,
    /// Counters of the program's output.
    pub console: console::Console,
    /// Standard input of the program.
    pub input: input::Input,
    /// EyeSim version whose conventions apply.
    pub dialect: Dialect,
    /// Numbers of robots and objects for programs.
    pub entity_numbers: Arc<ground_truth::EntityNumbers>,
    /// Hints given for the program.
    pub hints: hint::Hints,
    /// The program is in Rust: messages use the device names of the Rust library.
    pub is_rust: bool,
}

impl Robios {
    /// State for a robot of this type whose program uses RoBIOS 6.
    pub fn new(spec: &RobiSpec) -> Self {
        let serial = serial::Serial::new(&spec.serials);
        Self { table: Arc::new(table::Table::new(spec)), serial, ..Self::default() }
    }

    /// State for a robot of this type whose program uses RoBIOS-7.
    pub fn of_robios7(spec: &RobiSpec) -> Self {
        Self { screen: Some(new_screen(spec)), ..Self::new(spec) }
    }

    /// Returns true if the program uses RoBIOS-7.
    pub fn is_of_robios7(&self) -> bool {
        self.screen.is_some()
    }

    /// The display.
    pub fn panel(&self) -> PanelRef<'_> {
        self.screen.as_deref().map_or(PanelRef::Classic(&self.lcd), PanelRef::Colour)
    }

    /// Takes the display out, at the end of the run.
    pub fn take_panel(&mut self) -> Panel {
        match self.screen.take() {
            Some(screen) => Panel::Colour(screen),
            None => Panel::Classic(Box::new(std::mem::take(&mut self.lcd))),
        }
    }

    /// Sets the numbers of robots and objects.
    pub fn with_entity_numbers(self, entity_numbers: Arc<ground_truth::EntityNumbers>) -> Self {
        Self { entity_numbers, ..self }
    }
}

fn new_screen(spec: &RobiSpec) -> Box<Screen> {
    Box::new(Screen::new([spec.lcd.width, spec.lcd.height]))
}

/// Helpers that the families share.
impl Robot {
    /// The robot's colour display.
    fn screen(&mut self) -> &mut Screen {
        let Self { state, robios, .. } = self;
        robios.screen.get_or_insert_with(|| new_screen(&state.spec))
    }

    /// Counts a failure of `call` and returns `answer`. A program that keeps ignoring failures is given a hint.
    fn fail_call(&mut self, call: impl Into<Call>, answer: i32) -> i32 {
        if let Some(text) = self.robios.hints.count_failure(call.into()) {
            self.hint(&text);
        }
        answer
    }

    /// Like [`Self::fail_call`], for a failure whose reason the program cannot find out: a hint gives the reason, once
    /// per function.
    fn refuse_call(&mut self, call: impl Into<Call>, answer: i32, reason: impl FnOnce(&Self) -> String) -> i32 {
        let call = call.into();
        if self.robios.hints.is_first_reason(call) {
            let text = format!("`{}` returned {answer}: {}", call.name(), reason(self));
            self.hint(&text);
        }
        self.fail_call(call, answer)
    }

    /// Fails a call with a handle that is not open. Unless `init`, the function that opens it, has failed and given the
    /// reason, a hint says so, once for each `init`.
    fn refuse_handle(&mut self, call: Call6, answer: i32, handle: i32, init: Call6) -> i32 {
        if !self.robios.hints.has_failed(init.into()) {
            let (name, init) = (call.name(), init.name());
            let text = format!("`{name}`: handle {handle} is not open: pass the one that `{init}` returns");
            self.hint_once(Mistake::NotOpen(init), &text);
        }
        self.fail_call(call, answer)
    }

    /// Answers a call: 0 if it succeeded, otherwise `failure`, with a hint that gives the error.
    fn answer_call<E: Display>(&mut self, call: impl Into<Call>, failure: i32, outcome: Result<(), E>) -> i32 {
        outcome.map_or_else(|error| self.refuse_call(call, failure, |_| error.to_string()), |()| 0)
    }

    /// Counts a call that does nothing as a failure; a hint gives the reason, once per function.
    fn skip_call(&mut self, call: impl Into<Call>, reason: impl FnOnce(&Self) -> String) {
        let call = call.into();
        if self.robios.hints.is_first_reason(call) {
            let text = format!("`{}` did nothing: {}", call.name(), reason(self));
            self.hint(&text);
        }
        self.fail_call(call, 0);
    }

    /// Records a call of a forbidden function, which has no other effect.
    fn record_forbidden(&mut self, call: Call) {
        self.skip_call(call, |_| "it is forbidden here".to_owned());
        self.record(Event::Forbidden { function: call.name() });
    }

    /// Refuses a call for a device that the robot does not have.
    fn refuse_missing_device(&mut self, call: impl Into<Call>, answer: i32, kind: i32, semantics: i32) -> i32 {
        self.refuse_call(call, answer, |robot| {
            let constant = SEMANTICS.iter().find(|constant| constant.value == i64::from(semantics));
            let display_name = |name: &str| match robot.robios.is_rust {
                true => table::name_in_rust(name).unwrap_or_else(|| name.to_owned()),
                false => name.to_owned(),
            };
            let wanted = constant.map_or_else(|| semantics.to_string(), |constant| display_name(constant.name));
            let name = |device: &table::Device| match device.number() {
                0 => format!("{} (without a number)", device.name),
                _ => display_name(&device.name),
            };
            let names: Vec<String> = robot.robios.table.of_kind(kind).map(name).collect();
            let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            format!("`{}` has no `{wanted}`; of this kind it has: {names}", robot.spec.file)
        })
    }

    /// Index of the device of a kind with RoBIOS-7's `number`. If there is none, a hint lists the numbers, once per
    /// function.
    fn find_numbered(&mut self, call: Call7, kind: i32, number: i32, names: &[&str]) -> Option<usize> {
        let found = self.robios.table.numbered(kind, number, names).map(|device| device.index);
        if found.is_none() && self.robios.hints.is_first_reason(call.into()) {
            let table = &self.robios.table;
            let numbers: Vec<_> = (1..=table::MAX_NUMBER)
                .filter_map(|number| Some(format!("{number} ({})", table.numbered(kind, number, names)?.name)))
                .collect();
            let (call, robi) = (call.name(), &self.spec.file);
            let text = if numbers.is_empty() {
                format!("`{call}`: `{robi}` has no device of this kind")
            } else {
                format!("`{call}`: `{robi}` has no number {number}, it has: {}", numbers.join(", "))
            };
            self.hint(&text);
        }
        found
    }

    /// Gives the hint at a likely mistake, once per robot.
    fn hint_at(&mut self, mistake: Mistake) {
        self.hint_once(mistake, mistake.text());
    }

    /// Gives the hint `text` at a likely mistake, once per robot.
    fn hint_once(&mut self, mistake: Mistake, text: &str) {
        if self.robios.hints.is_first(mistake) {
            self.hint(text);
        }
    }

    /// Commands the drive.
    fn command(&mut self, world: &World, command: Command) -> Result<(), CommandError> {
        self.tasks.recheck_drive(self.state.now);
        self.state.command(world, command)
    }
}

/// Text from a program, for records: invalid UTF-8 is replaced.
fn text(characters: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(characters)
}
