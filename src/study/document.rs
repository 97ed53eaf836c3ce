//! Documents of tables, as Markdown and as an HTML page that needs no other file.

use std::fmt::Write;

use super::draw::escaped;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:80rem;margin:2rem auto;padding:0 1rem;\
color:#111;background:#fff}table{border-collapse:collapse;font-size:14px;display:block;overflow-x:auto}\
th,td{border:1px solid #ccc;padding:.2rem .6rem;text-align:left}svg{max-width:100%;height:auto}\
figure{margin:2rem 0;overflow-x:auto}@media(max-width:60rem){svg{max-width:none}}";

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
        let line = |row: &str, tag: &str| {
            let cells = row.split(CELL);
            let cells: String = cells
                .map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell)))
                .collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = self.rows.iter().map(|row| line(row, "td")).collect();
        let head = line(&self.head, "th");
        let caption = escaped(&self.caption);
        format!("<p>{caption}</p>\n<table>\n{head}{rows}</table>\n")
    }
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
            let _ = writeln!(body, "<li>{}</li>", escaped(note));
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
                "<figure>{svg}<figcaption>Figure {number}. {caption}</figcaption></figure>"
            );
        }
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width\">\
             <title>{title}</title><style>{STYLE}</style></head>\n\
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
            notes: vec!["one".to_owned()],
            sections: vec![("S".to_owned(), vec![table])],
        };
        let text = document.markdown();
        assert!(text.contains("## S\n\nCosts\n\n| a | b |\n|---|---:|\n| 1 |  |\n"));
        let html = document.page(&[]);
        for part in [
            "<h1>A &lt;b&gt;</h1>",
            "<li>one</li>",
            "<td>1</td><td></td>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
    }
}
