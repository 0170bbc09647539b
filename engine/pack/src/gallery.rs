//! One page with a card for each pack: where it drives, how it learned, what it claims, who signed it.
//!
//! The page is whole in one file, runs no script, and shows nothing of a pack but its PNG picture and escaped words.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::author::PICTURE;
use super::{Evidence, Pack, SeedClaim, Signature, TrustStore};
use engine::diagnostic::{Diagnostic, Result, printable};
use insight::words::bounded;

/// The largest picture that is shown, bytes.
const MAX_PICTURE_BYTES: usize = 4 << 20;
/// Width and height of a curve, in the units of its drawing.
const CURVE: [f64; 2] = [300.0, 84.0];
/// The least distance between two numbers beside a curve.
const LABEL: f64 = 12.0;
const STYLE: &str = include_str!("gallery.css");

/// A pack of the page, and what is known of its signature.
pub struct Card<'a> {
    /// The pack.
    pub pack: &'a Pack,
    /// Who signed it.
    pub signed: SignatureLine,
}

/// What is said of a signature.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignatureLine {
    /// In words.
    pub text: String,
    /// Whether it is valid, by a key that the user trusts for the owner.
    pub trusted: bool,
}

/// What to say of a pack's signature.
#[must_use]
pub fn signature_line(trust: &TrustStore, pack: &Pack, signature: Option<&Signature>) -> SignatureLine {
    let Some(signature) = signature else { return SignatureLine { text: "not signed".to_owned(), trusted: false } };
    let id = signature.key_id();
    match trust.judge(pack, Some(signature), false) {
        Ok(_) => SignatureLine { text: format!("signed by {id}"), trusted: true },
        Err(error) if error.code == "E-TRUST-KEY" => {
            SignatureLine { text: format!("signed by {id}, a key that is not trusted here"), trusted: false }
        }
        Err(error) => SignatureLine { text: format!("signature refused: {}", error.message), trusted: false },
    }
}

/// The page, as one HTML text.
///
/// # Errors
/// Never in practice: only if text cannot be written to memory.
pub fn gallery(cards: &[Card<'_>]) -> Result<String> {
    let mut page = String::new();
    write_page(&mut page, cards).map_err(|_| Box::new(Diagnostic::new("E-IO", "the gallery cannot be written")))?;
    Ok(page)
}

fn write_page(page: &mut String, cards: &[Card<'_>]) -> std::fmt::Result {
    let count = cards.len();
    let plural = if count == 1 { "" } else { "s" };
    write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n\
         <title>Behaviour packs</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>Behaviour packs</h1>\n<p>{count} behaviour{plural}, each with the evidence that it carries. \
         Measure one again with <code>engine pack verify --replay FILE.pack</code>.</p>\n</header>\n<main>\n"
    )?;
    cards.iter().try_for_each(|card| write_card(page, card))?;
    page.push_str("</main>\n</body>\n</html>\n");
    Ok(())
}

fn write_card(page: &mut String, card: &Card<'_>) -> std::fmt::Result {
    let manifest = card.pack.manifest();
    let (owner, name) = (escape(manifest.name.owner()), escape(manifest.name.name()));
    write!(
        page,
        "<article>\n<h2><span>{owner}/</span>{name} <small>{}</small></h2>\n",
        escape(&manifest.version.to_string())
    )?;
    writeln!(page, "<p class=\"about\">{}</p>", escape(&manifest.description))?;
    match picture(card.pack) {
        Some(data) => writeln!(
            page,
            "<img alt=\"Paths of {owner}/{name}: while learning, and with the learned policy\" src=\"data:image/png;base64,{data}\">"
        )?,
        None => page.push_str("<p class=\"none\">no picture</p>\n"),
    }
    if let Some(evidence) = &manifest.evidence {
        write_curve(page, evidence)?;
        write_figures(page, evidence)?;
    } else {
        page.push_str("<p class=\"none\">no evidence</p>\n");
    }
    let class = if card.signed.trusted { "good" } else { "open" };
    writeln!(page, "<p class=\"sign {class}\">{}</p>", escape(&card.signed.text))?;
    let asks = manifest.capabilities.lines();
    let asks = if asks.is_empty() { "nothing".to_owned() } else { asks.join(", ") };
    write!(
        page,
        "<p class=\"foot\">{} · asks for {}<br><code>{}</code></p>\n</article>\n",
        escape(&manifest.license),
        escape(&asks),
        card.pack.content()
    )
}

/// The picture that `build` drew, if it is a PNG of a sound size.
fn picture(pack: &Pack) -> Option<String> {
    let bytes = pack.file(PICTURE)?;
    let fine = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() <= MAX_PICTURE_BYTES;
    fine.then(|| STANDARD.encode(bytes))
}

/// The reinforcement of every 400 steps, a line for each seed.
fn write_curve(page: &mut String, evidence: &Evidence) -> std::fmt::Result {
    let values =
        || evidence.seeds.iter().flat_map(|claim| &claim.reinforcement_per_400).filter(|value| value.is_finite());
    let lowest = values().fold(-1.0, |low: f64, value| low.min(*value));
    let highest = values().fold(0.0, |high: f64, value| high.max(*value));
    if values().next().is_none() {
        page.push_str("<p class=\"none\">nothing is learned: learned policies are combined</p>\n");
        return Ok(());
    }
    let [width, height] = CURVE;
    let y = |value: f64| height * (highest - value) / (highest - lowest);
    writeln!(
        page,
        "<figure><svg viewBox=\"-34 -8 {} {}\" role=\"img\" aria-label=\"Reinforcement of every 400 steps\">",
        width + 40.0,
        height + 30.0
    )?;
    writeln!(page, "<path class=\"axis\" d=\"M0 {:.1}H{width}M0 0V{height}\"/>", y(0.0))?;
    let mut labelled: Vec<f64> = Vec::new();
    for value in [lowest, highest, 0.0] {
        // The line of zero needs no number where one of the ends is as good as there.
        if labelled.iter().all(|other| (y(*other) - y(value)).abs() >= LABEL) {
            writeln!(page, "<text x=\"-4\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", y(value) + 4.0, bounded(value))?;
            labelled.push(value);
        }
    }
    for claim in &evidence.seeds {
        let last = claim.reinforcement_per_400.len().saturating_sub(1).max(1) as f64;
        let point = |(index, value): (usize, &f64)| format!("{:.1},{:.1}", width * index as f64 / last, y(*value));
        let finite = claim.reinforcement_per_400.iter().enumerate().filter(|(_, value)| value.is_finite());
        let points: Vec<String> = finite.map(point).collect();
        writeln!(page, "<polyline points=\"{}\"/>", points.join(" "))?;
    }
    let label = height + 18.0;
    writeln!(page, "<text x=\"0\" y=\"{label}\">reinforcement of every 400 steps</text>")?;
    writeln!(page, "<text x=\"{width}\" y=\"{label}\" text-anchor=\"end\">{} steps</text>", evidence.steps)?;
    page.push_str("</svg></figure>\n");
    Ok(())
}

fn write_figures(page: &mut String, evidence: &Evidence) -> std::fmt::Result {
    let learned = evidence.seeds.iter().filter(|claim| claim.learned_at.is_some()).count();
    let Some(claim) = evidence.shown() else { return Ok(()) };
    let SeedClaim { seed, failures_per_1000, laps, contacts, mean_speed, .. } = claim;
    let mut rows = Vec::new();
    if evidence.steps > 0 {
        rows.push(("seeds that learned", format!("{learned} of {}", evidence.seeds.len())));
        rows.push(("learned at step", claim.learned_at.map_or("never".to_owned(), |step| step.to_string())));
    }
    rows.push(("failures in 1000 steps", format!("{failures_per_1000:.1}")));
    rows.push(("contacts", contacts.to_string()));
    rows.extend(laps.map(|laps| ("laps", format!("{laps:.1}"))));
    rows.push(("mean speed", format!("{mean_speed:.2} m/s")));
    writeln!(page, "<table><caption>seed {seed}, test of {} steps</caption>", evidence.test_steps)?;
    for (name, value) in rows {
        writeln!(page, "<tr><th>{name}</th><td>{value}</td></tr>")?;
    }
    page.push_str("</table>\n");
    Ok(())
}

/// A stranger's words as text of a page.
fn escape(text: &str) -> String {
    printable(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn a_strangers_words_stay_words() {
        assert_eq!(escape("<script>'\"&\u{1b}"), "&lt;script&gt;&#39;&quot;&amp;\\u{1b}");
    }
}
