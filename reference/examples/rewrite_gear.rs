//! Reads a deck, says what the GTM check finds, and writes one of its gears in its own frame as a deck of its own.
//!
//!     cargo run --release -p gearbench-reference --example rewrite_gear -- IN.inp[.gz] OUT.inp [GEAR [MODES]]
//!
//! GEAR counts from 1 (default 1); with MODES the deck computes that many modes with the bore held.
#![allow(clippy::print_stdout)]

use gearbench_reference::deck;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, output, rest @ ..] = arguments.as_slice() else {
        return Err("usage: rewrite_gear IN.inp[.gz] OUT.inp [GEAR [MODES]]".into());
    };
    let wanted: usize = rest.first().map_or(Ok(1), |n| n.parse())?;
    let modes = rest.get(1).map(|n| n.parse()).transpose()?;
    let read = deck::read(input)?;
    for finding in deck::check_gtm(&read) {
        println!("{finding}");
    }
    let gears = deck::gears(&read)?;
    let gear = wanted.checked_sub(1).and_then(|i| gears.get(i));
    let gear = gear.ok_or_else(|| format!("GEAR is 1 to {}", gears.len()))?;
    let mut out = BufWriter::new(std::fs::File::create(output)?);
    let options = deck::GearDeck {
        title: format!("{} of {input}", gear.name),
        modes,
    };
    deck::write(&mut out, &gear.mesh, &gear.material, &options)?;
    out.flush()?;
    Ok(())
}
