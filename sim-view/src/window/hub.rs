//! State shown to all pages, and the queue of their commands.
//!
//! The simulation never waits for a page: for each kind of message only the latest is kept, and events are kept in
//! a ring buffer. Texts are serialised when the first page needs them, on the server's thread, and shared.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::ws::Utf8Bytes;
use serde::Serialize;
use tokio::sync::{mpsc, watch};

use super::Look;
use crate::protocol::{Answer, Build, Command, Detail, Event, Layer, Message, Picture, Scene, Snapshot};

/// Number of events kept for pages that connect later or are slow.
pub(super) const MAX_EVENTS: usize = 20_000;
/// Maximum number of events in one message.
const MAX_BATCH: usize = 1_000;
/// Maximum number of commands that wait for the simulation.
pub(super) const MAX_COMMANDS: usize = 256;

/// Locks, ignoring poisoning: the guarded data is consistent after each statement.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A value and its serialised text, which is computed once.
struct CachedText<T> {
    value: T,
    text: OnceLock<Utf8Bytes>,
}

impl<T> CachedText<T> {
    fn new(value: T) -> Arc<CachedText<T>> {
        Arc::new(CachedText { value, text: OnceLock::new() })
    }

    fn text(&self, message: impl FnOnce(&T) -> Utf8Bytes) -> Utf8Bytes {
        self.text.get_or_init(|| message(&self.value)).clone()
    }
}

/// Serialised text of a message. Cannot fail: maps in the protocol's types have string keys only.
pub(super) fn text_of(message: &impl Serialize) -> Utf8Bytes {
    serde_json::to_string(message).unwrap_or_default().into()
}

/// A detail without its display. The display is stored separately, since some pages already have it.
struct CachedDetail {
    detail: Detail,
    lcd: Option<Arc<Picture>>,
    /// Version of the display; versions of all messages are numbers of one sequence.
    lcd_version: u64,
    text_without_lcd: OnceLock<Utf8Bytes>,
    text_with_lcd: OnceLock<Utf8Bytes>,
}

impl CachedDetail {
    fn text(&self, with_lcd: bool) -> Utf8Bytes {
        let cached = if with_lcd { &self.text_with_lcd } else { &self.text_without_lcd };
        cached
            .get_or_init(|| {
                let mut detail = self.detail.clone();
                detail.lcd = self.lcd.as_deref().filter(|_| with_lcd).cloned();
                text_of(&Message::Detail(Box::new(detail)))
            })
            .clone()
    }
}

/// The layers of a robot by name, each with its version.
type RobotLayers = BTreeMap<String, (u64, Arc<CachedText<Message>>)>;

#[derive(Default)]
struct State {
    /// Version of the latest message: the number of changes so far.
    version: u64,
    run: u32,
    scene: Option<(u64, Arc<CachedText<Message>>)>,
    snapshot: Option<(u64, Arc<CachedText<Message>>)>,
    build: Option<(u64, Arc<CachedText<Message>>)>,
    details: BTreeMap<u32, (u64, Arc<CachedDetail>)>,
    /// The last layers of programs, by robot.
    layers: BTreeMap<u32, RobotLayers>,
    events: VecDeque<Arc<CachedText<Event>>>,
    /// Number of events that the ring buffer has dropped since the run began.
    dropped_count: u64,
    /// Number of events since the run began that the simulation has omitted.
    omitted_count: u64,
}

impl State {
    /// Begins a run: discards everything of the previous run.
    fn begin_run(&mut self, run: u32) {
        if self.run != run {
            *self = State { run, version: self.version, build: self.build.take(), ..State::default() };
        }
    }

    fn next_version(&mut self) -> u64 {
        self.version += 1;
        self.version
    }
}

#[derive(Default)]
struct Inbox {
    commands: VecDeque<PendingCommand>,
    looks: BTreeMap<u64, Look>,
    pages: u64,
    is_woken: bool,
}

/// State shared by server and simulation.
pub(super) struct Hub {
    state: Mutex<State>,
    /// Wakes the pages.
    changed: watch::Sender<()>,
    inbox: Mutex<Inbox>,
    /// Wakes the simulation.
    command_arrived: Condvar,
}

impl Hub {
    pub(super) fn new() -> Arc<Hub> {
        Arc::new(Hub {
            state: Mutex::default(),
            changed: watch::Sender::new(()),
            inbox: Mutex::default(),
            command_arrived: Condvar::new(),
        })
    }

    pub(super) fn changes(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    pub(super) fn begin_run(&self, run: u32) {
        lock(&self.state).begin_run(run);
    }

    pub(super) fn show_scene(&self, scene: Scene) {
        let mut state = lock(&self.state);
        state.begin_run(scene.run);
        let version = state.next_version();
        state.scene = Some((version, CachedText::new(Message::Scene(Box::new(scene)))));
        drop(state);
        self.changed.send_replace(());
    }

    pub(super) fn show(&self, snapshot: Snapshot, details: Vec<Detail>) {
        let mut state = lock(&self.state);
        let version = state.next_version();
        state.snapshot = Some((version, CachedText::new(Message::Snapshot(snapshot))));
        for mut detail in details {
            let version = state.next_version();
            let previous = state
                .details
                .get(&detail.robot)
                .map(|(_, previous)| previous)
                .filter(|previous| previous.detail.run == detail.run);
            let (lcd, lcd_version) = match (detail.lcd.take(), previous) {
                (Some(new), _) => (Some(Arc::new(new)), version),
                (None, Some(previous)) => (previous.lcd.clone(), previous.lcd_version),
                (None, None) => (None, 0),
            };
            let cached = CachedDetail {
                lcd,
                lcd_version,
                text_without_lcd: OnceLock::new(),
                text_with_lcd: OnceLock::new(),
                detail,
            };
            state.details.insert(cached.detail.robot, (version, Arc::new(cached)));
        }
        drop(state);
        self.changed.send_replace(());
    }

    pub(super) fn show_layers(&self, layers: Vec<Layer>) {
        if layers.is_empty() {
            return;
        }
        let mut state = lock(&self.state);
        for layer in layers {
            let version = state.next_version();
            let of_robot = state.layers.entry(layer.robot).or_default();
            of_robot.insert(layer.name.clone(), (version, CachedText::new(Message::Layer(layer))));
        }
        drop(state);
        self.changed.send_replace(());
    }

    pub(super) fn add_events(&self, events: Vec<Event>, omitted: u32) {
        let mut state = lock(&self.state);
        state.omitted_count += u64::from(omitted);
        for event in events {
            if state.events.len() == MAX_EVENTS {
                state.events.pop_front();
                state.dropped_count += 1;
            }
            state.events.push_back(CachedText::new(event));
        }
        drop(state);
        self.changed.send_replace(());
    }

    pub(super) fn build(&self, build: Build) {
        let mut state = lock(&self.state);
        let version = state.next_version();
        state.build = Some((version, CachedText::new(Message::Build(build))));
        drop(state);
        self.changed.send_replace(());
    }

    pub(super) fn pages(&self) -> usize {
        self.changed.receiver_count()
    }

    pub(super) fn looks(&self) -> Vec<Look> {
        let inbox = lock(&self.inbox);
        let mut merged: BTreeMap<u32, Look> = BTreeMap::new();
        for look in inbox.looks.values() {
            let merged_look =
                merged.entry(look.robot).or_insert(Look { robot: look.robot, camera: false, calls: false });
            merged_look.camera |= look.camera;
            merged_look.calls |= look.calls;
        }
        merged.into_values().collect()
    }

    /// Assigns a number to a new page.
    pub(super) fn register_page(&self) -> u64 {
        let mut inbox = lock(&self.inbox);
        inbox.pages += 1;
        inbox.pages
    }

    pub(super) fn set_look(&self, page: u64, look: Option<Look>) {
        let mut inbox = lock(&self.inbox);
        match look {
            Some(look) => inbox.looks.insert(page, look),
            None => inbox.looks.remove(&page),
        };
        inbox.is_woken = true;
        drop(inbox);
        self.command_arrived.notify_all();
    }

    /// Queues a command for the simulation; returns it if the queue is full.
    pub(super) fn enqueue(&self, pending: PendingCommand) -> Result<(), PendingCommand> {
        let mut inbox = lock(&self.inbox);
        if inbox.commands.len() == MAX_COMMANDS {
            return Err(pending);
        }
        inbox.commands.push_back(pending);
        drop(inbox);
        self.command_arrived.notify_all();
        Ok(())
    }
}

/// A page's command, which waits to be carried out. Dropping the value without an answer refuses the command.
pub struct PendingCommand {
    /// The command.
    pub command: Command,
    pub(super) number: u32,
    pub(super) answers: Option<mpsc::UnboundedSender<Answer>>,
}

impl PendingCommand {
    /// Reports to the page that its command has been carried out.
    pub fn accept(mut self) {
        self.answer(None);
    }

    /// Reports to the page why its command has not been carried out.
    pub fn refuse(mut self, why: impl Into<String>) {
        self.answer(Some(why.into()));
    }

    fn answer(&mut self, refused: Option<String>) {
        if let Some(answers) = self.answers.take() {
            // A page that has disconnected needs no answer.
            let _ = answers.send(Answer { number: self.number, refused });
        }
    }
}

impl Drop for PendingCommand {
    fn drop(&mut self) {
        self.answer(Some("the run accepts no more commands".into()));
    }
}

impl std::fmt::Debug for PendingCommand {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PendingCommand")
            .field("number", &self.number)
            .field("command", &self.command)
            .finish_non_exhaustive()
    }
}

/// Commands of all pages, in order of arrival.
#[derive(Clone)]
pub struct Commands {
    pub(super) hub: Arc<Hub>,
}

impl Commands {
    /// Takes the next command, if there is one.
    #[must_use]
    pub fn try_recv(&self) -> Option<PendingCommand> {
        lock(&self.hub.inbox).commands.pop_front()
    }

    /// Takes the next command, waiting at most for `timeout`. Also returns `None` when [`looks`](super::Window::looks)
    /// has changed or after [`wake`](Self::wake).
    #[must_use]
    pub fn recv_timeout(&self, timeout: Duration) -> Option<PendingCommand> {
        let until = Instant::now() + timeout;
        let mut inbox = lock(&self.hub.inbox);
        loop {
            if let Some(pending) = inbox.commands.pop_front() {
                return Some(pending);
            }
            let remaining = until.saturating_duration_since(Instant::now());
            if std::mem::take(&mut inbox.is_woken) || remaining.is_zero() {
                return None;
            }
            inbox = self.hub.command_arrived.wait_timeout(inbox, remaining).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Ends a wait in [`recv_timeout`](Self::recv_timeout).
    pub fn wake(&self) {
        lock(&self.hub.inbox).is_woken = true;
        self.hub.command_arrived.notify_all();
    }
}

/// Versions of the messages that a page has already received.
#[derive(Default)]
pub(super) struct SentVersions {
    run: u32,
    scene: u64,
    snapshot: u64,
    build: u64,
    detail: u64,
    lcd: Option<(u32, u64)>,
    /// Version of the newest layer sent of the selected robot.
    layer: u64,
    /// Number of events of the run that the page has received or missed, without the omitted ones.
    events: u64,
    /// Number of omitted events of the run that the page knows of.
    omitted: u64,
}

impl SentVersions {
    /// Forgets the detail and the layers, so that they are sent again, with the display: the page has selected another
    /// robot or a new run began.
    pub(super) fn forget_detail(&mut self) {
        self.detail = 0;
        self.lcd = None;
        self.layer = 0;
    }

    /// New messages for a page with the request `look`, in the order of sending.
    pub(super) fn new_messages(&mut self, hub: &Hub, look: Option<Look>) -> Vec<Utf8Bytes> {
        let messages = self.collect(&lock(&hub.state), look);
        // Texts are serialised outside the lock, so that the simulation never waits for them.
        messages.into_iter().map(NewMessage::text).collect()
    }

    fn collect(&mut self, state: &State, look: Option<Look>) -> Vec<NewMessage> {
        let mut messages = Vec::new();
        if self.run != state.run {
            (self.run, self.events, self.omitted) = (state.run, 0, 0);
            self.forget_detail();
        }
        for (sent, current) in
            [(&mut self.build, &state.build), (&mut self.scene, &state.scene), (&mut self.snapshot, &state.snapshot)]
        {
            if let Some((version, message)) = current
                && *version > *sent
            {
                *sent = *version;
                messages.push(NewMessage::Message(message.clone()));
            }
        }
        if let Some((version, detail)) = look.and_then(|look| state.details.get(&look.robot))
            && *version > self.detail
        {
            self.detail = *version;
            let lcd = Some((detail.detail.robot, detail.lcd_version));
            messages.push(NewMessage::Detail(detail.clone(), self.lcd != lcd));
            self.lcd = lcd;
        }
        let layers = look.and_then(|look| state.layers.get(&look.robot)).into_iter().flat_map(BTreeMap::values);
        let new: Vec<_> = layers.filter(|(version, _)| *version > self.layer).collect();
        self.layer = new.iter().map(|(version, _)| *version).max().unwrap_or(self.layer);
        messages.extend(new.into_iter().map(|(_, message)| NewMessage::Message(message.clone())));
        // A page discards its events when it receives the scene of another run.
        if state.scene.is_some() {
            self.take_events(state, look, &mut messages);
        }
        messages
    }

    fn take_events(&mut self, state: &State, look: Option<Look>, messages: &mut Vec<NewMessage>) {
        let mut missed = state.dropped_count.saturating_sub(self.events) + (state.omitted_count - self.omitted);
        self.omitted = state.omitted_count;
        let first = usize::try_from(self.events.max(state.dropped_count) - state.dropped_count).unwrap_or(usize::MAX);
        let wanted: Vec<_> =
            state.events.iter().skip(first).filter(|event| is_wanted(&event.value, look)).cloned().collect();
        self.events = state.dropped_count + state.events.len() as u64;
        for batch in wanted.chunks(MAX_BATCH) {
            messages.push(NewMessage::Events(batch.to_vec(), std::mem::take(&mut missed)));
        }
        if missed > 0 {
            messages.push(NewMessage::Events(Vec::new(), missed));
        }
    }
}

/// Returns true unless the event is a RoBIOS call that the page has not requested.
fn is_wanted(event: &Event, look: Option<Look>) -> bool {
    event.kind != "call" || look.is_some_and(|look| look.calls && Some(look.robot) == event.robot)
}

enum NewMessage {
    Message(Arc<CachedText<Message>>),
    Detail(Arc<CachedDetail>, bool),
    Events(Vec<Arc<CachedText<Event>>>, u64),
}

impl NewMessage {
    fn text(self) -> Utf8Bytes {
        match self {
            NewMessage::Message(message) => message.text(text_of),
            NewMessage::Detail(detail, with_lcd) => detail.text(with_lcd),
            NewMessage::Events(events, missed) => {
                // Format of `Message::Events`, composed of existing texts.
                let texts: Vec<_> = events.iter().map(|event| event.text(text_of)).collect();
                let texts: Vec<_> = texts.iter().map(Utf8Bytes::as_str).collect();
                format!(r#"{{"type":"events","events":[{}],"missed":{missed}}}"#, texts.join(",")).into()
            }
        }
    }
}
