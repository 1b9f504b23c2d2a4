//! The threads of a run; its answers do not depend on their number.

use rayon::ThreadPoolBuilder;

use super::failure::Failure;

/// More threads than this are a slip of the keyboard.
const MOST: usize = 1024;

/// By this the number of threads may be given for all runs.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Make so many threads; all cores unless the environment says otherwise.
///
/// # Errors
/// [`Failure::BadInput`] where so many were asked for and cannot be had.
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
    let pool = ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    pool.map_err(|error| Failure::BadInput(format!("{name} {threads}: {error}; give fewer")))
}

/// A thread for every core; where the system does not give so many, fewer, and at last the one that there is.
fn as_usual() -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from).min(MOST);
    let fewer = std::iter::successors(Some(cores), |threads| (*threads > 1).then_some(threads / 2));
    let mut made =
        fewer.map(|threads| ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global());
    let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    match made.any(|pool| pool.is_ok()) {
        true => Ok(()),
        false => alone().map_err(|error| Failure::BadInput(format!("no thread can be made: {error}"))),
    }
}
