//! `eyesim lsp`: the checks of `eyesim check` as a language server, for editors.
//!
//! The server reads an editor's requests from standard input and answers on standard output, by the [Language Server
//! Protocol](https://microsoft.github.io/language-server-protocol/) 3.17. It keeps the texts that are open in the
//! editor and reads all other files from the disk. It runs no programs.

mod documents;
mod pages;
mod schema;
mod toml_cursor;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, Read};
use std::panic::resume_unwind;
use std::process::ExitCode;
use std::sync::mpsc;
use std::thread;

use anyhow::Context as _;
use clap::Args;
use documents::{Document, Documents, Encoding};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use lsp_types::notification::Notification as _;
use lsp_types::request::Request as _;
use lsp_types::{
    CompletionItem, CompletionOptions, CompletionParams, Diagnostic, DiagnosticSeverity, DidChangeTextDocumentParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, GotoDefinitionParams, Hover, HoverContents, HoverParams,
    HoverProviderCapability, InitializeParams, Location, MarkupContent, MarkupKind, NumberOrString, OneOf,
    PositionEncodingKind, PublishDiagnosticsParams, Range, ServerCapabilities, TextDocumentSyncCapability,
    TextDocumentSyncKind, notification, request,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sim_format::{Overrides, Severity};
use sim_host::files::DiskFiles;
use sim_host::launch::check::{FindProgram, finder, search_path};

use super::check::check;

/// Maximum length of a message in bytes; longer than any file that is typed.
const MAX_MESSAGE: u64 = 64 << 20;

/// Arguments of `eyesim lsp`.
#[derive(Args)]
pub struct LspArgs {
    /// Communicate over standard input and output (the only way; editors pass this option)
    #[arg(long)]
    stdio: bool,
}

/// Runs the command until the editor ends it: exit code 0, or 1 if it ends without the protocol's `shutdown`.
///
/// # Errors
/// The working folder is unknown, or the editor violates the protocol.
pub fn run(args: &LspArgs) -> anyhow::Result<ExitCode> {
    let LspArgs { stdio: _ } = args;
    let (connection, Connection { sender, receiver }) = Connection::memory();
    let (failure, failures) = mpsc::channel();
    let thread = |name: &str| thread::Builder::new().name(name.to_owned());
    thread("lsp-reader").spawn(move || {
        let mut input = LimitedInput(io::stdin().lock());
        let read = || {
            Message::read(&mut input).unwrap_or_else(|error| {
                // Nobody receives it after the end of the service.
                _ = failure.send(error);
                None
            })
        };
        std::iter::from_fn(read).all(|message| sender.send(message).is_ok())
    })?;
    let writer =
        thread("lsp-writer").spawn(move || receiver.iter().try_for_each(|message| message.write(&mut io::stdout())))?;
    let served = serve(connection);
    if let Ok(error) = failures.try_recv() {
        return Err(error).context("standard input");
    }
    let is_shut_down = served?;
    writer.join().unwrap_or_else(|panic| resume_unwind(panic))?;
    Ok(if is_shut_down { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Serves an editor; returns true if it has requested the shutdown.
fn serve(connection: Connection) -> anyhow::Result<bool> {
    let (id, params) = connection.initialize_start().context("an editor starts with `initialize`")?;
    let params: InitializeParams = serde_json::from_value(params).context("the parameters of `initialize`")?;
    let encoding = encoding_of(&params);
    let result = serde_json::json!({
        "capabilities": capabilities(encoding),
        "serverInfo": { "name": "eyesim", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, result).context("an editor goes on with `initialized`")?;
    let files = DiskFiles::of_environment();
    let find_program = finder(search_path(&files)?, None, None);
    let mut server = Server { documents: Documents::new(files, encoding), find_program, published: BTreeSet::new() };
    server.serve(&connection)
}

/// Input that refuses the header of a message longer than [`MAX_MESSAGE`], for which [`Message::read`] would wait.
struct LimitedInput<R>(R);

impl<R: Read> Read for LimitedInput<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl<R: BufRead> BufRead for LimitedInput<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.0.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.0.consume(count);
    }

    fn read_line(&mut self, line: &mut String) -> io::Result<usize> {
        let count = self.0.read_line(line)?;
        let header = line.trim_end().split_once(": ").filter(|(name, _)| name.eq_ignore_ascii_case("Content-Length"));
        match header.and_then(|(_, length)| length.parse::<u64>().ok()) {
            Some(length) if length > MAX_MESSAGE => {
                Err(io::Error::other(format!("a message of {length} bytes, expected at most {MAX_MESSAGE}")))
            }
            _ => Ok(count),
        }
    }
}

/// UTF-8 if the editor supports it, otherwise UTF-16, which every editor supports.
fn encoding_of(params: &InitializeParams) -> Encoding {
    let general = params.capabilities.general.as_ref();
    let encodings = general.and_then(|general| general.position_encodings.as_deref()).unwrap_or_default();
    if encodings.contains(&PositionEncodingKind::UTF8) { Encoding::Utf8 } else { Encoding::Utf16 }
}

fn capabilities(encoding: Encoding) -> ServerCapabilities {
    ServerCapabilities {
        position_encoding: Some(match encoding {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }),
        text_document_sync: Some(TextDocumentSyncCapability::Kind(TextDocumentSyncKind::FULL)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["[", ".", "\"", "/", " "].map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

struct Server {
    documents: Documents,
    find_program: Box<FindProgram<'static>>,
    /// Files for which the editor shows diagnostics.
    published: BTreeSet<String>,
}

impl Server {
    /// Serves until `exit` or the end of the input; returns true if the editor has requested the shutdown before.
    fn serve(&mut self, connection: &Connection) -> anyhow::Result<bool> {
        // The documents are checked once for all changes that have arrived.
        while let Ok(first) = connection.receiver.recv() {
            let mut is_changed = false;
            for message in std::iter::once(first).chain(connection.receiver.try_iter()) {
                match message {
                    Message::Request(request) => {
                        if connection.handle_shutdown(&request)? {
                            return Ok(true);
                        }
                        connection.sender.send(self.answer(request).into())?;
                    }
                    Message::Notification(notification) if notification.method == notification::Exit::METHOD => {
                        return Ok(false);
                    }
                    Message::Notification(notification) => is_changed |= self.apply(notification),
                    Message::Response(_) => {}
                }
            }
            if is_changed {
                for params in self.diagnostics() {
                    let method = notification::PublishDiagnostics::METHOD.to_owned();
                    connection.sender.send(Notification::new(method, params).into())?;
                }
            }
        }
        Ok(false)
    }

    /// Applies a notification to the open documents; returns true if diagnostics may have changed. Invalid
    /// notifications are ignored.
    fn apply(&mut self, notification: Notification) -> bool {
        let Notification { method, params } = notification;
        match method.as_str() {
            notification::DidOpenTextDocument::METHOD => {
                let opened: Option<DidOpenTextDocumentParams> = serde_json::from_value(params).ok();
                opened.is_some_and(|opened| self.documents.open(&opened.text_document.uri, opened.text_document.text))
            }
            notification::DidChangeTextDocument::METHOD => {
                let changed: Option<DidChangeTextDocumentParams> = serde_json::from_value(params).ok();
                let text = |changed: DidChangeTextDocumentParams| {
                    Some((changed.text_document.uri, changed.content_changes.into_iter().last()?))
                };
                changed.and_then(text).is_some_and(|(uri, change)| self.documents.open(&uri, change.text))
            }
            notification::DidCloseTextDocument::METHOD => {
                let closed: Option<DidCloseTextDocumentParams> = serde_json::from_value(params).ok();
                closed.is_some_and(|closed| self.documents.close(&closed.text_document.uri))
            }
            notification::DidSaveTextDocument::METHOD => true, // other files may refer to the saved one
            _ => false,
        }
    }

    /// Diagnostics of all open documents and of the files that they name, and empty lists for files that have none any
    /// more.
    fn diagnostics(&mut self) -> Vec<PublishDiagnosticsParams> {
        let checked =
            check(&self.documents.checkable(), Overrides::default(), self.documents.files(), &*self.find_program);
        let mut by_file: BTreeMap<String, Vec<Diagnostic>> = BTreeMap::new();
        self.published.extend(self.documents.names().map(str::to_owned));
        by_file.extend(std::mem::take(&mut self.published).into_iter().map(|name| (name, Vec::new())));
        for diagnostic in checked.diagnostics {
            let Some(document) = self.documents.document(&diagnostic.file) else { continue };
            let converted = converted(&diagnostic, &document);
            by_file.entry(diagnostic.file).or_default().push(converted);
        }
        let publish = |(name, diagnostics): (String, Vec<Diagnostic>)| {
            if !diagnostics.is_empty() {
                self.published.insert(name.clone());
            }
            Some(PublishDiagnosticsParams { uri: documents::uri_of(&name)?, diagnostics, version: None })
        };
        by_file.into_iter().filter_map(publish).collect()
    }

    fn answer(&self, request: Request) -> Response {
        let Request { id, method, params } = request;
        match method.as_str() {
            request::Completion::METHOD => reply(id, params, |params: CompletionParams| self.completion(&params)),
            request::HoverRequest::METHOD => reply(id, params, |params: HoverParams| self.hover(&params)),
            request::GotoDefinition::METHOD => {
                reply(id, params, |params: GotoDefinitionParams| self.definition(&params))
            }
            _ => Response::new_err(id, ErrorCode::MethodNotFound as i32, format!("`{method}` is not answered here")),
        }
    }

    fn completion(&self, params: &CompletionParams) -> Option<Vec<CompletionItem>> {
        let cursor = &params.text_document_position;
        let document = self.documents.open_document(&cursor.text_document.uri)?;
        let offset = document.offset(cursor.position);
        Some(if document.is_toml() {
            schema::completions(&document, offset, self.documents.files())
        } else {
            pages::completions(&document, offset, self.documents.files())
        })
    }

    fn hover(&self, params: &HoverParams) -> Option<Hover> {
        let cursor = &params.text_document_position_params;
        let document = self.documents.open_document(&cursor.text_document.uri)?;
        let offset = document.offset(cursor.position);
        let value =
            if document.is_toml() { schema::hover(&document, offset) } else { pages::hover(&document, offset) }?;
        Some(Hover {
            contents: HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value }),
            range: None,
        })
    }

    /// The file whose path is the word at a position.
    fn definition(&self, params: &GotoDefinitionParams) -> Option<Location> {
        let cursor = &params.text_document_position_params;
        let document = self.documents.open_document(&cursor.text_document.uri)?;
        let offset = document.offset(cursor.position);
        let name = self.documents.named_file(&document, offset)?;
        Some(Location { uri: documents::uri_of(&name)?, range: Range::default() })
    }
}

/// Answer to a request whose parameters are `params`.
fn reply<P: DeserializeOwned, R: Serialize>(
    id: lsp_server::RequestId,
    params: serde_json::Value,
    answer: impl FnOnce(P) -> Option<R>,
) -> Response {
    match serde_json::from_value(params) {
        Ok(params) => Response::new_ok(id, answer(params)),
        Err(error) => Response::new_err(id, ErrorCode::InvalidParams as i32, error.to_string()),
    }
}

fn converted(diagnostic: &sim_format::Diagnostic, document: &Document) -> Diagnostic {
    let sim_format::Diagnostic { severity, code, span, message, expected, suggestion, .. } = diagnostic;
    let mut text = message.clone();
    if !expected.is_empty() {
        text.push_str(&format!("\nexpected: {expected}"));
    }
    suggestion.iter().for_each(|suggestion| text.push_str(&format!("\n{suggestion}")));
    let range = if span.line == 0 { 0..0 } else { span.start..span.end };
    Diagnostic {
        range: document.range(range),
        severity: Some(match severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
        }),
        code: Some(NumberOrString::String(code.name().to_owned())),
        source: Some("eyesim".to_owned()),
        message: text,
        ..Diagnostic::default()
    }
}

/// Completion item with a label and an explanation.
fn item(label: &str, kind: lsp_types::CompletionItemKind, explanation: &str) -> CompletionItem {
    let explanation = MarkupContent { kind: MarkupKind::Markdown, value: explanation.to_owned() };
    CompletionItem {
        label: label.to_owned(),
        kind: Some(kind),
        documentation: Some(lsp_types::Documentation::MarkupContent(explanation)),
        ..CompletionItem::default()
    }
}
