//! Static or steady equilibrium of a scene under its loads, and its linearisation there.
//!
//! A free train accelerates as a whole under its loads. With the rigid-body motions `Z` of the mechanism, that part of
//! the forces `f` causes no deflection and is left out,
//!
//! ```text
//! P f(q, v) = 0,    P = 1 - M Z Z^T,    v = Z Z^T M v_0 + v_d
//! ```
//!
//! which is solved by Newton's method in the modes of the stiffness at each state. Gears without contact have a
//! relative motion without stiffness, which is followed by a step with a bound on how far flanks close and bodies
//! deform. The rotation of hubs itself has no bound: soft shafts twist as far as their torque requires. A step ends, by
//! bisection, where the power of the forces along it changes its sign: the potential of loads and contacts decreases up
//! to there, and contacts close and open accordingly. The velocities are those of the rigid-body motions nearest to the
//! start, plus the velocities `v_d` of members that follow driven gears in the mechanism, so that dampers of contacts
//! and shafts have no effect, while viscous loads do. Gears on a carrier have its velocity at their position, and their
//! centrifugal forces are part of `f`.

use super::admissible_motions::{AdmissibleMotions, Modes};
use super::{LoadedStateError, Patience};
use gearbench_integrators::system::{SecondOrderSystem, State};
use gearbench_models::scene::{LinearisedScene, Scene};
use nalgebra::DVector;

/// Share of the highest eigenvalue below which a motion has no stiffness.
const SLACK: f64 = 1e-12;
/// Largest Newton step that closes flanks, in typical deflections.
const BOUND: f64 = 20.0;
/// Largest Newton step otherwise [m]; far less than a tooth.
const FARTHEST: f64 = 2e-5;
/// Share of the initial power along a step at which the line search may end.
const LEFT: f64 = 0.5;
/// Largest Newton step at convergence, in typical deflections.
const FOUND: f64 = 1e-7;
/// Residual forces on gears without contact below this share of all forces are rounding errors.
const ROUNDING: f64 = 1e-10;
/// Bounds on the number of Newton steps, and of bisections of one step.
const MOST_STEPS: u32 = 200;
const MOST_HALVINGS: u32 = 45;

/// A loaded state of equilibrium with the linearised scene and its modes.
pub struct LoadedState {
    /// Coordinates, velocities and discrete state of the equilibrium.
    pub state: State,
    /// The scene linearised at the state.
    pub linear: LinearisedScene,
    /// The space of motions without the rigid-body ones.
    pub space: AdmissibleMotions,
    /// Natural modes without the rigid-body motions.
    pub modes: Modes,
    /// Rigid-body motions `y`, in coordinates of unit mass.
    pub rigid: Vec<DVector<f64>>,
    /// Number of Newton steps; 0 if the start is used as it is.
    pub steps: u32,
    /// Sum of the normal forces of each mesh [N].
    pub pressed: Vec<f64>,
}

/// Sum of the normal forces of each mesh [N].
pub(super) fn normal_forces(scene: &mut Scene, s: &State) -> Vec<f64> {
    let mut sums = vec![0.0; scene.meshes().len()];
    for contact in scene.contact_forces(s.at()) {
        sums[contact.mesh] += contact.normal_force;
    }
    sums
}

/// The remaining motions, the rigid-body motions `y`, and the velocities of the mechanism.
type Motions = (AdmissibleMotions, Vec<DVector<f64>>, Vec<f64>);

/// Rigid-body motions and velocities of the mechanism, without contact.
fn motions(
    scene: &mut Scene,
    s: &State,
    linear: &LinearisedScene,
) -> Result<Motions, LoadedStateError> {
    let mut space = AdmissibleMotions::new(&linear.mass)?;
    space.constrain(&scene.constraints());
    let mechanism = scene.mechanism(s.at(), &linear.mass);
    let modes = space.modes(&mechanism.stiffness)?;
    let floor = slack_of(&modes);
    let slack = modes.squares.iter().take_while(|x| **x <= floor).count();
    // Directions driven by the ground are constrained; bodies that follow it, and driven hubs, store no strain energy.
    let mut speeds = space.held_velocity(&s.v, space.constraints());
    let held = DVector::from_column_slice(&speeds);
    let driven = DVector::from_column_slice(&mechanism.driven) - &mechanism.stiffness * held;
    let driven = modes.vectors.tr_mul(&space.force(driven.as_slice()));
    let start = modes.vectors.tr_mul(&space.velocity(&s.v));
    let along = |(i, square): (usize, &f64)| {
        if i < slack {
            start[i]
        } else {
            driven[i] / square
        }
    };
    let along = modes.squares.iter().enumerate().map(along);
    let along = DVector::from_iterator(space.motions(), along);
    let moving = space.displacement(&(&modes.vectors * along));
    speeds.iter_mut().zip(moving).for_each(|(v, x)| *v += x);
    let of = |i: usize| space.whole(&modes.vectors.column(i).into_owned());
    let rigid: Vec<_> = (0..slack).map(of).collect();
    for y in &rigid {
        space.constrain_along(y.clone());
    }
    Ok((space, rigid, speeds))
}

/// Result of the line search along a step.
enum LineSearch {
    /// The forces along the step hardly change: no flank is in contact.
    Free,
    /// At this share of the step the forces along it are nearly balanced.
    Met(f64),
}

/// Quantities that all iterations of a search for equilibrium share.
struct Search<'a> {
    scene: &'a mut Scene,
    space: AdmissibleMotions,
    rigid: Vec<DVector<f64>>,
    /// Typical deflections of all coordinates.
    scales: Vec<f64>,
    /// Coordinates that are rotations of hubs, or motions of racks.
    turning: Vec<bool>,
    /// Closing of the flanks of each mesh by the motion of its hubs.
    closings: Vec<Vec<(usize, f64)>>,
    /// Typical deflection of flanks [m].
    deflection: f64,
}

/// A Newton step.
struct Step {
    x: Vec<f64>,
    /// Its largest component, in typical deflections.
    largest: f64,
    /// The largest of its closings of flanks and of its components that are no rotations of hubs, in typical
    /// deflections.
    deformed: f64,
}

impl Search<'_> {
    fn forces(&mut self, s: &State) -> Vec<f64> {
        let mut f = vec![0.0; s.q.len()];
        self.scene.force(s.at(), &mut f);
        self.scene.add_centrifugal(s.at(), &mut f);
        f
    }

    /// The state displaced by a share of a displacement.
    fn moved(&self, s: &State, displacement: &[f64], part: f64) -> State {
        let mut moved = s.clone();
        (moved.q.iter_mut().zip(displacement)).for_each(|(q, x)| *q += part * x);
        self.scene.follow_carriers(&mut moved);
        moved
    }

    /// Line search along a step with initial forces `on` the modes. Loads and contacts have a potential, which
    /// decreases along the step until the power of all forces along it, `f . x`, changes its sign.
    fn part_of(&mut self, s: &State, step: &[f64], modes: &Modes, on: &DVector<f64>) -> LineSearch {
        let along = modes.vectors.tr_mul(&self.space.velocity(step));
        let before = on.dot(&along);
        let (mut low, mut high, mut part) = (0.0, 1.0, 1.0);
        for trials in 0..MOST_HALVINGS {
            let trial = self.moved(s, step, part);
            let after = self.on_modes(&trial, modes).dot(&along);
            if trials == 0 && after > LEFT * before {
                return LineSearch::Free;
            }
            if after.abs() <= LEFT * before || (trials == 0 && after >= 0.0) {
                return LineSearch::Met(part);
            }
            if after > 0.0 {
                low = part;
            } else {
                high = part;
            }
            part = 0.5 * (low + high);
        }
        LineSearch::Met(if low > 0.0 { low } else { part })
    }

    /// Member with the largest residual force, and that force relative to the largest load.
    fn imbalance(&self, s: &State, on: &DVector<f64>) -> (f64, String) {
        let left = self.space.force_of(on);
        let gears = self.scene.gears();
        let along = |i: usize, force: f64| (force * self.scales[i]).abs();
        let loads = gears.iter().filter(|g| !g.range().is_empty()).map(|g| {
            let speed = g.model.hub_state(g.at(s.at())).speed;
            along(g.range().start, g.load(s.t, speed))
        });
        let load = loads.fold(f64::MIN_POSITIVE, f64::max);
        let parts = left
            .iter()
            .enumerate()
            .map(|(i, f)| (i, along(i, *f) / load));
        let (place, most) = parts.fold((0, 0.0), |most, x| if x.1 > most.1 { x } else { most });
        let owner = gears.iter().find(|g| g.range().contains(&place));
        (most, owner.map_or_else(String::new, |g| g.name.clone()))
    }

    /// Generalised forces on the modes.
    fn on_modes(&mut self, s: &State, modes: &Modes) -> DVector<f64> {
        let f = self.forces(s);
        modes.vectors.tr_mul(&self.space.force(&f))
    }

    /// Displacement under forces on the modes with additional stiffness `more`.
    fn answer(&self, modes: &Modes, on: &DVector<f64>, more: f64) -> Step {
        let floor = slack_of(modes);
        let u = DVector::from_fn(on.len(), |i, _| {
            let square = modes.squares[i].abs() + more;
            if square <= floor { 0.0 } else { on[i] / square }
        });
        let x = self.space.displacement(&(&modes.vectors * u));
        let along = |(i, x): (usize, &f64)| (i, (x / self.scales[i]).abs());
        let moved = || x.iter().enumerate().map(along);
        let bent = moved().filter(|(i, _)| !self.turning[*i]).map(|m| m.1);
        let closing = self.closings.iter().map(|row| {
            let closed: f64 = row.iter().map(|&(i, w)| w * x[i]).sum();
            (closed / self.deflection).abs()
        });
        Step {
            largest: moved().map(|m| m.1).fold(0.0, f64::max),
            deformed: bent.chain(closing).fold(0.0, f64::max),
            x,
        }
    }
}

fn slack_of(modes: &Modes) -> f64 {
    SLACK * modes.squares.last().map_or(0.0, |x| x.abs())
}

/// Computes the loaded state of a scene from its start; `loads` is true if loads act.
///
/// # Errors
/// [`LoadedStateError`] if there is no equilibrium, or if it was not found.
pub fn loaded(
    scene: &mut Scene,
    loads: bool,
    patience: &Patience<'_>,
) -> Result<LoadedState, LoadedStateError> {
    let mut s = scene.initial();
    let first = scene.without_damping(s.at());
    if !first
        .stiffness
        .iter()
        .chain(&first.mass)
        .all(|x| x.is_finite())
    {
        return Err(LoadedStateError::Matrices("its tangent is not finite"));
    }
    let start = s.v.clone();
    let mut sides = scene.acting_sides(s.at());
    let (space, rigid, speeds) = motions(scene, &s, &first)?;
    s.v = speeds;
    scene.follow_carriers(&mut s);
    let (mut scales, mut speeds) = (vec![0.0; s.q.len()], vec![0.0; s.q.len()]);
    scene.scales(&mut scales, &mut speeds);
    let mut turning = vec![false; s.q.len()];
    // Closings do not include the motion of carriers.
    if scene.carrier_coordinates().is_empty() {
        for g in scene.gears().iter().filter(|g| g.model.hub().is_free()) {
            turning[g.range().start] = true;
        }
    }
    let mut search = Search {
        deflection: scene.magnitudes().deflection,
        closings: scene.closings(s.at()),
        scene,
        space,
        rigid,
        scales,
        turning,
    };
    let mut steps = 0;
    let mut bound = BOUND;
    let farthest = BOUND.max(FARTHEST / search.deflection);
    loop {
        patience.check()?;
        let mut linear = search.scene.without_damping(s.at());
        let modes = search.space.modes(&linear.stiffness)?;
        let all = search.forces(&s);
        let on = modes.vectors.tr_mul(&search.space.force(&all));
        if on.iter().any(|x| !x.is_finite()) {
            return Err(LoadedStateError::Matrices("its forces are not finite"));
        }
        let apart = (modes.squares.iter().zip(&on))
            .filter(|(square, _)| **square <= slack_of(&modes))
            .fold(0.0_f64, |m, (_, on)| m.max(on.abs()));
        let pushes = apart > ROUNDING * search.space.size_of(&all);
        let mut step = search.answer(&modes, &on, 0.0);
        let balanced = !pushes && step.largest <= FOUND;
        let acting = search.scene.acting_sides(s.at());
        if loads && balanced && acting != sides && steps < MOST_STEPS {
            steps += 1;
            // On which flanks hubs without bearings float is known only now.
            sides = acting;
            s.v.clone_from(&start);
            (search.space, search.rigid, s.v) = motions(search.scene, &s, &linear)?;
            search.scene.follow_carriers(&mut s);
            continue;
        }
        if !loads || balanced {
            // A matrix by columns costs as much as the search itself, which needs none.
            linear.damping = search.scene.damping_matrix(s.at());
            if loads {
                s = search.moved(&s, &step.x, 1.0);
            }
            let pressed = normal_forces(search.scene, &s);
            return Ok(LoadedState {
                pressed,
                state: s,
                linear,
                modes,
                space: search.space,
                rigid: search.rigid,
                steps,
            });
        }
        if steps == MOST_STEPS {
            let on = search.on_modes(&s, &modes);
            let (imbalance, at) = search.imbalance(&s, &(&modes.vectors * on));
            return Err(LoadedStateError::Unbalanced {
                steps,
                imbalance,
                at,
            });
        }
        steps += 1;
        if pushes || step.deformed > bound {
            // As if masses were tied to where they are: what has no stiffness moves as far as the bound.
            let by_one = search.answer(&modes, &on, 1.0).deformed;
            let mut more = (2.0 * slack_of(&modes)).max(1e-6 * by_one / bound);
            loop {
                step = search.answer(&modes, &on, more);
                if step.deformed <= bound || !step.deformed.is_finite() {
                    break;
                }
                more *= 2.0;
            }
        }
        let part = search.part_of(&s, &step.x, &modes, &on);
        // Bodies without contact along the step may move further.
        bound = match part {
            LineSearch::Free => (2.0 * bound).min(farthest),
            LineSearch::Met(_) => BOUND,
        };
        let low = match part {
            LineSearch::Free => 1.0,
            LineSearch::Met(part) => part,
        };
        s = search.moved(&s, &step.x, low);
    }
}
