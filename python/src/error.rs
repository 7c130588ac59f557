//! Conversion of the library's errors to the exceptions of `eyesim._errors`.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use sim_format::Diagnostic;
use sim_host::launch;

/// An `eyesim.Error` with this message.
pub fn error(py: Python<'_>, message: impl std::fmt::Display) -> PyErr {
    new(py, "Error", (message.to_string(),))
}

/// The exception for a launch error: `eyesim.SceneError` with the locations of all mistakes in the scene's files,
/// otherwise `eyesim.Error`.
pub fn of_launch(py: Python<'_>, failed: launch::Error) -> PyErr {
    match failed {
        launch::Error::Rejected(rejected) => scene_error(py, &rejected.diagnostics),
        other => {
            let causes = std::iter::successors(std::error::Error::source(&other), |error| error.source());
            let text = causes.fold(other.to_string(), |text, cause| {
                let cause = cause.to_string();
                if text.contains(&cause) { text } else { format!("{text}: {cause}") }
            });
            error(py, text)
        }
    }
}

/// An `eyesim.SceneError` for these mistakes.
pub fn scene_error(py: Python<'_>, diagnostics: &[Diagnostic]) -> PyErr {
    new(py, "SceneError", (rows(diagnostics),))
}

/// Issues a warning of Python for each mistake in the files of a scene that can be run.
///
/// # Errors
/// The warning, if the user's filters turn it into an exception.
pub fn warn(py: Python<'_>, diagnostics: &[Diagnostic]) -> PyResult<()> {
    py.import("eyesim._errors")?.getattr("warn")?.call1((rows(diagnostics),)).map(drop)
}

/// The fields of an `eyesim.Diagnostic`.
type Row = (String, String, String, u32, u32, String, String);

fn rows(diagnostics: &[Diagnostic]) -> Vec<Row> {
    let row = |it: &Diagnostic| {
        let (severity, code) = (it.severity.to_string(), it.code.to_string());
        (severity, code, it.file.clone(), it.span.line, it.span.column, it.message.clone(), it.expected.clone())
    };
    diagnostics.iter().map(row).collect()
}

fn new<'py>(
    py: Python<'py>,
    name: &str,
    arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyErr {
    let made = || -> PyResult<Bound<'py, PyAny>> {
        let arguments = arguments.into_pyobject(py)?;
        py.import("eyesim._errors")?.getattr(name)?.call1(arguments)
    };
    made().map_or_else(|error| error, PyErr::from_value)
}
