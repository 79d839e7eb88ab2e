//! Reads the deck of an impact and writes it again, as gearbench writes its own.
//!
//!     cargo run --release -p gearbench-reference --example rewrite_impact -- IN.inp[.gz] OUT.inp [STEP_S END_S]
//!
//! `reference/calculix/own_deck.sh OUT.inp` runs CalculiX on the result.

use gearbench_reference::deck;
use gearbench_reference::gear_deck;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (input, output, times) = match arguments.as_slice() {
        [input, output] => (input, output, None),
        [input, output, step, end] => (input, output, Some((step.parse()?, end.parse()?))),
        _ => return Err("usage: rewrite_impact IN.inp[.gz] OUT.inp [STEP_S END_S]".into()),
    };
    let read = deck::read(input)?;
    let gears = gear_deck::gears(&read)?;
    let mut impact = gear_deck::Impact::of(&read, &gears)?;
    if let Some((step, end)) = times {
        (impact.step, impact.end) = (step, end);
    }
    let mut out = BufWriter::new(std::fs::File::create(output)?);
    gear_deck::write_impact(&mut out, &impact)?;
    out.flush()?;
    Ok(())
}
