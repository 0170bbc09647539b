//! A camera or a laser that is mounted where the body cannot carry it, or that looks at the body.

use super::Finding;
use engine::experiment::Plan;
use engine::sensors::CameraRays;

/// A mount may stand out so far, or lie so deep, before it is told, metres: a lens has a length.
const LEEWAY_M: f64 = 0.05;
/// Of so many rows of an image one may show the body before it is told.
const ROWS_FOR_ONE: usize = 10;

pub(super) fn check_mounts(plan: &Plan, findings: &mut Vec<Finding>) {
    let (body, camera, laser) = (plan.settings.robot.body, &plan.settings.camera, &plan.settings.laser);
    let deck_m = camera.deck_m.min(body.height_m);
    let mounts = [
        ("camera", camera.forward_m, camera.height_m, body.height_m),
        ("laser", laser.forward_m, laser.height_m, deck_m - LEEWAY_M),
    ];
    for (name, forward_m, height_m, top_m) in mounts {
        let place = |key: &str| plan.behaviour.place_of(key);
        let keys = ["forward_m", "height_m", "tilt_deg"];
        let own = keys.iter().find_map(|key| place(&format!("{name}.{key}")));
        let Some(span) = own.or_else(|| place("robot")) else { continue };
        let outside_m = body.footprint.outside_m(forward_m, 0.0);
        let (rows, height_px) = (body_rows(plan), camera.height_px);
        if outside_m > LEEWAY_M {
            let message = format!("the {name} stands {outside_m:.2} m outside of the body: it passes through walls");
            let help = format!("set {name}.forward_m to what the body reaches, or make the body longer");
            findings.push(Finding::warning(plan, "W-MOUNT", span, message).say("beyond the body", help));
        } else if outside_m < -LEEWAY_M && height_m < top_m {
            let top_m = if name == "camera" { body.height_m } else { deck_m };
            let message =
                format!("the {name} stands inside the body, which is {top_m} m high: it looks through its walls");
            let help = format!("set {name}.height_m above {top_m}, or {name}.forward_m to the front of the body");
            findings.push(Finding::warning(plan, "W-MOUNT", span, message).say("inside the body", help));
        } else if name == "camera" && !camera.own_body && rows * ROWS_FOR_ONE > height_px as usize {
            let message = format!(
                "a camera there looks at the robot's own body in {rows} of {height_px} rows, and the image does not show it"
            );
            let help = "write camera(#{ own_body: true }) to draw it, tilt the camera less, or say by camera.deck_m how high the body is below it";
            findings
                .push(Finding::warning(plan, "W-MOUNT", span, message).say("the body is in its view", help.to_owned()));
        }
    }
}

/// How many rows in the middle of the camera's image would show the body.
fn body_rows(plan: &Plan) -> usize {
    let (body, camera) = (plan.settings.robot.body, &plan.settings.camera);
    let below_m = camera.height_m - camera.deck_m.min(body.height_m);
    let rays = CameraRays::new(camera);
    let shows_body = |row: &u64| {
        let ray = rays.ray(0.5 * camera.width_px as f64, *row as f64 + 0.5);
        let meets_m = camera.forward_m - ray.x * below_m / ray.z;
        below_m > 0.0 && ray.z < 0.0 && body.footprint.outside_m(meets_m, 0.0) < 0.0
    };
    (0..camera.height_px).filter(shows_body).count()
}
