//! Two gears with fixed hubs: equilibrium at a position and an approach, or under a force.

use gearbench_integrators::equilibrium::{EquilibriumError, EquilibriumOptions, equilibrium};
use gearbench_integrators::system::State;
use gearbench_models::contact::pairs::LinePressure;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::{ContactForce, Scene};
use gearbench_models::spec::{Body, MeshLayout, Modelling, Mount, Profile, SceneSpec, mesh_layout};

/// Largest last Newton correction over the approach.
const TOLERANCE: f64 = 1e-9;
/// Relative tolerance of the requested force.
const FORCE_TOLERANCE: f64 = 1e-7;
/// Equilibria that a force may take: halving alone comes to the edge with fewer.
const FORCE_TRIALS: u32 = 100;
/// Width of a bracket over the approach below which the force jumps inside it.
const EDGE: f64 = 1e-10;
/// Largest distance of surfaces through nodes in front of the flanks, relative to the base pitch.
const AHEAD: f64 = 1e-4;
/// First guess of the mesh stiffness over the width [N/m^2]: a steel pair.
const FIRST_GUESS: f64 = 1.4e10;
/// Part of the base pitch that an approach may reach: that of steel teeth of module 2 mm under 1600 N/mm.
const LARGEST_APPROACH: f64 = 0.02;
/// Relative step of the tangent.
const TANGENT_STEP: f64 = 5e-3;

/// Why a position has no static contact to report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum StaticsError {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(
        "static tooth contact needs one mesh of two gears, but the scene has {gears} gears and {meshes} meshes; remove the others"
    )]
    NotAPair { gears: usize, meshes: usize },
    #[error("at s = {s:.6e} m, approach {approach:.4e} m: {source}")]
    Equilibrium {
        s: f64,
        approach: f64,
        source: EquilibriumError,
    },
    #[error(
        "at s = {s:.6e} m no approach up to {approach:.4e} m carries {force:.4e} N: the last one carried {reached:.4e} N; use a smaller load"
    )]
    Force {
        s: f64,
        force: f64,
        approach: f64,
        reached: f64,
    },
    #[error("no tooth pair is loaded on the path of contact at an approach of {approach:.4e} m")]
    NoContact { approach: f64 },
    #[error("{what} is {value}; it must be finite{and}")]
    Value {
        what: &'static str,
        value: f64,
        and: &'static str,
    },
}

/// Force of one tooth pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce {
    /// Number of base pitches by which the pair is ahead of the reference pair on the path.
    pub offset: i64,
    /// Its part of the force [N].
    pub force: f64,
}

/// Equilibrium at a position.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedContact {
    /// Position of the reference pair [m].
    pub s: f64,
    /// Approach in the transverse plane [m]: the transmission error.
    pub approach: f64,
    /// Force in the transverse plane [N]: torque over transverse base radius. The normal force is larger by `1/cos(beta_b)`.
    pub force: f64,
    /// Pairs that carry something, by their offset.
    pub pairs: Vec<PairForce>,
    /// A pair comes into contact, or leaves it, with its whole force at this very approach, and carries a part of it.
    pub on_edge: bool,
    /// The highest pressure of its lines of contact; `None` where contact is not that of lines.
    pub pressure: Option<LinePressure>,
}

impl LoadedContact {
    /// Part of the force that the pair `offset` base pitches ahead carries [N].
    pub fn pair(&self, offset: i64) -> f64 {
        let of = self.pairs.iter().find(|p| p.offset == offset);
        of.map_or(0.0, |p| p.force)
    }
}

/// Two gears of a scene, both with fixed hubs.
pub struct LoadedPair {
    scene: Scene,
    state: State,
    layout: MeshLayout,
    sign: f64,
    /// Displacement of each hub per path coordinate of its own.
    displacement_per_path: [f64; 2],
    /// By so much the approach may be negative: teeth deviate, and surfaces through nodes bulge [m].
    ahead: f64,
    /// Path coordinate of the reference pair at zero displacement [m].
    start: f64,
    equilibria: u64,
    iterations: u64,
}

impl LoadedPair {
    /// Builds the pair from gears, models and contact of a scene with one mesh. Mounts, loads and speeds are replaced
    /// by fixed hubs, damping and friction are left out; the loaded flank is that of the mesh's start.
    pub fn new(
        spec: &SceneSpec,
        modelling: &Modelling,
        models: &[Model],
    ) -> Result<Self, StaticsError> {
        let (mut spec, mut modelling) = (spec.clone(), modelling.clone());
        if spec.gears.len() != 2 || spec.meshes.len() != 1 {
            return Err(StaticsError::NotAPair {
                gears: spec.gears.len(),
                meshes: spec.meshes.len(),
            });
        }
        for g in &mut spec.gears {
            g.mount = Mount::Driven(Profile::Constant(0.0));
            g.loads.clear();
            g.speed = 0.0;
        }
        let mesh = &mut spec.meshes[0];
        mesh.start.gap = 0.0;
        for contact in &mut modelling.contacts {
            contact.damping = Damping::None;
            contact.friction = None;
            if let Some(points) = contact.flanks.points_mut() {
                *points = points.damped(0.0);
            }
        }
        let [a, b] = mesh.gears;
        let layout = mesh_layout(&spec.gears[a], &spec.gears[b])?;
        let sign = match mesh.start.side {
            Side::Left => 1.0,
            Side::Right => -1.0,
        };
        let start = mesh.start.path_coordinate.unwrap_or(layout.pitch_point);
        let per_displacement = |i: usize| match &spec.gears[i].body {
            Body::Gear(g) => g.sign() * g.r_base(),
            Body::Rack(_) => -layout.working_pressure_angle.cos(),
        };
        let displacement_per_path = [a, b].map(|i| sign / per_displacement(i));
        let ahead = [a, b].map(|i| match &spec.gears[i].body {
            Body::Gear(g) => g.greatest_tooth_deviation() / g.base_helix_angle().cos(),
            Body::Rack(_) => 0.0,
        });
        let base_pitch = layout.base_pitch;
        let scene = Scene::build(&spec, &modelling, models)?;
        let mut state = scene.initial();
        // The hubs rest from 1 s on.
        state.t = 2.0;
        Ok(LoadedPair {
            scene,
            state,
            layout,
            sign,
            displacement_per_path,
            ahead: ahead[0] + ahead[1] + AHEAD * base_pitch,
            start,
            equilibria: 0,
            iterations: 0,
        })
    }

    /// The mesh that does not depend on models: path of contact, pitch point, base pitch, common width.
    pub fn layout(&self) -> &MeshLayout {
        &self.layout
    }

    /// Coordinates that are solved for.
    pub fn unknowns(&self) -> usize {
        self.state.q.len()
    }

    /// Returns the numbers of computed equilibria and of their Newton iterations.
    pub fn work(&self) -> [u64; 2] {
        [self.equilibria, self.iterations]
    }

    /// Equilibrium at a position `s` [m] and an approach [m].
    pub fn at_approach(&mut self, s: f64, approach: f64) -> Result<LoadedContact, StaticsError> {
        finite("the position [m]", s)?;
        finite("the approach [m]", approach)?;
        let [a, b] = self.scene.meshes()[0].gears;
        let displacement = s - self.start;
        self.scene
            .hold(a, (displacement + approach) * self.displacement_per_path[0]);
        self.scene
            .hold(b, -displacement * self.displacement_per_path[1]);
        let size = approach.abs().max(1e-7);
        let options = EquilibriumOptions {
            tolerance: TOLERANCE * size / self.scene.magnitudes().deflection,
            ..EquilibriumOptions::default()
        };
        let work = equilibrium(&mut self.scene, &mut self.state, &options).map_err(|source| {
            StaticsError::Equilibrium {
                s,
                approach,
                source,
            }
        })?;
        self.equilibria += 1;
        self.iterations += work.newton_iterations;
        Ok(self.read(s, approach))
    }

    /// Equilibrium at a position `s` [m] under a force [N] along the line of action, by the approach that carries
    /// it: secants inside a bracket, halved wherever they are slow.
    ///
    /// Where a law lets a pair come into contact with its whole force at once, the force asked for may lie between the
    /// two sides of that approach: the balance stands there, on the edge, the pair carrying the part that is missing.
    pub fn under_force(&mut self, s: f64, force: f64) -> Result<LoadedContact, StaticsError> {
        finite("the force [N]", force)?;
        if force <= 0.0 {
            return Err(StaticsError::Value {
                what: "the force [N]",
                value: force,
                and: " and positive",
            });
        }
        let most = LARGEST_APPROACH * self.layout.base_pitch;
        let met = |found: &LoadedContact| (found.force - force).abs() <= FORCE_TOLERANCE * force;
        let mut low = LoadedContact {
            s,
            approach: -self.ahead,
            force: 0.0,
            pairs: Vec::new(),
            on_edge: false,
            pressure: None,
        };
        // A bracket: the approach grows from where no tooth can touch until it carries the force.
        let mut at = (force / (FIRST_GUESS * self.layout.face_width)).min(0.5 * most);
        let mut high = loop {
            let found = self.at_approach(s, at - self.ahead)?;
            if met(&found) {
                return Ok(found);
            }
            if found.force > force {
                break found;
            }
            if at >= most {
                return Err(StaticsError::Force {
                    s,
                    force,
                    approach: at,
                    reached: found.force,
                });
            }
            // The secant through nothing overshoots a little, so that it ends on the other side.
            let secant = at * force / found.force.max(f64::MIN_POSITIVE);
            at = (1.05 * secant).clamp(1.1 * at, 2.0 * at).min(most);
            low = found;
        };
        // Widths of the bracket now and two trials ago.
        let mut widths = [f64::INFINITY; 2];
        for _ in 0..FORCE_TRIALS {
            let width = high.approach - low.approach;
            if width <= EDGE * (high.approach + self.ahead) {
                return Ok(on_edge(&low, high, force));
            }
            let slope = (high.force - low.force) / width;
            let secant = low.approach + (force - low.force) / slope;
            let slow = width > 0.5 * widths[0];
            widths = [widths[1], width];
            let inside = secant > low.approach && secant < high.approach;
            let at = if slow || !inside {
                0.5 * (low.approach + high.approach)
            } else {
                secant
            };
            let found = self.at_approach(s, at)?;
            if met(&found) {
                return Ok(found);
            }
            if found.force < force {
                low = found;
            } else {
                high = found;
            }
        }
        Err(StaticsError::Force {
            s,
            force,
            approach: high.approach,
            reached: low.force,
        })
    }

    /// Tangent stiffness `dF/dd` [N/m] at an equilibrium, by central differences of half a per cent; on an edge the mean
    /// of those on its two sides.
    pub fn tangent(&mut self, at: &LoadedContact) -> Result<f64, StaticsError> {
        let h = TANGENT_STEP * at.approach;
        let mut force =
            |d: f64| Ok::<_, StaticsError>(self.at_approach(at.s, at.approach + d)?.force);
        let (above, below) = (force(h)?, force(-h)?);
        if at.on_edge {
            let sides = (force(2.0 * h)? - above) + (below - force(-2.0 * h)?);
            return Ok(sides / (2.0 * h));
        }
        Ok((above - below) / (2.0 * h))
    }

    /// Returns all contacts of the last equilibrium.
    pub fn contacts(&mut self) -> Vec<ContactForce> {
        self.scene.contact_forces(self.state.at())
    }

    /// Sums by tooth pair the forces along the line of action that balance the torques of the contacts.
    fn read(&mut self, s: f64, approach: f64) -> LoadedContact {
        let contacts = self.contacts();
        let mut pairs: Vec<PairForce> = Vec::new();
        let pressures = contacts.iter().filter_map(|c| c.pressure);
        let pressure = pressures.max_by(|a, b| a.peak.total_cmp(&b.peak));
        for c in &contacts {
            // The reference pair has tooth 0; a pair ahead belongs to a tooth ahead in the first gear's sense of
            // turning.
            let offset = c.teeth[0].index * self.sign as i64;
            // Where an edge touches off the line of action both torques answer to different forces along it; their mean
            // is what the potential grows by with the approach while the middle of the path stays, whichever gear is
            // the first.
            let along = |k: usize| -c.on_hubs[k] * self.displacement_per_path[k];
            let force = 0.5 * (along(0) + along(1));
            match pairs.iter_mut().find(|p| p.offset == offset) {
                Some(p) => p.force += force,
                None => pairs.push(PairForce { offset, force }),
            }
        }
        pairs.sort_by_key(|p| p.offset);
        LoadedContact {
            s,
            approach,
            force: pairs.iter().map(|p| p.force).sum(),
            pairs,
            on_edge: false,
            pressure,
        }
    }
}

/// Returns the equilibrium between two sides of an approach at which the force jumps: interpolated to the requested
/// force.
fn on_edge(low: &LoadedContact, high: LoadedContact, force: f64) -> LoadedContact {
    let part = (force - low.force) / (high.force - low.force);
    let mut pairs = high.pairs;
    for p in &mut pairs {
        let below = low.pair(p.offset);
        p.force = below + part * (p.force - below);
    }
    let gone = low
        .pairs
        .iter()
        .filter(|l| !pairs.iter().any(|p| p.offset == l.offset));
    let gone: Vec<PairForce> = gone
        .map(|l| PairForce {
            force: (1.0 - part) * l.force,
            ..*l
        })
        .collect();
    pairs.extend(gone);
    pairs.sort_by_key(|p| p.offset);
    LoadedContact {
        force,
        pairs,
        on_edge: true,
        ..high
    }
}

fn finite(what: &'static str, value: f64) -> Result<(), StaticsError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(StaticsError::Value {
            what,
            value,
            and: "",
        })
    }
}
