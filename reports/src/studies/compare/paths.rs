//! Paths of torque and power in a train, and load sharing of planets: tables, a chart over time, CSV files.

use crate::csv_table::{CsvTable, number};
use crate::drawing::Chart;
use crate::drawing::axis::Axis;
use crate::drawing::canvas::{DrawError, Ink, Stroke};
use crate::drawing::legend::Entry;
use crate::drawing::panel::{Curve, Panel, chart};
use crate::drawing::style::curve_style;
use crate::markup::table::Table;
use crate::markup::{note, section};
use crate::numbers::{Prefix, per_cent, quantity, significant};
use crate::record::{MemberPath, MeshPath, PlanetShare, Run, ShaftPath, Sharing, TorquePaths};
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

/// Formats a number with four digits; magnitudes below 1e-6 are zero.
fn four_digits(x: f64) -> String {
    match x.abs() < 1e-6 {
        true => "0".into(),
        false => significant(x, 4),
    }
}

/// Returns the tables of torque paths; empty for a scene without train and shafts.
pub fn tables(view: &View<'_>) -> Markup {
    let all = runs_with_paths(view);
    let Some(first) = all.first() else {
        return Markup::default();
    };
    let watt = |x: f64| quantity(x, "W", 4);
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
    let meshes = rows(&settled, |p| &p.meshes);
    let of_meshes = Table::of(&meshes)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .text("Mesh", |(_, m)| m.gears.join(" - "))
        .written("Mean force", "N", |(_, m)| four_digits(m.force_n))
        .result()
        .written("Torque on the first gear", "N m", |(_, m)| {
            four_digits(m.torque_nm[0])
        })
        .result()
        .written("on the second", "N m", |(_, m)| four_digits(m.torque_nm[1]))
        .result()
        .text("Power", |(_, m)| watt(m.power_w))
        .result()
        .percents("of the input", 3, |(_, m)| m.share)
        .result()
        .text("Rolling power", |(_, m)| m.rolling_w.map(watt))
        .text("Lost", |(_, m)| watt(m.loss_w));
    let members = rows(&settled, |p| &p.members);
    let of_members = Table::of(&members)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .text("Gear or body", |(_, m)| m.name.clone())
        .written("Mean speed", "rad/s", |(_, m)| four_digits(m.speed_rad_s))
        .result()
        .written("Loads", "N m", |(_, m)| four_digits(m.load_nm))
        .result()
        .written("Mount or drive", "N m", |(_, m)| four_digits(m.mount_nm))
        .result()
        .written("Contacts", "N m", |(_, m)| four_digits(m.contact_nm))
        .result()
        .text("Power of loads and drive", |(_, m)| watt(m.power_w))
        .result()
        .written("Bearing or pin, mean", "N", |(_, m)| {
            four_digits(m.bearing_n)
        })
        .result();
    let shafts = rows(&settled, |p| &p.shafts);
    let of_shafts = Table::of(&shafts)
        .grouped(|(s, _)| (s.label.to_owned(), s.style))
        .text("Shaft", |(_, s)| s.between.join(" - "))
        .written("Mean torque", "N m", |(_, s)| four_digits(s.torque_nm))
        .result()
        .text("Power", |(_, s)| watt(s.power_w))
        .result();
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
            @if !shafts.is_empty() { (of_shafts) }
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
        .text("Planet", |(.., p)| p.planet.clone())
        .percents("Share, mean", 4, |(.., p)| p.mean)
        .result()
        .percents("least", 4, |(.., p)| p.least)
        .result()
        .percents("greatest", 4, |(.., p)| p.greatest)
        .result()
        .written("K\u{3b3} of the means", "", |(_, of, _)| {
            significant(of.factor, 4)
        })
        .result()
        .written("greatest K\u{3b3}", "", |(_, of, _)| {
            significant(of.factor_greatest, 4)
        })
        .result();
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
    let with = all.iter().find(|s| {
        let series = s.run.series.as_ref();
        s.paths.has_settled()
            && !s.paths.sharing.is_empty()
            && series.is_some_and(|x| !x.columns.is_empty())
    });
    let Some((model, series)) = with.and_then(|s| Some((s, s.run.series.as_ref()?))) else {
        return Ok(None);
    };
    let end = series.time_s.last().copied().unwrap_or(1.0);
    let prefix = Prefix::of(end, 1.0);
    let x = Axis::linear(0.0, prefix.factor * end);
    let mut panels = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for of in &model.paths.sharing {
        let meshes = model.paths.meshes.iter().enumerate();
        let of_planet = |planet: &str| {
            let joins =
                |m: &MeshPath| m.gears.contains(&of.gear) && m.gears.iter().any(|g| g == planet);
            let (i, mesh) = meshes.clone().find(|(_, m)| joins(m))?;
            series.mesh_force(&mesh.gears, i == 0)
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
    type Of<'a, R> = (&'a Run, &'a R);
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
    let meshes = CsvTable::new::<Of<'_, MeshPath>>(
        "torque_paths.csv",
        all(&runs, |p| &p.meshes),
        &[
            ("model", &|(r, _)| r.model_label()),
            ("integrator", &|(r, _)| r.integrator.clone()),
            ("mesh_name", &|(_, m)| m.gears.join(" - ")),
            ("mean_force_n", &|(_, m)| number(m.force_n)),
            ("torque_1_nm", &|(_, m)| number(m.torque_nm[0])),
            ("torque_2_nm", &|(_, m)| number(m.torque_nm[1])),
            ("power_w", &|(_, m)| number(m.power_w)),
            ("power_share", &|(_, m)| number(m.share)),
            ("rolling_power_w", &|(_, m)| number(m.rolling_w)),
            ("loss_w", &|(_, m)| number(m.loss_w)),
        ],
    );
    let members = CsvTable::new::<Of<'_, MemberPath>>(
        "torque_members.csv",
        all(&runs, |p| &p.members),
        &[
            ("model", &|(r, _)| r.model_label()),
            ("integrator", &|(r, _)| r.integrator.clone()),
            ("member", &|(_, m)| m.name.clone()),
            ("speed_rad_s", &|(_, m)| number(m.speed_rad_s)),
            ("load_nm", &|(_, m)| number(m.load_nm)),
            ("mount_nm", &|(_, m)| number(m.mount_nm)),
            ("contact_nm", &|(_, m)| number(m.contact_nm)),
            ("power_w", &|(_, m)| number(m.power_w)),
            ("bearing_n", &|(_, m)| number(m.bearing_n)),
            ("work_j", &|(_, m)| number(m.work_j)),
        ],
    );
    let mut tables = vec![meshes, members];
    let shafts = all(&runs, |p| &p.shafts);
    if !shafts.is_empty() {
        tables.push(CsvTable::new::<Of<'_, ShaftPath>>(
            "torque_shafts.csv",
            shafts,
            &[
                ("model", &|(r, _)| r.model_label()),
                ("integrator", &|(r, _)| r.integrator.clone()),
                ("station_1", &|(_, s)| s.between[0].clone()),
                ("station_2", &|(_, s)| s.between[1].clone()),
                ("torque_nm", &|(_, s)| number(s.torque_nm)),
                ("power_w", &|(_, s)| number(s.power_w)),
            ],
        ));
    }
    let shares: Vec<(&Run, &Sharing, &PlanetShare)> = all(&runs, |p| &p.sharing)
        .into_iter()
        .flat_map(|(r, s)| s.planets.iter().map(move |p| (r, s, p)))
        .collect();
    if !shares.is_empty() {
        tables.push(CsvTable::new::<(&Run, &Sharing, &PlanetShare)>(
            "load_sharing.csv",
            shares,
            &[
                ("model", &|(r, ..)| r.model_label()),
                ("integrator", &|(r, ..)| r.integrator.clone()),
                ("carrier", &|(_, s, _)| s.carrier.clone()),
                ("gear", &|(_, s, _)| s.gear.clone()),
                ("planet", &|(.., p)| p.planet.clone()),
                ("share_mean", &|(.., p)| number(p.mean)),
                ("share_least", &|(.., p)| number(p.least)),
                ("share_greatest", &|(.., p)| number(p.greatest)),
                ("sharing_factor", &|(_, s, _)| number(s.factor)),
                ("sharing_factor_greatest", &|(_, s, _)| {
                    number(s.factor_greatest)
                }),
            ],
        ));
    }
    tables
}
