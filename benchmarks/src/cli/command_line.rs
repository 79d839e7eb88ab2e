//! The command line in records: one line that a shell splits into the same words.

/// Formats the command line with the name of the program in place of its path. Bytes that are not valid text are
/// replaced.
pub fn command_line(program: &str) -> String {
    let arguments = std::env::args_os().skip(1);
    let arguments: Vec<String> = arguments
        .map(|a| a.to_string_lossy().into_owned())
        .collect();
    join(program, &arguments)
}

/// Joins words to a line that a shell splits into the same words.
pub fn join(program: &str, words: &[String]) -> String {
    let quote = |a: &String| {
        let plain = !a.is_empty()
            && a.chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_./=@,:+".contains(c));
        if plain {
            a.clone()
        } else {
            format!("'{}'", a.replace('\'', "'\\''"))
        }
    };
    let words: Vec<String> = words.iter().map(quote).collect();
    format!("{program} {}", words.join(" "))
}

/// Splits the command line of a record into words, without the program.
pub fn split(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let (mut quoted, mut escaped) = (false, false);
    for c in text.chars() {
        match c {
            _ if escaped => {
                word.get_or_insert_default().push(c);
                escaped = false;
            }
            '\\' if !quoted => escaped = true,
            '\'' => {
                quoted = !quoted;
                word.get_or_insert_default();
            }
            ' ' if !quoted => words.extend(word.take()),
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words.into_iter().skip(1).collect()
}

#[cfg(test)]
mod tests {
    use super::split;

    #[test]
    fn a_command_line_is_read_as_it_was_told() {
        let told = r"gearbench compare 'my scene.toml' --integrators 'hht-alpha(alpha=0.1)@1us' --out 'it'\''s' --fresh";
        let words = split(told);
        let expected = [
            "compare",
            "my scene.toml",
            "--integrators",
            "hht-alpha(alpha=0.1)@1us",
            "--out",
            "it's",
            "--fresh",
        ];
        assert_eq!(words, expected);
        assert!(split("gearbench").is_empty());
        assert_eq!(split(r"gearbench 'it'\''s' ''"), ["it's", ""]);
    }
}
