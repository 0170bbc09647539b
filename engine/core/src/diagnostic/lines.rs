//! Lines and columns of a text, found without reading it again: a hostile text may have a mistake in each of its bytes.

/// So many characters lie between two marks.
const STRIDE: usize = 64;

/// Where lines and characters begin.
#[derive(Debug)]
pub(super) struct Lines {
    /// Of each line, its first byte and how many characters stand before it.
    starts: Vec<(usize, usize)>,
    /// The byte of every 64th character.
    marks: Vec<usize>,
}

impl Lines {
    pub(super) fn new(text: &str) -> Self {
        let (mut starts, mut marks, mut count) = (vec![(0, 0)], Vec::new(), 0);
        for (at, c) in text.char_indices() {
            if count % STRIDE == 0 {
                marks.push(at);
            }
            count += 1;
            if c == '\n' {
                starts.push((at + 1, count));
            }
        }
        Self { starts, marks }
    }

    /// The first byte of a line, counted from 1.
    pub(super) fn start(&self, line: usize) -> Option<usize> {
        Some(self.starts.get(line.checked_sub(1)?)?.0)
    }

    /// The byte of a character of a line, both counted from 1; nothing if the text ends before it.
    pub(super) fn offset(&self, text: &str, line: usize, column: usize) -> Option<usize> {
        let (_, before) = self.starts.get(line.checked_sub(1)?)?;
        let character = before + column.saturating_sub(1);
        let mark = *self.marks.get(character / STRIDE)?;
        text[mark..].char_indices().nth(character % STRIDE).map(|(index, _)| mark + index)
    }

    /// The line and the column, both from 1, of a byte at which a character begins.
    pub(super) fn position(&self, text: &str, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|(start, _)| *start <= offset);
        let (start, before) = self.starts[line - 1];
        let marks = self.marks.partition_point(|mark| *mark <= offset);
        let (mark, counted) = match marks.checked_sub(1) {
            Some(index) if self.marks[index] >= start => (self.marks[index], index * STRIDE),
            _ => (start, before),
        };
        (line, counted + text[mark..offset].chars().count() - before + 1)
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::SourceText;

    #[test]
    fn every_character_of_a_text_is_found_where_it_stands() {
        let text = format!("é\n{}\r\n\n{}ü", "aé".repeat(200), "ö".repeat(70));
        let source = SourceText::new("a.txt", text.clone());
        let (mut line, mut column) = (1, 1);
        for (at, c) in text.char_indices() {
            assert_eq!(source.position(at), (line, column));
            if !matches!(c, '\r' | '\n') {
                assert_eq!(source.offset(line, column), at);
            }
            (line, column) = if c == '\n' { (line + 1, 1) } else { (line, column + 1) };
        }
        assert_eq!(source.position(text.len()), (4, 72));
        // Beyond a line is its end, beyond the text the text's.
        assert_eq!(source.offset(1, 9), 2);
        assert_eq!((source.offset(4, 99), source.offset(9, 1)), (text.len(), text.len()));
    }
}
