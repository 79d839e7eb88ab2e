//! Evaluation of a recorded run-up.

use super::channels::ChannelLayout;
use super::orders::tracked;
use super::plan::{EvaluationSettings, Ramp};
use super::recorder::Recorder;
use super::windows::{SampledRecording, Windows, follow, map, rounded};
use gearbench_models::spec::SceneSpec;
use gearbench_reports::numbers::counted;
use gearbench_reports::run_up::{ModelRunUp, RunUpChannel, RunUpMap};
use std::f64::consts::TAU;

/// Least ratio of the highest to the lowest speed.
const CHANGES: f64 = 1.2;
/// Turns of the reference gear at least.
const LEAST_TURNS: f64 = 4.0;
/// Beyond the highest multiple of a mesh order that is followed, so much more is shown.
const BEYOND: f64 = 1.1;
/// Orders below this many lines of a window are hidden by what changes slowly.
const HIDDEN: f64 = 2.0;

/// Last part of a run whose mean speed is compared with that of its ramp.
const AT_END: f64 = 0.01;
/// Permitted deviation of the final speed from that of the ramp, over the change of speed.
const MISSED: f64 = 0.02;

/// Returns the reason why a run does not follow its ramp, with advice; `None` if it follows.
fn missed(name: &str, turns: &[f64], recorder: &Recorder, ramp: &Ramp) -> Option<String> {
    let last = turns.len() - 1;
    let first = last - ((AT_END * last as f64).ceil() as usize).clamp(1, last);
    let [start, end] = [first, last].map(|i| recorder.time(i));
    let reached = TAU * (turns[last] - turns[first]) / (end - start);
    let rate = (ramp.to - ramp.from) / ramp.over;
    let asked = ramp.from + rate * 0.5 * (start + end);
    let left = (reached - asked) / (ramp.to - ramp.from).abs();
    (left.abs() > MISSED).then(|| {
        let sense = if left < 0.0 { "below" } else { "above" };
        format!(
            "`{name}` does not follow the run-up: at its end its speed is {reached:.1} rad/s in place of {asked:.1}, {:.1} % of the change of speed \
             {sense} the ramp, with a limit of {:.0} %; the driving torque balances the loads, but not the losses by friction and vibration: drive a hub \
             (mount = {{ driven = {{ speed_rad_s = .. }} }}), whose speed is then the ramp of --from and --to",
            100.0 * left.abs(),
            100.0 * MISSED
        )
    })
}

/// The first sample from which on the reference gear only turns forward.
fn forward(turns: &[f64]) -> usize {
    let back = turns.windows(2).rposition(|w| w[1] <= w[0]);
    back.map_or(0, |i| i + 1)
}

fn rows(amplitudes: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let row = |r: Vec<f64>| r.into_iter().map(rounded).collect();
    amplitudes.into_iter().map(row).collect()
}

fn axes(windows: &Windows, lines: Vec<f64>) -> RunUpMap {
    RunUpMap {
        span: windows.span,
        time_s: windows.time.clone(),
        speed_rad_s: windows.speed.clone(),
        lines,
    }
}

/// Evaluates a recorded run-up: amplitudes of its quantities over frequency and order.
///
/// # Errors
/// The reason why the run cannot be evaluated, with advice.
pub fn analyse(
    spec: &SceneSpec,
    recorded: &ChannelLayout<'_>,
    recorder: &Recorder,
    (look, ramp): (&EvaluationSettings, Option<&Ramp>),
) -> Result<ModelRunUp, String> {
    let name = spec.gears[look.gear].name.clone();
    let angle = recorded.angle(recorder, look.gear);
    let n = recorder.len();
    if n < 64 {
        return Err("the run ended before the evaluation started".into());
    }
    let sense = (angle[n - 1] - angle[0]).signum();
    let all_turns: Vec<f64> = angle.iter().map(|a| sense * a / TAU).collect();
    let from = forward(&all_turns);
    let turns = &all_turns[from..];
    let turned = turns[turns.len() - 1] - turns[0];
    if turned < LEAST_TURNS || turns.len() < n / 2 {
        let way_out = match ramp {
            Some(_) => "use a longer --over, a higher --to, or a faster reference gear (--gear)",
            None => {
                "define a run-up with --from, --to and --over, or use a faster reference gear (--gear)"
            }
        };
        let since = match from {
            0 => String::new(),
            _ => format!("after its last reversal at {:.4} s ", recorder.time(from)),
        };
        return Err(format!(
            "a run-up needs {LEAST_TURNS} revolutions without reversal, but {since}`{name}` makes {turned:.2} revolutions; \
             {way_out}"
        ));
    }
    if let Some(why) = ramp.and_then(|ramp| missed(&name, &all_turns, recorder, ramp)) {
        return Err(why);
    }
    let cut = SampledRecording {
        time: [recorder.time(from), recorder.apart()],
        turns,
    };
    let between = [from, n - 1];
    let orders_of = |shortest: f64| {
        let scene = (spec, recorded);
        tracked(
            scene,
            recorder,
            between,
            (look.gear, look.multiples),
            shortest,
        )
    };
    let highest = |orders: &[gearbench_reports::run_up::TrackedOrder]| {
        let all = orders.iter().map(|o| o.order);
        BEYOND * all.fold(1.0_f64, f64::max)
    };
    let top = highest(&orders_of(0.0));
    let Some(by_turns) = cut.by_turns(top, look.turns.map(f64::from)) else {
        return Err(format!(
            "windows of {} do not fit into the {turned:.2} turns of `{name}`",
            counted(look.turns.unwrap_or(1) as usize, "turn", "turns")
        ));
    };
    let orders = orders_of(HIDDEN / by_turns.span);
    let ends = |f: fn(f64, f64) -> f64, start: f64| by_turns.speed.iter().copied().fold(start, f);
    let (slowest, fastest) = (ends(f64::min, f64::INFINITY), ends(f64::max, 0.0));
    if fastest < CHANGES * slowest {
        return Err(format!(
            "the speed of `{name}` stays between {slowest:.4} and {fastest:.4} rad/s, which is not a run-up; define one with --from and \
             --to, or drive a hub with a ramp"
        ));
    }
    // The fastest of the meshes decides how long a spectrum may take.
    let mesh = orders.iter().filter(|o| o.of_mesh).map(|o| o.order);
    let mesh = mesh.fold(1.0_f64, f64::max) / look.multiples as f64;
    let lasts = recorder.apart() * turns.len() as f64;
    let rising = mesh * (fastest - slowest) / TAU / lasts;
    let Some(by_time) = cut.by_time(rising) else {
        return Err("too few samples for a spectrum; use more (--samples)".into());
    };
    let nyquist = 0.25 / recorder.apart();
    let top_hz = (top * fastest / TAU).min(nyquist);
    let values: Vec<f64> = orders.iter().map(|o| o.order).collect();
    let (mut channels, mut kinds) = (Vec::new(), Vec::new());
    let mut lines = [Vec::new(), Vec::new()];
    for quantity in recorded.quantities(recorder, from) {
        let first = !kinds.contains(&quantity.kind);
        kinds.push(quantity.kind);
        let mut maps = [Vec::new(), Vec::new()];
        if first {
            for (k, (windows, highest)) in [(&by_time, top_hz), (&by_turns, top)]
                .into_iter()
                .enumerate()
            {
                let made = map(&cut, windows, &quantity.histories, highest);
                lines[k] = made.lines;
                maps[k] = rows(made.amplitudes);
            }
        }
        let [spectra, order_spectra] = maps;
        channels.push(RunUpChannel {
            orders: rows(follow(&cut, &by_turns, &quantity.histories, &values)),
            column: quantity.column,
            name: quantity.name,
            unit: quantity.unit.into(),
            spectra,
            order_spectra,
        });
    }
    let [of_time, of_turns] = lines;
    Ok(ModelRunUp {
        gear: name,
        onset_s: recorder.time(from),
        turns: turned,
        lowest_rad_s: slowest,
        highest_rad_s: fastest,
        orders,
        by_time: axes(&by_time, of_time),
        by_turns: axes(&by_turns, of_turns),
        channels,
        ..ModelRunUp::default()
    })
}
