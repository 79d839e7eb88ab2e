//! The report: one HTML page with everything inside, for the screen offline and for paper.
//!
//! No script, no font, no request: style and charts are in the page. Every text that came from data
//! goes through [`escape`].

mod choice_check;
mod choose;
mod finding;
mod penalty;
mod precision;
mod sections;
mod stability;
mod sweep;
mod table;
mod timing;
mod truncation;

use crate::charts::Chart;
use crate::record::{Results, Study};
use crate::view::View;

const STYLE: &str = include_str!("style.css");

/// Text made safe for HTML and XML, in content and in attributes; control characters are dropped.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// The page for a record and its charts.
pub fn page(results: &Results, charts: &[Chart]) -> String {
    let view = View::new(results);
    let name = if results.title.is_empty() {
        &results.scene
    } else {
        &results.title
    };
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta \
         name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta \
         name=\"generator\" content=\"gearbench\">\n<title>{0}: {1} - gearbench</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header>\n\
         <p class=\"kicker\">gearbench &middot; {1} &middot; scene <b>{2}</b></p>\n\
         <h1>{0}</h1>\n",
        escape(name),
        results.study,
        escape(&results.scene),
    );
    out.push_str(&sections::stamp(results));
    out.push_str("</header>\n");
    out.push_str(&format!(
        "<section class=\"finding\">\n<h2>Finding</h2>\n<p>{}</p>\n</section>\n",
        match results.study {
            Study::Choose => choose::finding(&view),
            Study::Truncation => truncation::finding(&view),
            Study::Sweep => sweep::finding(&view),
            Study::Penalty => penalty::finding(&view),
            Study::Stability => stability::finding(&view),
            Study::ChoiceCheck => choice_check::finding(&view),
            Study::Precision => precision::finding(&view),
            _ => finding::finding(&view),
        }
    ));
    out.push_str(&match results.study {
        Study::Choose => choose::tables(&view),
        Study::Truncation => truncation::tables(&view),
        Study::Sweep => sweep::tables(&view),
        Study::Penalty => penalty::tables(&view),
        Study::Stability => stability::tables(&view),
        Study::ChoiceCheck => choice_check::tables(&view),
        Study::Precision => precision::tables(&view),
        _ => sections::glance(&view) + &timing::timing(&view),
    });
    for (i, chart) in charts.iter().enumerate() {
        out.push_str(&format!(
            "<section class=\"chart\">\n<h2>{}</h2>\n<figure>\n{}<figcaption><b>Figure {}.</b> \
             {}</figcaption>\n</figure>\n</section>\n",
            escape(chart.title),
            chart.svg,
            i + 1,
            escape(&chart.caption),
        ));
    }
    match results.study {
        Study::Sweep => out.push_str(&sweep::speeds(&view)),
        Study::ChoiceCheck => out.push_str(&choice_check::scenes(&view)),
        Study::Precision => out.push_str(&precision::runs(&view)),
        Study::Stability | Study::Choose => {}
        _ => {
            out.push_str(&sections::metrics(&view));
            out.push_str(&sections::work(&view));
            out.push_str(&sections::ledger(&view));
        }
    }
    if ![
        Study::Stability,
        Study::Precision,
        Study::Choose,
        Study::ChoiceCheck,
    ]
    .contains(&results.study)
    {
        out.push_str(&sections::failures(&view));
    }
    out.push_str(&sections::setting(&view));
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn nothing_escapes() {
        let hostile = "<script>alert('x')</script> & \"quoted\"\u{0}\n";
        assert_eq!(
            escape(hostile),
            "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;quoted&quot; "
        );
    }
}
