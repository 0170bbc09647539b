//! Figures of runs and tests, for people.

use engine::experiment::{CombinationFigures, MemberFigures, Spread, Summary, TestFigures};

use crate::console::{Console, ConsoleError};

/// Disagreements that a person is shown.
const SHOWN: usize = 5;

type Printed = Result<(), ConsoleError>;

/// A seed on one line.
pub(super) fn one_line(summary: &Summary) -> String {
    let learned = summary.learned_at.map_or("not learned".to_owned(), |step| format!("learned at step {step}"));
    let laps = summary.test.laps.map_or(String::new(), |laps| format!(", {laps:.1} laps"));
    format!("{learned}; test: {:.1} failures in 1000 steps{laps}", summary.test.failures_per_1000)
}

/// One seed of a run.
pub(super) fn print_one(console: &mut Console, summary: &Summary) -> Printed {
    let Summary { behaviour, world, seed, steps, steps_per_second, test, .. } = summary;
    console.line(&format!("behaviour: {behaviour} in {world}, seed {seed}, {steps_per_second} steps per second"))?;
    match &summary.combination {
        Some(combination) => print_combination(console, combination)?,
        None => {
            let learned = match summary.learned_at {
                Some(step) => format!("at step {step} of {steps} (four windows of 400 steps with -1 or better)"),
                None => format!("not within {steps} steps (no four windows of 400 steps with -1 or better)"),
            };
            console.line(&format!("learned:   {learned}"))?;
        }
    }
    print_figures(console, test)
}

/// Many seeds of a run.
pub(super) fn print_many(console: &mut Console, spread: &Spread) -> Printed {
    let count = spread.seeds.len();
    console.line(&format!("behaviour: {} in {}, {count} seeds", spread.behaviour, spread.world))?;
    let combined = spread.seeds.iter().any(|seed| seed.combination.is_some());
    console.line(&format!(
        "{}   {} of {count} seeds ({:.0} %)",
        if combined { "good:   " } else { "learned:" },
        spread.converged,
        100.0 * spread.converged as f64 / count as f64
    ))?;
    console.line("                        median     worst")?;
    let step = |step: Option<u64>| step.map_or("never".to_owned(), |step| step.to_string());
    let (median, worst) = (&spread.median, &spread.worst);
    let mut row =
        |name: &str, median: String, worst: String| console.line(&format!("  {name:20}{median:>8}  {worst:>8}"));
    if !combined {
        row("learned at step", step(median.learned_at), step(worst.learned_at))?;
    }
    row("failures per 1000", format!("{:.1}", median.failures_per_1000), format!("{:.1}", worst.failures_per_1000))?;
    if let (Some(median), Some(worst)) = (median.laps, worst.laps) {
        row("laps", format!("{median:.1}"), format!("{worst:.1}"))?;
    }
    if let (Some(median), Some(worst)) = (median.prey_distance_m, worst.prey_distance_m) {
        row("distance to prey, m", format!("{median:.2}"), format!("{worst:.2}"))?;
    }
    row("contacts", format!("{:.0}", median.contacts), format!("{:.0}", worst.contacts))?;
    row("spinning, %", format!("{:.0}", 100.0 * median.spinning), format!("{:.0}", 100.0 * worst.spinning))?;
    let lost = spread.seeds.iter().filter(|seed| seed.test.does_task == Some(false)).count();
    if lost > 0 {
        console
            .line(&format!("{lost} of {count} seeds avoid punishment but make less than 0.1 m/s along the route"))?;
    }
    Ok(())
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
pub(crate) fn print_figures(console: &mut Console, test: &TestFigures) -> Printed {
    console.line(&format!(
        "test:      {} steps, {} ({:.1} per 1000), {}, {:.2} m/s",
        test.steps,
        counted(test.failures, "failure"),
        test.failures_per_1000,
        counted(test.contacts, "contact"),
        test.mean_speed
    ))?;
    if test.goals > 0 {
        let all = test.goals + test.failures;
        let share = 100.0 * test.goals as f64 / all as f64;
        console.line(&format!("goals:     {} of {all} attempts ({share:.0} %)", test.goals))?;
    }
    if let (Some(laps), Some(net_m)) = (test.laps, test.net_route_m) {
        console
            .line(&format!("route:     {laps:.1} laps, {net_m:.0} m net along it; {:.0} m driven", test.distance_m))?;
    }
    if let Some(distance_m) = test.prey_distance_m {
        console.line(&format!("prey:      median distance {distance_m:.2} m"))?;
    }
    let habits = [("spinning", test.spinning), ("standing", test.standing), ("circling", test.circling)];
    let habits: Vec<_> = habits.iter().filter(|(_, share)| *share > 0.02).collect();
    for (habit, share) in habits {
        console.line(&format!("warning:   {habit} {:.0} % of the time", 100.0 * share))?;
    }
    if test.does_task == Some(false) {
        console.line("warning:   it avoids punishment, but makes less than 0.1 m/s along the route")?;
    }
    Ok(())
}

/// `1 failure`, `2 failures`.
fn counted(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
