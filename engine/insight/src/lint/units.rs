//! Numbers that no fact can be compared with: centimetres for metres, degrees for radians, percent for shares.

use super::Finding;
use crate::words::short;
use engine::experiment::Plan;
use engine::script::Compared;

/// What a fact can be.
struct Reach {
    low: f64,
    high: f64,
    unit: &'static str,
    whose: &'static str,
}

pub(super) fn check(plan: &Plan, findings: &mut Vec<Finding>) {
    let mut seen = Vec::new();
    for compared in plan.behaviour.outline().all_comparisons() {
        let Some(reach) = reach(plan, compared) else { continue };
        let limit = compared.limit;
        if (reach.low..=reach.high).contains(&limit) || seen.contains(&compared.span.start) {
            continue;
        }
        seen.push(compared.span.start);
        let message = format!("{} is never near {limit}{}", compared.fact, reach.unit);
        let label = format!("{} give {} to {}{}", reach.whose, short(reach.low), short(reach.high), reach.unit);
        findings.push(Finding::warning(plan, "W-UNIT", compared.span.clone(), message).say(label, help(&reach, limit)));
    }
}

fn help(reach: &Reach, limit: f64) -> String {
    let fits = |value: f64| (reach.low..=reach.high).contains(&value) && value != 0.0;
    let (centi, milli, radians) = (limit / 100.0, limit / 1000.0, limit.to_radians());
    match reach.unit {
        " m" if fits(centi) => format!("ranges are in metres: {limit} cm are {} m", short(centi)),
        " m" if fits(milli) => format!("ranges are in metres: {limit} mm are {} m", short(milli)),
        " rad/s" if fits(radians) => format!("turns are in radians: {limit} degrees are {} rad", short(radians)),
        " m/s" if fits(limit / 3.6) => format!("speeds are in m/s: {limit} km/h are {} m/s", short(limit / 3.6)),
        " m/s" if fits(centi) => format!("speeds are in m/s: {limit} cm/s are {} m/s", short(centi)),
        "" if fits(centi) && reach.high == 1.0 => format!("shares go from 0 to 1: {limit} % are {}", short(centi)),
        _ => "compare it with a number between these two, or leave the comparison out".to_owned(),
    }
}

/// Between which values a fact lies in this plan; nothing where any number may be meant.
fn reach(plan: &Plan, compared: &Compared) -> Option<Reach> {
    let settings = &plan.settings;
    let fact = compared.fact.as_str();
    let actions = &settings.actions;
    let most = |of: &dyn Fn(&engine::geometry::Twist) -> f64| {
        actions.iter().map(of).fold(0.0_f64, |a, b| f64::max(a, b.abs()))
    };
    let around =
        |most: f64, unit, whose| Reach { low: if compared.absolute { 0.0 } else { -most }, high: most, unit, whose };
    // What the wheels measure may be six deviations more than what was commanded.
    let noise = 1.0 + 6.0 * settings.robot.speed_noise;
    let number = |high: f64, whose| Reach { low: 0.0, high, unit: "", whose };
    Some(match fact {
        "action.linear" => around(most(&|twist| twist.linear_m_per_s), " m/s", "the actions"),
        "action.angular" => around(most(&|twist| twist.angular_rad_per_s), " rad/s", "the actions"),
        "robot.linear" => around(noise * most(&|twist| twist.linear_m_per_s), " m/s", "the wheels"),
        "robot.angular" => around(noise * most(&|twist| twist.angular_rad_per_s), " rad/s", "the wheels"),
        "action.index" => number(actions.len() as f64 - 1.0, "the numbers of the actions"),
        "state.index" => number(plan.grid().ok()?.states() as f64 - 1.0, "the numbers of the states"),
        "laser.nearest_beam" | "laser.beams" => number(settings.laser.beams as f64, "the numbers of the beams"),
        "time.step" | "time.since_recovery" => {
            number(settings.run.steps.max(settings.run.test_steps) as f64, "the steps of a run")
        }
        "camera.coverage" => number(1.0, "shares"),
        _ if fact.starts_with("camera.cell") => number(1.0, "shares"),
        _ if fact.contains(".excess") || !fact.starts_with("laser") => return None,
        _ if fact.contains(".count_below") => number(settings.laser.beams as f64, "the numbers of the beams"),
        _ => {
            // Noise reaches a little beyond; a limit there is no mistake of the unit.
            let laser = &settings.laser;
            let (low, high) = (laser.min_range_m, laser.max_range_m + 6.0 * laser.noise_m);
            Reach { low, high, unit: " m", whose: "the laser's beams" }
        }
    })
}
