//! One page with the account and the figures, that needs no other file.

use std::fmt::Write;

use super::svg::escaped;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:80rem;margin:2rem auto;padding:0 1rem;\
color:#111;background:#fff}table{border-collapse:collapse;font-size:14px;display:block;overflow-x:auto}\
th,td{border:1px solid #ccc;padding:.2rem .6rem;text-align:left}svg{max-width:100%;height:auto}\
figure{margin:2rem 0;overflow-x:auto}@media(max-width:60rem){svg{max-width:none}}";

/// The page: `account` in Markdown, then figures with captions.
pub(super) fn page(account: &str, figures: &[(String, String, String)]) -> String {
    let mut body = markdown(account);
    for (number, (_, caption, svg)) in (1..).zip(figures) {
        let _ = writeln!(
            body,
            "<figure>{svg}<figcaption>Figure {number}. {}</figcaption></figure>",
            escaped(caption)
        );
    }
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\">\
         <title>The paper's experiment, run again</title><style>{STYLE}</style></head>\n\
         <body>\n{body}</body></html>\n"
    )
}

/// The little Markdown that the account uses: headings, lists, tables, paragraphs.
fn markdown(text: &str) -> String {
    let mut html = String::new();
    for block in text.split("\n\n").filter(|block| !block.trim().is_empty()) {
        let block = block.trim_matches('\n');
        let lines: Vec<&str> = block.lines().collect();
        let heading = block.trim_start_matches('#');
        let depth = block.len() - heading.len();
        if depth > 0 {
            let heading = inline(heading.trim());
            let _ = writeln!(html, "<h{depth}>{heading}</h{depth}>");
        } else if block.starts_with('|') {
            table(&mut html, &lines);
        } else if block.starts_with("- ") {
            let items = lines
                .iter()
                .map(|line| inline(line.trim_start_matches("- ")));
            let items: Vec<String> = items.map(|item| format!("<li>{item}</li>")).collect();
            let _ = writeln!(html, "<ul>{}</ul>", items.join("\n"));
        } else {
            let _ = writeln!(html, "<p>{}</p>", inline(&lines.join(" ")));
        }
    }
    html
}

/// The first line is the head, the second the rule under it.
fn table(html: &mut String, lines: &[&str]) {
    html.push_str("<table>\n");
    for (index, line) in lines.iter().enumerate().filter(|(index, _)| *index != 1) {
        let tag = if index == 0 { "th" } else { "td" };
        let inner = line.trim().trim_start_matches('|');
        let inner = inner.strip_suffix('|').unwrap_or(inner);
        let cells = inner.split('|').map(|cell| inline(cell.trim()));
        let cells: Vec<String> = cells.map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
        let _ = writeln!(html, "<tr>{}</tr>", cells.concat());
    }
    html.push_str("</table>\n");
}

/// Text with `code` in it.
fn inline(text: &str) -> String {
    escaped(text)
        .split('`')
        .enumerate()
        .map(|(index, part)| {
            if index % 2 == 1 {
                format!("<code>{part}</code>")
            } else {
                part.to_owned()
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::markdown;

    #[test]
    fn headings_lists_tables_and_code_become_html() {
        let html =
            markdown("# A <b>\n\nsee `x`\n\n- one\n- two\n\n| a | b |\n|---|---|\n| 1 | 2 |\n");
        for part in [
            "<h1>A &lt;b&gt;</h1>",
            "<p>see <code>x</code></p>",
            "<li>two</li>",
            "<th>b</th>",
            "<td>2</td>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
        assert!(!html.contains("---"));
    }
}
