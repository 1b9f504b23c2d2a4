//! Signals: a run ends after the current increment, with complete results; at the second signal, immediately.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether a signal has requested the end.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Watches for signals that request the end, except those ignored by the caller (nohup).
    #[cfg(unix)]
    pub fn watch() -> Self {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
        use signal_hook::flag::{register, register_conditional_shutdown};
        let interrupt = Self::default();
        let ignored = ignored();
        for signal in [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0) {
            // A signal that cannot be watched keeps its default action.
            let _ = register_conditional_shutdown(signal, 1, interrupt.0.clone());
            let _ = register(signal, interrupt.0.clone());
        }
        // Exceeding the file size limit is an error like a full disk.
        let _ = register(SIGXFSZ, Arc::default());
        interrupt
    }

    /// Watches for the signals of this system.
    #[cfg(not(unix))]
    pub fn watch() -> Self {
        let interrupt = Self::default();
        let _ = signal_hook::flag::register_conditional_shutdown(signal_hook::consts::SIGINT, 1, interrupt.0.clone());
        let _ = signal_hook::flag::register(signal_hook::consts::SIGINT, interrupt.0.clone());
        interrupt
    }

    /// Whether a signal has arrived.
    pub fn came(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Signals that are ignored, one bit each, from the Linux process status.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
