//! `engine certify`: a bound on what a policy does in worlds that nobody has seen.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::digest::Digest;
use engine::experiment::{Asked, Certificate, DRAWS, Decider, Overrides, Plan, certify};
use insight::disk::is_there;
use insight::folder::{CERTIFICATE_FILE, CertificateFolder, certificate_lines, read_certificate};
use insight::store::{POLICY_FILE, RUN_FILE, StoredRun, read_stored};

use super::behaviour::open_pack;
use super::sources::{catalogue, sources};
use super::stop::{INTERRUPTED, on_ctrl_c};
use super::test::{check_effect, check_states, of_pack};
use crate::cli::CertifyArguments;
use crate::console::{Console, ConsoleError};

/// The worst draws that a person is shown.
const SHOWN: usize = 4;

/// What is certified.
struct Subject {
    plan: Plan,
    decider: Decider,
    /// Of its policy.
    digest: Digest,
    is_pack: bool,
}

pub(crate) fn run(arguments: &CertifyArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let old = if arguments.again { Some(stated(arguments)?) } else { None };
    let set = old.as_ref().map_or_else(|| arguments.changes.set.clone(), |old| old.set.clone());
    let subject = open(arguments, &set)?;
    let asked = match &old {
        Some(old) => Asked { seed: arguments.seed.unwrap_or(old.seed), ..old.asked() },
        None => asked(arguments, &subject, set),
    };
    let out = arguments.out.as_deref().or((!subject.is_pack && !arguments.again).then_some(arguments.run.as_path()));
    let folder = out.map(|out| CertificateFolder::create(out, arguments.force)).transpose()?;
    let stop = on_ctrl_c()?;
    let Subject { plan, decider, .. } = &subject;
    let bar =
        console.bar_of("testing", asked.draws.unwrap_or(DRAWS) * asked.steps.unwrap_or(plan.settings.run.test_steps));
    let threads = arguments.threads.unwrap_or(0) as usize;
    let certified = certify(plan, decider, &asked, threads, &stop, &|steps| bar.inc(steps));
    bar.finish_and_clear();
    let Some(certificate) = certified? else {
        console.note("stopped by Ctrl-C: half a sample states nothing, and nothing is written");
        return Ok(INTERRUPTED);
    };
    if let Some(folder) = &folder {
        folder.write(plan, decider, &certificate)?;
    }
    console.json(&certificate)?;
    print(console, arguments, &certificate)?;
    if let Some(old) = &old {
        compare(console, arguments, old, &certificate)?;
    }
    if let Some(out) = out {
        console.line(&format!("results:   {}", out.join(CERTIFICATE_FILE).display()))?;
    }
    Ok(u8::from(!certificate.holds()))
}

/// The certificate that is to be drawn again.
fn stated(arguments: &CertifyArguments) -> Result<Certificate> {
    let Some((pack, _)) = open_pack(&arguments.run, arguments.allow_unsigned)? else {
        return read_certificate(&arguments.run);
    };
    let stated = pack.manifest().evidence.as_ref().and_then(|evidence| evidence.certificate.clone());
    let none = || Diagnostic::new("E-PACK-EVIDENCE", format!("{} carries no certificate", pack.title()));
    stated.ok_or_else(|| Box::new(none().help("leave out --again, to draw one of your own")))
}

/// The policy, and the plan of its run with changes.
fn open(arguments: &CertifyArguments, set: &[String]) -> Result<Subject> {
    let overrides = Overrides { set: set.to_vec(), ..Overrides::default() };
    let (stored, digest, is_pack) = match open_pack(&arguments.run, arguments.allow_unsigned)? {
        Some((pack, depends)) => {
            let stored = of_pack(&pack, &depends, &overrides, sources(&arguments.filters)?)?;
            check_effect(set, stored.plan.settings.learner.kind)?;
            (stored, pack.content(), true)
        }
        None => {
            let stored = StoredRun::load_with(&arguments.run, catalogue(&arguments.filters)?)?;
            check_effect(set, stored.plan.settings.learner.kind)?;
            let plan = stored.plan.clone().with_changes(&overrides)?;
            check_states(&stored.plan.settings, &plan.settings)?;
            (StoredRun { plan, ..stored }, digest_of(&arguments.run)?, false)
        }
    };
    Ok(Subject { plan: stored.plan, decider: stored.decider, digest, is_pack })
}

/// The digest of a run's policy; of a run that learned nothing, of its plan.
fn digest_of(run: &Path) -> Result<Digest> {
    let policy = run.join(POLICY_FILE);
    let said = if is_there(&policy)? { policy } else { run.join(RUN_FILE) };
    Ok(Digest::of(read_stored(&said)?.text.as_bytes()))
}

fn asked(arguments: &CertifyArguments, subject: &Subject, set: Vec<String>) -> Asked {
    let [a, b, c, d, ..] = *subject.digest.bytes();
    let of_policy = u64::from(u32::from_be_bytes([a, b, c, d]));
    Asked {
        worlds: arguments.worlds.clone(),
        draws: arguments.draws,
        steps: arguments.steps,
        seed: arguments.seed.unwrap_or(of_policy),
        aim: arguments.bound,
        set,
    }
}

fn print(
    console: &mut Console,
    arguments: &CertifyArguments,
    certificate: &Certificate,
) -> std::result::Result<(), ConsoleError> {
    console.line(&format!("certified: {}", printable(&certificate.behaviour)))?;
    for line in certificate_lines(certificate) {
        console.line(&format!("           {line}"))?;
    }
    let worst: Vec<_> = certificate.worst.iter().filter(|draw| draw.failures > 0 || !draw.success).collect();
    let set: String = certificate.set.iter().map(|pair| format!(" --set {}", printable(pair))).collect();
    for (index, draw) in worst.iter().take(SHOWN).enumerate() {
        let name = if index == 0 { "worst:" } else { "" };
        let (run, world) = (printable(&arguments.run.display().to_string()), printable(&draw.world));
        let failed = format!("{:.1} failures in 1,000 steps", draw.per_1000);
        let steps = certificate.steps;
        console.line(&format!(
            "{name:10} {failed}: engine test {run} --world {world} --seed {} --steps {steps}{set} --out worst-{}",
            draw.seed,
            index + 1
        ))?;
    }
    Ok(())
}

/// Holds what came out against what stands in the folder: every figure, or of another seed both statements beside one another.
fn compare(
    console: &mut Console,
    arguments: &CertifyArguments,
    old: &Certificate,
    new: &Certificate,
) -> std::result::Result<(), ConsoleError> {
    if old.seed == new.seed {
        if old == new {
            return console.line(&format!("again:     every figure of {CERTIFICATE_FILE} comes out the same"));
        }
        let shown = printable(&arguments.run.join(CERTIFICATE_FILE).display().to_string());
        let error = Diagnostic::new("E-LOG-DIFFERS", format!("'{shown}' does not come out as it stands there"));
        let help = "the file was changed, or made by another engine or for another policy: engine certify RUN --force";
        return Err(Box::new(error.help(help)).into());
    }
    console.line(&format!("before:    by seed {}, as it stands in {CERTIFICATE_FILE}:", old.seed))?;
    for line in certificate_lines(old) {
        console.line(&format!("           {line}"))?;
    }
    let apart = new.failures.low > old.failures.high || old.failures.low > new.failures.high;
    let says = if apart { "do not overlap: one of them does not tell the truth" } else { "overlap" };
    console.line(&format!("           the intervals of the failures {says}"))
}
