//! Figures of runs and tests, for people.

use engine::diagnostic::printable;
use engine::experiment::{
    CombinationFigures, FromRun, MemberFigures, Plan, Spread, StartJoined, Summary, UseFigures, WorldFigures,
};
use engine::verdict::{BaseLines, Because, SuccessVerdict, TestFigures};
use insight::verdict_words::{figures, headline, learned, spread_of_figures, tells_learning};

use crate::console::{Console, ConsoleError};

/// Disagreements that a person is shown.
const SHOWN: usize = 5;

type Printed = Result<(), ConsoleError>;

/// A seed on one line.
pub(super) fn one_line(summary: &Summary) -> String {
    let success = match summary.verdict.success {
        Some(true) => "success",
        Some(false) => "no success",
        None => "success cannot be told",
    };
    let learned = match (&summary.combination, summary.learned_at) {
        (Some(_), _) => String::new(),
        (None, Some(step)) => format!(", learned at step {step}"),
        (None, None) => ", not learned".to_owned(),
    };
    let laps = summary.test.laps.map_or(String::new(), |laps| format!(", {laps:.1} laps"));
    format!("{success}{learned}; {:.1} failures in 1000 steps{laps}", summary.test.failures_per_1000)
}

/// One seed of a run.
pub(super) fn print_one(console: &mut Console, plan: &Plan, summary: &Summary) -> Printed {
    let Summary { behaviour, world, seed, steps_per_second, test, base_lines, verdict, .. } = summary;
    console.line(&format!("behaviour: {behaviour} in {world}, seed {seed}, {steps_per_second} steps per second"))?;
    if let Some(from) = &summary.from {
        print_from(console, from)?;
    }
    print_verdict(console, verdict)?;
    match &summary.combination {
        Some(combination) => print_combination(console, combination)?,
        None if !plan.learns() => console.line("learned:   nothing: a policy that is used always drives")?,
        None => console.line(&format!("learned:   {}", learned(tells_learning(plan), summary)))?,
    }
    print_uses(console, &summary.uses)?;
    if !summary.starts.is_empty() {
        console.line(&format!("starts:    {}", starts(&summary.starts)))?;
    }
    if let Some(worlds) = hardest(&summary.worlds) {
        console.line(&format!("worlds:    {worlds}"))?;
    }
    print_figures(console, plan, test, base_lines)
}

/// The run that learning went on from, and what was carried on.
fn print_from(console: &mut Console, from: &FromRun) -> Printed {
    console.line(&format!("from:      {}: {}", printable(&from.run), from.carried))
}

/// Of several worlds the three in which the robot failed most.
fn hardest(worlds: &[WorldFigures]) -> Option<String> {
    let mut failing: Vec<&WorldFigures> = worlds.iter().filter(|of| of.failures > 0).collect();
    failing.sort_by(|a, b| b.failures_per_1000.total_cmp(&a.failures_per_1000));
    let one = |of: &&WorldFigures| {
        let (name, failures) = (printable(&of.world), of.failures_per_1000);
        format!("{name} ({failures:.1} failures in 1000 of its {} steps)", of.steps)
    };
    let shown = failing.iter().take(3).map(one).collect::<Vec<_>>().join(", ");
    match (worlds.is_empty(), failing.len()) {
        (true, _) => None,
        (_, 0) => Some(format!("no failure in any of {}", worlds.len())),
        (_, 1) => Some(format!("failures in one of {}: {shown}", worlds.len())),
        (_, count) => Some(format!("failures in {count} of {}, most in {shown}", worlds.len())),
    }
}

/// How much each policy drove that the script uses.
pub(super) fn print_uses(console: &mut Console, uses: &[UseFigures]) -> Printed {
    if uses.is_empty() {
        return Ok(());
    }
    let one = |used: &UseFigures| {
        let (name, drove) = (printable(&used.name), 100.0 * used.drove);
        format!("{name} drove {drove:.0} % of the test, taking over {:.1} times in 1000 steps", used.takeovers_per_1000)
    };
    console.line(&format!("used:      {}", uses.iter().map(one).collect::<Vec<_>>().join("; ")))
}

/// When each start came into use.
fn starts(starts: &[StartJoined]) -> String {
    let one = |start: &StartJoined| {
        let when = start.joined_at.map_or("never joined".to_owned(), |step| format!("from step {step}"));
        format!("\"{}\" {when}", printable(&start.name))
    };
    starts.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Whether a test is a success, and by which figures.
pub(super) fn print_verdict(console: &mut Console, verdict: &SuccessVerdict) -> Printed {
    console.line(&format!("success:   {}", headline(verdict)))?;
    let name = |name: &str| printable(name);
    let width = verdict.conditions.iter().map(|condition| name(&condition.name).chars().count()).max().unwrap_or(0);
    for condition in &verdict.conditions {
        let holds = if condition.holds { "holds" } else { "fails" };
        console.line(&format!("  {holds}  {:width$}  {}", name(&condition.name), figures(condition)))?;
    }
    Ok(())
}

/// Many seeds of a run.
pub(super) fn print_many(console: &mut Console, spread: &Spread) -> Printed {
    let count = spread.seeds.len();
    let share = |part: usize| format!("{part} of {count} seeds ({:.0} %)", 100.0 * part as f64 / count as f64);
    console.line(&format!("behaviour: {} in {}, {count} seeds", spread.behaviour, spread.world))?;
    if let Some(from) = spread.seeds.first().and_then(|seed| seed.from.as_ref()) {
        print_from(console, from)?;
    }
    match spread.seeds.first().map(|seed| &seed.verdict) {
        Some(verdict) if verdict.conditions.is_empty() => {
            console.line(&format!("success:   {}", headline(verdict)))?;
        }
        _ => console.line(&format!("success:   {}", share(spread.successes)))?,
    }
    let width = spread.conditions.iter().map(|condition| printable(&condition.name).chars().count()).max().unwrap_or(0);
    for condition in &spread.conditions {
        let name = printable(&condition.name);
        console.line(&format!(
            "  {:>3} of {count}  {name:width$}  {}",
            condition.held,
            spread_of_figures(condition)
        ))?;
    }
    let untold = [
        (Because::UntrainedToo, "a robot that knows nothing meets every condition too"),
        (Because::BlindToo, "a robot that does not look meets every condition too"),
        (Because::TooFew, "fewer than five attempts ended in the test"),
        (Because::NotMeasured, "no attempt lasts 20 s, so that idling cannot be told"),
        (Because::RewardOnly, "nothing but the reward tells success, which is the script's own word"),
        (Because::BrokenOff, "the test was broken off: they tell nothing"),
    ];
    for (why, what) in untold {
        let seeds = spread.seeds.iter().filter(|seed| seed.verdict.why == why).count();
        if seeds > 0 {
            console.line(&format!("warning:   with {seeds} of {count} seeds {what}"))?;
        }
    }
    let combined = spread.seeds.iter().any(|seed| seed.combination.is_some());
    if !combined {
        console.line(&format!("learned:   {}", share(spread.converged)))?;
    }
    console.line("                        median     worst")?;
    let step = |step: Option<u64>| step.map_or("never".to_owned(), |step| step.to_string());
    let (median, worst) = (&spread.median, &spread.worst);
    let mut row =
        |name: &str, median: String, worst: String| console.line(&format!("  {name:20}{median:>8}  {worst:>8}"));
    if !combined {
        row("learned at step", step(median.learned_at), step(worst.learned_at))?;
    }
    row("failures per 1000", format!("{:.1}", median.failures_per_1000), format!("{:.1}", worst.failures_per_1000))?;
    if let (Some(median), Some(worst)) = (median.goals_share, worst.goals_share) {
        row("goals, % of attempts", format!("{:.0}", 100.0 * median), format!("{:.0}", 100.0 * worst))?;
    }
    if let (Some(median), Some(worst)) = (median.laps, worst.laps) {
        row("laps", format!("{median:.1}"), format!("{worst:.1}"))?;
    }
    if let (Some(median), Some(worst)) = (median.prey_distance_m, worst.prey_distance_m) {
        row("distance to prey, m", format!("{median:.2}"), format!("{worst:.2}"))?;
    }
    row("contacts", format!("{:.0}", median.contacts), format!("{:.0}", worst.contacts))?;
    row("spinning, %", format!("{:.0}", 100.0 * median.spinning), format!("{:.0}", 100.0 * worst.spinning))
}

/// Who decided, and where the policies disagree.
pub(super) fn print_combination(console: &mut Console, figures: &CombinationFigures) -> Printed {
    let member = |member: &MemberFigures| match member.decided {
        Some(share) => format!("{} {:.0} %", member.name, 100.0 * share),
        None => member.name.clone(),
    };
    let members: Vec<String> = figures.policies.iter().map(member).collect();
    let way = if figures.way == "sum" { "sum of" } else { "priority, decided by" };
    console.line(&format!("combined:  {way} {}", members.join(", ")))?;
    console.line(&format!(
        "disagree:  {:.0} % of the time, in {} pairs of states",
        100.0 * figures.disagree,
        figures.disagreements
    ))?;
    for row in figures.most_frequent.iter().take(SHOWN) {
        let wish = |index: usize| {
            let [linear, angular] = row.motions[index];
            format!("{} in {} wants {linear} m/s {angular} rad/s", row.policies[index], row.states[index])
        };
        let won = match row.won {
            [0, 0] => "neither won".to_owned(),
            [first, second] if first >= second => format!("{} won", row.policies[0]),
            _ => format!("{} won", row.policies[1]),
        };
        console.line(&format!("  {} steps: {}; {}; {won}", row.steps, wish(0), wish(1)))?;
    }
    Ok(())
}

/// The figures of a test for a person, and in words what a reward cannot see.
pub(crate) fn print_figures(console: &mut Console, plan: &Plan, test: &TestFigures, lines: &BaseLines) -> Printed {
    let untrained = &lines.untrained;
    console.line(&format!(
        "test:      {} steps, {} ({:.1} per 1000, untrained {:.1}), {}, {:.2} m/s",
        test.steps,
        counted(test.failures, "failure"),
        test.failures_per_1000,
        untrained.failures_per_1000,
        counted(test.contacts, "contact"),
        test.mean_speed
    ))?;
    if let Some(forbidden) = test.forbidden_per_1000 {
        console.line(&format!("           guards took actions away in {forbidden:.1} of 1000 steps"))?;
    }
    if test.goals + test.restarts > 0 || plan.behaviour.has_goals() {
        let mut restarts =
            if test.restarts > 0 { format!("; {}", counted(test.restarts, "restart")) } else { String::new() };
        if test.hops > 0 {
            restarts += &format!("; {} broken off after run.stay_steps", test.hops);
        }
        console.line(&format!(
            "goals:     {} of {} ({:.0} %, untrained {:.0} %){restarts}",
            test.goals,
            counted(test.attempts() + test.hops, "attempt"),
            100.0 * test.goal_rate,
            100.0 * untrained.goal_rate
        ))?;
    }
    if let (Some(laps), Some(net_m)) = (test.laps, test.net_route_m) {
        console.line(&format!(
            "route:     {laps:.1} laps, {net_m:.0} m net along it; {:.0} m driven, {:.0} % of the steps off it",
            test.distance_m,
            100.0 * test.off_route.unwrap_or(0.0)
        ))?;
    }
    if let Some(distance_m) = test.prey_distance_m {
        console.line(&format!("prey:      median distance {distance_m:.2} m"))?;
    }
    if let Some(blind) = &lines.blind {
        let figures = &blind.test;
        console.line(&format!(
            "blind:     '{}' is the best that does not look: {:.1} failures and {:.1} restarts per 1000, {:.2} m/s",
            blind.does,
            figures.failures_per_1000,
            figures.per_1000(figures.restarts),
            figures.mean_speed
        ))?;
    }
    let habits = [("spinning", test.spinning), ("standing", test.standing), ("circling", test.circling)];
    let habits: Vec<_> = habits.iter().filter(|(_, share)| *share > 0.02).collect();
    for (habit, share) in habits {
        console.line(&format!("warning:   {habit} {:.0} % of the time", 100.0 * share))?;
    }
    Ok(())
}

/// `1 failure`, `2 failures`.
fn counted(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
