//! HTTP server of the page: routes, downloads, and limits of connections.

mod socket;

use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Extension, Router};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::AbortHandle;
use tokio::time::{Instant, sleep, sleep_until, timeout};

use super::access::refusal;
use super::hub::{Hub, lock};
use super::{Access, Options};
use crate::page::Page;

/// Maximum number of pages served at a time.
const MAX_PAGES: usize = 64;
/// Maximum number of pages of one address, so that no machine occupies the whole server. A class behind one router
/// shares this limit; pages on this machine have no such limit.
const MAX_PAGES_OF_ADDRESS: usize = 48;
/// Maximum number of pages beyond [`MAX_PAGES`] that are refused by a close frame with the reason; any further page
/// gets an HTTP error.
const MAX_REFUSED: usize = 32;
/// Maximum number of connections that are not pages yet; a new connection replaces the oldest one of the address with
/// the most connections.
const MAX_CONNECTIONS: usize = 128;
/// Maximum number of connections accepted in each tenth of a second.
const MAX_ACCEPTS: u32 = 100;
/// Time limit for the header of a request.
const HEAD_TIMEOUT: Duration = Duration::from_secs(5);
/// Time limit for a connection that is not a page, with all its requests.
const REQUESTS_TIMEOUT: Duration = Duration::from_secs(300);

/// Download for pages. Its content is generated on request, on a blocking thread.
#[derive(Clone)]
pub struct Download {
    media_type: &'static str,
    content: Arc<Content>,
}

type Content = dyn Fn() -> Result<Vec<u8>, String> + Send + Sync;

impl Download {
    /// A download of a media type such as `application/toml`. If `content` fails, the page gets the error message.
    pub fn new(
        media_type: &'static str,
        content: impl Fn() -> Result<Vec<u8>, String> + Send + Sync + 'static,
    ) -> Download {
        Download { media_type, content: Arc::new(content) }
    }
}

impl fmt::Debug for Download {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Download").field("media_type", &self.media_type).finish_non_exhaustive()
    }
}

/// State shared by all connections.
pub(super) struct Server {
    address: SocketAddr,
    access: Access,
    title: String,
    version: String,
    page: Page,
    hub: Arc<Hub>,
    files: Mutex<BTreeMap<String, Download>>,
    /// Number of open sockets, including those being refused.
    sockets: AtomicUsize,
    /// Number of open sockets of each address.
    addresses: Mutex<BTreeMap<IpAddr, usize>>,
    /// Permits for concurrently generated downloads.
    generation_permits: Arc<Semaphore>,
    closing: watch::Sender<bool>,
}

impl Server {
    pub(super) fn new(address: SocketAddr, options: Options, page: Page, hub: Arc<Hub>) -> Arc<Server> {
        Arc::new(Server {
            address,
            access: options.access,
            title: options.title,
            version: options.version,
            page,
            hub,
            files: Mutex::default(),
            sockets: AtomicUsize::new(0),
            addresses: Mutex::default(),
            generation_permits: Arc::new(Semaphore::new(2)),
            closing: watch::Sender::new(false),
        })
    }

    pub(super) fn offer(&self, name: &str, download: Download) {
        lock(&self.files).insert(name.into(), download);
    }

    /// Disconnects all pages; then [`serve`] returns.
    pub(super) fn close(&self) {
        self.closing.send_replace(true);
    }
}

/// Serves until [`Server::close`].
pub(super) async fn serve(server: Arc<Server>, listener: std::net::TcpListener) {
    let Ok(listener) = TcpListener::from_std(listener) else { return };
    let routes = Router::new()
        .route("/", get(index))
        .route("/ws", get(open_socket))
        .route("/recording.json", get(recording))
        .route("/files/{name}", get(file))
        .route("/{*path}", get(asset))
        .layer(from_fn_with_state(server.clone(), guard))
        .with_state(server.clone());
    let mut closing = server.closing.subscribe();
    tokio::select! {
        () = accept(listener, routes) => {}
        _ = closing.wait_for(|closing| *closing) => {}
    }
    let pages_closed = async {
        while server.sockets.load(Ordering::Relaxed) > 0 {
            sleep(Duration::from_millis(5)).await;
        }
    };
    let _ = timeout(Duration::from_millis(500), pages_closed).await;
}

async fn accept(listener: TcpListener, routes: Router) {
    let mut connections: VecDeque<(IpAddr, AbortHandle)> = VecDeque::new();
    let mut accepted = 0;
    let mut period_start = Instant::now();
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            // The process is out of file descriptors, or the client has already disconnected.
            sleep(Duration::from_millis(50)).await;
            continue;
        };
        if period_start.elapsed() > Duration::from_millis(100) {
            (period_start, accepted) = (Instant::now(), 0);
        }
        accepted += 1;
        if accepted > MAX_ACCEPTS {
            sleep_until(period_start + Duration::from_millis(100)).await;
        }
        let address = peer.ip().to_canonical();
        connections.retain(|(_, connection)| !connection.is_finished());
        if connections.len() == MAX_CONNECTIONS {
            let oldest = connection_to_replace(connections.iter().map(|(address, _)| *address));
            connections.remove(oldest).into_iter().for_each(|(_, connection)| connection.abort());
        }
        let routes = routes.clone().layer(Extension(address));
        connections.push_back((
            address,
            tokio::spawn(timeout(REQUESTS_TIMEOUT, serve_connection(stream, routes))).abort_handle(),
        ));
    }
}

/// Index of the oldest connection of the address with the most connections; `addresses` go from the oldest to the
/// newest connection.
fn connection_to_replace(addresses: impl Iterator<Item = IpAddr> + Clone) -> usize {
    let mut counts: BTreeMap<IpAddr, usize> = BTreeMap::new();
    addresses.clone().for_each(|address| *counts.entry(address).or_default() += 1);
    let max_count = counts.values().copied().max();
    addresses.clone().position(|address| counts.get(&address).copied() == max_count).unwrap_or(0)
}

/// Serves the requests of one connection. A connection that becomes a socket continues in a separate task.
async fn serve_connection(stream: TcpStream, routes: Router) {
    let _ = stream.set_nodelay(true);
    // Errors are caused by the client, which has disconnected or has sent invalid HTTP and got an error response.
    let _ = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIMEOUT)
        .max_buf_size(64 * 1024)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes))
        .with_upgrades()
        .await;
}

/// Refuses requests that do not come from this server's page, and adds the common headers to every response.
async fn guard(State(server): State<Arc<Server>>, request: Request, next: Next) -> Response {
    const HEADERS: [(HeaderName, HeaderValue); 4] = [
        (
            header::CONTENT_SECURITY_POLICY,
            HeaderValue::from_static(
                "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; \
                 connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
            ),
        ),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
        (HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin")),
    ];
    let mut response = match refusal(request.headers(), server.address, request.uri().path() == "/ws") {
        Some(why) => (StatusCode::FORBIDDEN, why).into_response(),
        None => next.run(request).await,
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, value);
    }
    response.headers_mut().entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-cache"));
    response
}

async fn index(State(server): State<Arc<Server>>) -> Response {
    page_file(&server, "index.html")
}

async fn asset(State(server): State<Arc<Server>>, Path(path): Path<String>) -> Response {
    page_file(&server, &path)
}

fn page_file(server: &Server, path: &str) -> Response {
    if let Some((content, media_type)) = server.page.file(path) {
        return ([(header::CONTENT_TYPE, media_type)], content).into_response();
    }
    match server.page.why_missing() {
        Some(why) if path == "index.html" => (StatusCode::SERVICE_UNAVAILABLE, why.to_owned()).into_response(),
        _ => (StatusCode::NOT_FOUND, "there is no such file").into_response(),
    }
}

async fn recording(State(server): State<Arc<Server>>) -> Response {
    download(&server, "recording.json", false).await
}

async fn file(State(server): State<Arc<Server>>, Path(name): Path<String>) -> Response {
    download(&server, &name, true).await
}

async fn download(server: &Server, name: &str, is_saved: bool) -> Response {
    let found = lock(&server.files).get(name).cloned();
    let Some(Download { media_type, content }) = found else {
        return (StatusCode::NOT_FOUND, "there is no such file").into_response();
    };
    // Some downloads are large: only a few are generated at a time, and the permit is held even if the client has
    // disconnected.
    let Ok(permit) = Arc::clone(&server.generation_permits).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "other downloads are being generated: try again in a moment")
            .into_response();
    };
    let content = tokio::task::spawn_blocking(move || {
        let content = content();
        drop(permit);
        content
    })
    .await;
    let content = match content {
        Ok(Ok(content)) => content,
        Ok(Err(why)) => return (StatusCode::SERVICE_UNAVAILABLE, why).into_response(),
        Err(_) => return (StatusCode::INTERNAL_SERVER_ERROR, "it could not be generated").into_response(),
    };
    let mut response = ([(header::CONTENT_TYPE, media_type)], content).into_response();
    if is_saved && let Ok(value) = HeaderValue::from_str(&format!("attachment; filename=\"{}\"", header_safe(name))) {
        response.headers_mut().insert(header::CONTENT_DISPOSITION, value);
    }
    response
}

/// Replaces characters of a name that would need quoting in a header.
fn header_safe(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_. ".contains(c) { c } else { '_' }).collect()
}

async fn open_socket(
    State(server): State<Arc<Server>>,
    Extension(address): Extension<IpAddr>,
    upgrade: WebSocketUpgrade,
) -> Response {
    let guard = SocketGuard::new(server, address);
    let open = guard.server.sockets.load(Ordering::Relaxed);
    let refused = why_full(open, guard.address_sockets, address.is_loopback());
    let is_crowding = !address.is_loopback() && guard.address_sockets > MAX_PAGES_OF_ADDRESS + MAX_REFUSED / 2;
    if open > MAX_PAGES + MAX_REFUSED || is_crowding {
        return (StatusCode::SERVICE_UNAVAILABLE, refused.unwrap_or_default()).into_response();
    }
    upgrade
        .max_message_size(socket::MAX_MESSAGE_BYTES)
        .max_frame_size(socket::MAX_MESSAGE_BYTES)
        .read_buffer_size(16 * 1024)
        .write_buffer_size(0)
        .on_upgrade(move |socket| async move {
            match refused {
                Some(why) => socket::refuse(socket, &why).await,
                None => socket::serve(socket, &guard.server).await,
            }
        })
}

/// Reason for refusing a page if `open` pages are open, including this page, and `address_sockets` of them are from its
/// address.
fn why_full(open: usize, address_sockets: usize, is_own_machine: bool) -> Option<String> {
    match () {
        () if open > MAX_PAGES => Some(format!("{MAX_PAGES} pages are open already")),
        () if address_sockets > MAX_PAGES_OF_ADDRESS && !is_own_machine => {
            Some(format!("{MAX_PAGES_OF_ADDRESS} pages of your machine or network are open already"))
        }
        () => None,
    }
}

/// Guard that counts one open socket.
struct SocketGuard {
    server: Arc<Server>,
    address: IpAddr,
    /// Number of open sockets of the address, including this socket.
    address_sockets: usize,
}

impl SocketGuard {
    fn new(server: Arc<Server>, address: IpAddr) -> SocketGuard {
        server.sockets.fetch_add(1, Ordering::Relaxed);
        let address_sockets = {
            let mut addresses = lock(&server.addresses);
            let count = addresses.entry(address).or_default();
            *count += 1;
            *count
        };
        SocketGuard { server, address, address_sockets }
    }
}

impl Drop for SocketGuard {
    fn drop(&mut self) {
        self.server.sockets.fetch_sub(1, Ordering::Relaxed);
        let mut addresses = lock(&self.server.addresses);
        if let Some(count) = addresses.get_mut(&self.address) {
            *count -= 1;
            if *count == 0 {
                addresses.remove(&self.address);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_address_cannot_occupy_all_pages() {
        assert_eq!(why_full(48, 48, false), None);
        assert_eq!(why_full(49, 49, false), Some("48 pages of your machine or network are open already".to_owned()));
        assert_eq!(why_full(50, 1, false), None, "another address");
        assert_eq!(why_full(64, 64, true), None, "the teacher's own machine");
        assert_eq!(why_full(65, 1, false), Some("64 pages are open already".to_owned()));
    }

    #[test]
    fn oldest_connection_of_the_busiest_address_is_replaced() {
        let address = |number| IpAddr::from([10, 0, 0, number]);
        let replaced = |numbers: &[u8]| connection_to_replace(numbers.iter().map(|number| address(*number)));
        assert_eq!(replaced(&[1, 2, 3, 2, 2, 1]), 1);
        assert_eq!(replaced(&[1, 2, 3]), 0);
        assert_eq!(replaced(&[1, 2, 2, 2, 3, 3]), 1);
    }
}
