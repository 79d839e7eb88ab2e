//! Escaping of texts from data for terminals, Markdown and table cells.
//!
//! Names of gears, labels and messages come from files of any origin. Each kind of output has one function here; `maud`
//! escapes pages.

use std::borrow::Cow;

/// Escapes a text for a terminal or a log: control characters become visible (except tab and line feed), no line is a
/// workflow command (`::error::`, `##[error]`), and typographic signs and spaces become plain ones.
pub fn terminal(text: &str) -> Cow<'_, str> {
    let plain = |c: char| !c.is_control() || matches!(c, '\n' | '\t');
    let typographic = |c: char| matches!(c, '\u{2212}' | '\u{a0}' | '\u{202f}');
    let ordinary = text.chars().all(|c| plain(c) && !typographic(c));
    if ordinary && !text.contains("::") && !text.contains("##") {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{2212}' => shown.push('-'),
            '\u{a0}' | '\u{202f}' => shown.push(' '),
            c if plain(c) => shown.push(c),
            c => shown.extend(c.escape_default()),
        }
    }
    let lines = shown.split('\n').map(|line| {
        let command = line.trim_start().starts_with("::");
        let line = if command {
            line.replacen("::", ": :", 1)
        } else {
            line.to_owned()
        };
        line.replace("##", "# #")
    });
    Cow::Owned(lines.collect::<Vec<_>>().join("\n"))
}

/// Escapes a text as [`terminal`] does, but keeps the sequences for colours and weights of letters.
pub fn coloured(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("\u{1b}[") {
        let (before, from) = rest.split_at(at);
        out.push_str(&terminal(before));
        let of_colour = |c: char| c.is_ascii_digit() || c == ';';
        let parameters = from[2..].find(|c: char| !of_colour(c)).map(|end| end + 2);
        let length = match parameters.filter(|&end| from[end..].starts_with('m')) {
            Some(end) => end + 1,
            None => {
                out.push_str(&terminal("\u{1b}"));
                1
            }
        };
        if length > 1 {
            out.push_str(&from[..length]);
        }
        rest = &from[length..];
    }
    out + &terminal(rest)
}

/// Escapes a text for a line or a table cell in Markdown, without markup, links or line breaks.
pub fn markdown(text: &str) -> String {
    let all: Vec<char> = text.chars().collect();
    let is_word = |at: Option<usize>| {
        at.and_then(|at| all.get(at))
            .is_some_and(|c| c.is_alphanumeric())
    };
    let mut out = String::with_capacity(text.len());
    for (i, &c) in all.iter().enumerate() {
        let (before, after) = (is_word(i.checked_sub(1)), is_word(Some(i + 1)));
        match c {
            c if c.is_control() => out.push(' '),
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '#' | '!' | '$' => out.extend(['\\', c]),
            // Within a word these are no markup: `peak_force_n`, `force_l2@calculix`.
            '_' if !(before && after) => out.push_str("\\_"),
            '@' if !before => out.push_str("&#64;"),
            // An address is no link.
            ':' if all.get(i + 1) == Some(&'/') => out.push_str("&#58;"),
            '.' if out.to_ascii_lowercase().ends_with("www") => out.push_str("&#46;"),
            c => out.push(c),
        }
    }
    out
}

/// Escapes a text for an element or a quoted attribute of XML and SVG; control characters become spaces.
pub fn xml(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Escapes a CSV cell: a text that a spreadsheet would read as a formula begins with an apostrophe; control characters
/// become spaces.
pub fn cell(text: &str) -> Cow<'_, str> {
    let formula = text.starts_with(['=', '@', '+', '-']) && text.parse::<f64>().is_err();
    let plain = !text.chars().any(char::is_control);
    if plain && !formula {
        return Cow::Borrowed(text);
    }
    let visible = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let visible: String = visible.collect();
    Cow::Owned(if formula {
        format!("'{visible}")
    } else {
        visible
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_gets_no_commands() {
        assert_eq!(
            terminal("a\u{1b}[31m\u{0}b\r\tc\nd"),
            "a\\u{1b}[31m\\u{0}b\\r\tc\nd"
        );
        assert_eq!(terminal("x\n ::error::boo"), "x\n : :error::boo");
        assert_eq!(terminal("::error::boo"), ": :error::boo");
        assert_eq!(terminal("a ##[error]boo"), "a # #[error]boo");
        assert_eq!(terminal("\u{2212}1.5\u{a0}%"), "-1.5 %");
        assert_eq!(terminal("path::of a thing"), "path::of a thing");
        assert!(matches!(terminal("plain"), Cow::Borrowed(_)));
    }

    #[test]
    fn colours_pass_and_nothing_else() {
        let text = "\u{1b}[31;1mred\u{1b}[0m \u{1b}[2J \u{1b}]0;title\u{7}";
        assert_eq!(
            coloured(text),
            "\u{1b}[31;1mred\u{1b}[0m \\u{1b}[2J \\u{1b}]0;title\\u{7}"
        );
    }

    #[test]
    fn markdown_has_no_markup_of_names() {
        assert_eq!(
            markdown("<img src=x onerror=alert(1)> & [a](https://b) | `c`\n# d"),
            "&lt;img src=x onerror=alert(1)&gt; &amp; \\[a\\](https&#58;//b) \\| \\`c\\` \\# d"
        );
        assert_eq!(
            markdown("force_l2@calculix, _x_ www.b @c"),
            "force_l2@calculix, \\_x\\_ www&#46;b &#64;c"
        );
    }

    #[test]
    fn a_cell_is_no_formula() {
        for formula in ["=1+1", "@SUM(A1)", "+1+cmd|' /C calc'!A0", "-2+3", "-"] {
            assert_eq!(cell(formula), format!("'{formula}"));
        }
        for other in ["-1.5e-3", "rigid", "a=b", "1e5", "", "-0.000000000e0"] {
            assert_eq!(cell(other), other);
        }
        assert_eq!(cell("a\nb\u{1b}"), "a b ");
    }
}
