//! The study of coupling: a scene in two parts, the hubs of its gears in a host and the gears as a sub-system, over the
//! communication step. The host prescribes the motion of the hubs. Each model is compared with its own run as one
//! system.
//!
//! With the motion `u` of each free gear as a whole and all else `x` (how teeth and modes deform it, bearings) a scene is
//!
//! ```text
//! J u'' = L(t, u') + T(t, u, u', x, x')          the host: hubs and the loads on them
//! M_x x'' = f(t, u, u', x, x')                   the gears
//! ```
//!
//! and both parts are these very lines of the whole: nothing is modelled twice, and a coupling of ever smaller steps comes to
//! the whole. The host goes first, on the forces `T` extrapolated through their last values at communication points; the gears
//! follow, on the motion of the hubs interpolated over the step (Schurr, Do, Ziegler, Eberhard, Simpack User Meeting 2014).
//!
//! **Which inertia is whose.** The host has the inertia of whole gears, the gears that of what deforms them: `u` is the turn of
//! the floating frame that holds the momentum, `J u' = ` angular momentum about the axis. Modes of a free hub hold none, so that
//! of elastic gears `u` is their frame's coordinate; teeth that move turn with it. Then `T` is the torque of the contacts, a
//! function of places and speeds alone, without the acceleration that the host asks for: there is no direct feed-through. A hub
//! that were prescribed in the place of the frame would hand over the inertia of teeth and modes that it shakes, at once; with
//! the body alone in the host, movable teeth of `spur_impact` bear less than a tenth of the communication step, for the body then
//! swings on the springs of all its teeth. Gears with inertia in common between frame and other coordinates (terms of rotation, hubs
//! that tilt) are left out for that.
//!
//! **Energy.** Over a step the host takes the work `int T~ u~' dt` from extrapolated forces, the gears give `int T u^' dt` along
//! the interpolated motion. The difference is made up or lost by the coupling alone, whatever the integrators do.
//!
//! | module | owns |
//! |---|---|
//! | `step_polynomial` | extrapolation of forces, interpolation of motions |
//! | `frames` | the gears with prescribed trajectories of their hubs |
//! | `host` | hubs under extrapolated forces and loads |
//! | `exchange` | alternating integration of both parts, and the energy between them |
//! | `theory` | an oscillator in two parts: growth and its limit |
//! | `stiffness` | the scene as that oscillator |
//! | `study` | arguments, cells, table and charts |

mod exchange;
mod frames;
mod host;
mod step_polynomial;
mod stiffness;
mod study;
#[cfg(test)]
mod tests;
mod theory;

pub(crate) use study::Coupling;
