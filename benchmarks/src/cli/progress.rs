//! Progress of a study: a bar on a terminal, otherwise one line per minute.

use crate::context::{Context, ProgressObserver};
use crate::experiment::parallel::lock;
use gearbench_reports::escape;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two lines of progress without a terminal.
const EVERY: Duration = Duration::from_secs(60);

/// Progress of a running study: pieces done, their total number, and the present piece.
#[derive(Debug, Default)]
struct ProgressState {
    done: usize,
    total: usize,
    what: String,
    /// Number of pieces that were finished before the start; they take no time.
    before: Option<usize>,
}

impl ProgressState {
    /// Estimated time to the end, from the pieces computed so far.
    fn left(&self, spent: Duration) -> Option<Duration> {
        let made = self.done.checked_sub(self.before?).filter(|n| *n > 0)?;
        let rest = self.total.saturating_sub(self.done);
        Some(spent.mul_f64(rest as f64 / made as f64))
    }

    fn line(&self, spent: Duration) -> String {
        let left = self.left(spent).map_or(String::new(), |left| {
            format!(", about {} left", minutes(left))
        });
        let part = if self.total > 0 {
            format!("{} of {}, ", self.done, self.total)
        } else {
            String::new()
        };
        format!("{part}{}{left}: {}", minutes(spent), self.what)
    }
}

/// Formats a duration in seconds, minutes and seconds, or hours and minutes.
fn minutes(time: Duration) -> String {
    match time.as_secs() {
        s @ 0..60 => format!("{s} s"),
        s @ 60..3600 => format!("{} min {} s", s / 60, s % 60),
        s => format!("{} h {} min", s / 3600, s / 60 % 60),
    }
}

/// Displays the progress of a piece of work until it is dropped.
pub struct Display {
    known: Arc<Mutex<ProgressState>>,
    bar: ProgressBar,
    begin: Instant,
    observer: Option<ProgressObserver>,
    ticker: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Display {
    /// Starts the display on the terminal; a length of 0 means that the number of pieces is unknown.
    pub fn new(length: usize) -> Display {
        Self::with(length, None)
    }

    /// Starts the display of a context, which is that on the terminal unless the context has an observer.
    pub fn of(context: &Context, length: usize) -> Display {
        Self::with(length, context.progress.clone())
    }

    fn with(length: usize, observer: Option<ProgressObserver>) -> Display {
        let terminal = std::io::stderr().is_terminal() && observer.is_none();
        let known = Arc::new(Mutex::new(ProgressState {
            total: length,
            ..ProgressState::default()
        }));
        let begin = Instant::now();
        Display {
            bar: progress_bar(length, terminal),
            ticker: (!terminal && observer.is_none()).then(|| ticker(&known, begin)),
            known,
            begin,
            observer,
        }
    }

    /// Updates the display: pieces done, their total number so far, and the name of the next piece.
    pub fn report_progress(&self, done: usize, total: usize, what: &str) {
        let what = &*escape::terminal(what);
        let mut known = lock(&self.known);
        known.before.get_or_insert(done);
        (known.done, known.total) = (done, total);
        what.clone_into(&mut known.what);
        if let Some(observer) = &self.observer {
            drop(known);
            (observer.0)(done, total, what);
            return;
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
        let left = known.left(self.begin.elapsed());
        self.bar.set_message(match left {
            Some(left) => format!("about {} left  {what}", minutes(left)),
            None => what.to_owned(),
        });
    }

    /// Hides the bar while other output is written.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Shows the name of the present piece of work.
    pub fn message(&self, what: &str) {
        let (done, total) = {
            let known = lock(&self.known);
            (known.done, known.total)
        };
        self.report_progress(done, total, what);
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some((stop, thread)) = self.ticker.take() {
            drop(stop);
            // A thread that printed lines has nothing to say.
            let _ = thread.join();
        }
    }
}

/// Creates a bar on a terminal, and a hidden one otherwise.
fn progress_bar(length: usize, terminal: bool) -> ProgressBar {
    if !terminal {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(length as u64);
    let template = if length > 0 {
        "{bar:30} {pos:>3}/{len} {elapsed:>4}  {wide_msg}"
    } else {
        "{spinner} {elapsed:>4}  {wide_msg}"
    };
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Starts a thread that prints a line at intervals, until the sender is dropped.
fn ticker(known: &Arc<Mutex<ProgressState>>, begin: Instant) -> (Sender<()>, JoinHandle<()>) {
    let (stop, stopped) = channel::<()>();
    let known = known.clone();
    let thread = std::thread::spawn(move || {
        while stopped.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
            crate::messages::print_error(&lock(&known).line(begin.elapsed()));
        }
    });
    (stop, thread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_estimated_from_what_was_made() {
        let known = ProgressState {
            done: 30,
            total: 50,
            what: "rigid, rk4".into(),
            before: Some(20),
        };
        let spent = Duration::from_secs(60);
        assert_eq!(known.left(spent), Some(Duration::from_secs(120)));
        let line = known.line(spent);
        assert_eq!(
            line,
            "30 of 50, 1 min 0 s, about 2 min 0 s left: rigid, rk4"
        );
        let nothing = ProgressState {
            before: Some(30),
            ..known
        };
        assert_eq!(nothing.left(spent), None);
        assert_eq!(minutes(Duration::from_secs(3725)), "1 h 2 min");
    }
}
