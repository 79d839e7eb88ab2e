//! Ratios of two wall times within one run.
//!
//! Criterion measures one function after the other, so that a neighbour on the machine slows one side of a ratio and
//! spares the other. Here the ratio itself is the measurement ([`Ratio`]): criterion warms up, decides how many turns a
//! sample has, tells the spread and the change since the last run; within a sample the sides take turns, and the least
//! times of both are divided, as noise only ever adds.

use criterion::measurement::{Measurement, ValueFormatter};
use criterion::{Criterion, SamplingMode, Throughput};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Criterion with ratios of two times instead of times.
pub type Ratios = Criterion<Ratio>;

/// A measurement whose value is a ratio.
pub struct Ratio;

impl Measurement for Ratio {
    type Intermediate = ();
    type Value = f64;

    fn start(&self) {}
    /// Returns NaN: a ratio does not follow from one time; benches pass theirs to [`by_turns`].
    fn end(&self, (): ()) -> f64 {
        f64::NAN
    }
    fn add(&self, a: &f64, b: &f64) -> f64 {
        a + b
    }
    fn zero(&self) -> f64 {
        0.0
    }
    fn to_f64(&self, value: &f64) -> f64 {
        *value
    }
    fn formatter(&self) -> &dyn ValueFormatter {
        self
    }
}

impl ValueFormatter for Ratio {
    fn scale_values(&self, _typical: f64, _values: &mut [f64]) -> &'static str {
        "x"
    }
    fn scale_throughputs(&self, _: f64, _: &Throughput, _: &mut [f64]) -> &'static str {
        "x"
    }
    fn scale_for_machines(&self, _values: &mut [f64]) -> &'static str {
        "x"
    }
}

/// Configures criterion for ratios: ten samples, together as long as given where a turn is short.
pub fn ratios(seconds: f64) -> Ratios {
    Criterion::default()
        .with_measurement(Ratio)
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs_f64(seconds))
}

/// Returns the wall time of some work [s].
pub fn seconds<T>(work: impl FnOnce() -> T) -> f64 {
    let begin = Instant::now();
    std::hint::black_box(work());
    begin.elapsed().as_secs_f64()
}

/// Returns the processor time [s] of this thread for some work, where the system reports it, so that other loads on
/// the machine do not count; otherwise wall time. For work of one thread.
pub fn busy_seconds<T>(work: impl FnOnce() -> T) -> f64 {
    gearbench::experiment::machine::timed(|| std::hint::black_box(work())).1
}

/// Measures the smallest times [s] of two sides in alternation; criterion reports their ratio `[0] / [1]`.
pub fn by_turns(
    criterion: &mut Ratios,
    group: &str,
    id: &str,
    mut turn: impl FnMut() -> [f64; 2],
) -> [f64; 2] {
    let name = format!("{group}: {id}");
    let mut least = [f64::INFINITY; 2];
    let mut group = criterion.benchmark_group(group);
    group.sampling_mode(SamplingMode::Flat);
    group.bench_function(id, |bencher| {
        bencher.iter_custom(|turns| {
            let mut sample = [f64::INFINITY; 2];
            for _ in 0..turns {
                let times = turn();
                sample = [0, 1].map(|k| sample[k].min(times[k]));
            }
            least = [0, 1].map(|k| least[k].min(sample[k]));
            // Criterion divides by the number of turns.
            turns as f64 * sample[0] / sample[1]
        });
    });
    group.finish();
    keep(&name, least[0] / least[1]);
    least
}

/// Adds a ratio to the file after `--ratios`, if one is given: by bench and name, beside those of other benches.
///
/// # Panics
/// When the file cannot be read as ratios, or not be written.
fn keep(name: &str, ratio: f64) {
    let Some(file) = super::scenes::after("--ratios") else {
        return;
    };
    let before = std::fs::read_to_string(&file).unwrap_or_else(|_| "{}".into());
    let mut all: Value = serde_json::from_str(&before).unwrap_or_else(|e| panic!("{file}: {e}"));
    let program = std::env::current_exe().unwrap_or_default();
    let stem = program.file_stem().unwrap_or_default().to_string_lossy();
    // Cargo appends a hash.
    let bench = stem.rsplit_once('-').map_or(&*stem, |(name, _)| name);
    // Three digits are more than a ratio repeats to.
    all[bench]["ratios"][name] = json!((1e3 * ratio).round() / 1e3);
    let command = format!("cargo bench --bench {bench} -- --ratios FILE");
    super::scenes::sign(&mut all[bench], &command);
    std::fs::write(&file, format!("{all:#}\n")).unwrap_or_else(|e| panic!("{file}: {e}"));
}

/// Returns the median of some times.
pub fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
