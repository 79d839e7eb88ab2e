//! Two gears held at their hubs: equilibrium at a position and an approach, or under a force.

use gearbench_integrators::equilibrium::{EquilibriumError, EquilibriumOptions, equilibrium};
use gearbench_integrators::system::State;
use gearbench_models::error::BuildError;
use gearbench_models::gear::table::Model;
use gearbench_models::geometry::Side;
use gearbench_models::law::Damping;
use gearbench_models::scene::Scene;
use gearbench_models::spec::{
    Body, MeshLayout, Modelling, Mount, Profile, SceneSpec, effective_radius, mesh_layout,
};

/// Largest last Newton correction over the approach.
const TOLERANCE: f64 = 1e-9;
/// The force asked for is met to this part of it.
const FORCE_TOLERANCE: f64 = 1e-7;
/// Equilibria that a force may take.
const FORCE_TRIALS: u32 = 40;
/// First guess of the mesh stiffness over the width [N/m^2]: a steel pair.
const FIRST_GUESS: f64 = 1.4e10;
/// Part of the base pitch that an approach may reach: a hundredth is far beyond elastic teeth.
const LARGEST_APPROACH: f64 = 0.01;
/// Relative step of the tangent.
const TANGENT_STEP: f64 = 5e-3;

/// Why a position has no static contact to report.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are about")]
pub enum StaticsError {
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(
        "static tooth contact is that of one mesh of two gears, but the scene has {gears} gears and {meshes} meshes; leave the others out"
    )]
    NotAPair { gears: usize, meshes: usize },
    #[error("at s = {s:.6e} m, approach {approach:.4e} m: {source}")]
    Equilibrium {
        s: f64,
        approach: f64,
        source: EquilibriumError,
    },
    #[error(
        "at s = {s:.6e} m no approach up to {approach:.4e} m carries {force:.4e} N: the last one carried {reached:.4e} N; ask for less load"
    )]
    Force {
        s: f64,
        force: f64,
        approach: f64,
        reached: f64,
    },
    #[error("no tooth pair presses on the path of contact at an approach of {approach:.4e} m")]
    NoContact { approach: f64 },
    #[error("{what} is {value}; it must be finite{and}")]
    Value {
        what: &'static str,
        value: f64,
        and: &'static str,
    },
}

/// What one tooth pair carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce {
    /// Base pitches by which the pair stands ahead of the reference pair on the path.
    pub offset: i64,
    /// Its part of the force [N].
    pub force: f64,
}

/// Equilibrium at a position.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedContact {
    /// Position of the reference pair [m].
    pub s: f64,
    /// Approach [m].
    pub approach: f64,
    /// Force [N].
    pub force: f64,
    /// Pairs that carry something, by their offset.
    pub pairs: Vec<PairForce>,
}

impl LoadedContact {
    /// Part of the force that the pair `offset` base pitches ahead carries [N].
    pub fn pair(&self, offset: i64) -> f64 {
        let of = self.pairs.iter().find(|p| p.offset == offset);
        of.map_or(0.0, |p| p.force)
    }
}

/// Two gears of a scene, both held at their hubs.
pub struct LoadedPair {
    scene: Scene,
    state: State,
    layout: MeshLayout,
    sign: f64,
    /// Displacement of each hub per path coordinate of its own.
    displacement_per_path: [f64; 2],
    effective_radius: f64,
    /// By so much the approach may be negative: teeth stand ahead of their places [m].
    ahead: f64,
    /// Path coordinate of the reference pair at zero displacement [m].
    start: f64,
    equilibria: u64,
    iterations: u64,
}

impl LoadedPair {
    /// Takes gears, models and contact of a scene with one mesh. Mounts, loads and speeds are replaced by held
    /// hubs, damping and friction are left out; the flank that carries is the one of the mesh's start.
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
            if let Some(points) = &mut contact.points {
                points.damping = 0.0;
            }
        }
        let [a, b] = mesh.gears;
        let layout = mesh_layout(&spec.gears[a], &spec.gears[b])?;
        let sign = match mesh.start.side {
            Side::Left => 1.0,
            Side::Right => -1.0,
        };
        let start = mesh.start.path_coordinate.unwrap_or(layout.pitch_point);
        let effective_radii = [a, b].map(|i| effective_radius(&spec.gears[i].body));
        let per_displacement = |i: usize| match &spec.gears[i].body {
            Body::Gear(g) => g.r_base(),
            Body::Rack(_) => -layout.working_pressure_angle.cos(),
        };
        let displacement_per_path = [a, b].map(|i| sign / per_displacement(i));
        let ahead = [a, b].map(|i| match &spec.gears[i].body {
            Body::Gear(g) => g.greatest_tooth_deviation() / g.base_helix_angle().cos(),
            Body::Rack(_) => 0.0,
        });
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
            effective_radius: effective_radii[0],
            ahead: ahead[0] + ahead[1],
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

    /// Equilibria found so far, and the Newton iterations they took.
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
    /// it (secant, held inside a bracket).
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
        // Approach, counted from where no tooth can touch, and force of the bracket; the force grows with it.
        let (mut low, mut high): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
        let mut slope = FIRST_GUESS * self.layout.face_width;
        let mut at = (force / slope).min(0.5 * most);
        for _ in 0..FORCE_TRIALS {
            let found = self.at_approach(s, at - self.ahead)?;
            let off = found.force - force;
            if off.abs() <= FORCE_TOLERANCE * force {
                return Ok(found);
            }
            let last = (at, found.force);
            if off < 0.0 {
                if at >= most {
                    return Err(StaticsError::Force {
                        s,
                        force,
                        approach: at,
                        reached: found.force,
                    });
                }
                // The slope from the end of the bracket on the same side is that of the contact's present branch.
                if last.1 > low.1 && low.0 > 0.0 {
                    slope = (last.1 - low.1) / (last.0 - low.0);
                }
                low = last;
            } else {
                if let Some(h) = high
                    && h.1 > last.1
                {
                    slope = (h.1 - last.1) / (h.0 - last.0);
                }
                high = Some(last);
            }
            if let Some(h) = high
                && low.0 > 0.0
                && low.1 > 0.0
            {
                slope = (h.1 - low.1) / (h.0 - low.0);
            }
            let newton = at - off / slope;
            let (bottom, top) = (low.0, high.map_or(most, |h| h.0));
            at = if newton > bottom && newton < top {
                newton
            } else if high.is_some() {
                0.5 * (bottom + top)
            } else {
                (2.0 * at).min(most)
            };
        }
        Err(StaticsError::Force {
            s,
            force,
            approach: at,
            reached: low.1,
        })
    }

    /// Tangent stiffness `dF/dd` [N/m] at an equilibrium, by central differences of half a per cent.
    pub fn tangent(&mut self, at: &LoadedContact) -> Result<f64, StaticsError> {
        let h = TANGENT_STEP * at.approach;
        let above = self.at_approach(at.s, at.approach + h)?.force;
        let below = self.at_approach(at.s, at.approach - h)?.force;
        Ok((above - below) / (2.0 * h))
    }

    /// Sums the contact forces by tooth pair.
    fn read(&mut self, s: f64, approach: f64) -> LoadedContact {
        let contacts = self.scene.contact_forces(self.state.at());
        let first = self.scene.meshes()[0].gears[0];
        let hub = self.scene.gears()[first].model.hub();
        let mut pairs: Vec<PairForce> = Vec::new();
        for c in &contacts {
            // The reference pair has tooth 0; a pair ahead belongs to a tooth ahead in the first gear's sense of
            // turning.
            let offset = c.teeth[0].index * self.sign as i64;
            let force = self.sign * hub.effective_radius(&c.x, &c.force) / self.effective_radius;
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
        }
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
