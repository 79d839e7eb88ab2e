//! Lines of a deck: keyword lines with options, data lines; comments, continuations and includes.
//!
//! A keyword line starts with `*` and goes on in the next line when it ends with a comma; `**` is a comment.
//! Case and blanks do not matter outside quotes. `*INCLUDE, INPUT=file` is followed here, relative to the
//! including file, so that the reader sees one stream of lines, each with the file and line it came from.

use super::error::{DeckError, DeckErrorKind, Place, quote};
use std::borrow::Cow;
use std::io;
use std::sync::Arc;

/// Includes within includes that are followed.
pub const MAX_INCLUDE_DEPTH: usize = 16;

/// Largest number of includes of a deck: a few files that include each other several times would never end.
pub const MAX_INCLUDES: usize = 1000;

/// Text [bytes] that a deck may have in all, includes counted each time.
pub const MAX_DECK_BYTES: usize = 1 << 30;

/// Text [bytes] of a line with the lines that continue it.
pub const MAX_LINE_BYTES: usize = 1 << 20;

/// An option of a keyword line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct KeywordOption {
    /// Name, upper case without blanks.
    pub(crate) key: String,
    /// Value as written, without quotes and outer blanks.
    pub(crate) value: Option<String>,
}

/// A keyword line with its options.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Keyword {
    /// First line of it.
    pub(crate) place: Place,
    /// Name, upper case without blanks and star.
    pub(crate) key: String,
    /// The line as written, for messages.
    pub(crate) text: String,
    pub(crate) options: Vec<KeywordOption>,
}

/// A data line with its fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Data {
    pub(crate) place: Place,
    /// Fields without surrounding blanks; a trailing comma does not add a field.
    pub(crate) fields: Vec<String>,
}

/// Errors of one kind: at a keyword line, and at a data line below one.
macro_rules! errors {
    ($($name:ident $kind:ident),*) => {
        impl Keyword {
            $(pub(crate) fn $name(
                &self,
                expected: impl Into<String>,
                found: impl Into<String>,
                help: impl Into<String>,
            ) -> DeckError {
                (self.place).error(DeckErrorKind::$kind, self.text.clone(), expected, found, help)
            })*
        }
        impl Data {
            $(pub(crate) fn $name(
                &self,
                keyword: &Keyword,
                expected: impl Into<String>,
                found: impl Into<String>,
                help: impl Into<String>,
            ) -> DeckError {
                (self.place).error(DeckErrorKind::$kind, keyword.text.clone(), expected, found, help)
            })*
        }
    };
}

errors!(syntax Syntax, unsupported Unsupported, reference Reference);

/// A line with content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Line {
    Keyword(Keyword),
    Data(Data),
}

/// Reads the text of an included file; the name is joined with the folder of the including file.
pub type Resolver<'a> = dyn FnMut(&str) -> io::Result<String> + 'a;

struct Source<'a> {
    name: Arc<str>,
    text: Cow<'a, str>,
    /// Where the next line begins [bytes].
    next: usize,
    /// Lines that were read.
    at: usize,
}

impl Source<'_> {
    /// Returns the next trimmed line that is neither blank nor a comment, within one file.
    ///
    /// # Errors
    /// A line beyond [`MAX_LINE_BYTES`].
    fn line(&mut self) -> Result<Option<(Place, String)>, DeckError> {
        while let Some(rest) = self.text.get(self.next..).filter(|r| !r.is_empty()) {
            let end = rest.find('\n');
            let line = &rest[..end.unwrap_or(rest.len())];
            self.next += end.map_or(rest.len(), |e| e + 1);
            self.at += 1;
            let text = line.trim_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
            if text.is_empty() || text.starts_with("**") {
                continue;
            }
            let place = Place {
                file: self.name.clone(),
                line: self.at,
            };
            check_length(&place, text)?;
            return Ok(Some((place, text.to_owned())));
        }
        Ok(None)
    }
}

fn check_length(place: &Place, text: &str) -> Result<(), DeckError> {
    if text.len() <= MAX_LINE_BYTES {
        return Ok(());
    }
    Err(place.error(
        DeckErrorKind::Limit,
        "",
        format!("lines of at most {MAX_LINE_BYTES} bytes"),
        "a longer line",
        "is it a deck?",
    ))
}

/// The stream of lines of a deck.
pub(crate) struct Lexer<'a> {
    stack: Vec<Source<'a>>,
    resolver: &'a mut Resolver<'a>,
    bytes: usize,
    includes: usize,
    ahead: Option<Line>,
}

impl<'a> Lexer<'a> {
    pub(crate) fn new(
        name: &str,
        text: &'a str,
        resolver: &'a mut Resolver<'a>,
    ) -> Result<Self, DeckError> {
        let mut lexer = Lexer {
            stack: Vec::new(),
            resolver,
            bytes: 0,
            includes: 0,
            ahead: None,
        };
        let start = Place {
            file: name.into(),
            line: 0,
        };
        lexer.open(&start, name, Cow::Borrowed(text))?;
        Ok(lexer)
    }

    fn open(&mut self, from: &Place, name: &str, text: Cow<'a, str>) -> Result<(), DeckError> {
        self.bytes = self.bytes.saturating_add(text.len());
        if self.bytes > MAX_DECK_BYTES {
            return Err(from.error(
                DeckErrorKind::Limit,
                "*INCLUDE",
                format!("at most {MAX_DECK_BYTES} bytes in total"),
                format!("{} bytes with {}", self.bytes, quote(name)),
                "split the model into several files",
            ));
        }
        self.stack.push(Source {
            name: name.into(),
            text,
            next: 0,
            at: 0,
        });
        Ok(())
    }

    /// Returns the position of the last line, for errors at the end of the deck.
    pub(crate) fn place(&self) -> Place {
        match self.stack.last() {
            Some(s) => Place {
                file: s.name.clone(),
                line: s.at,
            },
            None => Place {
                file: "".into(),
                line: 0,
            },
        }
    }

    /// The next line without taking it.
    pub(crate) fn peek(&mut self) -> Result<Option<&Line>, DeckError> {
        if self.ahead.is_none() {
            self.ahead = self.read()?;
        }
        Ok(self.ahead.as_ref())
    }

    /// Returns the next line of the deck.
    pub(crate) fn next(&mut self) -> Result<Option<Line>, DeckError> {
        match self.ahead.take() {
            Some(line) => Ok(Some(line)),
            None => self.read(),
        }
    }

    /// The next line if it is a data line.
    pub(crate) fn data(&mut self) -> Result<Option<Data>, DeckError> {
        if !matches!(self.peek()?, Some(Line::Data(_))) {
            return Ok(None);
        }
        match self.next()? {
            Some(Line::Data(data)) => Ok(Some(data)),
            _ => Ok(None),
        }
    }

    fn read(&mut self) -> Result<Option<Line>, DeckError> {
        loop {
            let Some(source) = self.stack.last_mut() else {
                return Ok(None);
            };
            let Some((place, text)) = source.line()? else {
                if self.stack.len() == 1 {
                    return Ok(None); // the deck itself stays, it names the end
                }
                self.stack.pop();
                continue;
            };
            if !text.starts_with('*') {
                return Ok(Some(Line::Data(Data {
                    place,
                    fields: split(&text),
                })));
            }
            let keyword = Self::keyword(source, place, text)?;
            if keyword.key == "INCLUDE" {
                self.include(&keyword)?;
                continue;
            }
            return Ok(Some(Line::Keyword(keyword)));
        }
    }

    fn keyword(source: &mut Source<'_>, place: Place, first: String) -> Result<Keyword, DeckError> {
        let mut text = first;
        while text.ends_with(',') {
            match source.line()? {
                Some((_, more)) if !more.starts_with('*') => {
                    text.push(' ');
                    text.push_str(&more);
                    check_length(&place, &text)?;
                }
                _ => {
                    return Err(place.error(
                        DeckErrorKind::Syntax,
                        short(&text),
                        "a further line of options after the comma at the end",
                        "none",
                        "remove the comma",
                    ));
                }
            }
        }
        let mut fields = split(&text).into_iter();
        let key = squeeze(fields.next().unwrap_or_default().trim_start_matches('*'));
        if key.is_empty() {
            return Err(place.error(
                DeckErrorKind::Syntax,
                short(&text),
                "a keyword after the star",
                "none",
                "a comment starts with **",
            ));
        }
        let mut options: Vec<KeywordOption> = Vec::new();
        for field in fields.filter(|f| !f.is_empty()) {
            let (key, value) = match field.split_once('=') {
                Some((key, value)) => (key, Some(value.trim().trim_matches('"').to_owned())),
                None => (field.as_str(), None),
            };
            let key = squeeze(key);
            if options.iter().any(|o| o.key == key) {
                return Err(place.error(
                    DeckErrorKind::Syntax,
                    short(&text),
                    "each option at most once",
                    format!("{} twice", quote(&key)),
                    "keep one",
                ));
            }
            options.push(KeywordOption { key, value });
        }
        Ok(Keyword {
            place,
            key,
            text: short(&text),
            options,
        })
    }

    fn include(&mut self, keyword: &Keyword) -> Result<(), DeckError> {
        let error = |kind, expected: &str, found: String, help: &str| {
            Err(keyword
                .place
                .error(kind, keyword.text.clone(), expected, found, help))
        };
        let input = match keyword.options.as_slice() {
            [
                KeywordOption {
                    key,
                    value: Some(value),
                },
            ] if key == "INPUT" && !value.is_empty() => value,
            _ => {
                return error(
                    DeckErrorKind::Syntax,
                    "*INCLUDE, INPUT=file",
                    "other options".into(),
                    "name one file",
                );
            }
        };
        if self.stack.len() > MAX_INCLUDE_DEPTH {
            return error(
                DeckErrorKind::Limit,
                &format!("at most {MAX_INCLUDE_DEPTH} nested includes"),
                "more".into(),
                "does a file include itself?",
            );
        }
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            return error(
                DeckErrorKind::Limit,
                &format!("at most {MAX_INCLUDES} includes in total"),
                "more".into(),
                "merge the included files",
            );
        }
        let name = join(&keyword.place.file, input);
        match (self.resolver)(&name) {
            Ok(text) => self.open(&keyword.place, &name, Cow::Owned(text)),
            Err(e) => error(
                DeckErrorKind::Io,
                "a readable file",
                format!("{}: {e}", quote(&name)),
                "the path is relative to the folder of the including file",
            ),
        }
    }
}

/// Returns true if an included file, by its name from [`join`], is outside the folder of the deck.
pub(super) fn is_foreign(deck: &str, included: &str) -> bool {
    let folder = |name: &str| name.rfind(['/', '\\']).map_or(0, |end| end + 1);
    let own = &deck[..folder(deck)];
    match included.strip_prefix(own) {
        Some(rest) => {
            let absolute = rest.starts_with(['/', '\\']) || rest.get(1..2) == Some(":");
            absolute || rest.split(['/', '\\']).any(|part| part == "..")
        }
        None => true,
    }
}

/// Resolves the name of an included file relative to the including file.
fn join(including: &str, input: &str) -> String {
    let absolute = input.starts_with(['/', '\\']) || input.get(1..2) == Some(":");
    match including.rfind(['/', '\\']) {
        Some(end) if !absolute => format!("{}{input}", &including[..=end]),
        _ => input.to_owned(),
    }
}

/// Splits at commas outside quotes; a comma at the end opens no further field.
fn split(text: &str) -> Vec<String> {
    let mut fields = Vec::new();
    let (mut start, mut quoted) = (0, false);
    for (i, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => {
                fields.push(text[start..i].trim().to_owned());
                start = i + 1;
            }
            _ => {}
        }
    }
    let last = text[start..].trim();
    if !last.is_empty() {
        fields.push(last.to_owned());
    }
    fields
}

/// Upper case without blanks: how keywords and options compare.
fn squeeze(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_whitespace())
        .map(|c| c.to_ascii_uppercase())
        .collect()
}

/// A keyword line for messages.
fn short(text: &str) -> String {
    let quoted = quote(text);
    quoted.trim_matches('`').to_owned()
}
