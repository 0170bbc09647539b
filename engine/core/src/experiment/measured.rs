//! The figures of a test, from what was counted and from the truth.

use super::spells::Spells;
use super::summary::rule_totals;
use super::truth::Truth;
use super::{Plan, Tally};
use crate::stats::Sorted;
use crate::verdict::{AskedFigure, MeasureTotal, StageTotal, TestFigures};

/// Half of the paper's cruising speed, net along the route, m/s.
const TASK_SPEED_M_PER_S: f64 = 0.1;

/// What was counted in so many steps, and what the truth says; a robot that does not know where it is has gone nowhere.
/// `goals_steps` are the lengths of the attempts that reached their goals, `goal_crashes` how many of them ended in a crash.
pub(super) fn figures(
    plan: &Plan,
    steps: u64,
    tally: &Tally,
    (goals_steps, goal_crashes): (&[u32], u64),
    truth: Option<&Truth>,
    asked: Vec<AskedFigure>,
    (stage_rates, measures): (Vec<StageTotal>, Vec<MeasureTotal>),
) -> TestFigures {
    let period_s = plan.settings.run.period_s;
    let seconds = (steps as f64 * period_s).max(f64::MIN_POSITIVE);
    let per_1000 = |count: f64| count * 1000.0 / steps.max(1) as f64;
    let spells = truth.map_or_else(Spells::default, |truth| truth.spells);
    let share = |count: u64| count as f64 / spells.all.max(1) as f64;
    let net_route_m = truth.and_then(Truth::net_m);
    let distance_m = truth.map_or(0.0, |truth| truth.distance_m);
    let prey_m = truth.map_or(&[][..], |truth| &truth.prey_m);
    let endings = tally.endings();
    TestFigures {
        steps,
        failures: endings.failures,
        goals: endings.goals,
        restarts: endings.restarts,
        failures_per_1000: per_1000(endings.failures as f64),
        hops: endings.hops,
        goal_rate: endings.goal_rate(),
        goal_crashes,
        goal_s: goals_steps.iter().map(|steps| f64::from(*steps) * period_s).collect::<Sorted>().upper_median(),
        reinforcement_per_1000: per_1000(tally.curve().iter().sum()),
        distance_m,
        net_route_m,
        laps: truth.and_then(Truth::laps),
        off_route: truth.and_then(Truth::off_steps).map(|off_steps| off_steps / steps.max(1) as f64),
        route_offset_m: truth.and_then(Truth::offsets_m).map(|offsets_m| offsets_m / steps.max(1) as f64),
        metres_per_failure: net_route_m.map_or(distance_m, f64::abs) / (endings.failures + 1) as f64,
        metres_per_intervention: net_route_m.map_or(distance_m, f64::abs)
            / (endings.failures + endings.restarts + 1) as f64,
        contacts: tally.contacts(),
        forbidden_per_1000: plan.behaviour.guards().next().map(|_| per_1000(tally.guarded() as f64)),
        mean_speed: distance_m / seconds,
        no_spells: truth.is_some() && spells.all == 0,
        spinning: share(spells.spinning),
        standing: share(spells.standing),
        circling: share(spells.circling),
        returning: share(spells.returning),
        lingering: share(spells.lingering),
        backwards: net_route_m.map(|_| share(spells.backwards)),
        prey_distance_m: prey_m.iter().map(|distance| f64::from(*distance)).collect::<Sorted>().upper_median(),
        does_task: net_route_m.map(|net_m| net_m.abs() / seconds >= TASK_SPEED_M_PER_S),
        rules: rule_totals(plan, tally),
        stages: tally.stages().0,
        rounds: tally.stages().1,
        stage_rates,
        measures,
        asked,
    }
}
