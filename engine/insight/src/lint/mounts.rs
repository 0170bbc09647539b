//! A camera or a laser that is mounted where the body cannot carry it.

use super::Finding;
use engine::experiment::Plan;

/// A mount may stand out so far, or lie so deep, before it is told, metres: a lens has a length.
const LEEWAY_M: f64 = 0.05;

pub(super) fn check_mounts(plan: &Plan, findings: &mut Vec<Finding>) {
    let (body, camera, laser) = (plan.settings.robot.body, &plan.settings.camera, &plan.settings.laser);
    let mounts = [("camera", camera.forward_m, camera.height_m), ("laser", laser.forward_m, laser.height_m)];
    for (name, forward_m, height_m) in mounts {
        let place = |key: &str| plan.behaviour.place_of(key);
        let own = place(&format!("{name}.forward_m")).or_else(|| place(&format!("{name}.height_m")));
        let Some(span) = own.or_else(|| place("robot")) else { continue };
        let outside_m = body.footprint.outside_m(forward_m, 0.0);
        if outside_m > LEEWAY_M {
            let message = format!("the {name} stands {outside_m:.2} m outside of the body: it passes through walls");
            let help = format!("set {name}.forward_m to what the body reaches, or make the body longer");
            findings.push(Finding::warning(plan, "W-MOUNT", span, message).say("beyond the body", help));
        } else if name == "camera" && outside_m < -LEEWAY_M && height_m < body.height_m {
            let top_m = body.height_m;
            let message =
                format!("the camera stands inside the body, which is {top_m} m high: it looks through its walls");
            let help = format!("set camera.height_m above {top_m}, or camera.forward_m to the front of the body");
            findings.push(Finding::warning(plan, "W-MOUNT", span, message).say("inside the body", help));
        }
    }
}
