//! Documentation, as it stands in the source, laid out for a terminal.

use comfy_table::{ContentArrangement, LineStyle, Table, TableStyle};
use pulldown_cmark::{BrokenLink, CowStr, Event, Options, Parser, Tag, TagEnd};
use textwrap::Options as Wrapping;

/// Columns between blanks, and a line below their heads.
const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// Lays out Markdown in so many columns: paragraphs and cells of tables are wrapped, code is kept as it is.
pub(super) fn laid_out(markdown: &str, width: usize) -> String {
    // Links to other items of the documentation have no target here.
    let broken = |_: BrokenLink<'_>| Some((CowStr::from(""), CowStr::from("")));
    let mut layout = Layout { width, ..Layout::default() };
    for event in Parser::new_with_broken_link_callback(markdown, Options::ENABLE_TABLES, Some(broken)) {
        layout.event(event);
    }
    layout.blocks.join("\n\n")
}

/// The first sentence of documentation, without marks.
pub(super) fn first_sentence(markdown: &str) -> String {
    let all = laid_out(markdown, usize::MAX);
    let paragraph = all.split("\n\n").next().unwrap_or_default();
    match paragraph.find(". ") {
        Some(end) => paragraph[..end].to_owned(),
        None => paragraph.trim_end_matches('.').to_owned(),
    }
}

/// A paragraph in so many columns; its first line begins with one text, the others with another.
pub(super) fn wrapped(text: &str, width: usize, first: &str, others: &str) -> String {
    let wrapping = Wrapping::new(width).initial_indent(first).subsequent_indent(others).break_words(false);
    textwrap::fill(text, wrapping)
}

#[derive(Default)]
struct Layout {
    width: usize,
    blocks: Vec<String>,
    /// What is being read: a paragraph, a cell.
    text: String,
    /// The rows of the table that is being read; the first has the heads.
    rows: Vec<Vec<String>>,
    /// For each list around, the number of its next item, where they have numbers.
    lists: Vec<Option<u64>>,
    /// What an item begins with, until it is written.
    marker: Option<String>,
    is_code: bool,
}

impl Layout {
    fn event(&mut self, event: Event) {
        match event {
            Event::Text(text) => self.text.push_str(&text),
            Event::Code(code) => self.text.push_str(&format!("`{code}`")),
            Event::SoftBreak | Event::HardBreak => self.text.push(' '),
            Event::Start(tag) => self.start(tag),
            Event::End(tag) => self.end(tag),
            Event::Rule => self.blocks.push("─".repeat(self.width.min(40))),
            Event::Html(text) | Event::InlineHtml(text) => self.text.push_str(&text),
            _ => {}
        }
    }

    fn start(&mut self, tag: Tag) {
        match tag {
            Tag::CodeBlock(_) => self.is_code = true,
            Tag::List(first) => {
                self.paragraph();
                self.lists.push(first);
            }
            Tag::Item => {
                let bullet = match self.lists.last_mut() {
                    Some(Some(number)) => {
                        *number += 1;
                        format!("{}. ", *number - 1)
                    }
                    _ => "- ".into(),
                };
                self.marker = Some(bullet);
            }
            Tag::TableHead | Tag::TableRow => self.rows.push(Vec::new()),
            _ => {}
        }
    }

    fn end(&mut self, tag: TagEnd) {
        match tag {
            TagEnd::Paragraph | TagEnd::Item | TagEnd::HtmlBlock => self.paragraph(),
            TagEnd::Heading(_) => {
                let heading = std::mem::take(&mut self.text).to_uppercase();
                self.blocks.push(heading);
            }
            TagEnd::CodeBlock => {
                self.is_code = false;
                let code = std::mem::take(&mut self.text);
                self.blocks.push(
                    code.trim_end().lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n"),
                );
            }
            TagEnd::List(_) => drop(self.lists.pop()),
            TagEnd::TableCell => {
                let cell = std::mem::take(&mut self.text);
                if let Some(row) = self.rows.last_mut() {
                    row.push(cell);
                }
            }
            TagEnd::Table => {
                let rows = std::mem::take(&mut self.rows);
                self.blocks.push(table(rows, self.width));
            }
            _ => {}
        }
    }

    /// What was read becomes a paragraph, or an item of a list, which follows the one before without a gap.
    fn paragraph(&mut self) {
        let text = std::mem::take(&mut self.text);
        if text.trim().is_empty() {
            return;
        }
        let depth = self.lists.len().saturating_sub(1);
        let marker = self.marker.take();
        let blank = if self.lists.is_empty() { String::new() } else { "  ".repeat(depth + 1) };
        let first = marker.as_ref().map_or(blank.clone(), |marker| "  ".repeat(depth) + marker);
        let written = wrapped(text.trim(), self.width, &first, &blank);
        let is_item = |line: &str| {
            line.trim_start().starts_with("- ") || line.trim_start().starts_with(|c: char| c.is_ascii_digit())
        };
        match self.blocks.last_mut().filter(|last| marker.is_some() && is_item(last)) {
            Some(last) => *last = format!("{last}\n{written}"),
            None => self.blocks.push(written),
        }
    }
}

/// A table whose cells are wrapped so that it fits. The first row has the heads of the columns.
pub(super) fn table(rows: Vec<Vec<String>>, width: usize) -> String {
    let mut table = Table::new();
    table.load_style(STYLE).set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(u16::try_from(width).unwrap_or(u16::MAX));
    let mut rows = rows.into_iter();
    if let Some(heads) = rows.next() {
        table.set_header(heads);
    }
    table.add_rows(rows);
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCS: &str = " A scalar field, see [`Grid`](crate::Grid) and [`Frame`]. It is\n *very* long.\n\n | field | type |\n |---|---|\n | `path` | a file whose name has an ending that is longer than others |\n\n - one\n - two\n\n ```ron\n Volume: File(\"a.nii\")\n     # kept\n ```\n";

    #[test]
    fn documentation_is_laid_out() {
        let expected = "A scalar field, see `Grid` and\n`Frame`. It is very long.\n";
        let found = laid_out(DOCS, 32);
        assert!(found.starts_with(expected), "{found}");
        assert!(found.contains("- one\n- two"), "{found}");
        assert!(found.contains("    Volume: File(\"a.nii\")\n        # kept"), "{found}");
        assert!(found.contains("────"), "{found}");
        for line in found.lines() {
            assert!(line.chars().count() <= 32, "`{line}` is too long");
        }
        assert!(!found.contains('|') && !found.contains("crate::"), "{found}");
    }

    #[test]
    fn the_first_sentence_is_found() {
        assert_eq!(first_sentence(DOCS), "A scalar field, see `Grid` and `Frame`");
        assert_eq!(first_sentence(" Turns an entity.\n"), "Turns an entity");
        assert_eq!(first_sentence(""), "");
    }
}
