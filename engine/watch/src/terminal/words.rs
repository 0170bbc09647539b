//! Numbers and texts as the page writes them, safe for a terminal and cut to a width.

use ratatui_core::text::Span;

use engine::diagnostic::printable;
use insight::words::{typeset, whole};

/// A number with its sign, also if it is positive.
pub(super) fn signed(number: f64) -> String {
    if number > 0.0 { format!("+{}", typeset(number)) } else { typeset(number) }
}

/// The sum of many rewards with its sign: whole and with commas once it is large.
pub(super) fn total(number: f64) -> String {
    if number.abs() < 1000.0 {
        return signed(number);
    }
    let sign = if number > 0.0 { '+' } else { '−' };
    format!("{sign}{}", whole(number.abs().round() as u64))
}

/// How a robot moves under an action.
pub(super) fn motion([linear, angular]: [f64; 2]) -> String {
    let side = if angular > 0.0 { "left" } else { "right" };
    let turn = if angular == 0.0 { "straight".to_owned() } else { format!("{} rad/s {side}", typeset(angular.abs())) };
    format!("{} m/s, {turn}", typeset(linear))
}

/// Where a beam looks, degrees from straight ahead.
pub(super) fn side(angle_deg: f64) -> String {
    let side = if angle_deg > 0.0 { "left" } else { "right" };
    if angle_deg.abs() < 0.5 { "ahead".to_owned() } else { format!("{:.0}° {side}", angle_deg.abs()) }
}

/// A stranger's text in at most `width` columns of a terminal.
pub(super) fn fit(text: &str, width: usize) -> String {
    let mut text = printable(text);
    if columns(&text) <= width {
        return text;
    }
    while !text.is_empty() && columns(&text) + 1 > width {
        text.pop();
    }
    if width > 0 {
        text.push('…');
    }
    text
}

/// How many columns a text takes.
pub(super) fn columns(text: &str) -> usize {
    Span::raw(text).width()
}

/// Breaks words into lines of at most `width` columns.
pub(super) fn lines(text: &str, width: usize) -> Vec<String> {
    let (mut out, mut line) = (Vec::new(), String::new());
    for word in text.split_whitespace() {
        if !line.is_empty() && columns(&line) + 1 + columns(word) > width {
            out.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    if !line.is_empty() {
        out.push(line);
    }
    out
}

/// Round numbers from low to high, about `count` of them.
pub(super) fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let raw = ((high - low) / count.max(1) as f64).max(1e-9);
    let mut power = 1e-9;
    while power * 10.0 <= raw * 1.000_001 {
        power *= 10.0;
    }
    let step = [1.0, 2.0, 5.0, 10.0].map(|by| by * power).into_iter().find(|step| *step >= raw * 0.999);
    let step = step.unwrap_or(raw);
    let first = (low / step - 1e-9).ceil() as i64;
    (first..first + 100).map(|at| at as f64 * step).take_while(|at| *at <= high + step * 1e-6).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_and_sums_have_their_sign() {
        assert_eq!([signed(0.25), signed(-3.0), signed(0.0)], ["+0.25", "−3", "0"]);
        assert_eq!([total(-1234.4), total(12.5)], ["−1,234", "+12.5"]);
    }

    #[test]
    fn text_is_cut_by_columns_and_never_reaches_the_terminal_raw() {
        assert_eq!(fit("corridor", 8), "corridor");
        assert_eq!(fit("corridors", 8), "corrido…");
        assert_eq!(fit("\u{1b}[2Jx", 40), "\\u{1b}[2Jx");
        // Each of these takes two columns.
        assert_eq!(fit("走廊走廊", 5), "走廊…");
        assert_eq!(fit("a", 0), "");
    }

    #[test]
    fn words_are_broken_into_lines() {
        assert_eq!(lines("write laser.nearest in metres", 15), ["write", "laser.nearest", "in metres"]);
        assert_eq!(lines("", 5), Vec::<String>::new());
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(ticks(-42.0, 0.0, 4), [-40.0, -20.0, 0.0]);
        assert_eq!(ticks(0.0, 2000.0, 4), [0.0, 500.0, 1000.0, 1500.0, 2000.0]);
        let (small, wanted) = (ticks(-0.3, 0.3, 3), [-0.2, 0.0, 0.2]);
        assert_eq!(small.len(), 3);
        assert!(small.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{small:?}");
        assert_eq!(ticks(0.0, 0.0, 3), [0.0]);
    }
}
