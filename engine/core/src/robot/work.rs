//! What one look at a world may cost: counted work, the same on every machine.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::site::{Site, in_view};
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::geometry::Pose;
use crate::sensors::observation::{Image, Scan};
use crate::settings::Settings;
use crate::world::Layout;
use filter_api::Format;

/// Rows of faces, runs of pixels, beams held against solids: of one image and one scan together. A look of so much work
/// takes some 15 ms on a slow machine; those of the shipped worlds take a hundredth of it.
const MOST_WORK: u64 = 500_000;
/// Worlds of fewer solids than these are looked at from nowhere before they are driven in: they cannot be too much.
const FEW_SOLIDS: usize = 200;
/// After so much work a world has been looked at enough beforehand.
const MOST_SURVEY: u64 = 10 * MOST_WORK;
/// Directions in which it is looked at from each start.
const HEADINGS: u32 = 8;

/// Refuses what the last image and scan took, if it is too much.
///
/// # Errors
/// `E-WORLD-WORK`.
pub(super) fn check(site: &Site) -> Result<()> {
    if site.camera.lacks_shadows() {
        let name = printable(&site.world.layout().name);
        let message =
            format!("the shadows of the world '{name}' are too much to compute: large solids that shade one another");
        let help = "take out solids that stand within one another, make them smaller, or leave light.shadows off";
        return Diagnostic::new("E-WORLD-SHADOWS", message).help(help).fail();
    }
    let (camera, laser) = (site.camera.work(), site.laser.work());
    if camera + laser <= MOST_WORK {
        return Ok(());
    }
    let (layout, pose) = (site.world.layout(), site.world.body(0).pose);
    let message = format!(
        "the world '{}' is too much to look at from x {:.1} m, y {:.1} m: {} units of work for one image and {} for one \
         scan, at most {MOST_WORK} together",
        printable(&layout.name),
        pose.x_m,
        pose.y_m,
        camera,
        laser
    );
    let dear = if camera > laser { "faces that cover many rows of the image" } else { "solids that many beams meet" };
    let help = format!("take out solids that stand within one another or are hidden: there are too many {dear}");
    Diagnostic::new("E-WORLD-WORK", message).help(help).fail()
}

/// Looks at a world from its starts in all directions, before anybody learns in it.
///
/// # Errors
/// As [`check`].
pub(super) fn survey(layout: &Arc<Layout>, settings: &Settings) -> Result<()> {
    let shaded = layout.scene.parts().light.shadows || settings.camera.light.shadows;
    if layout.scene.parts().solids.len() < FEW_SOLIDS && !shaded {
        return Ok(());
    }
    let mut site = Site::new(layout, settings, 0, 0);
    let (mut image, mut scan) = (Image::of(Format::Grey, 0, 0), Scan { ranges_m: Vec::new() });
    let mut left = MOST_SURVEY;
    for start in &layout.starts {
        for turn in 0..HEADINGS {
            let yaw_rad = start.pose.yaw_rad + TAU * f64::from(turn) / f64::from(HEADINGS);
            site.world.place(0, Pose { yaw_rad, ..start.pose });
            let world_from_robot = site.world.body(0).world_from_robot();
            if settings.sees() {
                site.camera.render(&world_from_robot, in_view(&site.world, &mut site.own), &mut image);
            }
            site.laser.scan(&world_from_robot, site.world.seen_by(0), &mut scan);
            check(&site)?;
            left = left.saturating_sub(site.camera.work() + site.laser.work());
            if left == 0 {
                return Ok(());
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::robot::SimulatedRobot;
    use crate::settings::RecoverTo;

    /// A world with so many solids before its start.
    fn world(count: usize, solid: impl Fn(usize) -> String) -> Arc<Layout> {
        let solids: String = (0..count).map(solid).collect();
        let text = format!("[[start]]\nposition_m = [0, 0]\n{solids}");
        Arc::new(Layout::parse(SourceText::new("w.toml", text), &Settings::default().robot.body).unwrap())
    }

    fn tried(layout: &Arc<Layout>) -> Result<()> {
        let mut settings = Settings::default();
        settings.recovery.to = RecoverTo::Start;
        SimulatedRobot::new(layout, &settings, 1).map(drop)
    }

    #[test]
    fn shadows_that_take_too_much_are_refused() {
        // Each shades all the others and the floor around them.
        let large = world(400, |index| {
            let x = 4.0 + (index % 50) as f64 * 0.01;
            format!("[[box]]\ncentre_m = [{x}, 0]\nsize_m = [4, 9, 900]\n")
        });
        let mut settings = Settings::default();
        settings.recovery.to = RecoverTo::Start;
        settings.camera.light.shadows = true;
        let wrong = SimulatedRobot::new(&large, &settings, 1).map(drop).unwrap_err();
        assert_eq!(wrong.code, "E-WORLD-SHADOWS");
    }

    #[test]
    fn solids_within_one_another_are_refused_and_the_same_ones_apart_are_not() {
        let within = |index: usize| {
            let (x, y) = (2.0 + (index % 50) as f64 * 0.01, (index / 50) as f64 * 0.01 - 0.1);
            format!("[[cylinder]]\ncentre_m = [{x}, {y}]\nradius_m = 0.3\nheight_m = 2\n")
        };
        let same = world(1000, within);
        let wrong = tried(&same).unwrap_err();
        assert_eq!(wrong.code, "E-WORLD-WORK");
        assert!(wrong.message.contains("'w' is too much to look at from x 0.0 m, y 0.0 m"), "{}", wrong.message);
        let apart = |index: usize| {
            let (x, y) = (3 + index % 45, index as i64 / 45 - 22);
            format!("[[box]]\ncentre_m = [{x}, {y}]\nsize_m = [0.4, 0.4, 0.5]\n")
        };
        assert!(tried(&world(2000, apart)).is_ok());
    }
}
