//! Mounting (boundary conditions) of a gear that is reduced.

use super::arguments::Reduce as Arguments;
use super::refuse;
use crate::cli::terminal::Refusal;
use gearbench_reference::reduction::Mounting;

/// The mounting with the changes of the command line.
pub(super) fn mounted(args: &Arguments, of: Mounting) -> Result<Mounting, Refusal> {
    let mass = args.added_mass.unwrap_or(of.added_mass);
    let tilting = args.added_tilting.unwrap_or(of.added_tilting);
    let (free, lateral) = args.mount.unwrap_or((of.free, of.lateral));
    let mounting = Mounting { free, ..of }.with_added(mass, tilting);
    let mounting = mounting.lateral(lateral);
    let mounting = mounting.map_err(|why| refuse(&why.cause, &why.help))?;
    let given = args.added_mass.is_some() || args.added_tilting.is_some();
    if given && !mounting.is_lateral() {
        return Err(refuse(
            "--added-mass and --added-tilting need a hub with out-of-plane directions, but this hub is fixed in them",
            "add directions, for example --mount free,x,y, or remove these options",
        ));
    }
    Ok(mounting)
}
