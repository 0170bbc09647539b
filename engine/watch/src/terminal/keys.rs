//! Which key does what.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::view::View;
use engine::experiment::Phase;

/// What a key asks of the program around the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// Nothing but a new drawing.
    Nothing,
    /// Learn again.
    Again,
    /// Draw everything from an empty screen: another program may have written over it.
    Clear,
    /// The end.
    Quit,
}

/// Every key with what it does, for the help; the first ones stand at the foot of the screen.
pub(super) const KEYS: &[(&str, &str, &str)] = &[
    ("q", "quit", "quit, as Ctrl-C does"),
    ("?", "help", "this help; ? again or Esc closes it"),
    ("space", "play", "play or pause"),
    ("←→", "step", "one step back or on; with shift 100 steps, [ and ] 50 steps"),
    ("tab", "panel", "one panel on the whole screen, then the next; Esc shows all"),
    ("n p", "seed", "the next or the previous seed, as ↓ and ↑ do"),
    ("t", "test", "between learning and the test of the frozen policy"),
    (". ,", "rule", "to the next or the previous step at which a rule fired"),
    ("r", "learn again", "learn again, as if the script were saved"),
    ("1-9", "speed", "the speed, from 1 to 1000 times as fast as the robot"),
    ("Home End", "", "the first or the last step"),
    ("PgUp PgDn", "", "scroll a long text"),
    ("Ctrl-L", "", "draw the screen anew"),
];

impl View {
    /// Does what a key says.
    pub fn key(&mut self, key: KeyEvent) -> Wish {
        if key.kind == KeyEventKind::Release {
            return Wish::Nothing;
        }
        let control = key.modifiers.contains(KeyModifiers::CONTROL);
        let far = key.modifiers.contains(KeyModifiers::SHIFT);
        match key.code {
            KeyCode::Char('c') if control => return Wish::Quit,
            KeyCode::Char('l') if control => return Wish::Clear,
            _ if control => {}
            KeyCode::Char('q') => return Wish::Quit,
            KeyCode::Char('r') => return Wish::Again,
            KeyCode::Char('?' | 'h') => (self.help, self.scroll) = (!self.help, 0),
            KeyCode::Esc => (self.help, self.large, self.scroll) = (false, None, 0),
            KeyCode::Tab => self.next_panel(true),
            KeyCode::BackTab => self.next_panel(false),
            KeyCode::Char(' ') => self.toggle(),
            KeyCode::Left => self.move_by(if far { -100 } else { -1 }),
            KeyCode::Right => self.move_by(if far { 100 } else { 1 }),
            KeyCode::Char('[') => self.move_by(-50),
            KeyCode::Char(']') => self.move_by(50),
            KeyCode::Char('.') => self.go_to_mark(true),
            KeyCode::Char(',') => self.go_to_mark(false),
            KeyCode::Home => self.go(0),
            KeyCode::End => self.go(usize::MAX),
            KeyCode::Char(digit @ '1'..='9') => self.speed = usize::from(digit as u8 - b'0'),
            KeyCode::Char('n') | KeyCode::Down => self.next_seed(1),
            KeyCode::Char('p') | KeyCode::Up => self.next_seed(-1),
            KeyCode::Char('t') => {
                let other = if self.phase == Phase::Learning { Phase::Test } else { Phase::Learning };
                self.playing = false;
                self.choose(other);
            }
            KeyCode::PageDown => self.scroll += 5,
            KeyCode::PageUp => self.scroll = self.scroll.saturating_sub(5),
            _ => {}
        }
        Wish::Nothing
    }
}
