//! Access control: requests that are refused, and pages that may act.

use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, HeaderName, header};

/// Rights of pages to watch and to act.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Access {
    /// Every page may act; for a server at the loopback address.
    Local,
    /// Every page may watch; a page with the token may act.
    Class {
        /// The teacher's token.
        token: String,
    },
}

/// An unguessable token: 128 random bits as 32 hexadecimal digits.
///
/// # Errors
/// If the system provides no random numbers.
pub fn random_token() -> std::io::Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)
        .map_err(|error| std::io::Error::other(format!("the system has no random numbers for a token: {error}")))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Access {
    /// Returns true if a page with this token may act; `None` if its token is wrong.
    pub(super) fn may_act(&self, given: Option<&str>) -> Option<bool> {
        match (self, given) {
            (Access::Local, _) => Some(true),
            (Access::Class { .. }, None) => Some(false),
            (Access::Class { token }, Some(given)) => equals_in_constant_time(token, given).then_some(true),
        }
    }
}

/// Compares two texts; the time depends neither on the contents nor on the length of `secret`.
fn equals_in_constant_time(secret: &str, given: &str) -> bool {
    let secret = secret.as_bytes();
    let mut difference = u8::from(secret.len() != given.len() || secret.is_empty());
    for (index, byte) in given.bytes().enumerate() {
        difference |= byte ^ secret.get(index % secret.len().max(1)).unwrap_or(&0);
        difference = std::hint::black_box(difference);
    }
    difference == 0
}

/// Reason for refusing a request before it is processed; `None` if it is allowed.
///
/// `Host` must be one of the served addresses or `localhost`: an attacker can make another name resolve to this server
/// (DNS rebinding), but not an address. A request made by a page of another origin is refused. A WebSocket request
/// (`is_socket`) must name its origin, since only pages make such a request.
pub(super) fn refusal(headers: &HeaderMap, served: SocketAddr, is_socket: bool) -> Option<String> {
    let Some(host) = text(headers, header::HOST) else {
        return Some("the request has no `Host`".into());
    };
    if !is_served(host, served) {
        return Some(format!("`{}` is not an address of this server", shortened(host)));
    }
    if let Some(origin) = text(headers, header::ORIGIN) {
        let is_same_origin = origin.strip_prefix("http://").is_some_and(|rest| rest.eq_ignore_ascii_case(host));
        return (!is_same_origin).then(|| format!("a page of `{}` may not ask this server", shortened(origin)));
    }
    if is_socket {
        return Some("the request has no `Origin`, which browsers send".into());
    }
    match text(headers, HeaderName::from_static("sec-fetch-site")) {
        None | Some("same-origin" | "none") => None,
        Some(_) => Some("a page of another origin may not ask this server".into()),
    }
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (Some(value), None) => Some(value.to_str().unwrap_or("?")),
        (Some(_), Some(_)) => Some("?"),
        (None, _) => None,
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}

fn is_served(host: &str, served: SocketAddr) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        Some((name, port)) if !port.contains(']') => (name, port.parse().ok()),
        _ => (host, Some(80)),
    };
    if port != Some(served.port()) {
        return false;
    }
    let ip = served.ip();
    if name.eq_ignore_ascii_case("localhost") {
        return ip.is_loopback() || ip.is_unspecified();
    }
    let host_ip: Option<IpAddr> = match name.strip_prefix('[').and_then(|name| name.strip_suffix(']')) {
        Some(ipv6) => ipv6.parse().ok().map(IpAddr::V6),
        None => name.parse().ok().map(IpAddr::V4),
    };
    host_ip.is_some_and(|host_ip| host_ip == ip || ip.is_unspecified())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_served_hosts_are_accepted() {
        let check = |served: &str, host: &str| is_served(host, served.parse().unwrap());
        for host in ["127.0.0.1:8000", "localhost:8000", "LOCALHOST:8000"] {
            assert!(check("127.0.0.1:8000", host), "{host}");
        }
        for host in [
            "127.0.0.1",
            "127.0.0.1:8001",
            "evil.example:8000",
            "[::1]:8000",
            "::1:8000",
            "",
            ":",
            ":8000",
            "10.0.0.1:8000",
        ] {
            assert!(!check("127.0.0.1:8000", host), "{host}");
        }
        assert!(check("[::1]:8000", "[::1]:8000"));
        assert!(check("[::1]:8000", "localhost:8000"));
        assert!(!check("[::1]:8000", "::1:8000"));
        assert!(check("0.0.0.0:80", "192.0.2.7"), "port 80 is the default");
        assert!(check("[::]:8000", "[2001:db8::1]:8000"));
        assert!(!check("0.0.0.0:8000", "evil.example:8000"));
        assert!(!check("192.0.2.7:8000", "localhost:8000"));
    }

    #[test]
    fn only_the_token_grants_permission_to_act() {
        let class = Access::Class { token: "abcabc".into() };
        assert_eq!(class.may_act(None), Some(false));
        assert_eq!(class.may_act(Some("abcabc")), Some(true));
        for wrong in ["", "abc", "abcabcabc", "abcabd", "ABCABC"] {
            assert_eq!(class.may_act(Some(wrong)), None, "{wrong}");
        }
        assert_eq!(Access::Class { token: String::new() }.may_act(Some("")), None, "an empty token is not a token");
        let (first, second) = (random_token().unwrap(), random_token().unwrap());
        assert_eq!(first.len(), 32);
        assert_ne!(first, second);
    }
}
