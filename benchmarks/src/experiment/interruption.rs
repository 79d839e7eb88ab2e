//! Interruption by the user (Ctrl-C), by the system (SIGTERM) or by a terminal that is closed (SIGHUP).
//!
//! Signals are handled from the first line of the program on, and always end it with the exit code [`CODE`]. While
//! nothing is finished yet (scenes are read, models are built, gears are meshed) a signal ends the program at once.
//! Once a study [defers](defer) signals, the first one sets a flag that every integration polls, so that finished work
//! is reported; a second one ends the program at once.

use std::io;
use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted program.
pub const CODE: u8 = 130;

/// True once the program was asked to end.
static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// True if the next signal ends the program at once.
static AT_ONCE: LazyLock<Arc<AtomicBool>> = LazyLock::new(|| Arc::new(AtomicBool::new(true)));

/// True once a signal asked the program to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// The flag that integrations poll; it is set by a signal.
pub fn flag() -> &'static AtomicBool {
    &REQUESTED
}

/// Defers signals: the first one sets a flag instead of ending the program.
pub fn defer() {
    if !requested() {
        AT_ONCE.store(false, Ordering::Relaxed);
    }
}

/// Installs the signal handlers.
///
/// # Errors
/// When the system refuses.
pub fn catch() -> io::Result<()> {
    for signal in signals() {
        // In this order: the first signal that is deferred finds the flag clear.
        let code = i32::from(CODE);
        signal_hook::flag::register_conditional_shutdown(signal, code, AT_ONCE.clone())?;
        signal_hook::flag::register(signal, AT_ONCE.clone())?;
        signal_hook::flag::register(signal, REQUESTED.clone())?;
    }
    Ok(())
}

/// The signals that end the program, except for those that its parent process set to be ignored, as `nohup` does.
fn signals() -> Vec<i32> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    #[cfg(target_os = "linux")]
    let all = vec![SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
    // Where it is not known whether SIGHUP is ignored, it stays as it is.
    #[cfg(not(target_os = "linux"))]
    let all = vec![SIGINT, SIGTERM];
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let ignored = ignored.unwrap_or(0);
    all.into_iter()
        .filter(|s| ignored >> (s - 1) & 1 == 0)
        .collect()
}
