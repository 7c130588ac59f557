//! The server: shows a run to pages and delivers their commands.
//!
//! The server runs on its own thread. The simulation never waits for a page, the network or serialisation.

mod access;
mod hub;
mod serve;

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, UdpSocket};
use std::sync::{Arc, Mutex, mpsc};
use std::thread::JoinHandle;
use std::time::Duration;

pub use access::{Access, random_token};
pub use hub::{Commands, PendingCommand};
pub use serve::Download;

use crate::page::Page;
use crate::protocol::{Build, Detail, Event, Layer, Scene, Snapshot};
use hub::Hub;
use serve::Server;

/// Options of a window.
#[derive(Clone, Debug)]
pub struct Options {
    /// Address of the server; port 0 for any free one.
    pub address: SocketAddr,
    /// Rights of pages to watch and to act.
    pub access: Access,
    /// Name of the scene.
    pub title: String,
    /// Version of the simulator.
    pub version: String,
}

/// Error when opening a window.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Another program listens at this address.
    #[error("`{0}` is taken by another program: choose another port, or 0 for any free one")]
    Taken(SocketAddr),
    /// The address does not belong to this machine.
    #[error("`{0}` is not an address of this machine")]
    NoAddress(SocketAddr),
    /// The token of a class is empty.
    #[error("the teacher's token is empty")]
    NoToken,
    /// Any other error.
    #[error("cannot open the window at `{0}`: {1}")]
    Other(SocketAddr, io::Error),
}

/// Request of pages for details of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Number of the robot.
    pub robot: u32,
    /// True to include pictures of its camera.
    pub camera: bool,
    /// True to include its RoBIOS calls in the events.
    pub calls: bool,
}

/// An open window. Dropping it disconnects its pages and closes it.
pub struct Window {
    address: SocketAddr,
    access: Access,
    hub: Arc<Hub>,
    commands: Commands,
    server: Arc<Server>,
    /// Disconnected when the thread is about to end. The mutex is needed because several threads of the simulator share
    /// a window.
    thread_end: Mutex<mpsc::Receiver<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Window {
    /// Opens a window that serves `page`.
    ///
    /// # Errors
    /// [`OpenError`], such as for a port that is taken.
    pub fn open(options: Options, page: Page) -> Result<Window, OpenError> {
        let other_error = |error| OpenError::Other(options.address, error);
        if matches!(&options.access, Access::Class { token } if token.is_empty()) {
            return Err(OpenError::NoToken);
        }
        let listener = TcpListener::bind(options.address).map_err(|error| match error.kind() {
            io::ErrorKind::AddrInUse => OpenError::Taken(options.address),
            io::ErrorKind::AddrNotAvailable => OpenError::NoAddress(options.address),
            _ => other_error(error),
        })?;
        listener.set_nonblocking(true).map_err(other_error)?;
        let address = listener.local_addr().map_err(other_error)?;
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build().map_err(other_error)?;
        let hub = Hub::new();
        let access = options.access.clone();
        let server = Server::new(address, options, page, hub.clone());
        let (end, thread_end) = mpsc::channel();
        let thread = std::thread::Builder::new()
            .name("window".into())
            .spawn({
                let server = server.clone();
                move || {
                    runtime.block_on(serve::serve(server, listener));
                    runtime.shutdown_background();
                    drop(end);
                }
            })
            .map_err(|error| OpenError::Other(address, error))?;
        let commands = Commands { hub: hub.clone() };
        Ok(Window { address, access, hub, commands, server, thread_end: Mutex::new(thread_end), thread: Some(thread) })
    }

    /// Address at which the server listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// URL for the user who started the window, with the token, if any, in the fragment, which browsers never send to a
    /// server.
    #[must_use]
    pub fn url(&self) -> String {
        match &self.access {
            Access::Local => self.public_url(),
            Access::Class { token } => format!("{}#token={token}", self.public_url()),
        }
    }

    /// URL for other users, without the token.
    #[must_use]
    pub fn public_url(&self) -> String {
        format!("http://{}/", SocketAddr::new(reachable_address(self.address.ip()), self.address.port()))
    }

    /// Begins the run of a number: discards the scene, events, layers and details of the previous run. Events that are
    /// added before the scene is shown reach the pages after it.
    pub fn begin_run(&self, run: u32) {
        self.hub.begin_run(run);
    }

    /// Shows the scene. Must be called before any other state of a run is shown, and when its bodies have changed. A
    /// new run number begins a run.
    pub fn show_scene(&self, scene: Scene) {
        self.hub.show_scene(scene);
    }

    /// Shows the current state, with details of the robots that [`looks`](Self::looks) returns. Slow pages skip
    /// intermediate states. A detail without a display keeps the display of the previous detail.
    pub fn show(&self, snapshot: Snapshot, details: Vec<Detail>) {
        self.hub.show(snapshot, details);
    }

    /// Shows layers of programs. A page receives those of the robot that it has selected; the last one of each name is
    /// kept for pages that connect later.
    pub fn show_layers(&self, layers: Vec<Layer>) {
        self.hub.show_layers(layers);
    }

    /// Adds events; the last 20,000 of the run are kept for pages that connect later. Events of kind `call` go only to
    /// pages that request the calls of this robot. `omitted` is the number of events left out of `events`; pages count
    /// them as missed.
    pub fn add_events(&self, events: Vec<Event>, omitted: u32) {
        self.hub.add_events(events, omitted);
    }

    /// Shows the progress of building the programs.
    pub fn build(&self, build: Build) {
        self.hub.build(build);
    }

    /// Robots selected by pages, each with all details that any page requests, in order of their numbers.
    #[must_use]
    pub fn looks(&self) -> Vec<Look> {
        self.hub.looks()
    }

    /// Number of connected pages.
    #[must_use]
    pub fn pages(&self) -> usize {
        self.hub.pages()
    }

    /// Returns true if a page is connected.
    #[must_use]
    pub fn has_pages(&self) -> bool {
        self.pages() > 0
    }

    /// Commands of the pages that may act.
    #[must_use]
    pub fn commands(&self) -> &Commands {
        &self.commands
    }

    /// Offers a download as `/files/NAME`; replaces an earlier download of that name. `recording.json` is also served
    /// as `/recording.json`.
    pub fn offer(&self, name: &str, download: Download) {
        self.server.offer(name, download);
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        self.server.close();
        // A thread that hangs must not keep the process from ending.
        if hub::lock(&self.thread_end).recv_timeout(Duration::from_secs(2)) == Err(mpsc::RecvTimeoutError::Disconnected)
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

/// Address at which other machines reach this machine. An unspecified address is replaced by the local address of the
/// route to an outside address; finding this route sends nothing.
fn reachable_address(ip: IpAddr) -> IpAddr {
    if !ip.is_unspecified() {
        return ip;
    }
    let (unspecified, outside): (IpAddr, SocketAddr) = match ip {
        IpAddr::V4(_) => (Ipv4Addr::UNSPECIFIED.into(), ([192, 0, 2, 1], 9).into()),
        IpAddr::V6(_) => (Ipv6Addr::UNSPECIFIED.into(), ([0x2001, 0xdb8, 0, 0, 0, 0, 0, 1], 9).into()),
    };
    let local = UdpSocket::bind((unspecified, 0)).and_then(|socket| {
        socket.connect(outside)?;
        socket.local_addr()
    });
    local.map(|address| address.ip()).ok().filter(|ip| !ip.is_unspecified()).unwrap_or(match ip {
        IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
    })
}
