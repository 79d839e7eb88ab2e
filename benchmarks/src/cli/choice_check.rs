//! Arguments of `choose` on random scenes: `--check`, `--draw`.

use clap::Args;

/// Judging choices on random scenes.
#[derive(Args, Clone, Debug)]
pub struct ChoiceCheck {
    /// Judge the choice on a set of random scenes, `tuning` or `held-out`
    #[arg(long, value_name = "SET")]
    pub check: Option<String>,
    /// Scenes of the set, from the first to the last [default: all]
    #[arg(long, value_name = "A..B", requires = "check", value_parser = range)]
    pub scenes: Option<[usize; 2]>,
    /// Judge so many scenes, the first of one impact, against full finite elements [default: as the set says]
    #[arg(long, value_name = "N", requires = "check")]
    pub full_order: Option<usize>,
    /// Scenes that are judged at the same time
    #[arg(long, value_name = "N", requires = "check", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub threads: u32,
    /// Print a random scene as a scene file, for example tuning:7
    #[arg(long, value_name = "SET:NUMBER", conflicts_with = "check", value_parser = one)]
    pub draw: Option<(String, usize)>,
}

fn range(text: &str) -> Result<[usize; 2], String> {
    let (a, b) = text.split_once("..").unwrap_or((text, text));
    match (a.trim().parse(), b.trim().parse()) {
        (Ok(a), Ok(b)) if 1 <= a && a <= b => Ok([a, b]),
        _ => Err("expected two numbers from 1 on, for example 1..12, both ends included".into()),
    }
}

fn one(text: &str) -> Result<(String, usize), String> {
    let parts = text.split_once(':');
    match parts.map(|(set, number)| (set, number.trim().parse())) {
        Some((set, Ok(number))) if !set.is_empty() => Ok((set.to_owned(), number)),
        _ => Err("expected a set and a number, for example tuning:7".into()),
    }
}
