//! The server: shows a run to pages and brings what they ask for.
//!
//! It runs on one thread of its own. Whoever fills it never waits: not for a page, not for the network, not for texts.

mod access;
mod hub;
mod serve;

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, UdpSocket};
use std::sync::{Arc, Mutex, mpsc};
use std::thread::JoinHandle;
use std::time::Duration;

pub use access::{Access, random_token};
pub use hub::{Asked, Commands};
pub use serve::Download;

use crate::page::Page;
use crate::protocol::{Build, Detail, Event, Scene, Snapshot};
use hub::Hub;
use serve::Server;

/// How the window is opened.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where pages find it; port 0 for any free one.
    pub address: SocketAddr,
    /// Who may watch and who may act.
    pub access: Access,
    /// Name of the scene.
    pub title: String,
    /// Version of the simulator.
    pub version: String,
}

/// Why a window cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// Somebody else listens there.
    #[error("`{0}` is taken by another program: choose another port, or 0 for any free one")]
    Taken(SocketAddr),
    /// This machine has no such address.
    #[error("`{0}` is not an address of this machine")]
    NoAddress(SocketAddr),
    /// A class without a token.
    #[error("the teacher's token is empty")]
    NoToken,
    /// Everything else.
    #[error("cannot open the window at `{0}`: {1}")]
    Other(SocketAddr, io::Error),
}

/// A robot that some page looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Its number.
    pub robot: u32,
    /// With what its camera sees.
    pub camera: bool,
    /// With its RoBIOS calls among the events.
    pub calls: bool,
}

/// An open window. Dropping it says goodbye to its pages and closes it.
pub struct Window {
    address: SocketAddr,
    access: Access,
    hub: Arc<Hub>,
    commands: Commands,
    server: Arc<Server>,
    /// Tells that the thread is about to end. Several threads of the simulator share a window.
    done: Mutex<mpsc::Receiver<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Window {
    /// Opens a window that serves `page`.
    ///
    /// # Errors
    /// [`OpenError`], such as for a port that is taken.
    pub fn open(options: Options, page: Page) -> Result<Window, OpenError> {
        let other = |error| OpenError::Other(options.address, error);
        if matches!(&options.access, Access::Class { token } if token.is_empty()) {
            return Err(OpenError::NoToken);
        }
        let listener = TcpListener::bind(options.address).map_err(|error| match error.kind() {
            io::ErrorKind::AddrInUse => OpenError::Taken(options.address),
            io::ErrorKind::AddrNotAvailable => OpenError::NoAddress(options.address),
            _ => other(error),
        })?;
        listener.set_nonblocking(true).map_err(other)?;
        let address = listener.local_addr().map_err(other)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build().map_err(other)?;
        let hub = Hub::new();
        let access = options.access.clone();
        let server = Server::new(address, options, page, hub.clone());
        let (end, done) = mpsc::channel();
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
        Ok(Window { address, access, hub, commands, server, done: Mutex::new(done), thread: Some(thread) })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What opens in the browser of whoever started it: with the token, if there is one, where no server sees it.
    #[must_use]
    pub fn url(&self) -> String {
        match &self.access {
            Access::Local => self.public_url(),
            Access::Class { token } => format!("{}#token={token}", self.public_url()),
        }
    }

    /// What others open: without the token.
    #[must_use]
    pub fn public_url(&self) -> String {
        format!("http://{}/", SocketAddr::new(reachable(self.address.ip()), self.address.port()))
    }

    /// Shows what there is to see: at first, when a run starts and when its bodies have changed. A new number of the run
    /// empties the list of events.
    pub fn show_scene(&self, scene: Scene) {
        self.hub.show_scene(scene);
    }

    /// Shows where everything is now, with details of the robots that [`looks`](Self::looks) names. Pages that are slow skip
    /// what is shown before they are ready. A detail without a display keeps that of the robot's detail before.
    pub fn show(&self, snapshot: Snapshot, details: Vec<Detail>) {
        self.hub.show(snapshot, details);
    }

    /// Tells what has happened; the last 20,000 events of the run are kept for pages that come later. Events of kind `call`
    /// go only to pages that look at the robot with its calls.
    pub fn tell(&self, events: Vec<Event>) {
        self.hub.tell(events);
    }

    /// Shows how the building of programs goes.
    pub fn build(&self, build: Build) {
        self.hub.build(build);
    }

    /// The robots that pages look at, each with all that any page wants of it, in order of their numbers.
    #[must_use]
    pub fn looks(&self) -> Vec<Look> {
        self.hub.looks()
    }

    /// How many pages watch.
    #[must_use]
    pub fn pages(&self) -> usize {
        self.hub.pages()
    }

    /// Whether anybody watches.
    #[must_use]
    pub fn has_pages(&self) -> bool {
        self.pages() > 0
    }

    /// What pages ask for, of those that may act.
    #[must_use]
    pub fn commands(&self) -> &Commands {
        &self.commands
    }

    /// Offers a download as `/files/NAME`, in the place of one of that name. `recording.json` is `/recording.json`, too.
    pub fn offer(&self, name: &str, download: Download) {
        self.server.offer(name, download);
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        self.server.close();
        // A thread that hangs must not keep the process from ending.
        if hub::lock(&self.done).recv_timeout(Duration::from_secs(2)) == Err(mpsc::RecvTimeoutError::Disconnected)
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

/// An address at which others reach this machine, for one that stands for all of them: that of the way to the outside,
/// which is asked for without sending anything.
fn reachable(ip: IpAddr) -> IpAddr {
    if !ip.is_unspecified() {
        return ip;
    }
    let (own, outside): (IpAddr, SocketAddr) = match ip {
        IpAddr::V4(_) => (Ipv4Addr::UNSPECIFIED.into(), ([192, 0, 2, 1], 9).into()),
        IpAddr::V6(_) => (Ipv6Addr::UNSPECIFIED.into(), ([0x2001, 0xdb8, 0, 0, 0, 0, 0, 1], 9).into()),
    };
    let local = UdpSocket::bind((own, 0)).and_then(|socket| {
        socket.connect(outside)?;
        socket.local_addr()
    });
    local.map(|address| address.ip()).ok().filter(|ip| !ip.is_unspecified()).unwrap_or(match ip {
        IpAddr::V4(_) => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(_) => Ipv6Addr::LOCALHOST.into(),
    })
}
