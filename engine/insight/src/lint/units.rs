//! Numbers that no fact can be compared with: centimetres for metres, degrees for radians, percent for shares.

use super::Finding;
use crate::words::short;
use engine::experiment::Plan;
use engine::geometry::Twist;
use engine::judge::{Reach, Unit};
use engine::script::Compared;

/// Between which values a fact lies in a plan.
struct Allowed {
    low: f64,
    high: f64,
    unit: Unit,
    whose: &'static str,
}

pub(super) fn check_units(plan: &Plan, findings: &mut Vec<Finding>) {
    let mut seen = Vec::new();
    for compared in plan.behaviour.outline().all_comparisons() {
        let Some(allowed) = allowed(plan, compared) else { continue };
        let (limit, symbol) = (compared.limit, symbol(allowed.unit));
        if allowed.contains(limit) || seen.contains(&compared.span.start) {
            continue;
        }
        seen.push(compared.span.start);
        let message = format!("{} is never near {limit}{symbol}", compared.fact.path);
        let label = format!("{} give {} to {}{symbol}", allowed.whose, short(allowed.low), short(allowed.high));
        let finding = Finding::warning(plan, "W-UNIT", compared.span.clone(), message);
        findings.push(finding.say(label, help(&allowed, limit)));
    }
}

impl Allowed {
    fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// What stands behind a number of this unit.
fn symbol(unit: Unit) -> &'static str {
    match unit {
        Unit::Metres => " m",
        Unit::MetresPerSecond => " m/s",
        Unit::RadiansPerSecond => " rad/s",
        _ => "",
    }
}

fn help(allowed: &Allowed, limit: f64) -> String {
    let fits = |value: f64| allowed.contains(value) && value != 0.0;
    let (centi, milli, radians) = (limit / 100.0, limit / 1000.0, limit.to_radians());
    match allowed.unit {
        Unit::Metres if fits(centi) => format!("ranges are in metres: {limit} cm are {} m", short(centi)),
        Unit::Metres if fits(milli) => format!("ranges are in metres: {limit} mm are {} m", short(milli)),
        Unit::RadiansPerSecond if fits(radians) => {
            format!("turns are in radians: {limit} degrees are {} rad", short(radians))
        }
        Unit::MetresPerSecond if fits(limit / 3.6) => {
            format!("speeds are in m/s: {limit} km/h are {} m/s", short(limit / 3.6))
        }
        Unit::MetresPerSecond if fits(centi) => format!("speeds are in m/s: {limit} cm/s are {} m/s", short(centi)),
        Unit::Degrees => "angles of this fact are in degrees: compare it with a number between these two".to_owned(),
        Unit::Share if fits(centi) => format!("shares go from 0 to 1: {limit} % are {}", short(centi)),
        _ => "compare it with a number between these two, or leave the comparison out".to_owned(),
    }
}

/// Between which values a fact lies in this plan; nothing where any number may be meant.
fn allowed(plan: &Plan, compared: &Compared) -> Option<Allowed> {
    let (settings, unit) = (&plan.settings, compared.fact.id.fact().unit);
    let actions = &settings.actions;
    let fastest = || {
        let speed = |twist: &Twist| match unit {
            Unit::RadiansPerSecond => twist.angular_rad_per_s,
            _ => twist.linear_m_per_s,
        };
        actions.iter().map(speed).fold(0.0_f64, |a, b| f64::max(a, b.abs()))
    };
    let between = |low: f64, high: f64, whose| Some(Allowed { low, high, unit, whose });
    let around = |most: f64, whose| between(if compared.absolute { 0.0 } else { -most }, most, whose);
    // Noise reaches a little beyond, six deviations at most; a limit there is no mistake of the unit.
    match compared.fact.id.fact().reach {
        Reach::Commanded => around(fastest(), "the actions"),
        Reach::Measured => around((1.0 + 6.0 * settings.robot.speed_noise) * fastest(), "the wheels"),
        Reach::Actions => between(0.0, actions.len() as f64 - 1.0, "the numbers of the actions"),
        Reach::States => between(0.0, plan.state_map().ok()?.states() as f64 - 1.0, "the numbers of the states"),
        Reach::Beams => between(0.0, settings.laser.beams as f64, "the numbers of the beams"),
        Reach::Steps => between(0.0, settings.run.steps.max(settings.run.test_steps) as f64, "the steps of a run"),
        Reach::Between(low, high) => between(low, high, if unit == Unit::Share { "shares" } else { "its values" }),
        // Where nothing is seen it is farther than any limit: that is no mistake of the unit.
        Reach::Seen(low, high, unseen) => between(low.min(unseen), high.max(unseen), "its values"),
        Reach::Laser => {
            let laser = &settings.laser;
            between(laser.min_range_m, laser.max_range_m, "the laser's beams")
        }
        Reach::Accident | Reach::Any => None,
    }
}
