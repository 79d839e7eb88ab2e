//! Interruption by the user (Ctrl-C), by the system (SIGTERM) or by a terminal that is closed (SIGHUP).
//!
//! A command handles signals from its first line on, and they always end it with the exit code [`CODE`]. While nothing
//! is finished yet (scenes are read, models are built, gears are meshed) a signal ends the program at once. Once a study
//! [defers](Interruption::defer) signals, the first one sets a flag that every integration polls, so that finished work
//! is reported; a second one ends the program at once.
//!
//! A program that runs several studies [requests](Interruption::request) the interruption of one in the context of that
//! study.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted program.
pub const CODE: u8 = 130;

/// The request that the studies of a context end; a clone is the same request.
#[derive(Clone, Debug)]
pub struct Interruption {
    requested: Arc<AtomicBool>,
    /// True if the next signal ends the program at once.
    at_once: Arc<AtomicBool>,
}

impl Default for Interruption {
    /// No request; a signal would end the program at once.
    fn default() -> Self {
        Interruption {
            requested: Arc::default(),
            at_once: Arc::new(AtomicBool::new(true)),
        }
    }
}

impl Interruption {
    /// Requests the end of the studies.
    pub fn request(&self) {
        self.requested.store(true, Ordering::Relaxed);
    }

    /// True once the end was requested.
    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// The flag that integrations poll.
    pub fn flag(&self) -> &AtomicBool {
        &self.requested
    }

    /// Defers signals: the first one sets the flag instead of ending the program.
    pub fn defer(&self) {
        if !self.is_requested() {
            self.at_once.store(false, Ordering::Relaxed);
        }
    }

    /// Installs the signal handlers of a program, whose signals are requests from here on.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn catch_signals(&self) -> io::Result<()> {
        for signal in signals() {
            // In this order: the first signal that is deferred finds the flag clear.
            let code = i32::from(CODE);
            let at_once = || self.at_once.clone();
            signal_hook::flag::register_conditional_shutdown(signal, code, at_once())?;
            signal_hook::flag::register(signal, at_once())?;
            signal_hook::flag::register(signal, self.requested.clone())?;
        }
        Ok(())
    }
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
