//! Whether the robot can stand on every start of a world.

use super::Obstruction;
use super::build::Built;
use super::reader::FileRow;
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::geometry::Pose;
use crate::world::footprint::Obstacle;

/// Checks that each start is free and on the ground.
///
/// # Errors
/// `E-WORLD-START` for each that is not.
pub(super) fn check_starts(world: &Built) -> Result<()> {
    let mut mistakes = Mistakes::new(&world.layout.source);
    for (row, &start) in world.file.rows("start").iter().zip(&world.layout.starts) {
        mistakes.take(check_start(world, row, start));
    }
    mistakes.end()
}

fn check_start(Built { layout, origins, .. }: &Built, row: &FileRow, start: Pose) -> Result<()> {
    let source = &layout.source;
    let at = |message: String, label: String| {
        Diagnostic::new("E-WORLD-START", message).at(source, row.span_of("position_m"), label)
    };
    let place = format!("the start at ({}, {})", start.x_m, start.y_m);
    match layout.obstruction(start) {
        Some(Obstruction::Solid(solid)) => {
            let (section, span) = &origins[solid];
            let line = source.position(span.start).0;
            return at(format!("{place} is inside a solid"), format!("overlaps the {section} of line {line}"))
                .help("the robot needs 0.5 m by 0.48 m around this place, along its heading")
                .fail();
        }
        Some(Obstruction::NoGround) => {
            return at(format!("{place} has no ground under all of the robot"), "it would fall".to_owned())
                .help("move it at least 0.35 m away from every edge")
                .fail();
        }
        None => {}
    }
    let stance = layout.terrain().put(&layout.scene, start).stance;
    for mover in &layout.movers {
        let mut solids = mover.solids.clone();
        mover.arrange(mover.pose_at(&layout.routes, 0.0), &mut solids);
        if solids.iter().any(|solid| Obstacle::new(solid).touches(&stance)) {
            let name = printable(&mover.name);
            return at(format!("{place} is inside a mover"), format!("overlaps '{name}' at time 0"))
                .help("move the start, or change the mover's 'offset_m'")
                .fail();
        }
    }
    Ok(())
}
