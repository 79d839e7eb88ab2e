//! Interruption by the user (Ctrl-C) or by the system (SIGTERM): runs stop, what is finished is reported.
//!
//! The first signal sets a flag that every integration looks at; a second one ends the program at once, with the code
//! that a shell gives to a program that a signal ended.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

static FLAG: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Whether the program was asked to end.
pub fn requested() -> bool {
    FLAG.load(Ordering::Relaxed)
}

/// What integrations look at.
pub fn flag() -> &'static AtomicBool {
    &FLAG
}

/// Catches the signals from here on.
///
/// # Errors
/// When the system refuses.
pub fn catch() -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal finds the flag clear.
        let code = 128 + signal;
        signal_hook::flag::register_conditional_shutdown(signal, code, FLAG.clone())?;
        signal_hook::flag::register(signal, FLAG.clone())?;
    }
    Ok(())
}
