//! The command line that gives a row: it works when pasted at the top of the repository.

use super::campaign::Options;
use super::claims::Claim;
use super::looks::Look;

/// The command for a claim.
pub(super) fn command(claim: &Claim, options: &Options) -> String {
    let plain = claim.trial.is_none_or(|trial| trial.look == Look::Figures);
    if claim.metric.is_looked_at() || !plain {
        return again(claim, options);
    }
    let (learn, seeds) = options.learn(claim.learn);
    let script = options.scripts.join(format!("{}.rhai", learn.script));
    let mut run = format!("cargo run --release -- run {}", quoted(&script.display().to_string()));
    run.push_str(&format!(" --seed {} --seeds {}", options.seed, seeds.len()));
    if let Some(steps) = learn.steps {
        run.push_str(&format!(" --steps {steps}"));
    }
    for pair in learn.changes() {
        run.push_str(&format!(" --set {pair}"));
    }
    run.push_str(&format!(" --set run.test_steps={}", learn.test_steps));
    let folder = format!("runs/{}", claim.id);
    run.push_str(&format!(" --out {folder}"));
    let Some(trial) = claim.trial.map(|trial| options.trial(trial)) else { return run };
    let mut test = format!("--steps {}", trial.steps);
    if let Some(world) = trial.world {
        test = format!("--world {world} {test}");
    }
    for pair in trial.set {
        test.push_str(&format!(" --set {pair}"));
    }
    match seeds.as_slice() {
        [first, .., last] => format!(
            "{run}; for seed in $(seq {first} {last}); do cargo run --release -- test {folder}/$seed {test}; done"
        ),
        _ => format!("{run}; cargo run --release -- test {folder} {test}"),
    }
}

/// The numbers that only this command shows: the row alone.
fn again(claim: &Claim, options: &Options) -> String {
    let scripts = options.scripts.display().to_string();
    let scripts = if scripts == "scripts" { String::new() } else { format!(" --scripts {}", quoted(&scripts)) };
    let quick = if options.quick { " --quick" } else { "" };
    format!(
        "cargo run --release -- reproduce --only {id} --seed {} --seeds {}{quick}{scripts} --out runs/{id} --markdown",
        options.seed,
        options.seeds,
        id = claim.id
    )
}

/// A path as a shell takes it.
fn quoted(path: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if path.chars().all(plain) { path.to_owned() } else { format!("'{}'", path.replace('\'', "'\\''")) }
}
