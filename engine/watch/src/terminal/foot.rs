//! What stands above and below the panels: which run, how it went, which step, the page's address, keys.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::text::{Line, Span};

use super::ink::TerminalInk;
use super::keys::KEYS;
use super::lines::{ends, heading, write, write_all};
use super::view::{SPEEDS, View};
use super::words::{columns, fit, signed};
use crate::board::WatchedSeed;
use engine::experiment::Phase;
use insight::words::{typeset, whole};

/// Columns of the keys that are always named: help and quit.
const LEAST_KEYS: usize = 16;

/// Which behaviour, what is being done; how the seeds did.
pub(super) fn head(view: &View, area: Rect, buffer: &mut Buffer) {
    let name = match view.document() {
        Some(document) => {
            fit(&format!("{} in {}", document.behaviour, document.world.name), usize::from(area.width / 2))
        }
        None => "engine watch".to_owned(),
    };
    let status = status(view, usize::from(area.width).saturating_sub(columns(&name) + 2));
    ends(vec![Span::styled(name, TerminalInk::strong())], status, Rect { height: 1, ..area }, buffer);
    let second = Rect { y: area.y + 1, height: 1, ..area };
    write(&Line::from(figures(view, area.width >= 100)), second, buffer);
}

fn status(view: &View, width: usize) -> Line<'static> {
    let text = fit(&view.shown.text, width);
    if view.shown.busy {
        Line::styled(text, view.ink.accent())
    } else if view.shown.error.is_some() {
        Line::styled(fit("the last save has a mistake", width), view.ink.bad())
    } else {
        Line::styled(text, TerminalInk::quiet())
    }
}

fn figures(view: &View, wide: bool) -> Vec<Span<'static>> {
    let (Some(shown), Some(seed)) = (&view.shown.run, view.seed_run()) else { return Vec::new() };
    let success = shown.run.plan.success();
    let learned =
        |seed: &WatchedSeed| seed.learned.as_ref().and_then(|learned| success.learned_at(&learned.tally.counts()));
    let count = shown.run.seeds.iter().filter(|seed| learned(seed).is_some()).count();
    let own = match learned(seed) {
        Some(step) if wide => format!("learned at step {}", whole(step)),
        Some(step) => format!("at step {}", whole(step)),
        None => "not learned".to_owned(),
    };
    let number = seed.seed;
    // Combined policies learn nothing.
    let mut spans = if seed.learned.is_none() {
        vec![Span::styled(format!("seed {number}"), TerminalInk::quiet())]
    } else {
        let all = Span::raw(format!("{count} of {} learned", shown.run.seeds.len()));
        vec![all, Span::styled(format!(" · seed {number}: "), TerminalInk::quiet()), Span::raw(own)]
    };
    if let Some(test) = &seed.test {
        spans.push(Span::styled("; test: ", TerminalInk::quiet()));
        let unit = if wide { "failures per 1,000 steps" } else { "failures/1,000" };
        spans.push(Span::raw(format!("{} {unit}", typeset(test.failures_per_1000))));
        if let Some(forbidden) = test.forbidden_per_1000.filter(|_| wide) {
            spans.push(Span::raw(format!(", {} guarded", typeset(forbidden))));
        }
        if let Some(laps) = test.laps {
            spans.push(Span::raw(format!(", {} laps", typeset(laps))));
        }
        if wide {
            spans.push(Span::raw(format!(", {} m/s", typeset(test.mean_speed))));
        }
    }
    spans
}

/// The shown step; the page's address and as many keys as there is room for.
pub(super) fn foot(view: &View, area: Rect, buffer: &mut Buffer) {
    if view.record().is_some() {
        ends(moment(view), Line::styled(playing(view), TerminalInk::quiet()), Rect { height: 1, ..area }, buffer);
    }
    let all = usize::from(area.width);
    // An address without its end is of no use; the help has it whole.
    let fits = columns(&view.address) + 2 + LEAST_KEYS <= all;
    let address = if fits { view.address.clone() } else { String::new() };
    let room = all.saturating_sub(columns(&address) + 2);
    let mut keys = Vec::new();
    let mut used = 0;
    for (key, name, _) in KEYS.iter().filter(|(_, name, _)| !name.is_empty()) {
        let width = columns(key) + columns(name) + 3;
        if used + width > room {
            break;
        }
        used += width;
        keys.splice(
            0..0,
            [
                Span::raw("  "),
                Span::styled(*key, TerminalInk::strong()),
                Span::raw(" "),
                Span::styled(*name, TerminalInk::quiet()),
            ],
        );
    }
    let second = Rect { y: area.y + 1, height: 1, ..area };
    ends(vec![Span::styled(address, TerminalInk::quiet())], Line::from(keys), second, buffer);
}

fn playing(view: &View) -> String {
    let speed = SPEEDS[view.speed - 1];
    if view.playing { format!("playing, {speed}×") } else { format!("paused, {speed}×") }
}

fn moment(view: &View) -> Vec<Span<'static>> {
    let (Some(record), Some(document)) = (view.record(), view.document()) else { return Vec::new() };
    let phase = if view.phase == Phase::Learning { "learning" } else { "test" };
    let time_s = (view.step + 1) as f64 * document.period_s;
    let mut spans = vec![
        Span::styled(format!("{phase}, step "), TerminalInk::quiet()),
        Span::raw(whole(view.step as u64)),
        Span::styled(format!(" of {} · ", whole(view.story.steps)), TerminalInk::quiet()),
        Span::raw(format!("{time_s:.1} s")),
        Span::styled(" · reward ", TerminalInk::quiet()),
        Span::raw(signed(record.reward)),
    ];
    for (event, word) in [(record.contact, "contact"), (record.fallen, "fallen"), (record.then.is_some(), "recovers")] {
        if event {
            spans.extend([Span::styled(" · ", TerminalInk::quiet()), Span::styled(word, view.ink.bad())]);
        }
    }
    spans
}

/// Every key in words.
pub(super) fn help(view: &View, area: Rect, buffer: &mut Buffer) {
    let inner = heading("Keys", Vec::new(), area, buffer);
    let mut lines: Vec<Line<'_>> = KEYS
        .iter()
        .map(|(key, _, words)| {
            Line::from(vec![Span::styled(format!("{key:>10}  "), TerminalInk::strong()), Span::raw(*words)])
        })
        .collect();
    lines.push(Line::default());
    let more = [
        "Save the script, its world or its filters: all seeds learn again (--keep: on).",
        "The page in a browser is at",
    ];
    lines.extend(more.map(|words| Line::styled(words, TerminalInk::quiet())));
    lines.push(Line::raw(view.address.clone()));
    write_all(&lines, view.scroll, inner, buffer);
}
