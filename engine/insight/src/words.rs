//! Numbers as people read them. Each way of writing has one name here:
//!
//! | function | -1234.5678 | where |
//! |---|---|---|
//! | [`short`] | `-1234.568` | the program's lines, findings: can be copied into a script |
//! | [`brief`] | `-1235` | figures of a verdict in the program's lines |
//! | [`typeset`] | `−1235` | the terminal of the live page, which writes as the page does |
//! | [`spaced`], one place | `−1234.6` | pictures; from five digits on with thin spaces between thousands |
//! | [`three_figures`] | `−1235` | values of states in pictures |
//! | [`with_commas`], one place | `−1,234.6` | the page of the paper |
//! | [`whole`], of 1234 | `1,234` | counts in the terminal of the live page |
//! | [`bounded`] | `-1235` | the gallery of packs, where strangers choose the number |

use engine::diagnostic::grouped;

/// At most three places, with a plain minus.
#[must_use]
pub fn short(value: f64) -> String {
    trimmed(value, 3)
}

/// At most two places, none from 100 on, with a plain minus.
#[must_use]
pub fn brief(value: f64) -> String {
    trimmed(value, if value.abs() >= 100.0 { 0 } else { 2 })
}

/// As [`brief`], with a true minus.
#[must_use]
pub fn typeset(value: f64) -> String {
    brief(value).replace('-', "−")
}

/// A whole number with commas between thousands.
#[must_use]
pub fn whole(count: u64) -> String {
    grouped(&count.to_string(), ",")
}

/// This many places, with commas between thousands and a true minus.
#[must_use]
pub fn with_commas(value: f64, places: usize) -> String {
    let (minus, whole, part) = parts(value, places);
    format!("{minus}{}{part}", grouped(&whole, ","))
}

/// This many places, with thin spaces between thousands and a true minus; from a billion on with an exponent.
#[must_use]
pub fn spaced(value: f64, places: usize) -> String {
    if value.abs() >= 1e9 {
        return format!("{value:.1e}").replace('-', "−");
    }
    let (minus, whole, part) = parts(value, places);
    // Four digits are still read at a glance.
    let whole = if whole.len() > 4 { grouped(&whole, "\u{2009}") } else { whole };
    format!("{minus}{whole}{part}")
}

/// About three figures, otherwise as [`spaced`].
#[must_use]
pub fn three_figures(value: f64) -> String {
    spaced(
        value,
        match value.abs() {
            size if size >= 100.0 => 0,
            size if size >= 10.0 => 1,
            _ => 2,
        },
    )
}

/// A whole number in a few letters, whatever it is.
#[must_use]
pub fn bounded(value: f64) -> String {
    if value.abs() < 1e5 { format!("{value:.0}") } else { format!("{value:.0e}") }
}

/// The number to one part in `per_one`, halves away from zero; what rounds to 0 has no sign.
#[must_use]
pub fn rounded(value: f64, per_one: f64) -> f64 {
    (value * per_one).round() / per_one + 0.0
}

/// At most this many places, and no minus before 0.
fn trimmed(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A true minus unless all digits are 0, the digits before the point, and the point with those after it.
fn parts(value: f64, places: usize) -> (&'static str, String, String) {
    let plain = format!("{:.places$}", value.abs());
    let (whole, part) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
    let is_zero = !plain.bytes().any(|digit| (b'1'..=b'9').contains(&digit));
    (if value < 0.0 && !is_zero { "−" } else { "" }, whole.to_owned(), part.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_number_has_no_more_places_than_it_needs() {
        assert_eq!([-1.0, 0.25, -0.0001, 10.0, -1234.5678].map(short), ["-1", "0.25", "0", "10", "-1234.568"]);
    }

    #[test]
    fn a_typeset_number_is_short_and_has_a_true_minus() {
        assert_eq!([-0.001, -1.5, 12.0, 1234.5, -100.4].map(typeset), ["0", "−1.5", "12", "1234", "−100"]);
    }

    #[test]
    fn thousands_have_commas() {
        assert_eq!([7, 1234, 1_234_567].map(whole), ["7", "1,234", "1,234,567"]);
        assert_eq!(with_commas(10_500.0, 0), "10,500");
        assert_eq!(with_commas(-1800.25, 1), "−1,800.2");
        assert_eq!(with_commas(-0.01, 1), "0.0");
    }

    #[test]
    fn pictures_have_thin_spaces_from_five_digits_on_and_a_true_minus() {
        assert_eq!(spaced(-12_500.0, 0), "−12\u{2009}500");
        assert_eq!(spaced(2500.0, 0), "2500");
        assert_eq!(spaced(-0.001, 1), "0.0");
        assert_eq!(spaced(1.25, 2), "1.25");
        assert_eq!(spaced(-2.5e9, 0), "−2.5e9");
        assert_eq!([-0.223, 12.34, -123.4].map(three_figures), ["−0.22", "12.3", "−123"]);
    }

    #[test]
    fn whatever_a_stranger_claims_stays_short() {
        assert_eq!([-19.6, 99_999.0, 1e300].map(bounded), ["-20", "99999", "1e300"]);
    }

    #[test]
    fn halves_are_rounded_away_from_zero_and_zero_has_no_sign() {
        assert_eq!([0.25, -0.25, -0.01].map(|value| rounded(value, 10.0).to_string()), ["0.3", "-0.3", "0"]);
    }
}
