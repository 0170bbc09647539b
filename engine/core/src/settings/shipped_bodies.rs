//! The body files that ship with the engine.

use crate::diagnostic::SourceText;

macro_rules! shipped {
    ($($name:literal,)*) => {
        /// Every body that ships: its name and its file.
        pub(crate) const SHIPPED_BODIES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../../robots/", $name, ".toml")))),*];
    };
}

shipped! {
    "duckiebot",
    "f1tenth",
    "pioneer2at",
    "turtlebot3",
}

/// The file of a body that ships.
pub(crate) fn shipped_body(name: &str) -> Option<SourceText> {
    let (_, text) = SHIPPED_BODIES.iter().find(|(shipped, _)| *shipped == name)?;
    Some(SourceText::new(format!("robots/{name}.toml"), *text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Footprint, Settings, read_body};

    fn settings(name: &str) -> Settings {
        let mut settings = Settings::default();
        read_body(&shipped_body(name).unwrap(), &mut settings).unwrap_or_else(|wrong| panic!("{wrong:?}"));
        settings
    }

    #[test]
    fn the_pioneer_is_the_robot_of_a_script_that_names_none() {
        assert_eq!(settings("pioneer2at"), Settings::default());
    }

    #[test]
    fn every_shipped_body_can_do_its_actions() {
        for (name, _) in SHIPPED_BODIES {
            let settings = settings(name);
            assert!(name == &"pioneer2at" || settings.robot.body != Settings::default().robot.body);
            let can = |twist| settings.robot.drive.refuses(twist).is_none();
            assert!(settings.actions.iter().filter(|twist| can(**twist)).count() >= 5, "{name}");
        }
    }

    #[test]
    fn the_car_turns_about_its_rear_axle() {
        let robot = settings("f1tenth").robot;
        let Footprint::Rectangle { ahead_m, .. } = robot.body.footprint else { panic!() };
        let bicycle = robot.drive.bicycle.unwrap();
        assert_eq!((bicycle.wheelbase_m, robot.body.wheelbase_m), (0.33, 0.33));
        assert!((ahead_m - 0.5 * bicycle.wheelbase_m).abs() < 0.02, "{ahead_m}");
    }
}
