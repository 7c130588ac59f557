//! The page as served: files built by Vite, embedded in release builds and built on demand in other builds.

mod build;

use std::collections::BTreeMap;
use std::path::Path;

use axum::body::Bytes;

/// Files of the page embedded in release builds; empty in other builds.
static EMBEDDED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/embedded.rs"));

/// Files of the page, or the reason why there are none.
#[derive(Clone, Debug)]
pub struct Page {
    files: Result<BTreeMap<String, Bytes>, String>,
}

/// Reason why there is no page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoPage(String);

impl Page {
    /// Loads the embedded page or, in a checkout, the page built there. Calls `report` if the page has to be built
    /// first, which takes several seconds to a minute.
    #[must_use]
    pub fn load(mut report: impl FnMut(&str)) -> Page {
        if !EMBEDDED.is_empty() {
            let files = EMBEDDED.iter().map(|(name, content)| ((*name).to_owned(), Bytes::from_static(content)));
            return Page { files: Ok(files.collect()) };
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        if !folder.is_dir() {
            return Page::missing("this eyesim was built without its page, and its sources are not here");
        }
        match build::built(&folder, &mut report) {
            Ok(files) => Page::of(files),
            Err(why) => Page::missing(&why),
        }
    }

    /// The page that consists of these files, by path; browsers request `index.html` first.
    #[must_use]
    pub fn of(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Page {
        Page { files: Ok(files.into_iter().map(|(name, content)| (name, content.into())).collect()) }
    }

    /// A missing page: requests are answered with `why`.
    #[must_use]
    pub fn missing(why: &str) -> Page {
        Page { files: Err(why.into()) }
    }

    /// Reason why there is no page; `None` if there is one.
    #[must_use]
    pub fn why_missing(&self) -> Option<&str> {
        self.files.as_ref().err().map(String::as_str)
    }

    /// Content and media type of the file at a path such as `index.html`.
    pub(crate) fn file(&self, path: &str) -> Option<(Bytes, &'static str)> {
        Some((self.files.as_ref().ok()?.get(path)?.clone(), media_type(path)))
    }

    /// The page as one HTML text with scripts and style sheets inlined.
    ///
    /// # Errors
    /// [`NoPage`] with the reason.
    pub fn inlined(&self) -> Result<String, NoPage> {
        let text = |path: &str| {
            let (content, _) = self.file(path)?;
            Some(String::from_utf8_lossy(&content).into_owned())
        };
        if let Some(why) = self.why_missing() {
            return Err(NoPage(why.to_owned()));
        }
        let html = text("index.html").ok_or_else(|| NoPage("the page has no `index.html`".to_owned()))?;
        let mut inlined = String::with_capacity(html.len());
        let mut rest = html.as_str();
        while let Some(start) = rest.find("<script").into_iter().chain(rest.find("<link")).min() {
            let (before, tag) = rest.split_at(start);
            let end = tag.find('>').map_or(tag.len(), |end| end + 1);
            let (tag, after) = tag.split_at(end);
            inlined.push_str(before);
            let path = |name| attribute(tag, name).map(|path| path.trim_start_matches("./"));
            rest = if let Some(script) = path("src").and_then(text) {
                inlined.push_str(&format!("<script type=\"module\">{}</script>", safe_script(&script)));
                after.strip_prefix("</script>").unwrap_or(after)
            } else if let Some(style) = path("href").and_then(text) {
                inlined.push_str(&format!("<style>{}</style>", style.replace("</", "<\\/")));
                after
            } else {
                inlined.push_str(tag);
                after
            };
        }
        inlined.push_str(rest);
        Ok(inlined)
    }

    /// The page as one HTML text that replays `recording`, the JSON text of a
    /// [`Recording`](crate::protocol::Recording).
    ///
    /// # Errors
    /// [`NoPage`] with the reason.
    pub fn with_recording(&self, recording: &str) -> Result<String, NoPage> {
        let page = self.inlined()?;
        // JSON has `<` only within strings.
        let recording = recording.replace('<', "\\u003c");
        let element = format!("<script type=\"application/json\" id=\"recording\">{recording}</script>\n");
        let end = page.rfind("</body>").ok_or_else(|| NoPage("the page has no `</body>`".to_owned()))?;
        Ok(format!("{}{element}{}", &page[..end], &page[end..]))
    }
}

/// Value of an attribute in a tag written by Vite.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, value) = tag.split_once(&format!(" {name}=\""))?;
    value.split_once('"').map(|(value, _)| value)
}

/// Escapes a script so that HTML finds no end tag and no comment in it: `\x3c` is `<` in all strings and regular
/// expressions of JavaScript, and minified code has `</` and `<!--` nowhere else.
fn safe_script(script: &str) -> String {
    let mut safe = String::with_capacity(script.len());
    let mut rest = script;
    while let Some(start) = rest.find('<') {
        let (before, tail) = rest.split_at(start);
        safe.push_str(before);
        let begins = |prefix: &str| tail.get(..prefix.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(prefix));
        safe.push_str(if begins("</script") || begins("<!--") { "\\x3c" } else { "<" });
        rest = &tail[1..];
    }
    safe + rest
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a page whose build appends a character to `built`, which is not among its sources.
    fn write_page(folder: &Path) {
        let package = r#"{"name":"p","version":"1.0.0","scripts":{"build":"node build.cjs"}}"#;
        let lock =
            r#"{"name":"p","version":"1.0.0","lockfileVersion":3,"packages":{"":{"name":"p","version":"1.0.0"}}}"#;
        let build = "const fs = require('fs'); fs.appendFileSync('built', '.'); fs.rmSync('dist', { recursive: true, force: true });
            fs.mkdirSync('dist/sub', { recursive: true }); fs.writeFileSync('dist/sub/a.js', '1');
            fs.copyFileSync('src/main.ts', 'dist/index.html');";
        std::fs::create_dir(folder.join("src")).unwrap();
        for (name, content) in [
            ("package.json", package),
            ("package-lock.json", lock),
            ("build.cjs", build),
            ("index.html", ""),
            ("tsconfig.json", ""),
            ("vite.config.ts", ""),
            ("src/main.ts", "one"),
        ] {
            std::fs::write(folder.join(name), content).unwrap();
        }
    }

    #[test]
    fn page_is_rebuilt_after_changes_by_one_process_at_a_time() {
        if std::process::Command::new("npm").arg("--version").output().is_err() {
            eprintln!("skipped: there is no npm");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        write_page(folder);
        let built = || build::built(folder, &mut |_| {}).unwrap();
        let build_count = || std::fs::read(folder.join("built")).unwrap().len();
        let expected =
            |main: &str| vec![("index.html".to_owned(), main.into()), ("sub/a.js".to_owned(), b"1".to_vec())];
        std::thread::scope(|scope| {
            let threads = [scope.spawn(built), scope.spawn(built)];
            for thread in threads {
                assert_eq!(thread.join().unwrap(), expected("one"));
            }
        });
        assert_eq!(build_count(), 1, "the second waits for the first and takes what it has built");

        std::fs::write(folder.join("src/main.ts"), "two").unwrap();
        assert_eq!(built(), expected("two"));
        assert_eq!((built(), build_count()), (expected("two"), 2));

        std::fs::write(folder.join("package.json"), "{").unwrap();
        let mut messages = String::new();
        assert_eq!(build::built(folder, &mut |text| messages += text).unwrap(), expected("two"), "the older page does");
        assert!(messages.contains("` failed in `") && messages.contains("older"), "{messages}");
        std::fs::remove_dir_all(folder.join("dist")).unwrap();
        let why = build::built(folder, &mut |_| {}).unwrap_err();
        assert!(why.contains("` failed in `"), "{why}");
    }

    #[test]
    fn page_is_inlined_into_one_file() {
        let html = concat!(
            "<html><head><link rel=\"icon\" href=\"data:,\" />",
            "<script type=\"module\" crossorigin src=\"./page.js\"></script>",
            "<link rel=\"stylesheet\" crossorigin href=\"./page.css\"></head><body></body></html>"
        );
        let files = [
            ("index.html", html),
            ("page.js", "let a = '</script><!--', b = /<\\/SCRIPT/, c = '</SCRIPT>', d = 1<2, e = '$&$1';"),
            ("page.css", "a::after { content: '</style>' }"),
        ];
        let page = Page::of(files.map(|(name, content)| (name.to_owned(), content.into())));
        let inlined = page.with_recording(r#"{"title":"</script><b>"}"#).unwrap();
        assert_eq!(
            inlined,
            concat!(
                "<html><head><link rel=\"icon\" href=\"data:,\" />",
                "<script type=\"module\">let a = '\\x3c/script>\\x3c!--', b = /<\\/SCRIPT/, c = '\\x3c/SCRIPT>', ",
                "d = 1<2, e = '$&$1';</script>",
                "<style>a::after { content: '<\\/style>' }</style></head><body>",
                "<script type=\"application/json\" id=\"recording\">{\"title\":\"\\u003c/script>\\u003cb>\"}</script>\n",
                "</body></html>"
            )
        );
        assert_eq!(Page::missing("why").inlined(), Err(NoPage("why".into())));
    }
}
