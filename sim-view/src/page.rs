//! The page as it is served: files that Vite has built.

use std::collections::BTreeMap;

/// The files of the page, or why there are none.
#[derive(Clone, Debug, Default)]
pub struct Page {
    files: BTreeMap<String, Vec<u8>>,
    missing: String,
}

impl Page {
    /// A page of these files, by their paths below the page's folder.
    #[must_use]
    pub fn of(files: BTreeMap<String, Vec<u8>>) -> Page {
        Page { files, missing: String::new() }
    }

    /// No page: who asks for it reads `why`.
    #[must_use]
    pub fn missing(why: &str) -> Page {
        Page { files: BTreeMap::new(), missing: why.into() }
    }

    /// The content and the media type of the file at a path such as `index.html`.
    #[must_use]
    pub fn file(&self, path: &str) -> Option<(&[u8], &'static str)> {
        let content = self.files.get(path)?;
        Some((content, media_type(path)))
    }

    /// Why there is no page; none if there is one.
    #[must_use]
    pub fn why_missing(&self) -> Option<&str> {
        self.files.is_empty().then_some(self.missing.as_str())
    }
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
