//! Threads of a run; results do not depend on their number.

use std::io;
use std::sync::mpsc::{Sender, channel};

use rayon::{ThreadBuilder, ThreadPoolBuilder};

use super::failure::Failure;
use crate::linear::memory::address_space;

/// Number of threads above which the input is refused as a typing error.
const MOST: usize = 1024;

/// Environment variable that sets the number of threads for all runs.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Stack size of a thread [MiB].
const STACK: usize = 2;

/// Address space of a thread [MiB]: its stack, the 64 MiB that glibc reserves for its allocations, and its own data.
const THREAD: usize = STACK + 64 + 1;

/// Bytes in a MiB.
const MIB: usize = 1 << 20;

/// Starts the given number of threads; all cores unless the environment specifies otherwise.
///
/// # Errors
/// Returns [`Failure::BadInput`] if the requested number is not available.
pub fn use_threads(asked: Option<usize>) -> Result<(), Failure> {
    let from_environment = || std::env::var(VARIABLE).ok()?.trim().parse().ok().filter(|threads| *threads > 0);
    let (threads, name) = match asked {
        Some(threads) => (threads, "--threads"),
        None => match from_environment() {
            Some(threads) => (threads, VARIABLE),
            None => return as_usual(),
        },
    };
    if !(1..=MOST).contains(&threads) {
        let message = format!("{name} {threads}: give 1 to {MOST}, or leave it out for all cores");
        return Err(Failure::BadInput(message));
    }
    let made = room_for(threads).and_then(|()| {
        let waiting: io::Result<Vec<_>> = (1..threads).map(|_| started()).collect();
        set_to_work(waiting.map_err(|error| error.to_string())?)
    });
    made.map_err(|cause| Failure::BadInput(format!("{name} {threads}: {cause}; give fewer")))
}

/// Starts one thread per core, fewer if the system refuses, and finally a single one.
fn as_usual() -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(MOST);
    let fitting = address_space().map_or(cores, |left| cores.min(left / (THREAD * MIB)));
    let waiting = (1..fitting).map_while(|_| started().ok()).collect();
    set_to_work(waiting).map_err(|cause| Failure::BadInput(format!("the threads cannot be started: {cause}")))
}

/// Refuses more threads than the limit of the address space permits: a thread that later runs out of memory would abort the
/// process.
fn room_for(threads: usize) -> Result<(), String> {
    let (needed, left) = (threads * THREAD, address_space().map(|left| left / MIB));
    match left.filter(|left| threads > 1 && *left < needed) {
        None => Ok(()),
        Some(left) => {
            Err(format!("they need {needed} MiB of address space, and its limit (ulimit -v) leaves {left} MiB"))
        }
    }
}

/// Starts a thread that waits for its task. It is created before the pool, which can be attempted only once.
fn started() -> io::Result<Sender<ThreadBuilder>> {
    let (work, given) = channel::<ThreadBuilder>();
    let waits = move || given.recv().map_or((), ThreadBuilder::run);
    std::thread::Builder::new().stack_size(STACK * MIB).spawn(waits)?;
    Ok(work)
}

/// Makes this thread and the waiting ones the pool of all parallel work.
fn set_to_work(mut waiting: Vec<Sender<ThreadBuilder>>) -> Result<(), String> {
    let lost = || io::Error::other("a thread has ended unexpectedly");
    let pool = ThreadPoolBuilder::new().num_threads(waiting.len() + 1).use_current_thread();
    let pool = pool.spawn_handler(|thread| waiting.pop().and_then(|one| one.send(thread).ok()).ok_or_else(lost));
    pool.build_global().map_err(|error| error.to_string())
}
