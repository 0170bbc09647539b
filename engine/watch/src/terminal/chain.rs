//! Why the action of the shown step had its value: what stands behind it, and the very steps.

use ratatui_core::text::{Line, Span};

use super::ink::TerminalInk;
use super::words::fit;
use engine::experiment::{TryReasons, ValueReasons};
use insight::words::{typeset, whole};

/// Of the steps behind a value so many are named.
const MOST_TRIES: usize = 6;

/// The chain as lines, its own tries last.
pub(super) fn chain(value: &ValueReasons, width: usize) -> Vec<Line<'static>> {
    let head = format!("worth {}, a spread of {} is usual", typeset(value.value), typeset(value.unit));
    let mut lines = vec![Line::styled(fit(&head, width), TerminalInk::strong())];
    let name_width = value.links.iter().map(|link| link.name.chars().count()).max().unwrap_or(0);
    lines.extend(value.links.iter().map(|link| {
        let mean = link.mean.map_or(String::new(), |mean| format!("mean {}", typeset(mean)));
        let words = format!("{:>7.1} tries  {mean:<12} so far {}", link.tries, typeset(link.value));
        Line::from(vec![
            Span::styled(format!("  {:name_width$}", link.name), TerminalInk::quiet()),
            Span::raw(fit(&words, width.saturating_sub(name_width + 2))),
        ])
    }));
    let one = |past: &TryReasons| {
        let earlier = if past.earlier { " before" } else { "" };
        format!("{}{earlier} ({})", whole(past.step), typeset(past.gain))
    };
    let own: Vec<String> = value.tries.iter().take(MOST_TRIES).map(one).collect();
    if !own.is_empty() {
        let more = if value.own_tries > own.len() { ", …" } else { "" };
        lines.push(Line::styled(fit(&format!("  at steps {}{more}", own.join(", ")), width), TerminalInk::quiet()));
    }
    lines
}
