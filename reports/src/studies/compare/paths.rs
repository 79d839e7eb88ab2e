//! Paths of torque and power in a train, and load sharing of planets: tables, a chart over time, CSV files.

use crate::columns::Columns;
use crate::csv_table::CsvTable;
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::curve_style;
use crate::markup::column::Format;
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::{Prefix, per_cent, quantity};
use crate::record::{MemberPath, MeshPath, PlanetShare, Run, ShaftPath, Sharing, TorquePaths};
use crate::series::CONTACT_FORCE;
use crate::view::View;
use maud::{Markup, html};

/// A run of a model that has paths: the first that did not fail.
struct RunWithPaths<'a> {
    label: &'a str,
    style: usize,
    run: &'a Run,
    paths: &'a TorquePaths,
}

fn runs_with_paths<'a>(view: &'a View<'a>) -> Vec<RunWithPaths<'a>> {
    let of = |group: &'a crate::view::Group<'a>| {
        let sound = group
            .runs
            .iter()
            .map(|r| r.1)
            .filter(|r| !r.status.is_failure());
        let mut with = sound.filter_map(|run| Some((run, run.paths.as_ref()?)));
        with.next().map(|(run, paths)| RunWithPaths {
            label: &group.label,
            style: group.style,
            run,
            paths,
        })
    };
    view.groups.iter().filter_map(of).collect()
}

/// Returns the rows of all models, each with its run.
fn rows<'a, R>(
    all: &[&'a RunWithPaths<'a>],
    of: fn(&TorquePaths) -> &[R],
) -> Vec<(&'a RunWithPaths<'a>, &'a R)> {
    let each = |s: &&'a RunWithPaths<'a>| {
        let s = *s;
        of(s.paths).iter().map(move |r| (s, r))
    };
    all.iter().flat_map(each).collect()
}

/// Returns the tables of torque paths; empty for a scene without train and shafts.
pub fn tables(view: &View<'_>) -> Markup {
    let all = runs_with_paths(view);
    let Some(first) = all.first() else {
        return Markup::default();
    };
    let unsettled: Vec<String> = (all.iter())
        .filter(|s| !s.paths.has_settled())
        .map(|s| {
            format!(
                "{}: the run has not settled, its means change by {} between both halves of the time from {} to {}; no means are shown.",
                s.label,
                per_cent(s.paths.change_rel, 2),
                quantity(s.paths.from_s, "s", 3),
                quantity(s.paths.to_s, "s", 3)
            )
        })
        .collect();
    let settled: Vec<&RunWithPaths<'_>> = all.iter().filter(|s| s.paths.has_settled()).collect();
    let of_runs = rows(&settled, |p| &p.meshes);
    let of_meshes = Table::of(&of_runs)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .columns(&meshes(), |(s, m)| Some((s.run, *m)));
    let of_runs = rows(&settled, |p| &p.members);
    let of_members = Table::of(&of_runs)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .columns(&members(), |(s, m)| Some((s.run, *m)));
    let sections = rows(&settled, |p| &p.shafts);
    let of_shafts = Table::of(&sections)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .text("Shaft", |(_, s)| s.between.join(" - "))
        .columns(&shafts(), |(s, m)| Some((s.run, *m)));
    let balances = Table::of(&all)
        .text("Model", |s| s.label.to_owned())
        .text("Work put in", |s| quantity(s.paths.work_in_j, "J", 5))
        .result()
        .text("taken out", |s| quantity(s.paths.work_out_j, "J", 5))
        .result()
        .text("dissipated", |s| quantity(s.paths.dissipated_j, "J", 4))
        .result()
        .text("stored", |s| quantity(s.paths.stored_j, "J", 4))
        .result()
        .text("not explained", |s| quantity(s.paths.unexplained_j, "J", 2))
        .result();
    let window = format!(
        "Means over the second half of the run, {} to {}, of the first run of each model. Torques are those of contacts about the axis of \
         the gear. The power of a mesh is what its first gear gives in space (of a planet its mate); rolling power is what goes from gear to \
         gear as the carrier sees it.",
        quantity(first.paths.from_s, "s", 3),
        quantity(first.paths.to_s, "s", 3)
    );
    html! {
        (section("Paths of torque", html! {
            @if !settled.is_empty() { (of_meshes) (note(window)) (of_members) }
            @if !sections.is_empty() { (of_shafts) }
            @for text in &unsettled { (note(text)) }
        }))
        (sharing(&settled))
        (section("Balance of power", html! {
            (balances)
            (note("Over the whole run. Works of loads are sums over the turn of their hub, exact for constant torques; works of drives are \
                   sums over the samples of the run. What is not explained is what these leave, and what the integration made up or lost."))
        }))
    }
}

fn sharing(all: &[&RunWithPaths<'_>]) -> Markup {
    let rows: Vec<(&RunWithPaths<'_>, &Sharing, &PlanetShare)> = (all.iter().copied())
        .flat_map(|s| s.paths.sharing.iter().map(move |of| (s, of)))
        .flat_map(|(s, of)| of.planets.iter().map(move |p| (s, of, p)))
        .collect();
    if rows.is_empty() {
        return Markup::default();
    }
    let table = Table::of(&rows)
        .grouped(|(s, of, _)| (format!("{}: planets on {}", s.label, of.gear), s.style))
        .columns(&load_sharing(), |(s, of, p)| Some((s.run, *of, *p)));
    section(
        "Load sharing of planets",
        html! {
            (table)
            (note("Share of each planet in the sum of the mesh forces on a gear, over the second half of the run. The load sharing factor is \
                   the number of planets times the largest share."))
        },
    )
}

/// Draws the shares of planets over time, a panel for each gear that they mesh with, for the first model that has them.
pub fn shares(view: &View<'_>) -> Result<Option<Chart>, DrawError> {
    let all = runs_with_paths(view);
    let with = all
        .iter()
        .find(|s| s.paths.has_settled() && !s.paths.sharing.is_empty() && s.run.series.is_some());
    let Some((model, series)) = with.and_then(|s| Some((s, s.run.series.as_ref()?))) else {
        return Ok(None);
    };
    let end = series.time_s.last().copied().unwrap_or(1.0);
    let prefix = Prefix::of(end, 1.0);
    let x = Axis::linear(0.0, prefix.factor * end);
    let mut panels = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for of in &model.paths.sharing {
        let of_planet = |planet: &str| {
            let joins =
                |m: &&MeshPath| m.gears.contains(&of.gear) && m.gears.iter().any(|g| g == planet);
            let mesh = model.paths.meshes.iter().find(joins)?;
            series.of_mesh(CONTACT_FORCE, &mesh.gears)
        };
        let forces: Option<Vec<&[f64]>> = of.planets.iter().map(|p| of_planet(&p.planet)).collect();
        let Some(forces) = forces else { continue };
        let sums: Vec<f64> = (0..series.len())
            .map(|i| forces.iter().map(|f| f[i]).sum())
            .collect();
        let most = sums.iter().copied().fold(0.0, f64::max);
        let mut panel =
            Panel::new(190.0, &x, "share [%]").remark(format!("planets on {}", of.gear));
        for (p, f) in of.planets.iter().zip(&forces) {
            let style = names
                .iter()
                .position(|n| *n == p.planet)
                .unwrap_or_else(|| {
                    names.push(&p.planet);
                    names.len() - 1
                });
            // A gap in a time without a force is bridged.
            let points: (Vec<f64>, Vec<f64>) = (0..series.len())
                .filter(|i| sums[*i] > 1e-3 * most)
                .map(|i| (prefix.factor * series.time_s[i], 100.0 * f[i] / sums[i]))
                .unzip();
            let look = curve_style(style);
            let stroke = Stroke::dashed(look.ink, 1.5, look.dash);
            panel
                .curves
                .push(Curve::history(stroke, &x, &points.0, &points.1).along(Some(style)));
        }
        let even = 100.0 / of.planets.len() as f64;
        panel.limits = vec![(even, String::new())];
        panel.bands = vec![(
            [
                prefix.factor * model.paths.from_s,
                prefix.factor * model.paths.to_s,
            ],
            Ink::GRID.opacity(0.5),
        )];
        panels.push(panel);
    }
    if panels.is_empty() {
        return Ok(None);
    }
    if let Some(last) = panels.last_mut() {
        last.x_name = Some(format!("time [{}s]", prefix.symbol));
    }
    let legend: Vec<Entry> = (names.iter().enumerate())
        .map(|(style, name)| {
            let look = curve_style(style);
            Entry::history(name, Stroke::dashed(look.ink, 1.5, look.dash), Some(style))
        })
        .collect();
    let caption = format!(
        "Share of each planet in the sum of the mesh forces, {} under {}. Means are taken in the tinted half.",
        model.label, model.run.integrator
    );
    chart(
        "load_sharing.svg",
        "Load sharing of planets",
        caption,
        &legend,
        &panels,
    )
    .map(Some)
}

/// Returns the CSV files with torque paths and load sharing of all runs that have settled.
pub fn csv(view: &View<'_>) -> Vec<CsvTable> {
    let runs: Vec<(&Run, &TorquePaths)> = (view.results.runs.iter())
        .filter_map(|r| Some((r, r.paths.as_ref().filter(|p| p.has_settled())?)))
        .collect();
    fn all<'a, R>(
        runs: &[(&'a Run, &'a TorquePaths)],
        of: fn(&TorquePaths) -> &[R],
    ) -> Vec<Of<'a, R>> {
        let each = |(run, paths): &(&'a Run, &'a TorquePaths)| {
            let run = *run;
            of(paths).iter().map(move |r| (run, r)).collect::<Vec<_>>()
        };
        runs.iter().flat_map(each).collect()
    }
    if runs.is_empty() {
        return Vec::new();
    }
    let mut tables = vec![
        meshes().table(all(&runs, |p| &p.meshes)),
        members().table(all(&runs, |p| &p.members)),
    ];
    let of_shafts = all(&runs, |p| &p.shafts);
    if !of_shafts.is_empty() {
        tables.push(shafts().table(of_shafts));
    }
    let shares: Vec<Share<'_>> = all(&runs, |p| &p.sharing)
        .into_iter()
        .flat_map(|(r, s)| s.planets.iter().map(move |p| (r, s, p)))
        .collect();
    if !shares.is_empty() {
        tables.push(load_sharing().table(shares));
    }
    tables
}

/// A part of the paths of a run.
type Of<'a, R> = (&'a Run, &'a R);
/// A planet of a run.
type Share<'a> = (&'a Run, &'a Sharing, &'a PlanetShare);

#[rustfmt::skip]
pub fn meshes<'a>() -> Columns<'a, Of<'a, MeshPath>> {
    Columns::<Of<'_, MeshPath>>::of("torque_paths.csv", "`compare` of scenes with a train or shafts: one row per run and mesh. All means are over the second half of the run.")
        .model(|(r, _)| r.model_label())
        .integrator(|(r, _)| r.integrator.clone())
        .add("mesh_name", "names of both gears of the mesh", |(_, m)| m.gears.join(" - ")).shown("Mesh", Format::Text)
        .add("mean_force_n", "mean contact force", |(_, m)| m.force_n).shown("Mean force", Format::Fixed(4)).result()
        .add("torque_1_nm", "mean torque of the mesh on its first gear about that gear's axis; of a rack the force along its motion in N", |(_, m)| m.torque_nm[0]).shown("Torque on the first gear", Format::Fixed(4)).result()
        .add("torque_2_nm", "mean torque of the mesh on its second gear", |(_, m)| m.torque_nm[1]).shown("on the second", Format::Fixed(4)).result()
        .add("power_w", "mean power that the first gear (of a planet its mate) delivers in space", |(_, m)| m.power_w).shown("Power", Format::Quantities(4)).result()
        .add("power_share", "its magnitude over the input power of all loads and drives", |(_, m)| m.share).shown("of the input", Format::Percents(3)).result()
        .add("rolling_power_w", "mean power from gear to gear in the frame of the carrier of a planetary set", |(_, m)| m.rolling_w).shown("Rolling power", Format::Quantities(4))
        .add("loss_w", "mean power loss in the contacts of the mesh", |(_, m)| m.loss_w).shown("Lost", Format::Quantities(4))
}

#[rustfmt::skip]
pub fn members<'a>() -> Columns<'a, Of<'a, MemberPath>> {
    Columns::<Of<'_, MemberPath>>::of("torque_members.csv", "`compare` of scenes with a train or shafts: one row per run and gear or body. All means are over the second half of the run.")
        .model(|(r, _)| r.model_label())
        .integrator(|(r, _)| r.integrator.clone())
        .add("member", "gear or body", |(_, m)| m.name.clone()).shown("Gear or body", Format::Text)
        .add("speed_rad_s", "mean speed", |(_, m)| m.speed_rad_s).shown("Mean speed", Format::Fixed(4)).result()
        .add("load_nm", "mean torque of its loads", |(_, m)| m.load_nm).shown("Loads", Format::Fixed(4)).result()
        .add("mount_nm", "mean torque of its mount or drive", |(_, m)| m.mount_nm).shown("Mount or drive", Format::Fixed(4)).result()
        .add("contact_nm", "mean torque of all its contacts", |(_, m)| m.contact_nm).shown("Contacts", Format::Fixed(4)).result()
        .add("power_w", "mean power of its loads and drive", |(_, m)| m.power_w).shown("Power of loads and drive", Format::Quantities(4)).result()
        .add("bearing_n", "mean magnitude of the force of its bearing or pin", |(_, m)| m.bearing_n).shown("Bearing or pin, mean", Format::Fixed(4)).result()
        .add("work_j", "work of its loads and drive over the whole run", |(_, m)| m.work_j)
}

#[rustfmt::skip]
pub fn shafts<'a>() -> Columns<'a, Of<'a, ShaftPath>> {
    Columns::<Of<'_, ShaftPath>>::of("torque_shafts.csv", "`compare` of scenes with shafts: one row per run and section of a shaft. All means are over the second half of the run.")
        .model(|(r, _)| r.model_label())
        .integrator(|(r, _)| r.integrator.clone())
        .add("station_1", "first member of the section: gear or body", |(_, s)| s.between[0].clone())
        .add("station_2", "second member of the section", |(_, s)| s.between[1].clone())
        .add("torque_nm", "mean torque that the first member exerts on the second", |(_, s)| s.torque_nm).shown("Mean torque", Format::Fixed(4)).result()
        .add("power_w", "mean power through the shaft", |(_, s)| s.power_w).shown("Power", Format::Quantities(4)).result()
}

#[rustfmt::skip]
pub fn load_sharing<'a>() -> Columns<'a, Share<'a>> {
    Columns::<Share<'_>>::of("load_sharing.csv", "`compare` of scenes with carriers: one row per run, gear and planet that meshes with it.")
        .model(|(r, ..)| r.model_label())
        .integrator(|(r, ..)| r.integrator.clone())
        .add("carrier", "carrier of planets that share a load", |(_, s, _)| s.carrier.clone())
        .add("gear", "gear that all of them mesh with", |(_, s, _)| s.gear.clone())
        .add("planet", "one of them", |(.., p)| p.planet.clone()).shown("Planet", Format::Text)
        .add("share_mean", "mean force of its mesh over the sum of those of all", |(.., p)| p.mean).shown("Share, mean", Format::Percents(4)).result()
        .add("share_least", "least momentary share", |(.., p)| p.least).shown("least", Format::Percents(4)).result()
        .add("share_greatest", "greatest momentary share", |(.., p)| p.greatest).shown("greatest", Format::Percents(4)).result()
        .add("sharing_factor", "load sharing factor of the mean forces: number of planets times the largest over their sum", |(_, s, _)| s.factor).shown("K\u{3b3} of the means", Format::Fixed(4)).result()
        .add("sharing_factor_greatest", "greatest momentary load sharing factor", |(_, s, _)| s.factor_greatest).shown("greatest K\u{3b3}", Format::Fixed(4)).result()
}
