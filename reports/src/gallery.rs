//! The gallery of a folder of results: a page with finding, first chart and date of each, which links to the reports.

use crate::drawing::canvas::DrawError;
use crate::markup::{document, sentences};
use crate::record::Results;
use crate::store::PAGE;
use crate::studies::report;
use maud::{Markup, html};

/// Content of the element `generator` of a gallery, by which it is known among other pages.
pub const GENERATOR: &str = "gearbench gallery";

/// A result of a gallery.
pub struct Entry {
    /// Folder of the result relative to that of the gallery, with `/` between its parts.
    pub folder: String,
    /// Its record.
    pub results: Results,
}

/// Returns the page of a gallery, the latest result first. Charts are read from their files next to the reports.
///
/// # Errors
/// [`DrawError`] if a chart of a record cannot be drawn.
pub fn gallery(title: &str, entries: &[Entry]) -> Result<String, DrawError> {
    let mut order: Vec<&Entry> = entries.iter().collect();
    order.sort_by(|a, b| {
        let created = |e: &Entry| e.results.header.created.clone();
        created(b).cmp(&created(a)).then(a.folder.cmp(&b.folder))
    });
    let cards: Vec<Markup> = order.iter().map(|e| card(e)).collect::<Result<_, _>>()?;
    let body = html! {
        main {
            header {
                p.kicker { "gearbench \u{b7} " (entries.len()) @if entries.len() == 1 { " result" } @else { " results" } }
                h1 { (title) }
            }
            div.gallery { @for card in &cards { (card) } }
        }
    };
    let page = document(&html! { (title) }, GENERATOR, &body);
    Ok(page.into_string())
}

/// Renders a result: heading, date, finding and first chart.
fn card(entry: &Entry) -> Result<Markup, DrawError> {
    let results = &entry.results;
    let header = &results.header;
    let names: Vec<&str> = results.scenes().map(|r| r.header.name()).collect();
    let scenes: Vec<&str> = results.scenes().map(|r| r.header.scene.as_str()).collect();
    let report = report(results)?;
    let below = |file: &str| address(&format!("{}/{file}", entry.folder));
    let link = below(PAGE);
    let answer = report.finding.get(report.answer).cloned();
    let answer: Vec<Markup> = answer.into_iter().collect();
    let first = report.all_charts().next();
    Ok(html! {
        section.card {
            h2 { a href=(link) { (names.join(" \u{b7} ")) } }
            p.stamp { (results.study_name()) " \u{b7} " (if scenes.len() > 1 { "scenes " } else { "scene " }) (scenes.join(", ")) " \u{b7} " (header.created) " \u{b7} " code { (entry.folder) } }
            p { (sentences(&answer)) }
            @if let Some(chart) = first {
                img loading="lazy" alt=(chart.title) src=(below(&chart.file));
            }
        }
    })
}

/// Returns a relative path as an address: all bytes but letters, digits and the usual signs of file names are escaped.
fn address(path: &str) -> String {
    let mut out = String::with_capacity(path.len() + 2);
    // A name with a colon would be read as a scheme.
    if !path.starts_with('.') {
        out.push_str("./");
    }
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'/' => {
                out.push(char::from(byte));
            }
            _ => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_relative_and_escaped() {
        assert_eq!(address("a/b c"), "./a/b%20c");
        assert_eq!(address("javascript:x"), "./javascript%3Ax");
        assert_eq!(address("\u{e4}\"<"), "./%C3%A4%22%3C");
    }

    /// The latest result is first, and names of scenes and folders are text.
    #[test]
    fn results_are_in_the_order_of_their_dates() {
        let of = |created: &str, title: &str, folder: &str| {
            let mut results = Results::default();
            results.header.created = created.into();
            results.header.title = title.into();
            Entry {
                folder: folder.into(),
                results,
            }
        };
        let entries = [
            of("2026-01-01T00:00:00Z", "older", "a"),
            of(
                "2026-02-01T00:00:00Z",
                "<script>newer</script>",
                "b\"><script>",
            ),
        ];
        let page = gallery("results", &entries).unwrap();
        let (newer, older) = (page.find("newer").unwrap(), page.find("older").unwrap());
        assert!(newer < older);
        assert!(!page.contains("<script"), "{page}");
        assert!(
            page.contains("&lt;script&gt;newer")
                && page.contains("./b%22%3E%3Cscript%3E/index.html")
        );
    }
}
