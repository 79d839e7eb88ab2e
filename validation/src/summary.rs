//! Counts and ranges of stored results, as the documents quote them: `gearbench-validation summary FILE...` prints a line
//! for each group of scenes.

use crate::choices::{ValidatedChoice, choices_of, share};
use gearbench_reports::load_results;
use gearbench_reports::numbers::quantile;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Limit of the errors that are counted; it is that of [`crate::reduction`].
const LIMIT: f64 = crate::reduction::LIMIT;
/// Cost ratio above which choices are counted.
const DEAR: f64 = 3.0;

/// A line of a CSV file: values by the names of their columns.
type Line = BTreeMap<String, String>;

/// Returns the summary of stored files of one kind: records of choices, tables of `reduction`, `coverage`, `agreement` or decks,
/// numbers of benches, or Markdown, whose lines get the heading above them.
///
/// # Errors
/// A file cannot be read, or is of none of these kinds.
pub fn lines(files: &[impl AsRef<Path>]) -> Result<Vec<String>, String> {
    let mut choices = Vec::new();
    let mut table: Vec<Line> = Vec::new();
    let mut text = Vec::new();
    for file in files {
        let file = file.as_ref();
        let fail = |e: String| format!("{}: {e}", file.display());
        match file.extension().and_then(|e| e.to_str()) {
            Some("json") => {
                let read = std::fs::read_to_string(file).map_err(|e| fail(e.to_string()))?;
                let value: Value = serde_json::from_str(&read).map_err(|e| fail(e.to_string()))?;
                if value.get("study").is_some() {
                    let record = load_results(file).map_err(|e| fail(e.to_string()))?;
                    choices.extend(choices_of(&record).map_err(|e| fail(e.to_string()))?);
                } else {
                    add_numbers("", &value, &mut text);
                }
            }
            Some("csv") => table.extend(read(file).map_err(fail)?),
            _ => {
                let read = std::fs::read_to_string(file).map_err(|e| fail(e.to_string()))?;
                text.extend(under_headings(&read));
            }
        }
    }
    if !choices.is_empty() {
        text.extend(of_choices(&choices));
    }
    let has = |column: &str| table.first().is_some_and(|line| line.contains_key(column));
    match () {
        () if has("force_l2_trigonometric") => text.extend(of_reduction(&table)),
        () if has("low_95") => text.extend(of_coverage(&table)),
        () if has("choose_answer") => text.extend(of_agreement(&table)),
        () if has("digits") => text.extend(of_decks(&table)),
        () if has("full_error") => text.extend(of_finer_elements(&table)),
        () => {}
    }
    if text.is_empty() {
        return Err("there are no results that have a summary".into());
    }
    Ok(text)
}

fn read(file: &Path) -> Result<Vec<Line>, String> {
    let reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(file);
    let mut reader = reader.map_err(|e| e.to_string())?;
    let lines = reader.deserialize().collect::<Result<_, csv::Error>>();
    lines.map_err(|e| e.to_string())
}

/// Returns the value of a column of a line; `None` where it is empty or no number.
fn number(line: &Line, column: &str) -> Option<f64> {
    line.get(column)?.parse().ok()
}

/// Returns the smallest, the median and the largest of some values.
fn spread(values: impl IntoIterator<Item = f64>) -> [f64; 3] {
    let values: Vec<f64> = values.into_iter().collect();
    [0.0, 0.5, 1.0].map(|part| quantile(&values, part).unwrap_or(f64::NAN))
}

fn of_choices(all: &[ValidatedChoice]) -> Vec<String> {
    let every: Vec<&ValidatedChoice> = all.iter().collect();
    let s = share("all", &every);
    let [_, cost, dearest] = spread(all.iter().filter_map(ValidatedChoice::cost_ratio));
    let dear = (all.iter()).filter(|c| c.cost_ratio().is_some_and(|r| r > DEAR));
    let own_contact = (all.iter()).filter(|c| c.reference.ends_with("contact of the scene"));
    let within = |error: fn(&ValidatedChoice) -> Option<f64>| {
        (all.iter())
            .filter(|c| error(c).is_some_and(|e| e <= c.tolerance))
            .count()
    };
    let mut models: BTreeMap<&str, usize> = BTreeMap::new();
    for name in all.iter().filter_map(|c| c.chosen.as_deref()) {
        let model = name.split_once(',').map_or(name, |(model, _)| model);
        *models.entry(model).or_default() += 1;
    }
    let models: Vec<String> = models.iter().map(|(m, n)| format!("{m} {n}")).collect();
    let [_, choosing, longest] = spread(all.iter().filter_map(|c| c.choosing_s));
    let [_, refining, longest_refining] = spread(all.iter().filter_map(|c| c.refining_s));
    vec![
        format!(
            "choices within the tolerance: {} of {}, {} judged with the contact of the scene",
            s.met,
            s.scenes,
            own_contact.count()
        ),
        format!(
            "cost over the cheapest adequate candidate: median {cost:.4}, {} above {DEAR}, largest {dearest:.4}",
            dear.count()
        ),
        format!(
            "predicted over true error: median {:.4}",
            s.prediction[1].unwrap_or(f64::NAN)
        ),
        format!("chosen models: {}", models.join(", ")),
        format!(
            "meshes of the scenes within the tolerance: {} with their contact, {} on half-spaces",
            within(|c| c.given_error),
            within(|c| c.mesh_error)
        ),
        format!(
            "processor time: choosing median {choosing:.4} s, at most {longest:.4} s; finer mesh median {refining:.4} s, at most {longest_refining:.4} s"
        ),
    ]
}

/// Choices of which the error against full finite elements on a finer mesh is known.
fn of_finer_elements(table: &[Line]) -> Vec<String> {
    let known: Vec<[f64; 2]> = (table.iter())
        .filter_map(|l| Some([number(l, "full_error")?, number(l, "tolerance")?]))
        .collect();
    let within = known.iter().filter(|[error, limit]| error <= limit).count();
    vec![format!(
        "choices within the tolerance of finer finite elements: {within} of {}",
        known.len()
    )]
}

fn of_reduction(table: &[Line]) -> Vec<String> {
    let loaded = |line: &&Line| line.get("kind").is_some_and(|kind| kind == "under load");
    let groups = [
        ("all", table.iter().collect::<Vec<_>>()),
        (
            "impacts and hammering gears",
            table.iter().filter(|l| !loaded(l)).collect(),
        ),
        ("under load", table.iter().filter(loaded).collect()),
    ];
    let filled = groups.into_iter().filter(|(_, lines)| !lines.is_empty());
    filled
        .map(|(name, lines)| {
            let of = |column: &'static str| lines.iter().filter_map(move |l| number(l, column));
            let within = |column| of(column).filter(|e| *e <= LIMIT).count();
            let [low, _, high] = spread(of("force_l2")).map(|e| 100.0 * e);
            let above = of("force_l2").filter(|e| *e > LIMIT);
            let [first, _, _] = spread(above).map(|e| 100.0 * e);
            let [_, _, smooth] = spread(of("force_l2_below_30_khz")).map(|e| 100.0 * e);
            let [_, _, path] = spread(of("transmission_error_l2")).map(|e| 100.0 * e);
            let [least, _, most] =
                spread(of("fe_force_l2_of_twice_the_step")).map(|e| 100.0 * e);
            format!(
                "{name}: force of {} of {} within {} %, {low:.4} % to {high:.4} %, others from {first:.4} %; below 30 kHz {} within, at most {smooth:.4} %; \
                 transmission error at most {path:.4} %; fe at twice the step {least:.4} % to {most:.4} %",
                within("force_l2"),
                lines.len(),
                100.0 * LIMIT,
                within("force_l2_below_30_khz"),
            )
        })
        .collect()
}

fn of_coverage(table: &[Line]) -> Vec<String> {
    let mut parameters: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for line in table {
        let text = |column: &str| line.get(column).map_or("", String::as_str);
        let [held, all] = parameters.entry(text("parameter")).or_default();
        *held += usize::from(text("holds") == "true");
        *all += 1;
    }
    let share = |[held, all]: &[usize; 2]| 100.0 * *held as f64 / *all as f64;
    let [least, _, most] = spread(parameters.values().map(share));
    let mut lines = vec![format!(
        "all parameters: the 95 % interval contains the true value in {least:.4} % to {most:.4} %"
    )];
    lines.extend(parameters.iter().map(|(name, counts)| {
        format!(
            "{name}: the 95 % interval contains the true value in {:.4} % of {} sets",
            share(counts),
            counts[1]
        )
    }));
    lines
}

fn of_agreement(table: &[Line]) -> Vec<String> {
    let is = |line: &Line, column: &str, text: &str| line.get(column).is_some_and(|t| t == text);
    let any = |line: &Line, text: &str| {
        is(line, "compare_rigid", text) || is(line, "compare_elastic", text)
    };
    let count = |of: &dyn Fn(&Line) -> bool| table.iter().filter(|l| of(l)).count();
    let open = |l: &Line| any(l, "not decided");
    vec![
        format!(
            "{} scenes, {} with a contradiction",
            table.len(),
            count(&|l| !is(l, "contradictions", ""))
        ),
        format!(
            "compare: {} with no adequate model and one not decided, {} with an adequate model and one not decided",
            count(&|l| open(l) && !any(l, "adequate")),
            count(&|l| open(l) && any(l, "adequate"))
        ),
        format!(
            "choose: {} not decided, {} refused",
            count(&|l| is(l, "choose_answer", "not decided")),
            count(&|l| is(l, "choose_answer", "refused"))
        ),
    ]
}

/// Decks of another program: those that were read, and frequencies that agree within one unit of the last printed digit.
fn of_decks(table: &[Line]) -> Vec<String> {
    let yes = |line: &Line, column: &str| line.get(column).is_some_and(|t| t == "yes");
    let solids: Vec<&Line> = table.iter().filter(|l| yes(l, "solid")).collect();
    let read = solids.iter().filter(|l| yes(l, "read")).count();
    let digits: Vec<f64> = table.iter().filter_map(|l| number(l, "digits")).collect();
    let agreed = digits.iter().filter(|d| **d <= 1.0).count();
    vec![format!(
        "{} decks, {} of linear isotropic solids: {read} read; frequencies of {} compared: {agreed} within one printed digit",
        table.len(),
        solids.len(),
        digits.len()
    )]
}

/// Adds a line for each number of a file of a bench, after the names of the members that contain it; an element of a list has
/// its first text as its name.
fn add_numbers(names: &str, value: &Value, lines: &mut Vec<String>) {
    match value {
        Value::Number(x) => lines.push(format!("{names}: {x}")),
        Value::Object(members) => {
            for (name, member) in members {
                add_numbers(&format!("{names}, {name}"), member, lines);
            }
        }
        Value::Array(elements) => {
            for (i, element) in elements.iter().enumerate() {
                let texts = element.as_object().into_iter().flat_map(|o| o.values());
                let name = texts.filter_map(Value::as_str).next();
                let name = name.map_or_else(|| i.to_string(), str::to_owned);
                add_numbers(&format!("{names}, {name}"), element, lines);
            }
        }
        _ => {}
    }
}

/// Returns the lines of a text in Markdown, each after its heading of the second level.
fn under_headings(text: &str) -> Vec<String> {
    let mut heading = "";
    let mut out = Vec::new();
    for line in text.lines().filter(|l| !l.is_empty()) {
        match line.strip_prefix("## ") {
            Some(title) => heading = title,
            None => out.push(format!("{heading}: {line}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Vec<Line> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        reader.deserialize().map(Result::unwrap).collect()
    }

    #[test]
    fn scenes_within_the_limit_are_counted() {
        let rows = table(
            "kind,force_l2,force_l2_below_30_khz,transmission_error_l2,fe_force_l2_of_twice_the_step\n\
             one impact,2e-3,1e-3,,5e-3\nhammering,1.2e-2,4e-3,,6e-3\nunder load,4e-1,9e-3,3e-2,1e-1\n",
        );
        let lines = of_reduction(&rows);
        assert!(lines[0].starts_with("all: force of 1 of 3 within 1 %, 0.2000 % to 40.0000 %"));
        assert!(lines[1].contains("others from 1.2000 %; below 30 kHz 2 within, at most 0.4000 %"));
        assert!(lines[2].contains(
            "below 30 kHz 1 within, at most 0.9000 %; transmission error at most 3.0000 %"
        ));
        assert!(lines[2].ends_with("fe at twice the step 10.0000 % to 10.0000 %"));
    }

    #[test]
    fn answers_that_are_open_are_counted() {
        let rows = table(
            "compare_rigid,compare_elastic,choose_answer,contradictions\n\
             not adequate,not decided,refused,\nnot decided,adequate,not decided,\nadequate,adequate,rigid,finding: none\n",
        );
        assert_eq!(
            of_agreement(&rows),
            [
                "3 scenes, 1 with a contradiction",
                "compare: 1 with no adequate model and one not decided, 1 with an adequate model and one not decided",
                "choose: 1 not decided, 1 refused"
            ]
        );
    }

    #[test]
    fn intervals_that_hold_are_counted() {
        let rows = table("parameter,low_95,holds\nk,1,true\nk,1,false\nc,1,true\n");
        assert_eq!(
            of_coverage(&rows),
            [
                "all parameters: the 95 % interval contains the true value in 50.0000 % to 100.0000 %",
                "c: the 95 % interval contains the true value in 100.0000 % of 1 sets",
                "k: the 95 % interval contains the true value in 50.0000 % of 2 sets"
            ]
        );
    }

    #[test]
    fn numbers_of_benches_have_their_names() {
        let file =
            serde_json::json!({"rows": [{"what": "rigid", "ratio": 2.5}, [4]], "commit": "none"});
        let mut lines = Vec::new();
        add_numbers("", &file, &mut lines);
        assert_eq!(lines, [", rows, rigid, ratio: 2.5", ", rows, 1, 0: 4"]);
    }

    #[test]
    fn costs_and_predictions_of_choices() {
        let choice = |cost: f64, reference: &str| ValidatedChoice {
            tolerance: 0.1,
            outcome: crate::choices::Outcome::Adequate,
            chosen: Some("rigid, static solves, dopri5".into()),
            error: Some(0.02),
            predicted_error: Some(0.03),
            given_error: Some(0.2),
            mesh_error: Some(0.1),
            cost_s: Some(cost),
            cheapest_cost_s: Some(1.0),
            reference: reference.into(),
            ..ValidatedChoice::default()
        };
        let lines = of_choices(&[
            choice(1.0, "refined"),
            choice(4.0, "refined, contact of the scene"),
        ]);
        for (i, wanted) in [
            "2 of 2, 1 judged with",
            "median 2.5000, 1 above 3, largest 4.0000",
            "median 1.5000",
            "rigid 2",
            "0 with their contact, 2 on half-spaces",
        ]
        .into_iter()
        .enumerate()
        {
            assert!(lines[i].contains(wanted), "{}", lines[i]);
        }
    }
}
