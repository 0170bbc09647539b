//! What a filter cannot see in this world with this camera, known without a step.

use std::ops::Range;

use super::Finding;
use engine::experiment::Plan;
use engine::geometry::Vector3;
use engine::settings::{FilterSettings, ViewSettings};
use engine::world::scene::{SceneParts, Shape, Solid, Texture};

pub(super) fn check_filters(plan: &Plan, findings: &mut Vec<Finding>) {
    for view in plan.settings.views() {
        for (index, filter) in view.filters.iter().enumerate() {
            let Some(span) = plan.behaviour.place_of(&view.place(&format!("filter:{index}"))) else { continue };
            match filter.name.as_str() {
                "chroma" => alike(plan, "colour", span, of_one_colour(filter), findings),
                "floor" if value(filter, "memory", 0.0) != 0.0 => {
                    alike(plan, "grey", span, of_one_grey(filter), findings);
                }
                _ => {}
            }
        }
    }
    unread_depth(plan, findings);
}

/// A parameter as it is written, or its default.
fn value(filter: &FilterSettings, name: &str, default: f64) -> f64 {
    filter.parameters.iter().find(|(key, _)| key == name).map_or(default, |(_, value)| *value)
}

/// A depth camera that no filter looks at.
fn unread_depth(plan: &Plan, findings: &mut Vec<Finding>) {
    let reads = |view: &ViewSettings| {
        let by_condition =
            |filter: &FilterSettings| filter.condition.as_ref().is_some_and(|text| text.contains("nearness"));
        let own = |filter: &FilterSettings| filter.name == "relief" || !plan.filters.is_own(&filter.name);
        view.filters.first().is_some_and(|filter| own(filter) || by_condition(filter))
    };
    let Some(span) = plan.behaviour.place_of("camera.depth").filter(|_| plan.settings.camera.depth) else { return };
    if plan.used.is_empty() && !plan.settings.views().any(reads) {
        let message = "the camera measures depth, and no filter reads it";
        let help = "add a filter that does, such as filter(\"relief\"), or leave depth out";
        findings.push(Finding::warning(plan, "W-UNUSED", span, message).say("not used", help));
    }
}

/// Something to run into whose face looks to the filter like the floor.
fn alike(
    plan: &Plan,
    what: &str,
    span: Range<usize>,
    words: impl Fn([f64; 3], [f64; 3]) -> Option<String>,
    findings: &mut Vec<Finding>,
) {
    let parts = plan.layout.scene.parts();
    let plain = |material: usize| matches!(parts.materials[material].texture, Texture::Plain);
    if !plain(parts.floor) {
        return;
    }
    let light = parts.light.changed(&plan.settings.camera.light);
    let seen = |material: usize, normal: &Vector3| seen(parts, light.on(normal), material);
    let floor = seen(parts.floor, &Vector3::z());
    let solids = parts.solids.iter().filter(|solid| solid.collides && plain(solid.material));
    let found = solids
        .flat_map(|solid| sides(solid).map(move |side| (solid.material, side)))
        .find_map(|(material, side)| Some((material, words(seen(material, &side), floor)?)));
    if let Some((material, words)) = found {
        let name = &parts.materials[material].name;
        let message = format!("a face of '{name}' has the {what} of the floor: {words}");
        let help =
            "no such filter can see that face: take another colour or light, or a depth camera with filter(\"relief\")";
        findings.push(Finding::warning(plan, "W-LOOK-ALIKE", span, message).say("cannot see it", help));
    }
}

/// What `floor` with a memory says of two colours: the greys, if they are within its levels.
fn of_one_grey(filter: &FilterSettings) -> impl Fn([f64; 3], [f64; 3]) -> Option<String> {
    let levels = value(filter, "levels", 6.0);
    move |face, floor| {
        let [face, floor] =
            [face, floor].map(|[red, green, blue]| ((77.0 * red + 150.0 * green + 29.0 * blue) / 256.0).floor());
        ((face - floor).abs() <= levels).then(|| format!("{face} is within {levels} of {floor}"))
    }
}

/// What `chroma` says of two colours: how far they are apart, if within its tolerance.
fn of_one_colour(filter: &FilterSettings) -> impl Fn([f64; 3], [f64; 3]) -> Option<String> {
    let tolerance = value(filter, "tolerance", 0.06);
    move |face, floor| {
        let share = |[red, green, blue]: [f64; 3]| {
            let all = (red + green + blue).max(1.0);
            [red / all, blue / all]
        };
        let (face, floor) = (share(face), share(floor));
        let apart = (face[0] - floor[0]).abs() + (face[1] - floor[1]).abs();
        (apart <= tolerance).then(|| format!("their shares of red and blue are {apart:.3} apart, within {tolerance}"))
    }
}

/// The colour that a face of a material has under light of a brightness.
fn seen(parts: &SceneParts, light: f64, material: usize) -> [f64; 3] {
    parts.materials[material].colour.map(|level| (f64::from(level) * light).round().clamp(0.0, 255.0))
}

/// The normals of the upright faces of a solid; of a cylinder, whose shade goes all round, none.
fn sides(solid: &Solid) -> impl Iterator<Item = Vector3> + use<> {
    let (sin, cos) = libm::sincos(solid.yaw_rad);
    let count = if matches!(solid.shape, Shape::Cylinder { .. }) { 0 } else { 4 };
    let sides = [[cos, sin], [-sin, cos], [-cos, -sin], [sin, -cos]];
    sides.into_iter().take(count).map(|[x, y]| Vector3::new(x, y, 0.0))
}
