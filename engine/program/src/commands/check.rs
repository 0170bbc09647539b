//! `engine check`: what is wrong or suspicious in a behaviour, before it is learned.

use std::io::IsTerminal;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::Told;
use engine::experiment::Plan;
use insight::lint::{self, Exploits, Report, Severity};
use insight::store::{policy_files, with_policies};
use insight::words::short;
use pack::Runnable;

use super::behaviour::open_to_look;
use crate::cli::{CheckArguments, CheckFormat};
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &CheckArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let overrides = arguments.changes.overrides();
    let format = arguments.format();
    let checked = open_to_look(&arguments.behaviour, &overrides, &arguments.filters, false).and_then(|runnable| {
        // A pack's filters stand in a folder that lives as long as it does.
        let Runnable { plan, unpacked: _unpacked, .. } = runnable;
        // Policies that are there must fit; those that are not may be learned later.
        if plan.behaviour.hands_over() && policy_files(&plan).len() == plan.settings.policies.len() {
            with_policies(plan.clone())?;
        }
        lint::check_behaviour(&plan).map(|report| (plan, report))
    });
    let (plan, report) = match checked {
        Ok(checked) => checked,
        // What does not load is told in the form that was asked for.
        Err(fault) if matches!(format, CheckFormat::Short | CheckFormat::Sarif) => {
            print_told(console, format, &fault.told_with_others())?;
            return Ok(fault.kind().exit_status());
        }
        // Whatever is wrong is told in one shape, in one place.
        Err(fault) if format == CheckFormat::Json => {
            console.json(&serde_json::json!({ "findings": fault.told_with_others(), "left_out": fault.left_out }))?;
            return Ok(fault.kind().exit_status());
        }
        Err(fault) => return Err(fault.into()),
    };
    let told: Vec<Told> =
        report.findings.iter().map(|finding| finding.diagnostic(&plan).told(finding.severity)).collect();
    match format {
        CheckFormat::Text => print(console, &plan, &report)?,
        CheckFormat::Json => {
            let mut whole = serde_json::json!(report);
            // In the shape that errors have.
            whole["findings"] = serde_json::json!(told);
            console.json(&whole)?;
        }
        CheckFormat::Short | CheckFormat::Sarif => print_told(console, format, &told)?,
    }
    Ok(u8::from(!report.is_clean()))
}

fn print_told(console: &mut Console, format: CheckFormat, told: &[Told]) -> std::result::Result<(), ConsoleError> {
    if format == CheckFormat::Sarif {
        return console.line(&format!("{:#}", lint::sarif(told)));
    }
    told.iter().try_for_each(|one| console.line(&one.to_string()))
}

fn print(console: &mut Console, plan: &Plan, report: &Report) -> std::result::Result<(), ConsoleError> {
    let plain = std::env::var_os("NO_COLOR").is_some() || std::env::var("TERM").as_deref() == Ok("dumb");
    let colour = std::io::stdout().is_terminal() && !plain;
    for finding in &report.findings {
        console.line(&finding.diagnostic(plan).render_as(finding.severity, colour))?;
        console.line("")?;
    }
    if report.left_out > 0 {
        console.line(&format!("... and {} more\n", report.left_out))?;
    }
    if let Some(exploits) = &report.exploits {
        print_exploits(console, exploits)?;
    }
    if plan.behaviour.hands_over() {
        let (there, named) = (policy_files(plan).len(), plan.settings.policies.len());
        let missing = if there < named { format!("; {} not there yet", named - there) } else { String::new() };
        console.line(&format!("uses:      {named} policies, which drive in no trial{missing}"))?;
    }
    console.line(&format!(
        "checked:   {} in {}, {} steps: {}",
        report.behaviour,
        report.world,
        report.steps,
        counts(report)
    ))?;
    if report.findings.is_empty() {
        return Ok(());
    }
    console.line("           engine explain CODE says more about a code")
}

/// Checks the behaviour of a run that is over; nothing if it was stopped.
pub(super) fn beside_a_run(plan: &Plan, threads: usize, stop: &AtomicBool, console: &Console) -> Option<Report> {
    lint::check_behaviour_until(plan, threads, stop).unwrap_or_else(|fault| {
        // The run itself is done, and its results are worth keeping.
        console.note(&format!("the check ended early: {}", fault.message));
        None
    })
}

/// The result of a check in two lines at most.
pub(super) fn print_short(console: &mut Console, report: &Report) -> std::result::Result<(), ConsoleError> {
    console.line(&format!("checked:   {}; report.html shows them", counts(report)))?;
    match &report.exploits {
        Some(exploits) => console.line(&format!("           {}", exploits.sentence)),
        None => Ok(()),
    }
}

fn counts(report: &Report) -> String {
    let count = |severity| report.findings.iter().filter(|finding| finding.severity == severity).count();
    let words = |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    let [errors, warnings] = [Severity::Error, Severity::Warning].map(count);
    format!("{}, {}", words(errors, "error"), words(warnings, "warning"))
}

fn print_exploits(console: &mut Console, exploits: &Exploits) -> std::result::Result<(), ConsoleError> {
    console.line("What this reward can be had for:")?;
    let heads = ["reward", "failures", "speed", "net", "spinning"];
    let units = ["per 400", "per 1000", "m/s", "m/s", "%"];
    for [a, b, c, d, e] in [heads, units] {
        console.line(&format!("  {:24}{a:>10}{b:>10}{c:>8}{d:>8}{e:>10}", ""))?;
    }
    for exploit in &exploits.behaviours {
        let net = exploit.net_m_per_s.map_or("-".to_owned(), |net| format!("{net:.2}"));
        console.line(&format!(
            "  {:24}{:>10}{:>10}{:>8.2}{net:>8}{:>10.0}{}",
            exploit.behaviour,
            short(exploit.reward_per_400),
            short(exploit.failures_per_1000),
            exploit.speed_m_per_s,
            100.0 * exploit.spinning,
            if exploit.nowhere { "   gets nowhere" } else { "" }
        ))?;
    }
    let coverage = &exploits.coverage;
    console.line(&format!("  {:24}{:>10}", "no failure, driving on", short(exploits.honest_per_400)))?;
    console.line(&format!("  {}", exploits.sentence))?;
    console.line(&format!(
        "  The model has seen {} of {} states, {} of them in fewer than 20 steps; {} of {} pairs of state and action \
         were never tried.\n",
        coverage.states_seen, coverage.states, coverage.states_hardly_seen, coverage.pairs_untried, coverage.pairs
    ))
}
