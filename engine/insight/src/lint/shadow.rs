//! Rules that an earlier rule always forestalls: it recovers whenever they could fire.

use super::Finding;
use engine::diagnostic::printable;
use engine::experiment::Plan;
use engine::judge::{Comparison, FactId, Reach};
use engine::script::{Compared, Condition};

pub(super) fn check_shadows(plan: &Plan, findings: &mut Vec<Finding>) {
    let (outline, rules) = (plan.behaviour.outline(), plan.behaviour.rules());
    let Ok(judge) = plan.judge() else { return };
    for (index, rule) in outline.rules.iter().enumerate() {
        let earlier = outline.rules[..index].iter().enumerate().find(|(before, earlier)| {
            let sooner = judge.held(*before).1 <= judge.held(index).1;
            earlier.then.is_some() && sooner && implies(&rule.condition, &earlier.condition)
        });
        let Some((before, _)) = earlier else { continue };
        let (name, first) = (printable(&rules[index].name), printable(&rules[before].name));
        let message = format!("rule \"{name}\" never fires: rule \"{first}\" recovers first");
        let label = format!("whenever this holds, \"{first}\" in line {} holds too", rules[before].line);
        let help = format!("put \"{name}\" before \"{first}\", or make the two conditions exclude each other");
        findings.push(Finding::warning(plan, "W-RULE-SHADOWED", rule.condition_span.clone(), message).say(label, help));
    }
}

/// Whether `b` holds wherever `a` does, as far as it can be told.
fn implies(a: &Condition, b: &Condition) -> bool {
    match (a, b) {
        (Condition::Other, _) | (_, Condition::Other) => false,
        (Condition::Any(parts), _) => parts.iter().all(|part| implies(part, b)),
        (_, Condition::All(parts)) => parts.iter().all(|part| implies(a, part)),
        (_, Condition::Any(parts)) if parts.iter().any(|part| implies(a, part)) => true,
        (Condition::All(parts), _) => parts.iter().any(|part| implies(part, b)),
        (Condition::Flag(fact, denied), Condition::Flag(other, also)) => fact == other && denied == also,
        (Condition::Compare(a), Condition::Compare(b)) => narrower(a, b),
        _ => false,
    }
}

/// Whether the values that `a` allows are among those that `b` allows.
fn narrower(a: &Compared, b: &Compared) -> bool {
    use Comparison::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual};
    if a.absolute != b.absolute {
        return false;
    }
    let same = a.fact == b.fact;
    // No beam is nearer than the nearest, none farther than the farthest.
    let is_range = a.fact.id.fact().reach == Reach::Laser;
    let below = same || b.fact.id == FactId::LaserNearest && is_range;
    let above = same || b.fact.id == FactId::LaserFarthest && is_range;
    match (a.comparison, b.comparison) {
        (Less, Less | LessOrEqual) | (LessOrEqual | Equal, LessOrEqual) => below && a.limit <= b.limit,
        (LessOrEqual | Equal, Less) => below && a.limit < b.limit,
        (Greater, Greater | GreaterOrEqual) | (GreaterOrEqual | Equal, GreaterOrEqual) => above && a.limit >= b.limit,
        (GreaterOrEqual | Equal, Greater) => above && a.limit > b.limit,
        (Equal, Equal) => same && a.limit == b.limit,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::script::NamedFact;

    fn named(id: FactId) -> NamedFact {
        NamedFact { id, path: id.fact().name() }
    }

    fn compare(id: FactId, comparison: Comparison, limit: f64) -> Condition {
        Condition::Compare(Compared { fact: named(id), absolute: false, comparison, limit, span: 0..0 })
    }

    #[test]
    fn a_narrower_threshold_implies_a_wider_one() {
        let (near, nearer) = (
            compare(FactId::LaserNearest, Comparison::Less, 0.5),
            compare(FactId::LaserNearest, Comparison::LessOrEqual, 0.3),
        );
        assert!(implies(&nearer, &near) && !implies(&near, &nearer));
    }

    #[test]
    fn a_near_beam_implies_a_near_laser() {
        let (one, all) =
            (compare(FactId::LaserBeam, Comparison::Less, 0.3), compare(FactId::LaserNearest, Comparison::Less, 0.3));
        assert!(implies(&one, &all) && !implies(&all, &one));
    }

    #[test]
    fn both_of_two_imply_each_of_them() {
        let (a, b) =
            (compare(FactId::LaserLeft, Comparison::Less, 1.0), Condition::Flag(named(FactId::CameraSeen), false));
        let both = Condition::All(vec![a.clone(), b.clone()]);
        let either = Condition::Any(vec![a.clone(), b.clone()]);
        assert!(implies(&both, &a) && implies(&both, &either) && implies(&a, &either));
        assert!(!implies(&either, &a) && !implies(&a, &both));
    }
}
