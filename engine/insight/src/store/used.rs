//! The policies that a script uses, read with the runs that learned them.

use std::sync::Arc;

use super::members::{PolicyText, all, wrong};
use super::run_file::{StoredRun, uses_policies};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Decider, Plan, UsedPolicy};

/// The plan with the policies that its script uses, one text for each that it names.
pub(super) fn with_used(plan: Plan, texts: Vec<PolicyText>) -> Result<Plan> {
    let used = texts.into_iter().enumerate().map(|(index, text)| used(&plan, index, text).map(Arc::new));
    let used = all(used)?;
    let plan = plan.with_used(used);
    match plan.motions_beyond_limit() {
        0 => Ok(plan),
        beyond => {
            let message =
                format!("the script and the policies that it uses have {beyond} actions too many: 64 are the most");
            let help = "use fewer policies, or some that were learned with the same actions";
            Err(wrong(&plan, 0, message, "with this one and the others", help))
        }
    }
}

/// One policy that it uses.
pub(super) fn used(plan: &Plan, index: usize, PolicyText { policy, run }: PolicyText) -> Result<UsedPolicy> {
    let name = plan.settings.policies[index].name.clone();
    let shown = printable(&name);
    let Some(run) = run else {
        let message = format!("policy \"{shown}\" cannot be used: there is no run.toml beside its policy.toml");
        let help = "a policy that drives by itself brings its script along: name the folder of its run";
        return Err(wrong(plan, index, message, "this policy", help));
    };
    // Looked at before it is read whole: a run within a run within a run would have no end.
    if uses_policies(&run) {
        let message = format!("policy \"{shown}\" uses policies itself");
        return Err(wrong(plan, index, message, "this policy", "name those here, each by a policy(...) of its own"));
    }
    let in_words = |error: Box<Diagnostic>| {
        let message = format!("policy \"{shown}\": {}", error.message);
        wrong(plan, index, message, "this policy", "learn its behaviour again")
    };
    let stored = StoredRun::parse(&run, || Ok(policy.clone()), Arc::clone(&plan.filters)).map_err(in_words)?;
    let (learned, of) = match stored.decider {
        Decider::Learned(learned) => (learned, stored.plan),
        Decider::Combined => {
            let message = format!("policy \"{shown}\" is no policy of its own: its run learned nothing");
            return Err(wrong(plan, index, message, "this policy", "name the run of a behaviour that learns"));
        }
    };
    let used = UsedPolicy { name: name.clone(), plan: of, policy: learned, texts: [policy, run] };
    used.fits(plan)
        .map_err(|[why, help]| wrong(plan, index, format!("policy \"{shown}\" {why}"), "cannot drive here", &help))?;
    Ok(used)
}
