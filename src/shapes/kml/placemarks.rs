//! The placemarks of KML text that cannot be read, such as those with an altitude mode above the sea floor.

use crate::shapes::Refused;

/// The text without the placemarks that `error` has an error for, and these by their names. Without any it is
/// the text as it stands.
pub(super) fn without_broken(
    text: &str,
    error: &dyn Fn(&str) -> Option<String>,
) -> (String, Vec<Refused>) {
    let (mut rest, mut refused) = (String::with_capacity(text.len()), Vec::new());
    let mut from = 0;
    for (begin, end) in placemarks(text) {
        let placemark = &text[begin..end];
        let Some(why) = error(placemark) else {
            continue;
        };
        let line = 1 + text[..begin].matches('\n').count();
        let name = name(placemark).unwrap_or_else(|| format!("line {line}"));
        let why = format!("line {line}: {}", why.escape_debug());
        refused.push(Refused { name, why });
        rest.push_str(&text[from..begin]);
        from = end;
    }
    rest.push_str(&text[from..]);
    (rest, refused)
}

/// Where each placemark begins and ends.
fn placemarks(text: &str) -> Vec<(usize, usize)> {
    let (mut found, mut begin, mut at) = (Vec::new(), None, 0);
    while let Some(next) = text[at..].find('<') {
        let open = at + next;
        let tag = &text[open..];
        let closed_by = match tag {
            _ if tag.starts_with("<!--") => "-->",
            _ if tag.starts_with("<![CDATA[") => "]]>",
            _ => ">",
        };
        let Some(length) = tag.find(closed_by) else {
            break;
        };
        at = open + length + closed_by.len();
        match local_name(tag) {
            ("", "Placemark") if !text[..at].ends_with("/>") => begin = Some(open),
            ("/", "Placemark") => found.extend(begin.take().map(|begin| (begin, at))),
            _ => {}
        }
    }
    found
}

/// `/` of a tag that ends an element, and the name of its element without a prefix.
fn local_name(tag: &str) -> (&str, &str) {
    let tag = &tag[1..];
    let (slash, tag) = tag.split_at(usize::from(tag.starts_with('/')));
    let end = tag.find(|sign: char| sign.is_whitespace() || sign == '>' || sign == '/');
    let name = &tag[..end.unwrap_or(tag.len())];
    (slash, name.rsplit(':').next().unwrap_or(name))
}

/// The text of the first element `name`.
fn name(placemark: &str) -> Option<String> {
    let from = placemark.find("name>")? + "name>".len();
    let text = &placemark[from..];
    let text = text.strip_prefix("<![CDATA[").unwrap_or(text);
    let end = text.find(['<', ']'])?;
    let name = text[..end].trim();
    (!name.is_empty()).then(|| name.to_owned())
}
