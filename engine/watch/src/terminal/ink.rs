//! Colours for meaning, in the terminal's own sixteen: its own back and text everywhere else.

use std::env::var_os;

use ratatui_core::style::{Color, Modifier, Style};

use insight::page::RuleView;

/// Rules that reward; one such colour after the other.
const GOOD: [Color; 3] = [Color::Green, Color::LightGreen, Color::LightBlue];
/// Rules that punish, and those that do both.
const BAD: [Color; 5] = [Color::Red, Color::Yellow, Color::Magenta, Color::LightRed, Color::LightMagenta];

/// What the terminal can show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TerminalInk {
    /// Whether colours may be used; without them, rules are told apart by letters.
    pub colour: bool,
    /// Whether the font has dots of eight to a cell; without them, half blocks are drawn.
    pub fine: bool,
}

impl TerminalInk {
    /// As the environment says: no colours under `NO_COLOR`, no fine dots on the console of Linux.
    #[must_use]
    pub fn of_environment() -> Self {
        let term = var_os("TERM").unwrap_or_default();
        let colour = var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Self { colour, fine: term != "linux" }
    }

    /// Less important than the text.
    pub(super) fn quiet() -> Style {
        Style::new().add_modifier(Modifier::DIM)
    }

    /// What the eye should find first.
    pub(super) fn strong() -> Style {
        Style::new().add_modifier(Modifier::BOLD)
    }

    /// The robot's own: its way, its laser, its curve.
    pub(super) fn accent(self) -> Style {
        self.coloured(Color::Cyan)
    }

    /// Mistakes and contact.
    pub(super) fn bad(self) -> Style {
        self.coloured(Color::Red)
    }

    /// What must be read, but stops nothing.
    pub(super) fn warning(self) -> Style {
        self.coloured(Color::Yellow)
    }

    /// Each rule's own.
    pub(super) fn rule(self, rules: &[RuleView], rule: usize) -> Style {
        let rewards = |view: &RuleView| view.value.is_some_and(|value| value > 0.0);
        let Some(own) = rules.get(rule).map(rewards) else { return Style::new() };
        let before = rules.iter().take(rule).filter(|view| rewards(view) == own).count();
        self.coloured(if own { GOOD[before % GOOD.len()] } else { BAD[before % BAD.len()] })
    }

    /// The mark of a rule: a dot in its colour, or its letter.
    pub(super) fn mark(self, rule: usize) -> char {
        if self.colour { '•' } else { letter(rule) }
    }

    /// The chip before a rule's name.
    pub(super) fn chip(self, rule: usize) -> char {
        if self.colour { '■' } else { letter(rule) }
    }

    fn coloured(self, colour: Color) -> Style {
        if self.colour { Style::new().fg(colour) } else { Style::new() }
    }
}

fn letter(rule: usize) -> char {
    char::from(b'a' + (rule % 26) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_that_reward_are_green_and_the_others_are_not() {
        let rule = |value| RuleView { name: String::new(), line: 1, lines: 1, value };
        let rules = [rule(Some(-1.0)), rule(Some(0.5)), rule(None), rule(Some(1.0))];
        let ink = TerminalInk { colour: true, fine: true };
        let colours: Vec<_> = (0..4).map(|index| ink.rule(&rules, index).fg).collect();
        assert_eq!(colours, [Color::Red, Color::Green, Color::Yellow, Color::LightGreen].map(Some));
        assert_eq!(TerminalInk { colour: false, fine: true }.rule(&rules, 0), Style::new());
    }

    #[test]
    fn without_colours_a_rule_has_a_letter() {
        assert_eq!(
            (TerminalInk { colour: false, fine: true }.mark(1), TerminalInk { colour: true, fine: true }.mark(1)),
            ('b', '•')
        );
    }
}
