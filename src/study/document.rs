//! Documents of tables, as Markdown and as an HTML page that needs no other file.

use std::fmt::Write;

use crate::report::BASE_STYLE;

use super::draw::escaped;

const STYLE: &str = include_str!("page.css");

/// Separates the cells of a row.
const CELL: &str = " | ";

/// A table whose rows are texts with cells separated by ` | `.
#[derive(Default)]
pub(super) struct Table {
    caption: String,
    head: String,
    rows: Vec<String>,
}

impl Table {
    pub(super) fn new(caption: impl Into<String>, head: impl Into<String>) -> Self {
        Self {
            caption: caption.into(),
            head: head.into(),
            rows: Vec::new(),
        }
    }

    pub(super) fn row(&mut self, row: String) {
        self.rows.push(row);
    }

    /// The table without its caption; all columns but the first are aligned to the right.
    pub(super) fn markdown(&self) -> String {
        let rule = "---:|".repeat(self.head.split(CELL).count() - 1);
        let mut text = format!("| {} |\n|---|{rule}\n", self.head);
        for row in &self.rows {
            let _ = writeln!(text, "| {row} |");
        }
        text
    }

    fn html(&self) -> String {
        let class = |is_number: bool| if is_number { " class=\"number\"" } else { "" };
        let of_first: Vec<&str> =
            (self.rows.first()).map_or_else(Vec::new, |row| row.split(CELL).collect());
        let heads = self.head.split(CELL).enumerate().map(|(column, head)| {
            let class = class(of_first.get(column).is_some_and(|cell| is_number(cell)));
            format!("<th{class}>{}</th>", marked(head))
        });
        let value = |cell: &str| format!("<td{}>{}</td>", class(is_number(cell)), marked(cell));
        let row = |row: &String| {
            let cells: String = row.split(CELL).map(value).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let heads: String = heads.collect();
        let rows: String = self.rows.iter().map(row).collect();
        let caption = marked(&self.caption);
        format!(
            "<p class=\"caption\">{caption}</p>\n<div class=\"wide\"><table>\n\
             <tr>{heads}</tr>\n{rows}</table></div>\n"
        )
    }
}

/// Whether a cell is one number, with its unit or not.
fn is_number(cell: &str) -> bool {
    let number = cell.split(' ').next().unwrap_or_default();
    number.parse::<f64>().is_ok() && cell.split(' ').count() <= 2
}

/// Text of a page, with what stands between backticks as code.
fn marked(text: &str) -> String {
    let parts = escaped(text);
    let parts = parts.split('`').enumerate();
    parts
        .map(|(number, part)| match number % 2 {
            0 => part.to_owned(),
            _ => format!("<code>{part}</code>"),
        })
        .collect()
}

/// A title, the command that makes the document, definitions, and sections of tables.
pub(super) struct Document {
    pub(super) title: &'static str,
    pub(super) command: String,
    pub(super) notes: Vec<String>,
    pub(super) sections: Vec<(String, Vec<Table>)>,
}

pub(super) fn yes_no(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

/// A drawing: file name, caption, SVG.
pub(super) type Figure = (String, String, String);

impl Document {
    pub(super) fn markdown(&self) -> String {
        let mut text = format!("# {}\n\nMade by `{}`.\n\n", self.title, self.command);
        for note in &self.notes {
            let _ = writeln!(text, "- {note}");
        }
        for (name, tables) in &self.sections {
            let _ = write!(text, "\n## {name}\n");
            for table in tables {
                let _ = write!(text, "\n{}\n\n{}", table.caption, table.markdown());
            }
        }
        text
    }

    pub(super) fn page(&self, figures: &[Figure]) -> String {
        let title = escaped(self.title);
        let mut body = format!(
            "<h1>{title}</h1>\n<p>Made by <code>{}</code>.</p>\n<ul>\n",
            escaped(&self.command)
        );
        for note in &self.notes {
            let _ = writeln!(body, "<li>{}</li>", marked(note));
        }
        body.push_str("</ul>\n");
        for (name, tables) in &self.sections {
            let tables: String = tables.iter().map(Table::html).collect();
            let _ = write!(body, "<h2>{}</h2>\n{tables}", escaped(name));
        }
        for (number, (_, caption, svg)) in (1..).zip(figures) {
            let caption = escaped(caption);
            let _ = writeln!(
                body,
                "<figure><div class=\"drawn\">{svg}</div><figcaption>Figure {number}. {caption}</figcaption></figure>"
            );
        }
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width\">\
             <title>{title}</title><style>{BASE_STYLE}{STYLE}</style></head>\n\
             <body>\n{body}</body></html>\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_document_is_markdown_and_html() {
        let mut table = Table::new("Costs", "a | b");
        table.row("1 | ".to_owned());
        let document = Document {
            title: "A <b>",
            command: "x".to_owned(),
            notes: vec!["one of `src`".to_owned()],
            sections: vec![("S".to_owned(), vec![table])],
        };
        let text = document.markdown();
        assert!(text.contains("## S\n\nCosts\n\n| a | b |\n|---|---:|\n| 1 |  |\n"));
        let html = document.page(&[]);
        for part in [
            "<h1>A &lt;b&gt;</h1>",
            "<li>one of <code>src</code></li>",
            "<td class=\"number\">1</td><td></td>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
    }
}
