//! Connection to one page: handshake, messages in both directions, and its end.

use std::time::Duration;

use axum::extract::ws::{CloseFrame, Message as Frame, Utf8Bytes, WebSocket};
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until, timeout};

use super::Server;
use crate::protocol::{Answer, Command, Message, PROTOCOL, Request, Welcome};
use crate::window::Look;
use crate::window::hub::{PendingCommand, SentVersions, text_of};

/// Maximum length of a message from a page, in bytes.
pub(super) const MAX_MESSAGE_BYTES: usize = 64 * 1024;
/// Time limit for the first message.
const HELLO_TIMEOUT: Duration = Duration::from_secs(5);
/// Delay after a wrong token, against guessing.
const WRONG_TOKEN_DELAY: Duration = Duration::from_millis(500);
/// Interval between two pings of a page.
const PING_INTERVAL: Duration = Duration::from_secs(5);
/// Time after which a page that reads or sends nothing is disconnected.
const STALL_TIMEOUT: Duration = Duration::from_secs(15);
/// Minimum speed at which a page must read a long message; a slower page is disconnected.
const MIN_BYTES_PER_SECOND: u64 = 10_000;
/// Minimum time between two updates of a page: 60 a second.
const UPDATE_INTERVAL: Duration = Duration::from_millis(16);
/// Rate limit of a page's messages: on average one per `READ_INTERVAL` (200 a second), with bursts that exceed this
/// rate by up to `READ_BURST` (100 messages).
const READ_INTERVAL: Duration = Duration::from_millis(5);
const READ_BURST: Duration = Duration::from_millis(500);
/// Maximum number of unanswered commands of one page.
const MAX_UNANSWERED: usize = 32;

/// Close frame of the server at the end of a connection.
#[derive(Debug)]
struct CloseReason {
    code: u16,
    text: String,
}

/// Close codes of RFC 6455 and of the protocol.
mod code {
    pub(super) const GOING_AWAY: u16 = 1001;
    pub(super) const PROTOCOL_ERROR: u16 = 1002;
    pub(super) const NOT_TEXT: u16 = 1003;
    pub(super) const TOO_BIG: u16 = 1009;
    pub(super) const TRY_LATER: u16 = 1013;
    pub(super) const MALFORMED: u16 = 4400;
    pub(super) const TOKEN: u16 = 4401;
    pub(super) const VERSION: u16 = 4406;
    pub(super) const SILENT: u16 = 4408;
}

impl CloseReason {
    fn new(code: u16, text: impl Into<String>) -> CloseReason {
        CloseReason { code, text: text.into() }
    }
}

/// End of a connection: with a close frame, or `None` if the page is disconnected or does not respond.
type End = Option<CloseReason>;

/// Serves one page until it disconnects or is disconnected.
pub(super) async fn serve(mut socket: WebSocket, server: &Server) {
    let mut closing = server.closing.subscribe();
    let end = tokio::select! {
        end = serve_page(&mut socket, server) => end,
        _ = closing.wait_for(|closing| *closing) => Some(CloseReason::new(code::GOING_AWAY, "the simulator has ended")),
    };
    if let Some(reason) = end {
        close(socket, reason).await;
    }
}

/// Refuses a page; `reason` is the text of the close frame.
pub(super) async fn refuse(socket: WebSocket, reason: &str) {
    close(socket, CloseReason::new(code::TRY_LATER, reason)).await;
}

async fn close(mut socket: WebSocket, reason: CloseReason) {
    // A close frame has room for 123 bytes.
    let mut text = reason.text;
    text.truncate(text.floor_char_boundary(123));
    let closing_handshake = async {
        let frame = CloseFrame { code: reason.code, reason: text.into() };
        if socket.send(Frame::Close(Some(frame))).await.is_ok() {
            // Reads the remaining messages of the page: otherwise the system would drop the close frame together with
            // the connection.
            while let Some(Ok(_)) = socket.recv().await {}
        }
    };
    let _ = timeout(Duration::from_secs(1), closing_handshake).await;
}

async fn serve_page(socket: &mut WebSocket, server: &Server) -> End {
    let may_act = match timeout(HELLO_TIMEOUT, hello(socket, server)).await {
        Err(_) => return Some(CloseReason::new(code::SILENT, "no `hello` within 5 s")),
        Ok(Err(end)) => return end,
        Ok(Ok(may_act)) => may_act,
    };
    let welcome = Message::Welcome(Welcome {
        protocol: PROTOCOL,
        version: server.version.clone(),
        title: server.title.clone(),
        may_act,
    });
    let (answers, answered) = mpsc::unbounded_channel();
    let mut page = PageConnection {
        id: server.hub.register_page(),
        server,
        may_act,
        look: None,
        sent: SentVersions::default(),
        answers,
        unanswered: 0,
    };
    match send(socket, text_of(&welcome)).await {
        Ok(()) => page.run(socket, answered).await,
        Err(end) => end,
    }
}

/// Receives the first message; returns true if the page may act.
async fn hello(socket: &mut WebSocket, server: &Server) -> Result<bool, End> {
    let text = loop {
        if let Some(text) = receive(socket.recv().await)? {
            break text;
        }
    };
    let Request::Hello { protocol, token } = parse(&text)? else {
        return Err(Some(CloseReason::new(code::MALFORMED, "the first message is not `hello`")));
    };
    if protocol != PROTOCOL {
        let reason =
            format!("the page speaks version {protocol} of the protocol, the server {PROTOCOL}: load the page again");
        return Err(Some(CloseReason::new(code::VERSION, reason)));
    }
    match server.access.may_act(token.as_deref()) {
        Some(may_act) => Ok(may_act),
        None => {
            tokio::time::sleep(WRONG_TOKEN_DELAY).await;
            Err(Some(CloseReason::new(code::TOKEN, "the token is wrong")))
        }
    }
}

fn parse(text: &str) -> Result<Request, End> {
    serde_json::from_str(text).map_err(|error| Some(CloseReason::new(code::MALFORMED, error.to_string())))
}

/// The text of a frame, if it has one.
fn receive(frame: Option<Result<Frame, axum::Error>>) -> Result<Option<Utf8Bytes>, End> {
    match frame {
        Some(Ok(Frame::Text(text))) => Ok(Some(text)),
        Some(Ok(Frame::Ping(_) | Frame::Pong(_))) => Ok(None),
        Some(Ok(Frame::Binary(_))) => Err(Some(CloseReason::new(code::NOT_TEXT, "messages must be text"))),
        Some(Ok(Frame::Close(_))) | None => Err(None),
        Some(Err(error)) if error.to_string().contains("too long") => {
            Err(Some(CloseReason::new(code::TOO_BIG, format!("messages have at most {MAX_MESSAGE_BYTES} bytes"))))
        }
        // A violation of the protocol or a lost connection, to which no close frame is delivered.
        Some(Err(error)) => Err(Some(CloseReason::new(code::PROTOCOL_ERROR, error.to_string()))),
    }
}

async fn send(socket: &mut WebSocket, text: Utf8Bytes) -> Result<(), End> {
    let limit = send_timeout(text.len());
    send_frame(socket, Frame::Text(text), limit).await
}

async fn send_frame(socket: &mut WebSocket, frame: Frame, limit: Duration) -> Result<(), End> {
    // A page that reads nothing would not receive a close frame either.
    timeout(limit, socket.send(frame)).await.ok().and_then(Result::ok).ok_or(None)
}

/// Time limit for sending a message of this length.
fn send_timeout(bytes: usize) -> Duration {
    STALL_TIMEOUT + Duration::from_secs(bytes as u64 / MIN_BYTES_PER_SECOND)
}

/// A connection to a page after its `hello`.
struct PageConnection<'a> {
    id: u64,
    server: &'a Server,
    may_act: bool,
    look: Option<Look>,
    sent: SentVersions,
    answers: mpsc::UnboundedSender<Answer>,
    unanswered: usize,
}

impl Drop for PageConnection<'_> {
    fn drop(&mut self) {
        self.server.hub.set_look(self.id, None);
    }
}

impl PageConnection<'_> {
    /// Serves the page. It never reads while it writes, so that a page that reads nothing cannot fill a queue here.
    async fn run(&mut self, socket: &mut WebSocket, mut answered: mpsc::UnboundedReceiver<Answer>) -> End {
        match self.exchange_messages(socket, &mut answered).await {
            Ok(never) => match never {},
            Err(end) => end,
        }
    }

    async fn exchange_messages(
        &mut self,
        socket: &mut WebSocket,
        answered: &mut mpsc::UnboundedReceiver<Answer>,
    ) -> Result<std::convert::Infallible, End> {
        let mut changes = self.server.hub.changes();
        changes.mark_changed();
        let mut ping = interval(PING_INTERVAL);
        ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut last_heard = Instant::now();
        let (mut next_update, mut next_read) = (last_heard, last_heard);
        loop {
            let now = Instant::now();
            tokio::select! {
                Ok(()) = changes.changed(), if now >= next_update => {
                    let start = Instant::now();
                    for text in self.sent.new_messages(&self.server.hub, self.look) {
                        send(socket, text).await?;
                    }
                    // While the server writes, it does not hear the page.
                    last_heard += start.elapsed();
                    next_update = now + UPDATE_INTERVAL;
                }
                () = sleep_until(next_update), if now < next_update => {}
                frame = socket.recv(), if now + READ_BURST >= next_read => {
                    last_heard = now;
                    next_read = next_read.max(now) + READ_INTERVAL;
                    if let Some(text) = receive(frame)?
                        && self.handle_request(parse(&text)?)?
                    {
                        changes.mark_changed();
                    }
                }
                () = sleep_until(next_read - READ_BURST), if now + READ_BURST < next_read => {}
                Some(answer) = answered.recv() => {
                    self.unanswered -= 1;
                    send(socket, text_of(&Message::Answer(answer))).await?;
                }
                _ = ping.tick() => {
                    if last_heard.elapsed() > STALL_TIMEOUT {
                        return Err(None);
                    }
                    send_frame(socket, Frame::Ping(Vec::new().into()), STALL_TIMEOUT).await?;
                }
            }
        }
    }

    /// Carries out a request; returns true if there may be new messages for the page.
    fn handle_request(&mut self, request: Request) -> Result<bool, End> {
        match request {
            Request::Hello { .. } => Err(Some(CloseReason::new(code::MALFORMED, "`hello` must be the first message"))),
            Request::Look { robot, camera, calls } => {
                self.look = robot.map(|robot| Look { robot, camera, calls });
                self.sent.forget_detail();
                self.server.hub.set_look(self.id, self.look);
                Ok(true)
            }
            Request::Act { number, command } => {
                self.act(number, command);
                Ok(false)
            }
        }
    }

    fn act(&mut self, number: u32, command: Command) {
        let pending = PendingCommand { command, number, answers: Some(self.answers.clone()) };
        self.unanswered += 1;
        if !self.may_act {
            pending.refuse("this page may only watch: it has no token");
        } else if self.unanswered > MAX_UNANSWERED {
            pending.refuse("too many commands of this page are waiting");
        } else if let Err(pending) = self.server.hub.enqueue(pending) {
            pending.refuse("too many commands are waiting");
        }
    }
}
