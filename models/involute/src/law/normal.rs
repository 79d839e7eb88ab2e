//! The normal law: force, derivatives, elastic energy.

use super::damping::Damping;
use super::error::LawError;
use super::half_space::HalfSpace;
use super::user_law::{ForceLaw, SharedUserLaw};
use std::sync::Arc;

/// Speed (m/s) below which motion is neglected; it only keeps a quotient finite.
const LEAST_SPEED: f64 = 1e-15;

/// Load of a mesh, about which its contacts vibrate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshLoad {
    /// Force along the line of action (N); 0 without a load.
    pub force: f64,
    /// Stiffness of a contact (N/m^n).
    pub stiffness: f64,
    /// Reduced mass of both gears along the line of action (kg).
    pub mass: f64,
}

/// Normal force of a law and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LawForce {
    /// Normal force `N` (N).
    pub n: f64,
    /// Derivative `dN/dg` (N/m).
    pub dn_dg: f64,
    /// Derivative `dN/dg'` (N s/m).
    pub dn_dgdot: f64,
    /// Derivative `dN/dk` (m^n).
    pub dn_dk: f64,
}

/// Length [m] by which a force that a law cuts off at zero counts as ended.
pub(super) const ENDED: f64 = 1e-12;

/// Exponents that have fast powers, and forces that are no power.
#[derive(Debug, Clone, PartialEq)]
enum Power {
    One,
    ThreeHalves,
    General,
    /// Approach of half-spaces under a line load; see [`HalfSpace`].
    HalfSpace(HalfSpace),
    /// Force of a law that a program adds, with its damping; see [`ForceLaw`].
    User(SharedUserLaw),
}

/// A validated normal contact law.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    exponent: f64,
    damping: Damping,
    power: Power,
    pub(super) c: f64,
    pub(super) chi: f64,
    /// Factor of the elastic force: two where a bounded dashpot has reached its limit.
    pub(super) gain: f64,
    /// Speed added to the approach speed (m/s).
    pub(super) load_speed: f64,
}

impl Default for Law {
    /// Returns the linear elastic law.
    fn default() -> Self {
        Law::elastic()
    }
}

impl Law {
    /// Creates a law with the penetration exponent `n` in [1, 3] and a damping.
    ///
    /// # Errors
    /// [`LawError`] names the parameter out of range; a damping ratio must be
    /// [resolved](Damping::resolved) first.
    pub fn new(exponent: f64, damping: Damping) -> Result<Law, LawError> {
        if !(1.0..=3.0).contains(&exponent) {
            return Err(LawError::Exponent { value: exponent });
        }
        let c = damping.checked_dashpot()?;
        let power = if exponent == 1.0 {
            Power::One
        } else if exponent == 1.5 {
            Power::ThreeHalves
        } else {
            Power::General
        };
        Ok(Law {
            exponent,
            damping,
            power,
            c,
            chi: damping.chi(),
            gain: 1.0,
            load_speed: 0.0,
        })
    }

    /// Returns the linear elastic law `N = k d`.
    pub const fn elastic() -> Law {
        Law {
            exponent: 1.0,
            damping: Damping::None,
            power: Power::One,
            c: 0.0,
            chi: 0.0,
            gain: 1.0,
            load_speed: 0.0,
        }
    }

    /// Creates a law from the function of a program.
    pub fn of_program(law: Arc<dyn ForceLaw>) -> Law {
        Law {
            power: Power::User(SharedUserLaw::new(law)),
            ..Law::elastic()
        }
    }

    /// Returns the law of a program, if the force is one.
    pub fn user_law(&self) -> Option<&dyn ForceLaw> {
        match &self.power {
            Power::User(own) => Some(own.law()),
            _ => None,
        }
    }

    /// Replaces the power of the penetration by the approach of half-spaces.
    #[must_use]
    pub fn with_half_space(self, half_space: HalfSpace) -> Law {
        Law {
            exponent: 1.0,
            power: Power::HalfSpace(half_space),
            ..self
        }
    }

    /// Returns the law in a mesh under a load; the module head describes the effect on its damping.
    ///
    /// # Errors
    /// [`LawError::NoLoad`] for a damping ratio at load without one.
    pub fn under_load(self, load: MeshLoad) -> Result<Law, LawError> {
        let zeta = self.damping.ratio_at_load();
        let loaded = load.force > 0.0 && load.mass.is_finite();
        let by_load = self.damping.is_by_load();
        if zeta == 0.0 || !(loaded || by_load) {
            return Ok(self);
        }
        if !loaded {
            return Err(LawError::NoLoad);
        }
        let chi = if by_load { 1.0 } else { self.chi };
        let deflection = (load.force / load.stiffness).powf(1.0 / self.exponent);
        let stiffness = self.exponent * load.force / deflection;
        Ok(Law {
            chi,
            load_speed: chi * load.force / (2.0 * zeta * (stiffness * load.mass).sqrt()),
            ..self
        })
    }

    /// Returns the elastic part of the law; that of a law of a program is its force at rest.
    pub fn undamped(&self) -> Law {
        Law {
            damping: Damping::None,
            c: 0.0,
            chi: 0.0,
            gain: 1.0,
            load_speed: 0.0,
            exponent: self.exponent,
            power: self.power.clone(),
        }
    }

    /// Returns the law of a point with a share of the contact: its constant damper is multiplied by the share.
    #[inline]
    pub fn shared(&self, share: f64) -> Law {
        let power = match &self.power {
            Power::HalfSpace(h) => Power::HalfSpace(h.shared(share)),
            Power::User(own) => Power::User(own.shared(share)),
            other => other.clone(),
        };
        Law {
            damping: self.damping.shared(share),
            power,
            c: self.c * share,
            exponent: self.exponent,
            chi: self.chi,
            gain: self.gain,
            load_speed: self.load_speed,
        }
    }

    /// Returns the exponent `n` of the penetration.
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Returns the damping law.
    pub fn damping(&self) -> Damping {
        self.damping
    }

    /// Returns the factor chi of `1 + chi d'/v`; zero for elastic and Kelvin-Voigt contact.
    pub fn chi(&self) -> f64 {
        self.chi
    }

    /// Returns the identifier of the damping, as in scenes and reports.
    pub fn id(&self) -> &'static str {
        self.damping.id()
    }

    /// Returns true if the law depends on the speed stored at first contact.
    #[inline]
    pub fn needs_impact_speed(&self) -> bool {
        match self.user_law() {
            Some(own) => own.uses_impact_speed(),
            None => self.damping.restitution().is_some() && self.chi > 0.0,
        }
    }

    /// Returns the reference speed of vibration under the load of the mesh (m/s); 0 without a load.
    #[inline]
    pub fn load_speed(&self) -> f64 {
        self.load_speed
    }

    /// Returns `chi / v` and its derivative by the gap rate.
    #[inline]
    fn per_speed(&self, g_rate: f64, v0: f64) -> (f64, f64) {
        if self.chi == 0.0 {
            return (0.0, 0.0);
        }
        // A speed of parting does not count.
        let touched = if self.damping.restitution().is_some() {
            v0.max(0.0)
        } else {
            0.0
        };
        let v = touched + self.load_speed;
        let speed = g_rate.abs();
        if self.damping.restitution().is_some() && speed > v {
            (self.chi / speed, -self.chi / (speed * g_rate))
        } else {
            (self.chi / v.max(LEAST_SPEED), 0.0)
        }
    }

    /// Returns true if a cycle of closing and opening dissipates energy.
    #[inline]
    pub fn is_dissipative(&self) -> bool {
        self.chi > 0.0 || self.c > 0.0 || self.user_law().is_some_and(|own| !own.is_elastic())
    }

    /// Returns the elastic force of a penetration, odd in it, and its derivatives by the penetration and by `k`.
    #[inline]
    pub(super) fn elastic_force(&self, d: f64, k: f64) -> (f64, f64, f64) {
        let (power, slope) = match &self.power {
            Power::One => (d, 1.0),
            Power::ThreeHalves => {
                let root = d.abs().sqrt();
                (d * root, 1.5 * root)
            }
            Power::General => {
                let below = d.abs().powf(self.exponent - 1.0);
                (d * below, self.exponent * below)
            }
            Power::HalfSpace(h) => {
                let (n, stiffness, by_k) = h.force(d.abs(), k);
                return (n.copysign(d), stiffness, by_k.copysign(-d));
            }
            Power::User(own) => {
                let at_rest = own.smooth(-d, 0.0, 0.0, k);
                return (at_rest.n, -at_rest.dn_dg, at_rest.dn_dk);
            }
        };
        (k * power, k * slope, power)
    }

    /// Computes the smooth branch: odd in the penetration, neither clipped nor switched off when open. `k` (N/m^n) is
    /// the stiffness at this point, `v0` (m/s) the impact speed (ignored by laws that do not
    /// [need](Law::needs_impact_speed) it).
    #[inline]
    pub fn smooth(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        if let Power::User(own) = &self.power {
            return own.smooth(g, g_rate, v0, k);
        }
        let (elastic, stiffness, by_k) = self.elastic_force(-g, k);
        let (per_speed, slope_of_it) = self.per_speed(g_rate, v0);
        let factor = self.gain - per_speed * g_rate;
        LawForce {
            n: elastic * factor - self.c * g_rate,
            dn_dg: -stiffness * factor,
            dn_dgdot: -elastic * (per_speed + g_rate * slope_of_it) - self.c,
            dn_dk: by_k * factor,
        }
    }

    /// Computes the force of the smooth branch alone, without derivatives.
    #[inline]
    pub fn force(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        match &self.power {
            Power::User(own) => own.force(g, g_rate, v0, k),
            _ => self.smooth(g, g_rate, v0, k).n,
        }
    }

    /// Computes the contact force: zero when the gap is open (`g >= 0`) or the smooth branch would be tensile. NaN is
    /// passed through so that the caller can detect it.
    #[inline]
    pub fn clipped(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> LawForce {
        if g >= 0.0 {
            return LawForce::default();
        }
        if self.is_bounded() {
            return self.at_point(g, g_rate, k);
        }
        let force = self.smooth(g, g_rate, v0, k);
        if force.n < 0.0 {
            return LawForce::default();
        }
        force
    }

    /// Returns true if the force is piecewise linear in gap and gap rate.
    #[inline]
    pub fn is_piecewise_linear(&self) -> bool {
        self.is_linear_elastic() && self.chi == 0.0 && !self.is_bounded()
    }

    /// Returns true if the elastic force is linear in the gap.
    #[inline]
    pub fn is_linear_elastic(&self) -> bool {
        self.power == Power::One
    }

    /// Converts a force to the length that the elastic law would need for it, with sign (m).
    #[inline]
    pub fn as_length(&self, n: f64, k: f64) -> f64 {
        let x = n / k;
        if self.exponent == 1.0 {
            x
        } else {
            x.signum() * x.abs().powf(1.0 / self.exponent)
        }
    }

    /// Returns the distance of an open contact from a compressive force (m): the gap, or, where the bodies still
    /// overlap after a damped release, a length that is zero when the law becomes compressive again.
    #[inline]
    pub fn until_it_pushes(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        if g > 0.0 {
            return g;
        }
        let n = self.force(g, g_rate, v0, k);
        if n == 0.0 && g < 0.0 && self.user_law().is_some() {
            // A force that is cut off at zero has no slope towards its beginning.
            return ENDED;
        }
        g.max(-self.length_at(n, g, v0, k))
    }

    /// Converts a force of a contact with one branch to a length with the same sign and simple roots (m): see
    /// [`Self::as_length`]. The exponent of a law of a program is not known; its length is the penetration, multiplied by
    /// the force over that at rest.
    #[inline]
    pub(super) fn length_at(&self, n: f64, g: f64, v0: f64, k: f64) -> f64 {
        if let Power::User(own) = &self.power {
            let at_rest = own.force(g, 0.0, v0, k);
            if g != 0.0 && at_rest != 0.0 {
                return -g * (n / at_rest);
            }
        }
        self.as_length(n, k)
    }

    /// Returns the force that is left of a closed contact with one branch; negative after its end.
    #[inline]
    pub(super) fn left(&self, g: f64, g_rate: f64, v0: f64, k: f64) -> f64 {
        let n = self.force(g, g_rate, v0, k);
        let ends_open = self.chi > 0.0 || self.user_law().is_some() && g_rate > 0.0;
        if ends_open && g > 0.0 {
            return -n.abs();
        }
        n
    }

    /// Returns the elastic energy `k d^(n+1) / (n+1)` (J), zero when open.
    #[inline]
    pub fn potential(&self, g: f64, k: f64) -> f64 {
        if g >= 0.0 {
            return 0.0;
        }
        match &self.power {
            Power::HalfSpace(h) => h.energy(-g, k).0,
            Power::User(own) => own.potential(g, k),
            _ => -g * self.elastic_force(-g, k).0 / (self.exponent + 1.0),
        }
    }

    /// Returns the derivative of [`Law::potential`] with respect to `k` (m^(n+1)); times `dk/dt` it is the parametric
    /// power of a varying stiffness.
    #[inline]
    pub fn d_potential_dk(&self, g: f64, k: f64) -> f64 {
        if g >= 0.0 {
            return 0.0;
        }
        match &self.power {
            Power::HalfSpace(h) => h.energy(-g, k).1,
            Power::User(own) => own.d_potential_dk(g, k),
            _ => -g * self.elastic_force(-g, k).2 / (self.exponent + 1.0),
        }
    }
}
