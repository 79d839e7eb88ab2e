//! Table of the stored references. A further one is a folder with its files and one line in [`REFERENCES`].

use super::{ExternalReference, History, ReferenceError, format};

/// A stored reference before it is read: the embedded files.
#[derive(Clone, Copy, Debug)]
pub struct StoredReference {
    /// Identifier `program/case`.
    pub id: &'static str,
    /// One line for legends and lists.
    pub title: &'static str,
    /// Command that computes it again, from the root of the repository.
    pub regenerate: &'static str,
    /// Note for the assessment of the reference.
    pub note: &'static str,
    /// Estimated relative error of its own force history, by its mesh, elements and contact together [-].
    pub own_error: Option<f64>,
    pub(super) source: &'static str,
    pub(super) params: &'static str,
    pub(super) summary: &'static str,
    pub(super) results: &'static str,
    pub(crate) deck: &'static [u8],
}

/// Of decks that models are run on as well.
const ON_ONE_MESH: &str =
    "first-order bricks, faceted flanks: programs that agree on this mesh, not converged physics";

/// Embeds the folder of a case.
macro_rules! stored {
    ($program:literal, $case:literal, $deck:literal, $title:literal) => {
        stored!($program, $case, $deck, $title, ON_ONE_MESH, None)
    };
    ($program:literal, $case:literal, $deck:literal, $title:literal, $note:expr, $error:expr) => {
        StoredReference {
            id: concat!($program, "/", $case),
            title: $title,
            note: $note,
            own_error: $error,
            regenerate: concat!("reference/", $program, "/regenerate.sh ", $case),
            source: include_str!(concat!("../../", $program, "/", $case, "/SOURCE.md")),
            params: include_str!(concat!("../../", $program, "/", $case, "/params.json")),
            summary: include_str!(concat!("../../", $program, "/", $case, "/summary.json")),
            results: include_str!(concat!("../../", $program, "/", $case, "/results.csv")),
            deck: include_bytes!(concat!(
                "../../", $program, "/", $case, "/", $deck, ".inp.gz"
            )),
        }
    };
}

/// All stored references.
pub static REFERENCES: &[StoredReference] = &[
    stored!(
        "calculix",
        "case-a-fine",
        "AF8_d05",
        "CalculiX 2.20, C3D8, impact of z = 20/30, m = 4 mm at 20 rad/s"
    ),
    stored!(
        "calculix",
        "case-c",
        "C8_d25",
        "CalculiX 2.20, C3D8, impact of z = 30/30, m = 10 mm at 3 rad/s"
    ),
    stored!(
        "calculix",
        "case-a-coarse",
        "A8_d05",
        "CalculiX 2.20, C3D8, as case A with 8 elements per flank, to 250 us"
    ),
    // Parts of its error: SOURCE.md in its folder.
    stored!(
        "calculix",
        "case-a-graded",
        "graded",
        "CalculiX 2.20, C3D8, as case A on meshes that resolve the contact",
        "elements of 0.03 mm where the contact is 0.36 mm wide; one layer of first-order bricks over the width",
        Some(0.023)
    ),
    stored!(
        "calculix",
        "rack-pinion",
        "R8b_d05",
        "CalculiX 2.20, C3D8, impact of z = 20, m = 2 mm at 100 rad/s on a held rack"
    ),
    stored!(
        "calculix",
        "helical",
        "H_aligned",
        "CalculiX 2.20, C3D8, impact of z = 20/30, m = 4 mm, helix 15 degrees at 20 rad/s"
    ),
    stored!(
        "calculix",
        "helical-tilted",
        "H_tilted",
        "CalculiX 2.20, C3D8, as helical with the axis of gear 2 inclined by 0.5 mrad"
    ),
];

impl StoredReference {
    /// Reads the embedded files.
    pub fn load(&self) -> Result<ExternalReference, ReferenceError> {
        let damaged = |file: &'static str, message: String| ReferenceError::Damaged {
            id: self.id.into(),
            file,
            message,
        };
        let (solver, parameters) =
            format::read(self.params).map_err(|e| damaged("params.json", e))?;
        let summary = serde_json::from_str(self.summary)
            .map_err(|e| damaged("summary.json", e.to_string()))?;
        let history = History::read(self.results, parameters.rack.is_some())
            .map_err(|e| damaged("results.csv", e))?;
        Ok(ExternalReference {
            id: self.id,
            title: self.title,
            solver,
            source: self.source,
            regenerate: self.regenerate,
            note: self.note,
            own_error: self.own_error,
            deck: self.deck,
            parameters,
            summary,
            history,
        })
    }
}

/// Finds a stored reference by its id and reads it.
pub fn reference(id: &str) -> Result<ExternalReference, ReferenceError> {
    match REFERENCES.iter().find(|r| r.id == id) {
        Some(stored) => stored.load(),
        None => Err(ReferenceError::Unknown {
            id: id.into(),
            known: REFERENCES
                .iter()
                .map(|r| r.id)
                .collect::<Vec<_>>()
                .join(", "),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stored::{GearData, trapezoid};
    use gearbench_models::Vec3;

    fn close(found: f64, expected: f64, relative: f64) {
        assert!(
            (found - expected).abs() <= relative * expected.abs(),
            "found {found}, expected {expected} within {relative}"
        );
    }

    #[test]
    fn every_reference_is_consistent_with_its_summary() {
        for stored in REFERENCES {
            let r = stored.load().unwrap();
            let (h, s, p) = (&r.history, &r.summary, &r.parameters);
            let last = h.time.len() - 1;
            assert_eq!(h.time.len() as u32, s.increments + 1, "{}", r.id);
            close(h.time[last], s.end_s, 1e-8);
            close(h.impulse(), s.impulse_ns, 1e-6);
            assert_eq!(h.peak().1, s.peak_time_s);
            close(h.peak().0, s.peak_force_n, 1e-8);
            assert_eq!(
                h.contact_interval(),
                Some((s.first_contact_s, s.last_contact_s))
            );
            close(h.omega1_mean[last], s.omega1_mean_end_rad_s, 1e-7);
            close(h.omega2_mean[last], s.omega2_mean_end_rad_s, 1e-7);
            close(h.omega1_hub[last], s.omega1_hub_end_rad_s, 1e-7);
            close(h.energy(last), s.energy_end_j, 1e-7);
            close(h.energy(0), s.energy_start_j, 1e-7);
            assert_eq!(h.contact_force[0], 0.0);
            assert_eq!(h.omega1_mean[0], p.gears[0].speed);
            assert_eq!(h.omega2_mean[0], p.gears.get(1).map_or(0.0, |g| g.speed));
            assert_eq!(p.gears.len() == 2, p.rack.is_none());
            // Angular momentum of each gear against the integrated moment on it, about its axis.
            let axis = |g: &GearData| {
                let tilt = Vec3::from(g.tilt);
                tilt.norm().cos() * Vec3::z() + tilt.cross(&Vec3::z())
            };
            let at = |v: &[Vec<f64>; 3], i: usize| Vec3::new(v[0][i], v[1][i], v[2][i]);
            let about = |centre: Vec3, axis: Vec3| -> f64 {
                let moment = |i| axis.dot(&(at(&h.moment, i) - centre.cross(&at(&h.force, i))));
                let moments: Vec<f64> = (0..=last).map(moment).collect();
                trapezoid(&h.time, &moments)
            };
            let first = about(Vec3::zeros(), axis(&p.gears[0]));
            close(first, s.angular_impulse1_nms, 1e-6);
            let momentum = [
                (
                    &h.omega1_mean,
                    Some(s.angular_impulse1_nms),
                    Some(s.angular_momentum_change1_nms),
                ),
                (
                    &h.omega2_mean,
                    s.angular_impulse2_nms,
                    s.angular_momentum_change2_nms,
                ),
            ];
            for (gear, (mean, impulse, change)) in p.gears.iter().zip(momentum) {
                let found = gear.inertia * (mean[last] - mean[0]);
                close(found, impulse.unwrap(), 5e-6);
                close(found, change.unwrap(), 1e-6);
            }
            // The moment on gear 2 is that of the opposite force about its own axis.
            if let (Some(impulse), [_, gear]) = (s.angular_impulse2_nms, p.gears.as_slice()) {
                let second = -about(p.centre_distance * Vec3::x(), axis(gear));
                close(second, impulse, 1e-6);
            }
            for (i, f) in h.contact_force.iter().enumerate() {
                assert!((at(&h.force, i).norm() - f).abs() <= 1e-6 * f.max(1.0));
            }
            // The force is that along the normal, which stands to the transverse plane at the base helix angle.
            let base_helix = |g: &GearData| {
                let sine = g.helix_angle_deg.to_radians().sin() * p.pressure_angle.cos();
                sine.asin()
            };
            let slope = h.impulse() * base_helix(&p.gears[0]).sin();
            let axial = trapezoid(&h.time, &h.force[2]);
            assert!(
                (axial - slope).abs() <= 5e-3 * slope.abs(),
                "{}: {axial} {slope}",
                r.id
            );
            // A held rack is infinitely heavy.
            let reduced = p
                .gears
                .iter()
                .map(|g| (g.base_radius * base_helix(g).cos()).powi(2) / g.inertia)
                .sum::<f64>()
                .recip();
            close(reduced, s.reduced_mass_kg, 1e-12);
            close(
                2.0 * reduced * s.approach_speed_m_s,
                s.impulse_rigid_elastic_ns,
                1e-12,
            );
            close(
                -s.separation_speed_m_s / s.approach_speed_m_s,
                s.restitution,
                1e-12,
            );
            if let [a, b] = p.gears.as_slice() {
                close(
                    p.working_pressure_angle.cos(),
                    (a.base_radius + b.base_radius) / p.centre_distance,
                    1e-12,
                );
            }
            // Chords open the gap; a tilt closes it at one end of the width, and by the helix where it shifts the
            // flank along the axis, in proportion to the length of roll.
            let roll: f64 = p.gears.iter().map(|g| g.base_radius).sum::<f64>()
                * p.working_pressure_angle.tan()
                - p.path_coordinate;
            let closing = |g: &GearData| {
                let shift = roll * base_helix(g).tan().abs();
                Vec3::from(g.tilt).norm() * (0.5 * p.face_width + shift)
            };
            let closed: f64 = p.gears.iter().map(closing).sum();
            let opened = p.gap_effective - (p.gap_exact - closed);
            assert!(opened > 0.0 && p.gap_effective < 2e-5, "{}", r.id);
            assert_eq!(r.deck[..2], [0x1f, 0x8b], "a gzip file");
            assert!(
                r.source.contains(&stored.id["calculix/".len()..]) && r.source.contains("CalculiX")
            );
            assert!(r.solver.starts_with("CalculiX 2.20"));
        }
    }

    /// The figures printed where the data were published with their solver notes.
    #[test]
    fn published_figures() {
        let a = reference("calculix/case-a-fine").unwrap();
        close(a.history.impulse(), 0.22575, 5e-6);
        close(a.history.peak().0, 3725.0, 5e-5);
        assert_eq!(a.history.peak().1, 56e-6);
        assert_eq!(a.history.contact_interval(), Some((4.5e-6, 103.5e-6)));
        close(a.summary.omega1_mean_end_rad_s, -7.3385, 1e-5);
        close(a.summary.omega2_mean_end_rad_s, -8.2467, 1e-5);
        close(a.summary.restitution, 0.9854, 5e-5);
        close(a.parameters.gears[0].inertia, 3.102056e-4, 1e-7);
        close(a.parameters.gears[1].inertia, 1.5432706e-3, 1e-7);
        close(a.parameters.gap_effective, 3.107e-6, 1e-4);
        let teeth: Vec<u32> = a.parameters.gears.iter().map(|g| g.teeth).collect();
        assert_eq!(teeth, [20, 30]);

        let c = reference("calculix/case-c").unwrap();
        close(c.history.impulse(), 5.17656, 1e-6);
        close(c.history.peak().0, 27162.0, 1e-5);
        assert_eq!(c.history.peak().1, 192.5e-6);
        assert_eq!(c.history.contact_interval(), Some((35e-6, 345e-6)));
        close(c.summary.omega1_mean_end_rad_s, 0.0291, 1e-3);
        close(c.summary.omega2_mean_end_rad_s, -2.9703, 2e-5);
        close(c.summary.restitution, 0.9804, 5e-5);
        close(c.parameters.gears[0].inertia, 0.24557573, 1e-7);

        let coarse = reference("calculix/case-a-coarse").unwrap();
        close(coarse.history.impulse(), 0.22617, 2e-5);
        close(coarse.history.peak().0, 3710.0, 2e-5);
        assert_eq!(coarse.history.peak().1, 62e-6);
        assert_eq!(coarse.history.contact_interval(), Some((10e-6, 110e-6)));
        close(coarse.summary.omega1_mean_end_rad_s, -7.4224, 1e-5);
        close(coarse.summary.omega2_mean_end_rad_s, -8.2368, 1e-5);
        close(coarse.summary.restitution, 0.9889, 5e-5);

        let r = reference("calculix/rack-pinion").unwrap();
        close(r.history.impulse(), 0.20400, 5e-6);
        close(r.history.peak().0, 7926.0, 5e-6);
        assert_eq!(r.history.peak().1, 23e-6);
        assert_eq!(r.history.contact_interval(), Some((1e-6, 44.5e-6)));
        close(r.summary.omega1_mean_end_rad_s, -98.865, 5e-6);
        close(r.summary.restitution, 0.9887, 5e-5);
        close(r.parameters.gears[0].inertia, 1.9273140e-5, 1e-7);
        let rack = r.parameters.rack.unwrap();
        assert_eq!(rack.teeth, 5);
        close(rack.distance, 0.02005, 1e-12);
        assert_eq!(r.summary.arm2_m, None);

        let helical = ["helical", "helical-tilted"].map(|case| {
            let r = reference(&format!("calculix/{case}")).unwrap();
            let helix: Vec<f64> = r
                .parameters
                .gears
                .iter()
                .map(|g| g.helix_angle_deg)
                .collect();
            assert_eq!(helix, [15.0, -15.0]);
            assert_eq!(r.parameters.gears[0].tilt, [0.0; 3]);
            r
        });
        let [aligned, tilted] = helical;
        close(aligned.history.impulse(), 0.30341, 5e-5);
        close(aligned.history.peak().0, 4100.0, 2e-5);
        assert_eq!(
            aligned.history.contact_interval(),
            Some((10.5e-6, 135.5e-6))
        );
        assert_eq!(aligned.parameters.gears[1].tilt, [0.0; 3]);
        close(tilted.history.impulse(), 0.30423, 5e-5);
        close(tilted.history.peak().0, 4040.6, 2e-5);
        // The end that the inclination brings nearer touches 8 us earlier.
        assert_eq!(tilted.history.contact_interval(), Some((2.5e-6, 137e-6)));
        let tilt = Vec3::from(tilted.parameters.gears[1].tilt);
        close(tilt.norm(), 5e-4, 1e-12);
        let (sin, cos) = tilted.parameters.working_pressure_angle.sin_cos();
        assert!(tilt.dot(&Vec3::new(sin, cos, 0.0)).abs() < 1e-18);
    }

    #[test]
    fn an_unknown_id_lists_the_known_ones() {
        let message = reference("calculix/case-b").unwrap_err().to_string();
        assert_eq!(
            message,
            "there is no reference `calculix/case-b`; there are calculix/case-a-fine, calculix/case-c, \
             calculix/case-a-coarse, calculix/case-a-graded, calculix/rack-pinion, calculix/helical, \
             calculix/helical-tilted"
        );
    }
}
