//! Python functions as robot programs; `eyesim._callable` runs them.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use robios_sys::Status;
use sim_core::RobotId;
use sim_host::program::embedded::{self, EmbeddedCode, EmbeddedEnd};

use super::error::error;

/// Exit code of a program that the package itself could not run.
const EXIT_BROKEN: i32 = 1;

/// A program of the package, of the class `eyesim._callable.Program`.
pub struct Callable(pub Py<PyAny>);

/// Calls of a robot's program.
#[pyclass(module = "eyesim._native", frozen)]
pub struct Calls(Arc<dyn embedded::Calls>);

#[pymethods]
impl Calls {
    /// Executes the call in `request`, the body of a message, while other Python threads run. Returns the body of the
    /// answer, or `None` if the program must end.
    fn call<'py>(&self, py: Python<'py>, request: &[u8]) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let mut reply = Vec::new();
        let status = py.detach(|| self.0.call(request, &mut reply)).map_err(|failed| error(py, failed))?;
        Ok((status == Status::OK).then(|| PyBytes::new(py, &reply)))
    }
}

impl EmbeddedCode for Callable {
    fn run(&self, robot: RobotId, arguments: &[String], calls: Arc<dyn embedded::Calls>) -> EmbeddedEnd {
        Python::attach(|py| {
            let ended = self.0.bind(py).call_method1("run", (robot.0, arguments, Calls(calls)));
            let end = ended.and_then(|ended| match ended.extract() {
                Ok(code) => Ok(EmbeddedEnd::Exited(code)),
                Err(_) => Ok(EmbeddedEnd::Overdue(ended.extract()?)),
            });
            self.value_or_report(py, end).unwrap_or(EmbeddedEnd::Exited(EXIT_BROKEN))
        })
    }

    fn call_back(&self, robot: RobotId, number: u64) -> Status {
        Python::attach(|py| {
            let goes_on = self.0.bind(py).call_method1("call_back", (robot.0, number)).and_then(|it| it.extract());
            if self.value_or_report(py, goes_on).unwrap_or(false) { Status::OK } else { Status::STOP }
        })
    }

    fn stop(&self, robot: RobotId) {
        Python::attach(|py| _ = self.value_or_report(py, self.0.bind(py).call_method1("stop", (robot.0,))));
    }
}

impl Callable {
    /// Returns the value. Reports an error to Python as an unraisable exception, since no caller could catch it, and
    /// returns `None`.
    fn value_or_report<T>(&self, py: Python<'_>, result: PyResult<T>) -> Option<T> {
        result.map_err(|failed| failed.write_unraisable(py, Some(self.0.bind(py)))).ok()
    }
}
