//! Work and precision of the rigid model compared with SciPy, on the identical impact and hammering problems.
//!
//! ```sh
//! python3 benchmarks/scripts/scipy_floor.py scipy.csv     # some minutes; pip install numpy scipy
//! cargo bench --bench against_scipy -- $PWD/scipy.csv [--csv FILE]
//! ```
//!
//! `--csv` writes the table into a file, after lines with the command, commit, processor and date.
//!
//! At each error level the cheapest run of either side counts, whatever its method and tolerance. Error: rms of
//! the pinion's speed over its span, 5001 points, against the exact piecewise solution. Time: wall clock of the
//! integration alone, median. (Not by criterion: the hundreds of candidates are alternatives to choose from, no pairs, and
//! SciPy's times are of another process.)

mod support;

use gearbench::experiment::machine;
use gearbench_integrators::{METHODS, Resolution, Stepping};
use gearbench_models::scene::{Channel, OfGear};
use support::problem::Problem;
use support::scenes;
use support::sweep::{record, sweep, time};

struct Point {
    what: String,
    error: f64,
    wall: f64,
}

fn gearbench(problem: Problem) -> Vec<Point> {
    let mut scene = problem.scene();
    let n = 5000;
    let grid: Vec<f64> = (0..=n)
        .map(|i| problem.end() * f64::from(i) / f64::from(n))
        .collect();
    let exact = problem.exact(&grid);
    let span = exact.iter().fold(f64::MIN, |a, &b| a.max(b))
        - exact.iter().fold(f64::MAX, |a, &b| a.min(b));
    let mut points = Vec::new();
    for row in METHODS {
        for resolution in sweep(row.info.stepping != Stepping::Fixed, 2e-5) {
            if let Resolution::Step(h) = resolution
                && problem.end() / h > 3e5
            {
                continue;
            }
            let mut method = row.build();
            let Ok(speed) = record(
                &mut scene,
                method.as_mut(),
                resolution,
                &grid,
                Channel::Gear(0, OfGear::Speed),
            ) else {
                continue;
            };
            let mean = speed
                .iter()
                .zip(&exact)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                / speed.len() as f64;
            let (wall, _) = time(&mut scene, method.as_mut(), resolution, problem.end());
            points.push(Point {
                what: format!("{} {}", row.info.id, scenes::resolution(resolution)),
                error: mean.sqrt() / span,
                wall,
            });
        }
    }
    points
}

fn scipy(path: &str, problem: Problem) -> Vec<Point> {
    let mut reader = csv::Reader::from_path(path)
        .unwrap_or_else(|e| panic!("{path}: {e}; make it with benchmarks/scripts/scipy_floor.py"));
    reader
        .deserialize()
        .map(|r: Result<(String, String, f64, f64, f64, f64), _>| r.unwrap())
        .filter(|r| r.0 == problem.name())
        .map(|r| Point {
            what: format!("{} {:.0e}", r.1, r.2),
            error: r.3,
            wall: r.4,
        })
        .collect()
}

fn cheapest(points: &[Point], level: f64) -> Option<&Point> {
    points
        .iter()
        .filter(|p| p.error <= level)
        .min_by(|a, b| a.wall.total_cmp(&b.wall))
}

/// Returns the lines above a stored table.
fn signature() -> String {
    format!(
        "# cargo bench --bench against_scipy -- scipy.csv --csv FILE\n# commit {}, {}, {}\n",
        machine::commit_of_checkout(),
        machine::machine().cpu,
        machine::now()
    )
}

#[allow(clippy::print_stdout)]
fn main() {
    let mut table = signature() + "problem,error,gearbench_s,scipy_s,ratio\n";
    let path = std::env::args().skip(1).find(|a| a.ends_with(".csv"));
    for problem in [Problem::Impact, Problem::Hammer] {
        let ours = gearbench(problem);
        let theirs = path.as_deref().map_or_else(Vec::new, |p| scipy(p, problem));
        println!(
            "\n{}: cheapest run at an rms error of the pinion speed of at most",
            problem.name()
        );
        println!(
            "{:>8}  {:>10} {:<26} {:>10} {:<24} {:>7}",
            "error", "gearbench", "", "SciPy", "", "ratio"
        );
        for exponent in 2..=9 {
            let level = 10f64.powi(-exponent);
            let Some(a) = cheapest(&ours, level) else {
                continue;
            };
            let wall = |p: &Point| format!("{:.1} us", p.wall * 1e6);
            match cheapest(&theirs, level) {
                Some(b) => {
                    let ratio = b.wall / a.wall;
                    println!(
                        "{level:>8.0e}  {:>10} {:<26} {:>10} {:<24} {ratio:>7.0}",
                        wall(a),
                        a.what,
                        wall(b),
                        b.what
                    );
                    let (name, ours, theirs) = (problem.name(), a.wall, b.wall);
                    table += &format!("{name},{level:.0e},{ours:.4e},{theirs:.4e},{ratio:.4e}\n");
                }
                None => println!("{level:>8.0e}  {:>10} {:<26} {:>10}", wall(a), a.what, "-"),
            }
        }
    }
    if let Some(file) = scenes::after("--csv") {
        std::fs::write(&file, table).unwrap_or_else(|e| panic!("{file}: {e}"));
    }
    if path.is_none() {
        println!(
            "\nSciPy's side: python3 benchmarks/scripts/scipy_floor.py scipy.csv, then give scipy.csv here"
        );
    }
}
