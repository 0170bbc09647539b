//! Whether the robot can stand on every start of a world.

use super::Obstruction;
use super::build::Built;
use super::reader::FileRow;
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::geometry::Pose;
use crate::settings::{BodyShape, Footprint};
use crate::world::obstacle::Obstacle;

/// Checks that each start is free and on the ground.
///
/// # Errors
/// `E-WORLD-START` for each that is not.
pub(super) fn check_starts(world: &Built, body: &BodyShape) -> Result<()> {
    let mut mistakes = Mistakes::new(&world.layout.source);
    for (row, start) in world.file.rows("start").iter().zip(&world.layout.starts) {
        mistakes.take(check_start(world, body, row, start.pose));
    }
    mistakes.end()
}

fn check_start(Built { layout, origins, .. }: &Built, body: &BodyShape, row: &FileRow, start: Pose) -> Result<()> {
    let source = &layout.source;
    let at = |message: String, label: String| {
        Diagnostic::new("E-WORLD-START", message).at(source, row.span_of("position_m"), label)
    };
    let place = format!("the start at ({}, {})", start.x_m, start.y_m);
    match layout.obstruction(body, start) {
        Some(Obstruction::Solid(solid)) => {
            let (section, span) = &origins[solid];
            let line = source.position(span.start).0;
            return at(format!("{place} is inside a solid"), format!("overlaps the {section} of line {line}"))
                .help(format!("the robot needs {}", room(body)))
                .fail();
        }
        Some(Obstruction::NoGround) => {
            return at(format!("{place} has no ground under all of the robot"), "it would fall".to_owned())
                .help(format!("move it at least {} m away from every edge", centimetres(body.radius_m())))
                .fail();
        }
        None => {}
    }
    let stance = layout.terrain().put(&layout.scene, body, start).stance;
    for mover in &layout.movers {
        let mut solids = mover.solids.clone();
        mover.arrange(mover.pose_at(&layout.routes, 0.0), &mut solids);
        if solids.iter().any(|solid| Obstacle::new(solid).touches(body, &stance)) {
            let name = printable(&mover.name);
            return at(format!("{place} is inside a mover"), format!("overlaps '{name}' at time 0"))
                .help("move the start, or change the mover's 'offset_m'")
                .fail();
        }
    }
    Ok(())
}

/// The room that a body takes, in words.
fn room(body: &BodyShape) -> String {
    match body.footprint {
        Footprint::Rectangle { length_m, width_m, .. } => {
            let (length_m, width_m) = (centimetres(length_m), centimetres(width_m));
            format!("{length_m} m by {width_m} m around this place, along its heading")
        }
        Footprint::Round { radius_m } => format!("{} m on all sides of this place", centimetres(radius_m)),
    }
}

/// Metres, rounded up to whole centimetres.
fn centimetres(metres: f64) -> f64 {
    (metres * 100.0).ceil() / 100.0
}
