//! Arguments of `stability`.

use crate::cli::arguments::BoundedOutput;
use crate::cli::values::{positive_load, time};
use crate::experiment::conditions::logarithmic;
use crate::studies::stability::axis::Axis;
use crate::studies::stability::scene::{AxisValues, COLUMNS, MOST, ROWS, Span};
use clap::Args;

const EXAMPLES: &str = "\
Examples:
  gearbench stability spur_impact                        the maps of the scene
  gearbench stability spur_impact --grid 24x16           finer
  gearbench stability spur_impact --models rigid --integrators velocity-verlet,rk4 --steps 1e-7:1e-4
  gearbench stability spur_rotation --models movable-teeth-3.6e9 --axis tooth-stiffness=5.6e7:3.6e9
  gearbench stability hammer --axis damping=0,0.05,0.2 --axis speed=0.5:2:3

Every cell of a map is a run of the scene with one status: converged, inaccurate, energy growth, chatter, newton
failure, step underflow, blow-up, tunnelling, adhesive force or timeout. At the scene's own parameters the study
determines the largest stable step to 2 % and compares it with the theoretical limit, if one is known.

Axes: contact-stiffness and speed (factors on the values of the scene), tooth-stiffness (N/m), damping (ratio), modes,
rho-inf, hht-alpha. A second axis makes one panel per value. Without --axis, [study] stability of the scene defines
the maps.

Results besides report and record (--out DIR, default out/SCENE/stability/):
  stability.csv         one line per run
  stability_limits.csv  the largest stable steps and their theoretical limits
  timings.csv           wall time per run";

/// Arguments of `stability`.
#[derive(Args, Clone, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Stability {
    /// Name of a shipped scene, or path of a scene file (.toml)
    pub scene: String,
    /// Models of the scene by label, separated by commas [default: those of the scene's maps]
    #[arg(long, value_name = "A,B")]
    pub models: Option<String>,
    /// Integrators separated by commas: id or id(name=value) [default: those of the scene's maps]
    #[arg(long, value_name = "X,Y")]
    pub integrators: Option<String>,
    /// Parameter of a map besides the step: NAME=FROM:TO, NAME=FROM:TO:POINTS or NAME=A,B,C; a second one gives panels
    #[arg(long, value_name = "NAME=VALUES", value_parser = axis)]
    pub axis: Vec<AxisValues>,
    /// Steps with a unit (10ns:1us), or in seconds [default: the range of the scene, else a range about the period of
    /// the model's fastest oscillation]
    #[arg(long, value_name = "FROM:TO[:POINTS]", value_parser = span)]
    pub steps: Option<Span>,
    /// Tolerances of adaptive methods [default: the range of the scene, else 1e-9 to 1e-1]
    #[arg(long, value_name = "FROM:TO[:POINTS]", value_parser = tolerances)]
    pub rtol: Option<Span>,
    /// Number of steps and number of values of the first axis, within the same ranges
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = grid)]
    pub grid: Option<[usize; 2]>,
    /// Simulated time in seconds [default: the duration of the scene's maps]
    #[arg(long, value_name = "S", value_parser = positive_load)]
    pub duration: Option<f64>,
    /// Number of steps, rejected ones included, after which a run counts as a timeout [default: the number of the
    /// scene, else 200000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub max_steps: Option<u64>,
    /// Do not refine the largest stable steps
    #[arg(long)]
    pub no_refine: bool,
    /// Number of simultaneous runs [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Where results go, and how long a run may take.
    #[command(flatten)]
    pub run: BoundedOutput,
}

fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// `FROM:TO` or `FROM:TO:POINTS`, each end read by `number`.
fn ends(
    text: &str,
    points: usize,
    number: fn(&str) -> Result<f64, String>,
) -> Result<Span, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let (from, to, points) = match parts.as_slice() {
        [from, to] => (number(from)?, number(to)?, points),
        [from, to, n] => match n.trim().parse::<u32>() {
            Ok(n) if (2..=MOST).contains(&n) => (number(from)?, number(to)?, n as usize),
            _ => return Err(format!("`{n}` points; expected 2 to {MOST}")),
        },
        _ => return Err("expected FROM:TO or FROM:TO:POINTS, for example 1e-8:1e-5:12".into()),
    };
    if !(from > 0.0 && to > from) {
        return Err(format!("from {from:e} to {to:e}: expected 0 < FROM < TO"));
    }
    Ok(Span { from, to, points })
}

fn span(text: &str) -> Result<Span, String> {
    ends(text, COLUMNS, time)
}

fn tolerances(text: &str) -> Result<Span, String> {
    let span = ends(text, COLUMNS, number)?;
    if span.to < 1.0 {
        Ok(span)
    } else {
        Err("a tolerance is less than 1".into())
    }
}

fn grid(text: &str) -> Result<[usize; 2], String> {
    let side = |t: &str| match t.trim().parse::<u32>() {
        Ok(n) if (2..=MOST).contains(&n) => Ok(n as usize),
        _ => Err(format!("`{t}`: expected 2 to {MOST}")),
    };
    match text.split_once('x') {
        Some((columns, rows)) => Ok([side(columns)?, side(rows)?]),
        None => Err("expected COLUMNSxROWS, for example 24x16".into()),
    }
}

fn axis(text: &str) -> Result<AxisValues, String> {
    let (name, rest) = text.split_once('=').unwrap_or((text, ""));
    let known: Vec<&str> = Axis::ALL.iter().map(|a| a.id()).collect();
    let axis = (Axis::ALL.into_iter().find(|a| a.id() == name.trim()))
        .ok_or_else(|| format!("there is no axis `{name}`; there are {}", known.join(", ")))?;
    let values = if rest.is_empty() {
        axis.defaults()
    } else if rest.contains(':') {
        let s = ends(rest, ROWS, number)?;
        logarithmic(s.from, s.to, s.points)
    } else {
        rest.split(',').map(number).collect::<Result<_, _>>()?
    };
    if values.is_empty() {
        return Err(format!(
            "{name} needs values, for example {name}=5.6e7:3.6e9"
        ));
    }
    AxisValues::new(axis, values).map_err(|x| {
        let [low, high] = axis.range();
        format!("{name} {x} lies outside {low} to {high}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_read() {
        let s = span("1e-8:1e-5:4").unwrap();
        assert_eq!((s.from, s.to, s.points), (1e-8, 1e-5, 4));
        assert_eq!(span("1:2").unwrap().points, COLUMNS);
        assert_eq!(span("10ns:1us").unwrap(), span("1e-8:1e-6").unwrap());
        assert_eq!(grid("24x16"), Ok([24, 16]));
        let a = axis("damping=0.2,0,0.05").unwrap();
        assert_eq!((a.axis, a.values), (Axis::Damping, vec![0.0, 0.05, 0.2]));
        assert_eq!(axis("tooth-stiffness=1e9:1e10:3").unwrap().values.len(), 3);
        assert_eq!(axis("rho-inf").unwrap().values, Axis::RhoInf.defaults());
    }

    #[test]
    fn what_cannot_be_says_what_could() {
        for (got, word) in [
            (span("1e-5:1e-8").map(|_| ()), "FROM < TO"),
            (span("1e-5").map(|_| ()), "1e-8:1e-5:12"),
            (span("1:2:1").map(|_| ()), "points"),
            (tolerances("1e-3:1").map(|_| ()), "less than 1"),
            (grid("24").map(|_| ()), "24x16"),
            (axis("stiffness=1:2").map(|_| ()), "contact-stiffness"),
            (axis("damping=2").map(|_| ()), "outside"),
            (axis("tooth-stiffness").map(|_| ()), "needs values"),
            (axis("speed=x").map(|_| ()), "not a number"),
        ] {
            let e = got.unwrap_err();
            assert!(e.contains(word), "{e}");
        }
    }
}
