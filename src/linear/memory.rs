//! Free memory as reported by the system, and checks of required memory.

use std::fs::read_to_string;

use thiserror::Error;

/// Size below which the free memory is not checked [bytes].
pub const LITTLE: usize = 1 << 24;

/// Error: the required memory exceeds the free memory.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{needed:.2} GiB of memory, and {available:.2} GiB are free")]
pub struct NoRoom {
    /// required [GiB]
    pub needed: f64,
    /// available [GiB]
    pub available: f64,
}

/// Refuses a request for more bytes than are free, as far as the system reports it, since the process would be killed. The
/// bytes already `held` are released first.
///
/// # Errors
/// Returns [`NoRoom`] with the required and the free memory.
pub fn room_for(needed: usize, held: usize) -> Result<(), NoRoom> {
    if needed < held + LITTLE {
        return Ok(());
    }
    available_memory().map_or(Ok(()), |free| fits(needed, held + free))
}

/// Checks that the required bytes are available.
fn fits(needed: usize, available: usize) -> Result<(), NoRoom> {
    match needed <= available {
        true => Ok(()),
        false => Err(NoRoom { needed: gibibytes(needed), available: gibibytes(available) }),
    }
}

/// Converts bytes to GiB.
pub(super) fn gibibytes(bytes: usize) -> f64 {
    bytes as f64 / (1u64 << 30) as f64
}

/// Memory still available to this process [bytes]: the minimum of the available memory reported by Linux, the room left by its
/// control groups, and that left by the limit of its address space (ulimit -v).
pub fn available_memory() -> Option<usize> {
    let status = read_to_string("/proc/meminfo").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let machine = line.trim().trim_end_matches("kB").trim().parse::<usize>().ok()? * 1024;
    Some(control_groups().chain(address_space()).fold(machine, usize::min))
}

/// Room left by the limit of the address space (ulimit -v), if there is one [bytes].
pub fn address_space() -> Option<usize> {
    let limits = read_to_string("/proc/self/limits").ok()?;
    let limit = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: usize = limit.split_whitespace().next()?.parse().ok()?;
    let status = read_to_string("/proc/self/status").ok()?;
    let used = status.lines().find_map(|line| line.strip_prefix("VmSize:"))?;
    Some(limit.saturating_sub(1024 * used.trim().trim_end_matches("kB").trim().parse::<usize>().ok()?))
}

/// Room left by every control group of this process: its limit minus the used memory, without caches that can be
/// dropped.
fn control_groups() -> impl Iterator<Item = usize> {
    const FIRST: (&str, [&str; 2]) = ("/sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes"]);
    const SECOND: (&str, [&str; 2]) = ("/sys/fs/cgroup", ["memory.max", "memory.current"]);
    let own = read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups: Vec<_> = own
        .lines()
        .filter_map(|line| line.split_once(':')?.1.split_once(':'))
        .map(|(kind, path)| {
            let (root, files) = if kind.split(',').any(|kind| kind == "memory") { FIRST } else { SECOND };
            (root, files, path.to_string())
        })
        .collect();
    groups.into_iter().flat_map(|(root, [limit, usage], path)| {
        let folders: Vec<_> = std::path::Path::new(&path)
            .ancestors()
            .map(|folder| format!("{root}/{}", folder.to_string_lossy().trim_start_matches('/')))
            .collect();
        folders.into_iter().filter_map(move |folder| {
            let number = |file: &str| read_to_string(format!("{folder}/{file}")).ok()?.trim().parse::<usize>().ok();
            let (limit, used) = (number(limit)?, number(usage)?);
            Some(limit.saturating_sub(used - dropped(&folder).min(used)))
        })
    })
}

/// Size of cached files that a control group can drop [bytes].
fn dropped(folder: &str) -> usize {
    let statistics = read_to_string(format!("{folder}/memory.stat")).unwrap_or_default();
    let line = statistics.lines().find_map(|line| line.strip_prefix("inactive_file "));
    line.and_then(|bytes| bytes.trim().parse().ok()).unwrap_or(0)
}
