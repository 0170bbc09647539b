//! The terminal while it is ours: taken, drawn on where something changed, given back however this ends.

use std::io::{Result, Write, stdout};

use crossterm::cursor::{Hide, MoveTo, Show};
use crossterm::style::{Attribute, Color as Ansi, Colors, Print, ResetColor, SetAttribute, SetColors};
use crossterm::terminal::{
    Clear, ClearType, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode, size,
};
use crossterm::{execute, queue};
use ratatui_core::buffer::{Buffer, Cell};
use ratatui_core::layout::Rect;
use ratatui_core::style::{Color, Modifier};

/// What the terminal calls the modifiers that are drawn with.
const ATTRIBUTES: [(Modifier, Attribute); 6] = [
    (Modifier::BOLD, Attribute::Bold),
    (Modifier::DIM, Attribute::Dim),
    (Modifier::ITALIC, Attribute::Italic),
    (Modifier::UNDERLINED, Attribute::Underlined),
    (Modifier::REVERSED, Attribute::Reverse),
    (Modifier::CROSSED_OUT, Attribute::CrossedOut),
];

/// The terminal's other screen, in raw mode, without a cursor.
pub(super) struct Tty {
    /// What stands on it.
    shown: Buffer,
}

impl Tty {
    /// Takes the terminal.
    ///
    /// # Errors
    /// If it cannot be written to or put into raw mode.
    pub(super) fn open() -> Result<Self> {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // What a panic has to say must not be written on a screen that goes away.
            give_back();
            hook(panic);
        }));
        enable_raw_mode()?;
        let tty = Self { shown: Buffer::empty(Rect::ZERO) };
        execute!(stdout(), EnterAlternateScreen, Hide)?;
        Ok(tty)
    }

    /// Shows what `draw` draws on an empty buffer of the terminal's present size.
    ///
    /// # Errors
    /// If the terminal cannot be written to.
    pub(super) fn draw(&mut self, draw: impl FnOnce(Rect, &mut Buffer)) -> Result<()> {
        let (width, height) = size()?;
        let area = Rect::new(0, 0, width, height);
        let mut out = Vec::new();
        if self.shown.area != area {
            queue!(out, Clear(ClearType::All))?;
            self.shown = Buffer::empty(area);
        }
        let mut next = Buffer::empty(area);
        draw(area, &mut next);
        put(&mut out, self.shown.diff(&next))?;
        // In one piece, so that no half of a drawing is seen.
        let mut terminal = stdout().lock();
        terminal.write_all(&out)?;
        terminal.flush()?;
        self.shown = next;
        Ok(())
    }

    /// Forgets what stands there: the next drawing begins with an empty screen.
    pub(super) fn forget(&mut self) {
        self.shown = Buffer::empty(Rect::ZERO);
    }
}

impl Drop for Tty {
    fn drop(&mut self) {
        give_back();
    }
}

fn give_back() {
    // Nobody is left to be told if this fails; a closed terminal needs nothing back.
    let _ = disable_raw_mode();
    let _ = execute!(stdout(), LeaveAlternateScreen, Show);
}

/// Writes cells with their places and styles, each as seldom as possible.
fn put(out: &mut Vec<u8>, cells: Vec<(u16, u16, &Cell)>) -> Result<()> {
    let plain = (Color::Reset, Color::Reset, Modifier::empty());
    let (mut style, mut cursor) = (plain, None);
    for (x, y, cell) in cells {
        if cursor != Some((x, y)) {
            queue!(out, MoveTo(x, y))?;
        }
        // Behind a character of two columns the next cell is another one, and the cursor is moved.
        cursor = Some((x + 1, y));
        let own = (cell.fg, cell.bg, cell.modifier);
        if own != style {
            queue!(out, SetAttribute(Attribute::Reset), SetColors(Colors::new(ansi(cell.fg), ansi(cell.bg))))?;
            for (_, attribute) in ATTRIBUTES.into_iter().filter(|(modifier, _)| cell.modifier.contains(*modifier)) {
                queue!(out, SetAttribute(attribute))?;
            }
            style = own;
        }
        queue!(out, Print(cell.symbol()))?;
    }
    if style != plain {
        queue!(out, ResetColor, SetAttribute(Attribute::Reset))?;
    }
    Ok(())
}

/// The two libraries name the sixteen colours differently: here red is the plain one, there the bright one.
fn ansi(colour: Color) -> Ansi {
    match colour {
        Color::Reset => Ansi::Reset,
        Color::Black => Ansi::Black,
        Color::Red => Ansi::DarkRed,
        Color::Green => Ansi::DarkGreen,
        Color::Yellow => Ansi::DarkYellow,
        Color::Blue => Ansi::DarkBlue,
        Color::Magenta => Ansi::DarkMagenta,
        Color::Cyan => Ansi::DarkCyan,
        Color::Gray => Ansi::Grey,
        Color::DarkGray => Ansi::DarkGrey,
        Color::LightRed => Ansi::Red,
        Color::LightGreen => Ansi::Green,
        Color::LightYellow => Ansi::Yellow,
        Color::LightBlue => Ansi::Blue,
        Color::LightMagenta => Ansi::Magenta,
        Color::LightCyan => Ansi::Cyan,
        Color::White => Ansi::White,
        Color::Indexed(index) => Ansi::AnsiValue(index),
        Color::Rgb(r, g, b) => Ansi::Rgb { r, g, b },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui_core::style::Style;

    /// What is written to get from one text of two rows to another.
    fn written(before: [&str; 2], after: [&str; 2], style: Style) -> String {
        let buffer = |lines: [&str; 2], style| {
            let mut buffer = Buffer::empty(Rect::new(0, 0, 6, 2));
            for (y, line) in lines.into_iter().enumerate() {
                buffer.set_string(0, y as u16, line, style);
            }
            buffer
        };
        let mut out = Vec::new();
        let (before, after) = (buffer(before, Style::new()), buffer(after, style));
        put(&mut out, before.diff(&after)).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn only_what_changed_is_written_where_it_stands() {
        let plain = |before, after| written(before, after, Style::new());
        assert_eq!(plain(["abc", "de"], ["abc", "de"]), "");
        assert_eq!(plain(["abc", "de"], ["axy", "dz"]), "\u{1b}[1;2Hxy\u{1b}[2;2Hz");
        // Each of these takes two columns.
        assert_eq!(plain(["", ""], ["走廊", ""]), "\u{1b}[1;1H走\u{1b}[1;3H廊");
    }

    #[test]
    fn a_style_is_written_once_and_taken_back() {
        let strong = Style::new().add_modifier(Modifier::BOLD | Modifier::REVERSED);
        let text = written(["", ""], ["ab", ""], strong);
        assert!(text.starts_with("\u{1b}[1;1H\u{1b}[0m"), "{text:?}");
        assert!(text.contains("\u{1b}[1m\u{1b}[7mab") && text.ends_with("\u{1b}[0m"), "{text:?}");
    }
}
