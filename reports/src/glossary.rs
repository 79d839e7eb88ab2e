//! Meanings of the terms of the field on a page: those of the glossary of the book, and nothing else.

use maud::{Markup, html};
use std::sync::LazyLock;

const GLOSSARY: &str = include_str!("../../docs/book/src/glossary.md");

/// Terms in lower case with their meanings, the longest first, so that a term is preferred to a part of it.
static TERMS: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let rows = GLOSSARY.lines().filter(|line| line.starts_with('|'));
    let row = |line: &str| {
        let mut cells = line.trim_matches('|').split(" | ");
        let (term, meaning) = (cells.next()?.trim(), cells.next()?.trim());
        let is_term = term != "term" && !term.starts_with("---");
        is_term.then(|| (term.to_lowercase(), meaning.replace('`', "")))
    };
    let mut terms: Vec<(String, String)> = rows.filter_map(row).collect();
    terms.sort_by_key(|(term, _)| std::cmp::Reverse(term.len()));
    terms
});

/// Terms whose meaning every reader of a report knows, or that are words of daily life as well.
const PLAIN: [&str; 6] = ["cell", "event", "reference", "scene", "slice", "study"];

/// Renders a text in which the first occurrence of each term of the glossary has its meaning.
pub fn explained(text: &str) -> Markup {
    let lower = text.to_lowercase();
    // Letters whose lower case is longer would shift the places of terms.
    let mut found: Vec<(usize, usize, &str)> = Vec::new();
    if lower.len() == text.len() {
        for (term, meaning) in TERMS.iter().filter(|(t, _)| !PLAIN.contains(&t.as_str())) {
            let is_free = |at: usize| {
                found
                    .iter()
                    .all(|(a, b, _)| at + term.len() <= *a || at >= *b)
            };
            let mut places = lower.match_indices(term.as_str()).map(|(at, _)| at);
            let place = places.find(|at| is_word(&lower, *at, term.len()) && is_free(*at));
            if let Some(at) = place {
                found.push((at, at + term.len(), meaning));
            }
        }
        found.sort_unstable_by_key(|f| f.0);
    }
    let mut from = 0;
    let parts: Vec<(&str, &str, &str)> = (found.iter())
        .map(|(a, b, meaning)| {
            let before = &text[from..*a];
            from = *b;
            (before, &text[*a..*b], *meaning)
        })
        .collect();
    html! {
        @for (before, term, meaning) in parts { (before) abbr title=(meaning) { (term) } }
        (&text[from..])
    }
}

/// True if the letters around a place are not part of the same word; a plural counts as the word.
fn is_word(text: &str, at: usize, length: usize) -> bool {
    let letter = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let before = text[..at].chars().next_back();
    let behind = &text[at + length..];
    let behind = behind.strip_prefix('s').unwrap_or(behind);
    !before.is_some_and(letter) && !behind.chars().next().is_some_and(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_book_has_the_meanings() {
        assert!(TERMS.len() > 30, "{}", TERMS.len());
        let page = explained("Transmission error, peak to peak, and the ledger <b>").0;
        assert!(
            page.starts_with("<abbr title=\"r_b1 theta_1 + r_b2 theta_2 in the transverse plane [m]\">Transmission error</abbr>, peak"),
            "{page}"
        );
        assert!(page.contains(">ledger</abbr> &lt;b&gt;"), "{page}");
    }

    /// A term is a word of its own, the longest one counts, and each has its meaning once.
    #[test]
    fn terms_are_words() {
        assert_eq!(
            explained("meshed, submesh, mesh-wise").0,
            "meshed, submesh, mesh-wise"
        );
        let page = explained("mesh frequency, mesh, mesh").0;
        assert_eq!(page.matches("<abbr").count(), 2, "{page}");
        assert!(page.contains(">mesh frequency</abbr>"), "{page}");
        assert!(explained("of all meshes").0.contains("of all meshes"));
        assert!(
            explained("references and ledgers")
                .0
                .contains(">ledger</abbr>s")
        );
    }
}
