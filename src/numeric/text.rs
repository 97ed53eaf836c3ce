//! Text from outside of the program, made safe to show on one line.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Whether a character moves the cursor, changes the direction of reading or cannot be
/// seen: controls (C0, DEL, C1), line separators, bidirectional marks and overrides
/// (UAX #9), and characters without width (`Default_Ignorable_Code_Point`, UAX #44,
/// variation selectors apart).
#[must_use]
pub fn is_hidden(sign: char) -> bool {
    sign.is_control()
        || matches!(sign,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{180e}'
            | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{3164}' | '\u{feff}' | '\u{ffa0}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e0fff}')
}

/// A text in which each hidden character is written out, such as `\u{1b}` or `\n`: it
/// stays on one line and commands no terminal.
#[must_use]
pub fn escaped(text: &str) -> Cow<'_, str> {
    escaped_except(text, |_| false)
}

/// The same, with some characters that stay as they are.
#[must_use]
pub fn escaped_except(text: &str, stays: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_unsafe = |sign: char| is_hidden(sign) && !stays(sign);
    if !text.contains(is_unsafe) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 16);
    for sign in text.chars() {
        if is_unsafe(sign) {
            safe.extend(sign.escape_default());
        } else {
            safe.push(sign);
        }
    }
    Cow::Owned(safe)
}

/// JSON with its hidden characters but line feeds as JSON escapes them: they are all inside of strings, whose
/// values stay the same.
#[must_use]
pub fn escaped_json(json: &str) -> Cow<'_, str> {
    let is_unsafe = |sign: char| sign != '\n' && is_hidden(sign);
    if !json.contains(is_unsafe) {
        return Cow::Borrowed(json);
    }
    let mut safe = String::with_capacity(json.len() + 16);
    for sign in json.chars() {
        if !is_unsafe(sign) {
            safe.push(sign);
            continue;
        }
        for unit in sign.encode_utf16(&mut [0; 2]) {
            safe += &format!("\\u{unit:04x}");
        }
    }
    Cow::Owned(safe)
}

/// Writes JSON as [`escaped_json`] has it; each piece ends where a character ends.
#[derive(Debug)]
pub struct JsonWriter<W>(pub W);

impl<W: Write> Write for JsonWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match std::str::from_utf8(bytes) {
            Ok(json) => self.0.write_all(escaped_json(json).as_bytes())?,
            Err(_) => self.0.write_all(bytes)?,
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Opens a regular file to read it. A pipe would be waited for as long as nobody writes to it.
///
/// # Errors
/// It is something else than a regular file, or it cannot be opened.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let data = std::fs::metadata(path)?;
    if data.is_dir() {
        let what = "it is a folder (allowed: a file)";
        return Err(io::Error::new(io::ErrorKind::IsADirectory, what));
    }
    if !data.is_file() {
        let what = "it is a pipe, a socket or a device (allowed: a regular file)";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    File::open(path)
}

/// Reads a regular file as text.
///
/// # Errors
/// As [`open_regular`]; also a file that is not UTF-8.
pub fn read_regular(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    open_regular(path)?.read_to_string(&mut text)?;
    Ok(text)
}

/// Reads a regular file as bytes.
///
/// # Errors
/// As [`open_regular`].
pub fn read_regular_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A text whose lines end with a line feed alone: readers of tables count the others one line late.
#[must_use]
pub fn with_line_feeds(text: &[u8]) -> Vec<u8> {
    let next = text.iter().skip(1).map(Some).chain([None]);
    let both = text.iter().zip(next);
    let stays = both.filter(|(byte, next)| **byte != b'\r' || *next != Some(&b'\n'));
    stays.map(|(byte, _)| *byte).collect()
}

/// A file name as one word of a shell.
#[must_use]
pub fn shell_word(name: &str) -> String {
    let is_plain = |sign: char| sign.is_alphanumeric() || "._/-+:@,".contains(sign);
    match !name.is_empty() && !name.starts_with('-') && name.chars().all(is_plain) {
        true => name.to_owned(),
        false => format!("'{}'", name.replace('\'', r"'\''")),
    }
}

/// The known word that is most like an unknown one, if any is.
pub fn meant<'a>(word: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> Option<&'a str> {
    // Two of three letters are the same at least.
    const LIKE: f64 = 0.67;
    // The unit was forgotten, or another one written.
    let goes_on = |long: &str, short: &str| {
        long.strip_prefix(short)
            .is_some_and(|unit| unit.starts_with('_'))
    };
    let all = known.clone().into_iter();
    let with_unit = all.filter(|known| goes_on(known, word) || goes_on(word, known));
    if let Some(shortest) = with_unit.min_by_key(|known| known.len()) {
        return Some(shortest);
    }
    let all = known.clone().into_iter();
    if let Some(known) = all
        .into_iter()
        .find(|known| other_unit(word, known).is_some())
    {
        return Some(known);
    }
    let like = |known: &&str| {
        let (word, known) = (word.to_lowercase(), known.to_lowercase());
        strsim::normalized_damerau_levenshtein(&word, &known)
    };
    known
        .into_iter()
        .filter(|known| like(known) >= LIKE)
        .max_by(|a, b| like(a).total_cmp(&like(b)))
}

/// The unit of a known key, in words, if another key differs from it in the unit alone.
#[must_use]
pub fn other_unit(key: &str, known: &str) -> Option<&'static str> {
    const UNITS: [(&str, &str); 8] = [
        ("m", "metres"),
        ("s", "seconds"),
        ("deg", "degrees"),
        ("mps", "metres per second"),
        ("mps2", "metres per second squared"),
        ("hpa", "hectopascals"),
        ("w", "watts"),
        ("wh", "watt hours"),
    ];
    let (stem, written) = key.rsplit_once('_')?;
    let (known_stem, unit) = known.rsplit_once('_')?;
    let (_, words) = UNITS.iter().find(|(known, _)| *known == unit)?;
    (stem == known_stem && written != unit).then_some(*words)
}

/// A question for the word that was meant, to follow what was found; empty without one.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str> + Clone) -> String {
    meant(word, known).map_or_else(String::new, |meant| format!(": did you mean `{meant}`?"))
}

/// The greatest hour of an offset from UTC (RFC 3339).
const MAX_OFFSET_H: u8 = 23;

/// A time with its offset from UTC; none for a text that is no such time. The parser alone takes offsets up to 25 h.
#[must_use]
pub fn timestamp(text: &str) -> Option<jiff::Timestamp> {
    let time = text.parse().ok()?;
    let clock = text.split_once(['T', 't', ' ']).map_or("", |(_, of)| of);
    // A name of a zone may follow.
    let clock = clock.split('[').next().unwrap_or_default();
    let offset = clock.split(['+', '-']).nth(1);
    let hours = offset.and_then(|of| of.get(..2)?.parse::<u8>().ok());
    hours.is_none_or(|of| of <= MAX_OFFSET_H).then_some(time)
}

#[cfg(test)]
mod tests {
    use super::{JsonWriter, escaped, escaped_except, escaped_json, shell_word, timestamp};

    #[test]
    fn an_offset_of_a_day_or_more_is_none() {
        for offset in [
            "Z",
            "+00:00",
            "-00:00",
            "+23:59",
            "-23:59",
            "+01:00[Europe/Berlin]",
        ] {
            let time = format!("2026-11-27T10:00:00{offset}");
            assert!(timestamp(&time).is_some(), "{time}");
        }
        for offset in ["+24:00", "-24:00", "+25:00", "+25", "-2530", "+99:00", ""] {
            let time = format!("2026-11-27T10:00:00{offset}");
            assert_eq!(timestamp(&time), None, "{time}");
        }
    }

    #[test]
    fn characters_that_command_a_terminal_or_hide_are_written_out() {
        assert_eq!(
            escaped("\u{1b}[2K\r landed as planned\n"),
            "\\u{1b}[2K\\r landed as planned\\n"
        );
        assert_eq!(escaped("a\u{7f}\u{9b}2J"), "a\\u{7f}\\u{9b}2J");
        assert_eq!(escaped("\u{202e}nalp\u{2069}"), "\\u{202e}nalp\\u{2069}");
        assert_eq!(escaped("al\u{200b}pha\u{feff}"), "al\\u{200b}pha\\u{feff}");
    }

    #[test]
    fn hidden_characters_of_json_are_escaped_and_its_values_stay() {
        let text = "\u{202e}landed\u{2066} \u{9b}2J\u{e0001} Übung 東京";
        let plain = serde_json::to_string_pretty(&[text, "a\nb"]).expect("JSON");
        let safe = escaped_json(&plain);
        assert!(
            !safe.contains(|sign| sign != '\n' && super::is_hidden(sign)),
            "{safe}"
        );
        assert!(
            safe.contains("\\u202elanded\\u2066") && safe.contains("\\udb40\\udc01"),
            "{safe}"
        );
        let read: Vec<String> = serde_json::from_str(&safe).expect("JSON");
        assert_eq!(read, [text, "a\nb"]);
        let mut written = JsonWriter(Vec::new());
        serde_json::to_writer_pretty(&mut written, &[text, "a\nb"]).expect("JSON");
        assert_eq!(written.0, safe.as_bytes());
    }

    #[test]
    fn letters_of_every_alphabet_and_narrow_spaces_stay() {
        let text = "Übung 12\u{202f}345 m, Север, 東京, −5°\u{2002}\u{fe0f}";
        assert_eq!(escaped(text), text);
        assert_eq!(escaped_except("a\nb\tc\r", |c| c == '\n'), "a\nb\\tc\\r");
    }

    #[test]
    fn a_name_is_one_word_of_a_shell() {
        for (name, word) in [
            ("tiles/dem-1.tif", "tiles/dem-1.tif"),
            ("my dem.tif", "'my dem.tif'"),
            ("it's.tif", r"'it'\''s.tif'"),
            ("-rf.tif", "'-rf.tif'"),
            ("$(x).tif", "'$(x).tif'"),
        ] {
            assert_eq!(shell_word(name), word);
        }
    }
}
