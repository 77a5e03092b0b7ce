//! Takes calls from Python; gives the answers of the program as JSON, and shapes and contacts as NumPy arrays.
//!
//! Long calls run beside the interpreter: other threads go on, and Ctrl-C raises at once. Not promised: that a call left
//! so ends early; it goes on by itself until it has the answer that nobody reads.

use numpy::ndarray::{Array1, Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use weavelock::assembly::PartIx;
use weavelock::cli;
use weavelock::contact::Joined;
use weavelock::locking::{Freedom, rows};
use weavelock::watch::Watch;

/// How long an interrupt may wait to be seen.
const LISTEN: Duration = Duration::from_millis(50);

/// Runs a call on a thread of its own, without the interpreter's lock; signals are listened to meanwhile. An interrupt
/// asks the call to stop; it ends at its next counted step.
fn beside<T: Send + 'static>(py: Python<'_>, call: impl FnOnce(&Watch) -> T + Send + 'static) -> PyResult<T> {
    let (give, take) = channel();
    let take = Mutex::new(take);
    let watch = Watch::default();
    let watched = watch.clone();
    std::thread::spawn(move || drop(give.send(call(&watched))));
    loop {
        let waited = py.detach(|| {
            let take = take.lock().map_err(|_| RecvTimeoutError::Disconnected)?;
            take.recv_timeout(LISTEN)
        });
        match waited {
            Ok(answer) => return Ok(answer),
            Err(RecvTimeoutError::Timeout) => py.check_signals().inspect_err(|_| watch.stop())?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("a fault of ours: the call ended without an answer"));
            }
        }
    }
}

/// What the program answers to these words: exit code, one JSON object, remarks. Bad input raises ValueError.
#[pyfunction]
fn ask(py: Python<'_>, words: Vec<String>) -> PyResult<(u8, String, Vec<String>)> {
    let asked = beside(py, move |watch| cli::answered(&words, watch))?.map_err(PyValueError::new_err)?;
    Ok((asked.code, asked.json, asked.remarks))
}

/// An assembly in place, in model units (crossings for woven tiles, the file's unit for meshes).
#[pyclass(frozen, module = "weavelock")]
struct Assembly {
    joined: Joined,
}

/// Reads a spec or puzzle file and finds its contacts.
#[pyfunction]
fn load(py: Python<'_>, file: PathBuf) -> PyResult<Assembly> {
    let joined = beside(py, move |watch| cli::joined(&file, watch))?.map_err(PyValueError::new_err)?;
    Ok(Assembly { joined })
}

impl Assembly {
    fn find(&self, part: &str) -> PyResult<PartIx> {
        let asm = &self.joined.assembly;
        asm.ids().find(|&p| asm.part(p).id == part).ok_or_else(|| PyKeyError::new_err(part.to_string()))
    }
}

type Rows<'py> = (
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

#[pymethods]
impl Assembly {
    #[getter]
    fn name(&self) -> &str {
        &self.joined.assembly.name
    }

    #[getter]
    fn mm_per_unit(&self) -> f64 {
        self.joined.assembly.mm_per_unit
    }

    #[getter]
    fn parts(&self) -> Vec<String> {
        self.joined.assembly.parts.iter().map(|p| p.id.clone()).collect()
    }

    #[getter]
    fn held(&self) -> Vec<String> {
        let asm = &self.joined.assembly;
        asm.held().map(|p| asm.part(p).id.clone()).collect()
    }

    /// Corners of a part in its own frame, (n, 3).
    fn vertices<'py>(&self, py: Python<'py>, part: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = &self.joined.assembly.solid(self.find(part)?).vertices;
        let of = |(k, c): (usize, usize)| points[k][c];
        Ok(Array2::from_shape_fn((points.len(), 3), of).into_pyarray(py))
    }

    /// Triangles of a part, (m, 3), counter-clockwise seen from outside.
    fn faces<'py>(&self, py: Python<'py>, part: &str) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let all: Vec<[u32; 3]> = self.joined.assembly.solid(self.find(part)?).triangles().collect();
        Ok(Array2::from_shape_fn((all.len(), 3), |(k, c)| all[k][c]).into_pyarray(py))
    }

    /// Poses of all parts, (parts, 3, 4): own frame to world.
    fn poses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        let parts = &self.joined.assembly.parts;
        let of = |(p, r, c): (usize, usize, usize)| {
            let pose = &parts[p].pose;
            if c < 3 { pose.matrix3.col(c)[r] } else { pose.translation[r] }
        };
        Array3::from_shape_fn((parts.len(), 3, 4), of).into_pyarray(py)
    }

    /// Contact rows in world coordinates: part a, part b (indices into `parts`), unit normal from a to b, point.
    fn contact_rows<'py>(&self, py: Python<'py>) -> Rows<'py> {
        let all = rows(&self.joined.patches, Freedom::Rigid);
        let parts = |of: fn(&weavelock::locking::Row) -> PartIx| {
            Array1::from_iter(all.iter().map(|r| of(r).0)).into_pyarray(py)
        };
        let normals = Array2::from_shape_fn((all.len(), 3), |(k, c)| all[k].normal[c]).into_pyarray(py);
        let points = Array2::from_shape_fn((all.len(), 3), |(k, c)| all[k].point[c]).into_pyarray(py);
        (parts(|r| r.a), parts(|r| r.b), normals, points)
    }

    fn __repr__(&self) -> String {
        let asm = &self.joined.assembly;
        format!("<weavelock.Assembly {:?}: {} parts, {} contacts>", asm.name, asm.parts.len(), self.joined.patches.len())
    }
}

#[pymodule]
fn _weavelock(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_function(wrap_pyfunction!(ask, m)?)?;
    m.add_function(wrap_pyfunction!(load, m)?)?;
    m.add_class::<Assembly>()
}
