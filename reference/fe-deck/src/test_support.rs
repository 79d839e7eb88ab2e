//! Decks that several tests share.

use crate::{Deck, read_str};

/// A deck from its text, without includes.
pub(crate) fn parsed(name: &str, text: &str) -> Deck {
    let read = read_str(name, text, &mut |_| {
        Err(std::io::Error::other("no includes"))
    });
    read.unwrap_or_else(|e| panic!("{e}"))
}
