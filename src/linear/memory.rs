//! How much memory there is, as far as the system tells.

use std::fs::read_to_string;

/// Bytes that this process can still take: what Linux says is available, and what its control groups leave.
pub fn available_memory() -> Option<usize> {
    let status = read_to_string("/proc/meminfo").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let machine = line.trim().trim_end_matches("kB").trim().parse::<usize>().ok()? * 1024;
    Some(control_groups().fold(machine, usize::min))
}

/// What every control group around this process leaves: its limit less what is used, caches that can be dropped not counted.
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

/// Bytes of files that a control group keeps in memory and can drop.
fn dropped(folder: &str) -> usize {
    let statistics = read_to_string(format!("{folder}/memory.stat")).unwrap_or_default();
    let line = statistics.lines().find_map(|line| line.strip_prefix("inactive_file "));
    line.and_then(|bytes| bytes.trim().parse().ok()).unwrap_or(0)
}
