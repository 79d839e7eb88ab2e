//! Gears of a model: toothing, material, modifications, profile shift and tooth thickness.

use super::report::ImportReport;
use super::topography::{FlankMeasures, TopographyGrid};
use crate::rexs::attributes as key;
use crate::rexs::model::{Component, Model};
use crate::scene_file::SceneError;
use crate::scene_file::format::{
    AmountTable, Degrees, EndReliefTable, EndTable, GearTable, MaterialChoice, MaterialTable,
    PerSide, ReliefTable, SideTable, TopographyTable,
};
use gearbench_models::geometry::{ReliefShape, inv, inv_inverse};

/// Largest difference of values that have to be equal, relative to their magnitude.
const EQUAL: f64 = 1e-9;

/// A gear of a model, before its stages determine shift and thickness.
#[derive(Clone, Debug)]
pub struct ImportedGear {
    /// Id of the component.
    pub id: u64,
    /// Name in the scene.
    pub name: String,
    /// Keys of the scene.
    pub table: GearTable,
    /// Profile shift coefficient, if the file has it.
    pub shift: Option<f64>,
    /// Tip radius, if the file has it [m].
    tip: Option<f64>,
    /// Root radius, if the file has it [m].
    root: Option<f64>,
}

/// A stage: two gears with their centre distance.
#[derive(Clone, Debug)]
pub struct ImportedStage {
    /// Indices of the gears, an internal gear last.
    pub gears: [usize; 2],
    /// Centre distance, if the file has it [m].
    pub distance: Option<f64>,
    /// Direction from the first to the second gear [rad].
    pub direction: f64,
    /// Normal backlash, if the file has it [m].
    pub backlash: Option<f64>,
}

fn bad(why: String, help: impl Into<String>) -> SceneError {
    SceneError::plain(why, help)
}

/// A number that a component must have.
pub(super) fn needed(of: &Component, attribute: &key::Attribute) -> Result<f64, SceneError> {
    of.number(attribute)?.ok_or_else(|| {
        bad(
            format!("{} has no `{}`", of.title(), attribute.names[0]),
            format!("add it in {}", attribute.unit),
        )
    })
}

/// A value that both flanks of a gear must share.
fn of_flanks(flanks: &[&Component], attribute: &key::Attribute) -> Result<Option<f64>, SceneError> {
    let mut found: Option<f64> = None;
    for flank in flanks {
        let Some(x) = flank.number(attribute)? else {
            continue;
        };
        match found {
            Some(first) if (first - x).abs() > EQUAL * first.abs().max(1.0) => {
                return Err(bad(
                    format!(
                        "{}: `{}` differs between the flanks of a gear",
                        flank.title(),
                        attribute.names[0]
                    ),
                    "gearbench has gears with one pressure angle and one profile shift: give both flanks one value",
                ));
            }
            _ => found = Some(found.unwrap_or(x)),
        }
    }
    Ok(found)
}

/// Reads a gear.
pub fn gear(
    model: &Model,
    of: &Component,
    name: String,
    report: &mut ImportReport,
) -> Result<ImportedGear, SceneError> {
    let internal = of.kind == "ring_gear";
    let teeth = needed(of, &key::TEETH)?.abs();
    if !(3.0..=10_000.0).contains(&teeth) || teeth.fract() != 0.0 {
        return Err(bad(
            format!("{}: `number_of_teeth` is {teeth}", of.title()),
            "expected a whole number from 3 to 10000",
        ));
    }
    let module = needed(of, &key::MODULE)?;
    if module <= 0.0 {
        return Err(bad(
            format!("{}: `normal_module` is {} mm", of.title(), 1e3 * module),
            "expected a positive number",
        ));
    }
    let flanks = flanks(model, of.id);
    let pressure = of_flanks(&flanks, &key::PRESSURE_ANGLE)?;
    if pressure.is_none() {
        report.assume(format!("{name}: normal pressure angle 20 degrees"));
    }
    let shift = match of_flanks(&flanks, &key::SHIFT)? {
        Some(x) => Some(x),
        None => of_flanks(&flanks, &key::SHIFT_LENGTH)?.map(|x| x / module),
    };
    let helix = of.number(&key::HELIX)?.unwrap_or(0.0).to_degrees();
    let inner = of.number(&key::INNER)?.filter(|d| *d > 0.0);
    let mut table = GearTable {
        teeth: teeth as u32,
        module_m: module,
        face_width_m: needed(of, &key::WIDTH)?,
        pressure_angle_deg: pressure.map(|a| Degrees(exact_degrees(a))),
        helix_angle_deg: (helix != 0.0).then_some(Degrees(exact_degrees(helix.to_radians()))),
        internal,
        bore_radius_m: inner.filter(|_| !internal).map_or(0.0, |d| exact(0.5 * d)),
        material: material(model, of.id, &name, report)?,
        ..GearTable::default()
    };
    tool(model, of, &name, &mut table, report)?;
    let mut gear = ImportedGear {
        id: of.id,
        name,
        table,
        shift,
        tip: of.number(&key::TIP)?.map(|d| 0.5 * d.abs()),
        root: of.number(&key::ROOT)?.map(|d| 0.5 * d.abs()),
    };
    modify(model, &mut gear, report)?;
    Ok(gear)
}

/// Rounds a converted length to 15 digits, as files have fewer.
pub(super) fn exact(x: f64) -> f64 {
    format!("{x:.14e}").parse().unwrap_or(x)
}

/// An angle in degrees, rounded likewise.
fn exact_degrees(radians: f64) -> f64 {
    exact(radians.to_degrees())
}

/// Left and right flank of a gear.
fn flanks(model: &Model, gear: u64) -> Vec<&Component> {
    let sides = ["left", "right"].map(|side| model.related("flank", "gear", gear, side));
    sides.into_iter().flatten().collect()
}

/// The material that a component refers to.
pub(super) fn material(
    model: &Model,
    id: u64,
    name: &str,
    report: &mut ImportReport,
) -> Result<MaterialChoice, SceneError> {
    let referred = model.related("reference", "origin", id, "referenced");
    let Some(found) = referred.into_iter().find(|c| c.kind == "material") else {
        report.assume(format!("{name}: steel, 210 GPa, 0.3, 7850 kg/m^3"));
        return Ok(MaterialChoice::Steel);
    };
    let value = |attribute: &key::Attribute, usual: f64, report: &mut ImportReport| {
        Ok(match found.number(attribute)? {
            Some(x) => exact(x),
            None => {
                let what = attribute.names[0];
                report.assume(format!("{name}: {what} of steel, as its material has none"));
                usual
            }
        })
    };
    let own = MaterialTable {
        young_pa: value(&key::YOUNG, 2.1e11, report)?,
        poisson: value(&key::POISSON, 0.3, report)?,
        density_kg_m3: value(&key::DENSITY, 7850.0, report)?,
    };
    let steel = own.young_pa == 2.1e11 && own.poisson == 0.3 && own.density_kg_m3 == 7850.0;
    Ok(match steel {
        true => MaterialChoice::Steel,
        false => MaterialChoice::Own(own),
    })
}

/// Reads the reference profile from the tool that cuts the teeth: the first rack-shaped tool or cutter wheel.
fn tool(
    model: &Model,
    of: &Component,
    name: &str,
    table: &mut GearTable,
    report: &mut ImportReport,
) -> Result<(), SceneError> {
    let flanks = flanks(model, of.id);
    let workpieces = flanks.iter().map(|f| f.id).chain([of.id]);
    let tools =
        workpieces.flat_map(|id| model.related("manufacturing_step", "workpiece", id, "tool"));
    let mut tools =
        tools.filter(|t| matches!(t.kind.as_str(), "rack_shaped_tool" | "cutter_wheel_tool"));
    let Some(tool) = tools.next() else {
        return Ok(());
    };
    if let Some(x) = tool.number(&key::TOOL_ADDENDUM)? {
        table.dedendum_factor = Some(x);
    }
    let radius = match tool.number(&key::TOOL_RADIUS)? {
        Some(x) => Some(x),
        None => tool
            .number(&key::TOOL_RADIUS_LENGTH)?
            .map(|r| exact(r / table.module_m)),
    };
    table.tip_radius_factor = radius;
    if tool.kind == "cutter_wheel_tool"
        && table.internal
        && let Some(teeth) = tool.number(&key::TEETH)?
    {
        table.cutter_teeth = Some(teeth.abs() as u32);
    }
    if tool.number(&key::PROTUBERANCE)?.is_some_and(|x| x != 0.0) {
        report.leave(format!("{name}: protuberance of its tool"));
    }
    Ok(())
}

/// Reads the modifications that the flanks of a gear refer to.
fn modify(
    model: &Model,
    gear: &mut ImportedGear,
    report: &mut ImportReport,
) -> Result<(), SceneError> {
    let sides = ["left", "right"].map(|side| model.related("flank", "gear", gear.id, side));
    let name = gear.name.clone();
    let [mut slopes, mut twists] = [[None; 2]; 2];
    let mut grids: [Option<TopographyGrid>; 2] = [None, None];
    let measures = {
        let [_, transverse, beta] = angles(gear);
        let reference = 0.5 * gear.table.module_m * f64::from(gear.table.teeth) / beta.cos();
        FlankMeasures {
            r_base: reference * transverse.cos(),
            width: gear.table.face_width_m,
        }
    };
    for (i, flank) in sides.iter().enumerate() {
        let Some(flank) = flank.first() else { continue };
        for own in model.related("reference", "origin", flank.id, "referenced") {
            let table = &mut gear.table;
            match own.kind.as_str() {
                "tip_relief" => {
                    let start = own.number(&key::TIP_RELIEF_START)?;
                    let (Some(amount), Some(start)) = (own.number(&key::TIP_RELIEF)?, start) else {
                        report.leave(format!("{name}: {} without depth or diameter", own.title()));
                        continue;
                    };
                    let relief = ReliefTable {
                        amount_m: exact(amount),
                        start_radius_m: exact(0.5 * start),
                        shape: shape(own),
                    };
                    let other = table.tip_relief.replace(Box::new(relief.clone()));
                    if other.is_some_and(|other| *other != relief) {
                        report.assume(format!("{name}: tip relief of the right flank, on both"));
                    }
                }
                "profile_crowning" => {
                    let amounts = [&key::PROFILE_CROWNING_TIP, &key::PROFILE_CROWNING_ROOT];
                    let [tip, root] = amounts.map(|a| own.number(a));
                    table.profile_crowning_m = both(tip?, root?, &name, own, report);
                }
                "helix_crowning" => {
                    let amounts = [&key::HELIX_CROWNING_DATUM, &key::HELIX_CROWNING_OTHER];
                    let [datum, other] = amounts.map(|a| own.number(a));
                    table.lead_crowning_m = both(datum?, other?, &name, own, report);
                }
                "helix_slope" => slopes[i] = own.number(&key::HELIX_SLOPE)?,
                "profile_twist" => twists[i] = own.number(&key::PROFILE_TWIST)?,
                "topographical_modification" => match TopographyGrid::of(own, &measures) {
                    Ok(grid) => {
                        if grid.is_resampled {
                            report.assume(format!(
                                "{name}: linear interpolation between the points of {}, as their steps differ",
                                own.title()
                            ));
                        }
                        grids[i] = Some(grid);
                    }
                    Err(why) => report.leave(format!("{name}: {}: {why}", own.title())),
                },
                "end_relief_datum_face" | "end_relief_non_datum_face" => {
                    let is_datum = own.kind == "end_relief_datum_face";
                    let [depth, length] = match is_datum {
                        true => [&key::DATUM_RELIEF, &key::DATUM_RELIEF_LENGTH],
                        false => [&key::OTHER_RELIEF, &key::OTHER_RELIEF_LENGTH],
                    };
                    let end = EndTable {
                        amount_m: exact(needed(own, depth)?),
                        length_m: exact(needed(own, length)?),
                        shape: shape(own),
                    };
                    let ends = table.end_relief.get_or_insert(EndReliefTable {
                        low: None,
                        high: None,
                    });
                    *(if is_datum {
                        &mut ends.low
                    } else {
                        &mut ends.high
                    }) = Some(end);
                    report.assume("datum faces are at the lower ends of the axes".to_owned());
                }
                kind if kind.contains("relief")
                    || kind.starts_with("profile_")
                    || kind.starts_with("helix_") =>
                {
                    report.leave(format!("{name}: {}", own.title()));
                }
                _ => {}
            }
        }
    }
    let sides = |values: [Option<f64>; 2]| {
        let [left, right] = values.map(|s| s.map(exact));
        let any = [left, right].iter().any(|s| s.is_some_and(|s| s != 0.0));
        any.then_some(PerSide::Each(SideTable { left, right }))
    };
    gear.table.helix_slope_m = sides(slopes);
    if gear.table.helix_slope_m.is_some() {
        report.assume("positive helix slopes remove material towards the upper ends of the axes");
    }
    gear.table.twist_m = sides(twists);
    if gear.table.twist_m.is_some() {
        report.assume("positive twists remove material at the tips of the upper ends of the axes");
    }
    let [left, right] = grids;
    if let (Some(l), Some(r)) = (&left, &right)
        && l.extent() != r.extent()
    {
        report.leave(format!(
            "{name}: the topography of the right flank, whose points are not those of the left one"
        ));
    }
    if let Some(first) = left.as_ref().or(right.as_ref()) {
        report.assume(
            "topographies: positive amounts are removed material, coordinates count from the lower ends of the axes",
        );
        let [radii, heights] = first.extent();
        let rows = |grid: &Option<TopographyGrid>| {
            let grid = grid.as_ref().filter(|g| g.extent() == [radii, heights]);
            grid.map(|g| AmountTable::Rows(g.rows.clone()))
        };
        gear.table.topography = Some(Box::new(TopographyTable {
            left: rows(&left),
            right: rows(&right),
            both: None,
            unit_m: None,
            radii_m: Some(radii),
            heights_m: Some(heights),
        }));
    }
    Ok(())
}

/// The crowning of both ends; unequal ends are replaced by their mean.
fn both(
    a: Option<f64>,
    b: Option<f64>,
    name: &str,
    of: &Component,
    report: &mut ImportReport,
) -> f64 {
    let [x, y] = [a.or(b), b.or(a)].map(Option::unwrap_or_default);
    if (x - y).abs() > EQUAL {
        report.assume(format!("{name}: mean of both ends of {}", of.title()));
    }
    exact(0.5 * (x + y))
}

/// The shape of a relief, if the file gives one that gearbench has.
fn shape(of: &Component) -> Option<ReliefShape> {
    match of.text(&key::RELIEF_SHAPE)? {
        text if text.contains("parabol") || text.contains("circular") => {
            Some(ReliefShape::Parabolic)
        }
        _ => None,
    }
}

impl ImportedGear {
    /// Signed number of teeth: negative for internal gears, as in DIN 3960.
    fn signed_teeth(&self) -> f64 {
        let sign = if self.table.internal { -1.0 } else { 1.0 };
        sign * f64::from(self.table.teeth)
    }

    /// Sets profile shift, tip and root of the scene.
    ///
    /// # Errors
    /// A tip circle that does not lie outside of the root circle.
    pub fn settle(&mut self, of: &Component, report: &mut ImportReport) -> Result<(), SceneError> {
        let x = self.shift.unwrap_or_else(|| {
            report.assume(format!("{}: profile shift 0", self.name));
            0.0
        });
        self.table.profile_shift = x;
        let (m, beta) = (self.table.module_m, angle(self.table.helix_angle_deg));
        let reference = 0.5 * m * f64::from(self.table.teeth) / beta.cos();
        // Outwards from the reference circle for external gears, inwards for internal ones.
        let sign = self.signed_teeth().signum();
        if let (Some(root), true) = (self.root, self.table.internal) {
            // The root of a ring depends on its cutter: it has a key of its own.
            (self.table.dedendum_factor, self.table.root_circle_radius_m) =
                (None, Some(exact(root)));
        } else if let Some(root) = self.root {
            self.table.dedendum_factor = Some(exact(sign * (reference - root) / m + x));
        } else if self.table.dedendum_factor.is_none() {
            report.assume(format!("{}: dedendum 1.25 modules", self.name));
        }
        if self.table.tip_radius_factor.is_none() && !self.table.internal {
            report.assume(format!(
                "{}: tip radius of the tool 0.38 modules",
                self.name
            ));
        }
        self.avoid_undercut(report);
        let by_factor = reference - sign * m * (self.table.dedendum_factor.unwrap_or(1.25) - x);
        let root = self.table.root_circle_radius_m.unwrap_or(by_factor);
        let Some(tip) = self.tip else {
            report.assume(format!("{}: addendum 1 module", self.name));
            return Ok(());
        };
        if sign * (tip - root) <= 0.0 {
            let inside = if sign > 0.0 { "outside of" } else { "inside" };
            return Err(bad(
                format!(
                    "{}: `tip_diameter` is {} mm, but its root diameter is {:.3} mm and its reference diameter {:.3} mm",
                    of.title(),
                    exact(2e3 * tip),
                    2e3 * root,
                    2e3 * reference
                ),
                format!(
                    "the tip circle has to lie {inside} the root circle: correct `tip_diameter`, or delete it, and an addendum of 1 module is assumed"
                ),
            ));
        }
        if self.table.internal {
            self.table.tip_circle_radius_m = Some(exact(tip));
        } else {
            self.table.addendum_factor = Some(exact((tip - reference) / m - x));
        }
        Ok(())
    }
}

impl ImportedGear {
    /// Enlarges the tip radius of the tool until it does not cut into the involute, as gearbench has no undercut teeth:
    ///
    /// ```text
    /// h - x - rho (1 - sin a_n) <= z sin^2 a_t / (2 cos b),    rho <= (pi/4 - h tan a_n) cos a_n / (1 - sin a_n)
    /// ```
    fn avoid_undercut(&mut self, report: &mut ImportReport) {
        if self.table.internal {
            return;
        }
        let [normal, transverse, beta] = angles(self);
        let table = &mut self.table;
        let (teeth, x) = (f64::from(table.teeth), table.profile_shift);
        let (h, rho) = (
            table.dedendum_factor.unwrap_or(1.25),
            table.tip_radius_factor.unwrap_or(0.38),
        );
        let straight = 0.5 * teeth * transverse.sin().powi(2) / beta.cos();
        let needed = (h - x - straight) / (1.0 - normal.sin());
        let largest =
            (0.25 * std::f64::consts::PI - h * normal.tan()) * normal.cos() / (1.0 - normal.sin());
        // Four digits, rounded up.
        let needed = (1e4 * needed).ceil() * 1e-4;
        if needed <= rho || needed > largest {
            return;
        }
        let needed = exact(needed);
        table.tip_radius_factor = Some(needed);
        report.assume(format!(
            "{}: tip radius of its tool {needed} modules, not {rho}, so that its teeth have no undercut",
            self.name
        ));
    }
}

/// An optional angle [rad].
pub(super) fn angle(of: Option<Degrees>) -> f64 {
    of.map_or(0.0, Degrees::radians)
}

/// Normal pressure angle, transverse pressure angle, helix angle of a gear [rad].
fn angles(gear: &ImportedGear) -> [f64; 3] {
    let normal = gear
        .table
        .pressure_angle_deg
        .map_or(20f64.to_radians(), Degrees::radians);
    let beta = angle(gear.table.helix_angle_deg);
    [normal, (normal.tan() / beta.cos()).atan(), beta]
}

/// Centre distance without profile shift [m], and numbers of teeth with sign.
fn unshifted(gears: [&ImportedGear; 2]) -> (f64, [f64; 2]) {
    let teeth = gears.map(ImportedGear::signed_teeth);
    let [_, _, beta] = angles(gears[0]);
    let a = 0.5 * (teeth[0] + teeth[1]) * gears[0].table.module_m / beta.cos();
    (a.abs(), teeth)
}

/// The sum of profile shift coefficients for a centre distance without backlash, `inv a_w - inv a_t = 2 tan a_n (x1 + x2) /
/// (z1 + z2)` (DIN 3960), with a negative number of teeth of internal gears; `None` if the distance is too small.
pub fn shift_sum(gears: [&ImportedGear; 2], distance: f64) -> Option<f64> {
    let [normal, transverse, _] = angles(gears[0]);
    let (a, teeth) = unshifted(gears);
    let cosine = a * transverse.cos() / distance;
    (cosine > 0.0 && cosine < 1.0).then(|| {
        (inv(cosine.acos()) - inv(transverse)) * (teeth[0] + teeth[1]) / (2.0 * normal.tan())
    })
}

/// The centre distance without backlash for profile shift coefficients, and the working pressure angle.
pub fn distance_of(gears: [&ImportedGear; 2], shifts: f64) -> Option<[f64; 2]> {
    let [normal, transverse, _] = angles(gears[0]);
    let (a, teeth) = unshifted(gears);
    let involute = inv(transverse) + 2.0 * normal.tan() * shifts / (teeth[0] + teeth[1]);
    let working = (involute > 0.0).then(|| inv_inverse(involute))?;
    Some([a * transverse.cos() / working.cos(), working])
}

/// Fills in profile shifts that the file does not have from centre distances.
pub fn fill_shifts(
    gears: &mut [ImportedGear],
    stages: &[ImportedStage],
    report: &mut ImportReport,
) {
    // Each pass determines at least one gear, or gives the first unknown one no shift.
    for _ in 0..=gears.len() {
        let mut progressed = false;
        for stage in stages {
            let [a, b] = stage.gears;
            let Some(distance) = stage.distance else {
                continue;
            };
            let (known, unknown) = match (gears[a].shift, gears[b].shift) {
                (Some(x), None) => (x, b),
                (None, Some(x)) => (x, a),
                _ => continue,
            };
            if let Some(sum) = shift_sum([&gears[a], &gears[b]], distance) {
                let x = sum - known;
                // Rounding of the centre distance is no profile shift.
                let x = if x.abs() < 1e-6 { 0.0 } else { exact(x) };
                gears[unknown].shift = Some(x);
                report.assume(format!(
                    "{}: profile shift {x:.6} from the centre distance of its stage",
                    gears[unknown].name
                ));
                progressed = true;
            }
        }
        if progressed {
            continue;
        }
        let Some(gear) = gears.iter_mut().find(|g| g.shift.is_none()) else {
            return;
        };
        gear.shift = Some(0.0);
        report.assume(format!("{}: profile shift 0", gear.name));
    }
}

/// Thins the teeth for the backlash of all stages; without one in the file for the smallest backlash that ISO/TR 10064-2
/// recommends, `2/3 (0.06 + 0.0005 a + 0.03 m)` in millimetres.
pub fn thin(gears: &mut [ImportedGear], stages: &[ImportedStage], report: &mut ImportReport) {
    for stage in stages {
        let pair = stage.gears.map(|i| &gears[i]);
        let [normal, transverse, beta] = angles(pair[0]);
        let shifts = pair.iter().filter_map(|g| g.shift).sum();
        let (distance, free) = match (stage.distance, distance_of(pair, shifts)) {
            (Some(distance), Some(free)) => (distance, free),
            _ => continue,
        };
        let backlash = stage.backlash.unwrap_or_else(|| {
            let (a, m) = (1e3 * distance, 1e3 * pair[0].table.module_m);
            report.assume(
                "normal backlash: the least of ISO/TR 10064-2, by thinner teeth of both gears",
            );
            1e-3 * 2.0 / 3.0 * (0.06 + 0.0005 * a + 0.03 * m)
        });
        // Backlash of the centre distance itself; an internal pair loses it as the distance grows.
        let sign = if pair[1].table.internal { -1.0 } else { 1.0 };
        let base_helix = (beta.sin() * normal.cos()).asin();
        let base = unshifted(pair).0 * transverse.cos();
        // Zero where the distance is less than the sum of the base radii; such a pair is refused when the scene is read.
        let turned = inv((base / distance).min(1.0).acos()) - inv(free[1]);
        let own = sign * 2.0 * base * turned * base_helix.cos();
        let each = 0.5 * (backlash - own) / (transverse.cos() * base_helix.cos());
        for i in stage.gears {
            let table = &mut gears[i].table;
            table.thinning_m = table.thinning_m.max(exact(each.max(0.0)));
        }
    }
}
