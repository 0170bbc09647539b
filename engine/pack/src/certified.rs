//! A certificate as evidence of a pack: the policy that it carries, in worlds made by rule that anybody can draw again.

use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::evidence::Difference;
use super::{Digest, MAX_EVIDENCE_STEPS, Pack, Runnable, malformed};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Asked, Certificate, Decider, certify};
use engine::world::{FAMILIES, FamilyRange};

/// What an author asks for in `pack.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifyLine {
    /// Families and ranges of them; without any, the family of the script's own worlds.
    #[serde(default)]
    pub worlds: Vec<String>,
    /// How many draws.
    #[serde(default = "draws")]
    pub draws: u64,
    /// Steps of each; without it, those of the script's test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
}

fn draws() -> u64 {
    200
}

/// Measures what an author asks for. Whoever changes the policy changes the draws: the seed is made of its text.
pub(super) fn certificate_of(
    runnable: &Runnable,
    decider: &Decider,
    policy: &[u8],
    line: &CertifyLine,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Certificate> {
    let CertifyLine { worlds, draws, steps } = line.clone();
    let asked = Asked { worlds, draws: Some(draws), steps, seed: seed_of(policy), ..Asked::default() };
    drawn(runnable, decider, &asked, threads, stop)
}

/// Draws a certificate that a pack carries again.
///
/// # Errors
/// `E-PACK-EVIDENCE` if it is drawn from files, or by a seed that is not its policy's; `E-PACK-LIMIT` if it takes too long.
pub(super) fn certificate_difference(
    pack: &Pack,
    runnable: &Runnable,
    stop: &AtomicBool,
) -> Result<Option<Difference>> {
    let Some(evidence) = &pack.manifest().evidence else { return Ok(None) };
    let (Some(claimed), Some(policy)) = (&evidence.certificate, pack.policy(&runnable.plan)?) else { return Ok(None) };
    let text = pack.manifest().entry.policy.as_ref().and_then(|path| pack.file(path.as_str())).unwrap_or_default();
    if claimed.seed != seed_of(text) || !claimed.set.is_empty() {
        let message =
            format!("the certificate of {} is drawn by a seed or settings of its author's choice", pack.title());
        return malformed("E-PACK-EVIDENCE", message).help("draw your own: engine certify PACK").fail();
    }
    let again = drawn(runnable, &Decider::Learned(policy), &claimed.asked(), 0, stop)?;
    let what = || "the certificate does not come out as it is claimed".to_owned();
    let seed = evidence.policy_seed.unwrap_or_default();
    Ok((again != *claimed).then(|| Difference { seed, step: None, what: what() }))
}

fn drawn(
    runnable: &Runnable,
    decider: &Decider,
    asked: &Asked,
    threads: usize,
    stop: &AtomicBool,
) -> Result<Certificate> {
    check_worlds(&asked.worlds)?;
    check_length(runnable, asked)?;
    let certificate = certify(&runnable.plan, decider, asked, threads, stop, &|_| ())?;
    certificate.ok_or_else(|| Box::new(Diagnostic::new("E-PACK-STOPPED", "stopped before every world was drawn")))
}

/// Worlds of a stranger's certificate are made by rule: a name could be that of any file.
pub(super) fn check_worlds(worlds: &[String]) -> Result<()> {
    let by_rule = |name: &str| FAMILIES.contains(&name) || matches!(FamilyRange::of(name), Some(Ok(_)));
    if let Some(file) = worlds.iter().find(|name| !by_rule(name)) {
        let message = format!("a pack is certified in worlds made by rule, not in '{}'", printable(file));
        return malformed("E-PACK-EVIDENCE", message).help(format!("the families are: {}", FAMILIES.join(", "))).fail();
    }
    Ok(())
}

/// What nobody could draw again in reasonable time is refused.
fn check_length(runnable: &Runnable, asked: &Asked) -> Result<()> {
    let steps = asked.steps.unwrap_or(runnable.plan.settings.run.test_steps);
    // The robot that knows nothing does as many.
    let all = asked.draws.unwrap_or(u64::MAX).saturating_mul(2).saturating_mul(steps);
    if all > MAX_EVIDENCE_STEPS {
        let message = format!("the certificate of this behaviour takes {all} steps; the limit is {MAX_EVIDENCE_STEPS}");
        return malformed("E-PACK-LIMIT", message).help("ask for fewer draws or steps in pack.toml: [certify]").fail();
    }
    Ok(())
}

fn seed_of(policy: &[u8]) -> u64 {
    let [a, b, c, d, ..] = *Digest::of(policy).bytes();
    u64::from(u32::from_be_bytes([a, b, c, d]))
}
