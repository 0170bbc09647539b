//! One page with a card for each pack: where it drives, how it learned, what it claims, who signed it.
//!
//! The page is whole in one file, runs no script, and shows nothing of a pack but its PNG picture and escaped words.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{Markup, html};

use super::author::PICTURE;
use super::{Evidence, Pack, SeedClaim, Signature, TrustStore};
use engine::diagnostic::printable;
use insight::shell::page_without_scripts;
use insight::words::bounded;

/// The largest picture that is shown, bytes.
const MAX_PICTURE_BYTES: usize = 4 << 20;
/// Width and height of a curve, in the units of its drawing.
const CURVE: [f64; 2] = [300.0, 84.0];
/// The least distance between two numbers beside a curve.
const LABEL: f64 = 12.0;
const STYLE: &str = include_str!("gallery.css");

/// A pack on the page, and what is known about its signature.
pub struct Card<'a> {
    /// The pack.
    pub pack: &'a Pack,
    /// Who signed it.
    pub signed: SignatureLine,
}

/// What is known about a signature.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignatureLine {
    /// In words.
    pub text: String,
    /// Whether it is valid, by a key that the user trusts for the owner.
    pub trusted: bool,
}

/// Describes a pack's signature.
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
#[must_use]
pub fn gallery(cards: &[Card<'_>]) -> String {
    let count = cards.len();
    let body = html! {
        header {
            h1 { "Behaviour packs" }
            p {
                (count) (if count == 1 { " behaviour" } else { " behaviours" })
                ", each with the evidence that it carries. Measure one again with "
                code { "engine pack verify --replay FILE.pack" } "."
            }
        }
        main { @for card in cards { (drawn(card)) } }
    };
    page_without_scripts("Behaviour packs", STYLE, &body)
}

fn drawn(card: &Card<'_>) -> Markup {
    let manifest = card.pack.manifest();
    let (owner, name) = (said(manifest.name.owner()), said(manifest.name.name()));
    let asks = manifest.capabilities.lines().join(", ");
    html! {
        article {
            h2 {
                span { (owner) "/" } (name) " " small { (said(&manifest.version.to_string())) }
            }
            p .about { (said(&manifest.description)) }
            @match picture(card.pack) {
                Some(data) => img alt={ "Paths of " (owner) "/" (name) ": while learning, and with the learned policy" }
                    src={ "data:image/png;base64," (data) };,
                None => p .none { "no picture" },
            }
            @match &manifest.evidence {
                Some(evidence) => { (curve(evidence)) (figures(evidence)) }
                None => p .none { "no evidence" },
            }
            p class={ "sign " (if card.signed.trusted { "good" } else { "open" }) } { (said(&card.signed.text)) }
            p .foot {
                (said(&manifest.license)) " · asks for "
                (said(if asks.is_empty() { "nothing" } else { &asks }))
                br;
                code { (card.pack.content()) }
            }
        }
    }
}

/// The picture that `build` drew, if it is a PNG of a sound size.
fn picture(pack: &Pack) -> Option<String> {
    let bytes = pack.file(PICTURE)?;
    let fine = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() <= MAX_PICTURE_BYTES;
    fine.then(|| STANDARD.encode(bytes))
}

/// The reinforcement of every 400 steps, a line for each seed.
fn curve(evidence: &Evidence) -> Markup {
    let values =
        || evidence.seeds.iter().flat_map(|claim| &claim.reinforcement_per_400).filter(|value| value.is_finite());
    let lowest = values().fold(-1.0, |low: f64, value| low.min(*value));
    let highest = values().fold(0.0, |high: f64, value| high.max(*value));
    if values().next().is_none() {
        return html! { p .none { "nothing is learned: learned policies are combined" } };
    }
    let [width, height] = CURVE;
    let y = |value: f64| height * (highest - value) / (highest - lowest);
    let mut labelled: Vec<f64> = Vec::new();
    for value in [lowest, highest, 0.0] {
        // The line of zero needs no number where one of the ends is as good as there.
        if labelled.iter().all(|other| (y(*other) - y(value)).abs() >= LABEL) {
            labelled.push(value);
        }
    }
    let points = |claim: &SeedClaim| {
        let last = claim.reinforcement_per_400.len().saturating_sub(1).max(1) as f64;
        let point = |(index, value): (usize, &f64)| format!("{:.1},{:.1}", width * index as f64 / last, y(*value));
        let finite = claim.reinforcement_per_400.iter().enumerate().filter(|(_, value)| value.is_finite());
        finite.map(point).collect::<Vec<_>>().join(" ")
    };
    let below = height + 18.0;
    html! {
        figure {
            svg viewBox={ "-34 -8 " (width + 40.0) " " (height + 30.0) } role="img"
                aria-label="Reinforcement of every 400 steps" {
                path .axis d=(format!("M0 {:.1}H{width}M0 0V{height}", y(0.0))) {}
                @for value in labelled {
                    text x="-4" y=(format!("{:.1}", y(value) + 4.0)) text-anchor="end" { (bounded(value)) }
                }
                @for claim in &evidence.seeds { polyline points=(points(claim)) {} }
                text x="0" y=(below) { "reinforcement of every 400 steps" }
                text x=(width) y=(below) text-anchor="end" { (evidence.steps) " steps" }
            }
        }
    }
}

fn figures(evidence: &Evidence) -> Markup {
    let learned = evidence.seeds.iter().filter(|claim| claim.learned_at.is_some()).count();
    let successes = evidence.seeds.iter().filter(|claim| claim.success == Some(true)).count();
    let Some(claim) = evidence.shown() else { return Markup::default() };
    let SeedClaim { seed, failures_per_1000, laps, contacts, mean_speed, .. } = claim;
    let mut rows = Vec::new();
    if evidence.seeds.iter().any(|claim| claim.success.is_some()) {
        rows.push(("seeds that are a success", format!("{successes} of {}", evidence.seeds.len())));
    }
    if evidence.steps > 0 {
        rows.push(("seeds that learned", format!("{learned} of {}", evidence.seeds.len())));
        rows.push(("learned at step", claim.learned_at.map_or("never".to_owned(), |step| step.to_string())));
    }
    rows.extend(evidence.params.iter().map(|(name, shown)| (name.as_str(), printable(shown))));
    rows.push(("failures in 1000 steps", format!("{failures_per_1000:.1}")));
    rows.extend(claim.untrained_failures_per_1000.map(|untrained| ("untrained", format!("{untrained:.1}"))));
    rows.push(("contacts", contacts.to_string()));
    rows.extend(laps.map(|laps| ("laps", format!("{laps:.1}"))));
    rows.push(("mean speed", format!("{mean_speed:.2} m/s")));
    html! {
        table {
            caption { "seed " (seed) ", test of " (evidence.test_steps) " steps" }
            @for (name, value) in rows { tr { th { (said(name)) } td { (value) } } }
        }
    }
}

/// A stranger's words, made safe for people by [`printable`] and for a page by the template.
fn said(words: &str) -> Markup {
    html! { (printable(words)) }
}

#[cfg(test)]
mod tests {
    use super::said;

    #[test]
    fn a_strangers_words_stay_words() {
        assert_eq!(said("<script>'\"&\u{1b}").into_string(), "&lt;script&gt;'&quot;&amp;\\u{1b}");
    }
}
