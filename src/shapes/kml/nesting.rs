//! How deep the elements of XML are nested.

/// Whether elements are nested deeper than that.
pub(super) fn is_deeper(text: &str, most: usize) -> bool {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(next) = text[at..].find('<') {
        let tag = &text[at + next..];
        let Some(length) = length(tag) else {
            return false;
        };
        let is_alone = tag[..length].ends_with("/>");
        match tag.as_bytes().get(1) {
            Some(b'/') => depth = depth.saturating_sub(1),
            Some(b'!' | b'?') => {}
            _ if !is_alone => depth += 1,
            _ => {}
        }
        if depth > most {
            return true;
        }
        at += next + length;
    }
    false
}

/// Bytes of the markup at the start of text, if it ends.
fn length(markup: &str) -> Option<usize> {
    for (begin, end) in [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")] {
        if let Some(inside) = markup.strip_prefix(begin) {
            return Some(begin.len() + inside.find(end)? + end.len());
        }
    }
    // A `>` in quotes ends no tag.
    let mut quote = None;
    for (index, byte) in markup.bytes().enumerate() {
        match (byte, quote) {
            (b'>', None) => return Some(index + 1),
            (b'"' | b'\'', None) => quote = Some(byte),
            _ if quote == Some(byte) => quote = None,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::is_deeper;

    #[test]
    fn only_elements_that_are_open_count_as_nested() {
        for (text, depth) in [
            ("<a><b/><b/><c></c></a>", 2),
            (
                "<?xml version='1.0'?><!-- <a><a><a> --><a><![CDATA[<a><a>]]></a>",
                1,
            ),
            ("<a b='/>'><a b=\"'/>\"><a>", 3),
            ("</a></a><a>", 1),
            ("<a><a", 1),
            ("no markup", 0),
        ] {
            assert!(!is_deeper(text, depth), "{text}");
            assert!(depth == 0 || is_deeper(text, depth - 1), "{text}");
        }
    }
}
