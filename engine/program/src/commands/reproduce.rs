//! `engine reproduce`: the paper's figures and claims beside what is measured here.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use engine::diagnostic::{Diagnostic, nearest_name, printable};
use insight::disk::{Together, write_atomic};
use insight::folder::write_json;
use paper::{CLAIMS, Campaign, Options, Reproduction, Verdict, figures, markdown, page, rows};

use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::cli::ReproduceArguments;
use crate::console::{Console, ConsoleError};

const PAGE: &str = "reproduce.html";

pub(crate) fn run(arguments: &ReproduceArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let started = Instant::now();
    for id in &arguments.only {
        known(id)?;
    }
    let together = Together::into(&arguments.out)?;
    let campaign = Campaign::new(Options {
        scripts: arguments.scripts.clone(),
        seed: arguments.seed,
        seeds: arguments.seeds,
        threads: arguments.threads.unwrap_or(0) as usize,
        quick: arguments.quick,
        only: arguments.only.clone(),
    });
    let stop = on_ctrl_c()?;
    let steps = campaign.steps();
    let bar = console.bar(steps);
    let done = AtomicU64::new(0);
    let progress = |more: u64| {
        bar.inc(more);
        let before = done.fetch_add(more, Ordering::Relaxed);
        let tenth = |steps_done: u64| steps_done * 10 / steps.max(1);
        if bar.is_hidden() && tenth(before + more) > tenth(before) {
            console.note(&format!("{} % of {steps} steps", 10 * tenth(before + more)));
        }
    };
    let measured = campaign.run(&stop, &progress);
    bar.finish_and_clear();
    let measured = measured?;
    if stop.load(Ordering::Relaxed) {
        console.note("stopped by Ctrl-C; nothing was written, since half of the numbers is missing");
        return Ok(INTERRUPTED);
    }
    let found = rows(&measured);
    let drawn = figures(&measured)?;
    write_json(&together.folder().join("reproduce.json"), &found)?;
    write_atomic(&together.folder().join(PAGE), page(&found, &drawn).as_bytes())?;
    together.commit()?;
    let path = arguments.out.join(PAGE);
    tell(arguments, console, &found, &path, steps)?;
    console.note(&format!("{steps} steps in {:.1} s", started.elapsed().as_secs_f64()));
    Ok(0)
}

fn tell(
    arguments: &ReproduceArguments,
    console: &mut Console,
    found: &Reproduction,
    path: &Path,
    steps: u64,
) -> Result<(), ConsoleError> {
    console.json(found)?;
    if arguments.markdown {
        return console.line(markdown(found).trim_end());
    }
    let quick = if found.quick { " (quick check: the verdicts mean nothing)" } else { "" };
    console.line(&format!("reproduced: {} rows from {steps} steps{quick}", found.rows.len()))?;
    for row in &found.rows {
        let ours = row.ours.as_ref().map_or("-", |ours| ours.text.as_str());
        console.line(&format!("  {:20}{:>20}  {:>28}  {}", row.id, row.paper, ours, row.verdict.word()))?;
    }
    let missing: Vec<_> = found.rows.iter().filter(|row| row.verdict == Verdict::NotMeasured).collect();
    for row in missing {
        console.line(&format!("  {}: {}", row.id, row.reason))?;
    }
    console.line(&format!("page:      {}", path.display()))
}

fn known(id: &str) -> Result<(), ConsoleError> {
    let ids = || CLAIMS.iter().map(|claim| claim.id);
    if ids().any(|known| known == id) {
        return Ok(());
    }
    let help = match nearest_name(id, ids()) {
        Some(near) => format!("did you mean '{near}'?"),
        None => format!("there are: {}", ids().collect::<Vec<_>>().join(", ")),
    };
    let message = format!("there is no row '{}'", printable(id));
    Err(Box::new(Diagnostic::new("E-ROW", message).help(help)).into())
}
