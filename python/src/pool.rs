//! Threads that work while Python goes on listening.
//!
//! Every run and simulation has threads of its own: none are shared by accident, and none are missing in a process that was
//! forked from one that has used the package.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use fecontact::case::job::Ends;
use fecontact::run::error::Error;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// More threads than this are a slip of the keyboard.
const MOST: usize = 1024;

/// How often signals are looked for, and progress is told.
const LOOK: Duration = Duration::from_millis(100);

/// Why work is to end before its time: what Python has raised meanwhile.
#[derive(Clone, Default)]
pub struct Raised {
    why: Arc<Mutex<Option<(PyErr, Error)>>>,
    /// whether there is something: what many threads look at after every step
    set: Arc<AtomicBool>,
}

thread_local! {
    /// Where the threads of a pool put what Python raises in them.
    static OF_THIS_POOL: RefCell<Option<Raised>> = const { RefCell::new(None) };
}

impl Raised {
    /// The first exception stays; `ended` says how the work is to end.
    pub fn set(&self, error: PyErr, ended: Error) {
        self.why.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert((error, ended));
        self.set.store(true, Ordering::Relaxed);
    }

    /// Whether something was raised.
    pub fn is_set(&self) -> bool {
        self.set.load(Ordering::Relaxed)
    }

    /// What is set as soon as something was raised.
    pub fn flag(&self) -> Arc<AtomicBool> {
        self.set.clone()
    }

    /// Of the pool that this thread belongs to.
    pub fn of_this_pool() -> Self {
        OF_THIS_POOL.with_borrow(|raised| raised.clone().unwrap_or_default())
    }

    /// What was raised; there is nothing afterwards.
    pub fn take(&self) -> Option<PyErr> {
        self.set.store(false, Ordering::Relaxed);
        self.why.lock().unwrap_or_else(PoisonError::into_inner).take().map(|(error, _)| error)
    }

    /// Whether the work is to end, and why.
    pub fn ends(&self) -> Ends {
        let raised = self.clone();
        Arc::new(move || {
            let raised = raised.why.lock().unwrap_or_else(PoisonError::into_inner);
            raised.as_ref().map(|(_, ended)| match ended {
                Error::Ended(why) => Error::Ended(why.clone()),
                _ => Error::Interrupted,
            })
        })
    }
}

/// Does what enters the interpreter often: the thread keeps the state that every entry would make and drop again otherwise, which
/// takes as long as a short function.
pub fn attached<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    Python::attach(|py| py.detach(work))
}

/// Threads of one run or simulation.
pub struct Pool {
    threads: ThreadPool,
    /// what Python raises meanwhile
    pub raised: Raised,
    process: u32,
}

impl Pool {
    /// So many threads; all cores, or `RAYON_NUM_THREADS`, unless given.
    pub fn new(threads: Option<i64>) -> PyResult<Self> {
        let bad = |message: String| PyValueError::new_err(message);
        if let Some(threads) = threads.filter(|threads| !(1..=MOST as i64).contains(threads)) {
            return Err(bad(format!("threads {threads}: give 1 to {MOST}, or leave it out for all cores")));
        }
        let raised = Raised::default();
        let own = raised.clone();
        let pool = ThreadPoolBuilder::new().num_threads(threads.map_or(0, |threads| threads as usize));
        let pool = pool.start_handler(move |_| OF_THIS_POOL.set(Some(own.clone()))).build();
        let threads = pool.map_err(|error| bad(format!("threads: {error}; give fewer")))?;
        Ok(Self { threads, raised, process: std::process::id() })
    }

    /// Do something short in it; Python is free meanwhile.
    pub fn short<T: Send>(&self, py: Python, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        self.check_process()?;
        Ok(py.detach(|| self.threads.install(work)))
    }

    /// Do something in it, while signals are looked for and `report` is called now and then. Whatever that raises, [`Raised`] has,
    /// and the work is waited for; a second exception is not waited for.
    pub fn long<T: Send + 'static>(
        &self,
        py: Python,
        mut report: impl FnMut(Python) -> PyResult<()>,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> PyResult<T> {
        self.check_process()?;
        let (sender, receiver) = channel();
        self.threads.spawn(move || {
            let done = catch_unwind(AssertUnwindSafe(work));
            // Whoever waited may have gone.
            let _ = sender.send(done);
        });
        let receiver = Mutex::new(receiver);
        let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK);
        let mut raised_before = false;
        loop {
            match py.detach(wait) {
                Ok(Ok(done)) => return Ok(done),
                Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                    return Err(crate::errors::internal_error(py, "the threads of the run have ended"));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            match py.check_signals().and_then(|()| if raised_before { Ok(()) } else { report(py) }) {
                Ok(()) => {}
                Err(error) if raised_before => return Err(error),
                Err(error) => {
                    raised_before = true;
                    self.raised.set(error, Error::Interrupted);
                }
            }
        }
    }

    /// Do something that borrows what it works on, while signals are looked for: what they raise, [`Raised`] has, and the work,
    /// which looks at [`Raised::flag`] and ends soon then, is waited for.
    pub fn watched<T: Send>(&self, py: Python, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        self.check_process()?;
        let (sender, receiver) = channel();
        let receiver = Mutex::new(receiver);
        let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK);
        self.threads.in_place_scope(|scope| {
            scope.spawn(move |_| {
                let done = catch_unwind(AssertUnwindSafe(work));
                let _ = sender.send(done);
            });
            loop {
                match py.detach(wait) {
                    Ok(Ok(done)) => return Ok(done),
                    Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => {
                        return Err(crate::errors::internal_error(py, "the threads of the laws have ended"));
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                }
                if let Err(error) = py.check_signals() {
                    self.raised.set(error, Error::Interrupted);
                }
            }
        })
    }

    fn check_process(&self) -> PyResult<()> {
        match self.process == std::process::id() {
            true => Ok(()),
            false => {
                Err(PyRuntimeError::new_err("a simulation lives in the process that made it, and not in its forks"))
            }
        }
    }
}
