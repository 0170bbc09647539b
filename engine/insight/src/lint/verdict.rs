//! Whether cheating pays: the cheapest cheat against driving on without a failure, and against the best that was learned.

use std::ops::Range;

use super::choice::place;
use super::{Exploit, Exploits, Finding};
use crate::words::rounded;
use engine::experiment::{Plan, WINDOW_STEPS};

/// A cheat that is brought back more often than this in 1,000 steps does not count as one.
const MOST_FAILURES: f64 = 20.0;

/// What the cheapest cheat earns, held against driving on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ExploitVerdict {
    /// More: the reward can be had without getting anywhere.
    Pays,
    /// Less than a robot that never fails, but more than the best that could be learned of it: learning is likely to end there.
    Easier,
    /// As much, as far as chance lets one tell: the reward does not say which is better.
    Equal,
    /// Less, or there is no cheat that gets by.
    Loses,
}

/// What cheats are held against, in 400 steps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Against {
    /// What driving on without a failure would earn.
    pub honest: f64,
    /// What the best of the model or of the short learning earned that got somewhere, failures and all, and how far chance
    /// may have moved that; nothing if neither got anywhere.
    pub learned: Option<(f64, f64)>,
    /// The greatest reward of any step, either way.
    pub largest: f64,
}

impl Against {
    pub(super) fn new(behaviours: &[Exploit], honest: f64, largest: f64) -> Self {
        let learned = behaviours.iter().filter(|exploit| !exploit.cheat && !exploit.nowhere);
        let best = learned.reduce(|a, b| if b.reward_per_400 > a.reward_per_400 { b } else { a });
        Self { honest, learned: best.map(|best| (best.reward_per_400, spread(best))), largest }
    }
}

/// How far chance moves what a behaviour earns in 400 steps: one standard deviation of its mean.
fn spread(exploit: &Exploit) -> f64 {
    WINDOW_STEPS as f64 * (exploit.variance / exploit.steps.max(1) as f64).sqrt()
}

/// Which behaviour is the cheapest cheat, and whether it pays.
pub(super) fn judge(behaviours: &[Exploit], against: &Against) -> (Option<usize>, ExploitVerdict) {
    let earns = |exploit: &Exploit| exploit.nowhere && exploit.failures_per_1000 <= MOST_FAILURES;
    let idle = behaviours.iter().enumerate().filter(|(_, exploit)| earns(exploit));
    let Some((index, cheat)) = idle.reduce(|a, b| if b.1.reward_per_400 > a.1.reward_per_400 { b } else { a }) else {
        return (None, ExploitVerdict::Loses);
    };
    let scale = against.honest.abs().max(cheat.reward_per_400.abs());
    // Less than one event in 400 steps is no difference.
    let event = against.largest.max(0.02 * scale);
    let sure = 3.0 * spread(cheat) + event;
    let more = cheat.reward_per_400 - against.honest;
    let easier = against.learned.is_some_and(|(learned, chance)| {
        cheat.reward_per_400 - learned > 2.0 * (chance * chance + spread(cheat) * spread(cheat)).sqrt() + event
    });
    let verdict = match () {
        () if more > sure => ExploitVerdict::Pays,
        () if easier => ExploitVerdict::Easier,
        () if more < -sure.min(0.5 * scale) => ExploitVerdict::Loses,
        () => ExploitVerdict::Equal,
    };
    (Some(index), verdict)
}

/// The verdict for a person.
pub(super) fn sentence(cheat: Option<&Exploit>, verdict: ExploitVerdict, against: &Against) -> String {
    let honest = figure(against.honest);
    let learned = match against.learned {
        Some((learned, _)) => format!(", the best that was learned here {}", figure(learned)),
        None => ", and nothing that was learned here gets anywhere".to_owned(),
    };
    let Some(cheat) = cheat else {
        return "No cheat gets by: whatever gets nowhere here fails more than 20 times in 1,000 steps.".to_owned();
    };
    let (name, earned) = (&cheat.behaviour, figure(cheat.reward_per_400));
    let speed = match cheat.net_m_per_s {
        Some(net) => format!("a net {:.2} m/s along the route", rounded(net, 100.0)),
        None => format!("{:.2} m/s", cheat.speed_m_per_s),
    };
    let cost = match cheat.failures_per_1000 {
        0.0 => speed,
        failures => format!("{speed} and {} failures in 1,000", figure(failures)),
    };
    match verdict {
        ExploitVerdict::Pays => format!(
            "The reward can be had without getting anywhere: '{name}' earns {earned} in 400 steps, with {cost}; driving on \
             without a failure earns {honest}{learned}."
        ),
        ExploitVerdict::Easier => format!(
            "It is easier to get nowhere: '{name}' earns {earned} in 400 steps, with {cost}{learned}; only a robot that never \
             fails would earn {honest}."
        ),
        ExploitVerdict::Equal => format!(
            "Nothing in the reward tells '{name}' from driving on: it earns {earned} in 400 steps, with {cost}; driving on \
             without a failure earns {honest}{learned}."
        ),
        ExploitVerdict::Loses => format!(
            "No cheat pays: '{name}', the cheapest, earns {earned} in 400 steps, with {cost}; driving on without a failure \
             earns {honest}{learned}."
        ),
    }
}

/// The cheapest cheat as a finding, if it earns more than driving on, or than what was learned. Where it earns the same the sentence says so: many good
/// rewards punish only what must not happen.
pub(super) fn check_exploits(plan: &Plan, exploits: &Exploits, findings: &mut Vec<Finding>) {
    let Some(cheat) = exploits.cheapest.map(|index| &exploits.behaviours[index]) else { return };
    let name = &cheat.behaviour;
    let (message, than, reference) = match (exploits.verdict, exploits.learned_per_400) {
        (ExploitVerdict::Pays, _) => (
            format!("the reward can be had without getting anywhere: '{name}' earns more than driving on"),
            "driving on without a failure",
            exploits.honest_per_400,
        ),
        (ExploitVerdict::Easier, Some(learned)) => (
            format!("it is easier to get nowhere: '{name}' earns more than what was learned"),
            "the best that was learned here",
            learned,
        ),
        _ => return,
    };
    if findings.iter().any(|finding| finding.code == "W-NO-CHOICE") {
        return;
    }
    let span = what_pays(plan, cheat).unwrap_or_else(|| place(plan));
    let label = format!("'{name}' earns {:.1} in 400 steps, {than} {reference:.1}", cheat.reward_per_400);
    let help = match exploits.verdict {
        ExploitVerdict::Easier => {
            "look at camera, filter and grid first: can the state tell what to do? else make what gets nowhere cost more"
        }
        _ => {
            "reward speed or progress, or punish what the robot does instead: \
             rule \"spinning\" when abs(action.angular) >= 0.6 for 6 seconds => -1;"
        }
    };
    findings.push(Finding::warning(plan, "W-EXPLOIT", span, message).say(label, help));
}

/// The rule that a cheat is paid most by, or `fn reward`; nothing if none pays.
fn what_pays(plan: &Plan, cheat: &Exploit) -> Option<Range<usize>> {
    let (outline, paying) =
        (plan.behaviour.outline(), cheat.rules.iter().enumerate().filter(|(_, rule)| rule.total > 0.0));
    let (most, _) = paying.reduce(|a, b| if b.1.total > a.1.total { b } else { a })?;
    outline.rules.get(most).map(|rule| rule.condition_span.clone()).or_else(|| outline.reward.clone())
}

/// At most one place, and none where it is 0.
fn figure(value: f64) -> String {
    rounded(value, 10.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exploit(behaviour: &str, reward_per_400: f64, failures_per_1000: f64, nowhere: bool) -> Exploit {
        Exploit {
            behaviour: behaviour.to_owned(),
            cheat: true,
            reward_per_400,
            speed_m_per_s: 0.05,
            net_m_per_s: Some(-0.001),
            spinning: 1.0,
            failures_per_1000,
            nowhere,
            steps: 400,
            rules: Vec::new(),
            clean: 0.0,
            variance: 0.0,
        }
    }

    fn judged(behaviours: &[Exploit], honest_per_400: f64) -> (Option<usize>, ExploitVerdict, String) {
        let against = Against::new(behaviours, honest_per_400, 1.0);
        let (cheapest, verdict) = judge(behaviours, &against);
        (cheapest, verdict, sentence(cheapest.map(|index| &behaviours[index]), verdict, &against))
    }

    #[test]
    fn the_cheapest_cheat_earns_most_of_those_that_get_nowhere_and_seldom_fail() {
        let all = [
            exploit("drive", 90.0, 0.0, false),
            exploit("stand", 40.0, 2.5, true),
            exploit("spin", 60.0, 0.0, true),
            exploit("crash", 80.0, 20.5, true),
        ];
        let (cheapest, verdict, sentence) = judged(&all, 50.0);
        assert_eq!((cheapest, verdict), (Some(2), ExploitVerdict::Pays));
        assert_eq!(
            sentence,
            "The reward can be had without getting anywhere: 'spin' earns 60 in 400 steps, with a net 0.00 m/s along the \
             route; driving on without a failure earns 50, and nothing that was learned here gets anywhere."
        );
    }

    #[test]
    fn less_than_one_event_is_no_difference() {
        let all = [exploit("spin", -0.96, 2.5, true)];
        let (_, verdict, sentence) = judged(&all, 0.0);
        assert_eq!(verdict, ExploitVerdict::Loses, "half of what is at stake is much where next to nothing is");
        assert!(sentence.starts_with("No cheat pays: 'spin', the cheapest, earns -1 in 400 steps, "), "{sentence}");
        assert!(sentence.contains("along the route and 2.5 failures in 1,000; "), "{sentence}");
        assert_eq!(judged(&[exploit("spin", 50.5, 0.0, true)], 50.0).1, ExploitVerdict::Equal);
        assert_eq!(judged(&[exploit("spin", 49.5, 0.0, true)], 50.0).1, ExploitVerdict::Equal);
        assert_eq!(judged(&[exploit("spin", 48.5, 0.0, true)], 50.0).1, ExploitVerdict::Loses);
    }

    #[test]
    fn a_cheat_that_earns_more_than_what_was_learned_is_the_easier_way() {
        let learned = |reward: f64| Exploit { cheat: false, ..exploit("best by the model", reward, 25.0, false) };
        let cheat = exploit("spin", -2.4, 5.0, true);
        let (_, verdict, sentence) = judged(&[learned(-10.3), cheat.clone()], 0.0);
        assert_eq!(verdict, ExploitVerdict::Easier);
        assert!(
            sentence.contains("the best that was learned here -10.3; only a robot that never fails would earn 0."),
            "{sentence}"
        );
        // One event less is chance.
        assert_eq!(judged(&[learned(-3.3), cheat.clone()], 0.0).1, ExploitVerdict::Loses);
        // 16 failures in 800 steps have a variance of 0.0196, so -8 in 400 has a spread of 400 x sqrt(0.0196 / 800) = 1.98.
        let spread = |exploit: Exploit| Exploit { variance: 0.0196, steps: 800, ..exploit };
        assert_eq!(judged(&[spread(learned(-7.3)), cheat.clone()], 0.0).1, ExploitVerdict::Loses);
        assert_eq!(judged(&[spread(learned(-7.4)), cheat], 0.0).1, ExploitVerdict::Easier);
    }

    #[test]
    fn where_every_cheat_fails_too_often_there_is_none() {
        let (cheapest, verdict, sentence) = judged(&[exploit("spin", 60.0, 21.0, true)], 50.0);
        assert_eq!((cheapest, verdict), (None, ExploitVerdict::Loses));
        assert!(sentence.starts_with("No cheat gets by"), "{sentence}");
    }
}
