//! The default of every setting: the paper's robot and its way of learning. What an edition decides stands in `edition.rs`.

use super::{
    BodyShape, CameraSettings, CombineSettings, CombineWay, DriveLimits, GroundSettings, LaserSettings, LearnerKind,
    LearnerSettings, Lens, LightSettings, MoverSettings, RecoverTo, RecoverySettings, RobotSettings, RunSettings,
    Settings, StartSettings, UNNAMED_VIEW, ViewSettings,
};
use crate::geometry::Twist;

/// Table 2 of the paper: forward speed in m/s, turning speed in rad/s.
const PAPER_ACTIONS: [(f64, f64); 14] = [
    (0.4, 0.2),
    (0.4, 0.0),
    (0.4, -0.2),
    (0.2, 0.8),
    (0.2, 0.6),
    (0.2, 0.4),
    (0.2, 0.2),
    (0.2, 0.0),
    (0.2, -0.2),
    (0.2, -0.4),
    (0.2, -0.6),
    (0.2, -0.8),
    (0.05, 0.8),
    (0.05, -0.8),
];

impl Settings {
    /// What is the same in every edition.
    pub(super) fn of_every_edition() -> Self {
        Self {
            world: "room".to_owned(),
            worlds: Vec::new(),
            randomise: Vec::new(),
            view: ViewSettings::named(UNNAMED_VIEW),
            further_views: Vec::new(),
            state: Vec::new(),
            actions: PAPER_ACTIONS.iter().map(|&(linear, angular)| Twist::new(linear, angular)).collect(),
            run: RunSettings { steps: 5_200, test_steps: 5_000, period_s: 0.5, stay_steps: 150 },
            robot: RobotSettings {
                body: BodyShape::pioneer2at(),
                drive: DriveLimits::default(),
                lag_s: 0.15,
                speed_noise: 0.05,
                slip: 0.0,
                tick_s: 0.05,
            },
            camera: camera(),
            laser: laser(),
            ground: GroundSettings { ahead_m: 0.1, aside_m: 0.15 },
            learner: learner(),
            recovery: RecoverySettings {
                to: RecoverTo::Nearest,
                at: None,
                distance_m: 1.1,
                position_m: 0.1,
                yaw_deg: 8.6,
            },
            movers: MoverSettings { speed: 1.0 },
            starts: StartSettings::default(),
            stages: Vec::new(),
            policies: Vec::new(),
            combine: CombineSettings { way: CombineWay::Priority, margin: 0.5, scaled: false },
        }
    }
}

/// The camera stands 53 cm above the robot's deck (paper, section 4.1) with the deck at 0.28 m.
fn camera() -> CameraSettings {
    CameraSettings {
        width_px: 160,
        height_px: 120,
        field_of_view_deg: 80.0,
        lens: Lens::Pinhole,
        forward_m: 0.10,
        height_m: 0.81,
        tilt_deg: 42.0,
        noise: 2.0,
        exposure_drift: 0.0,
        white_balance_drift: 0.0,
        own_body: false,
        depth: false,
        depth_noise: 0.005,
        depth_holes: 0.0,
        deck_m: 0.25,
        light: LightSettings {
            gain: 1.0,
            ambient: 0.0,
            turn_deg: 0.0,
            raise_deg: 0.0,
            shadows: false,
            softness_deg: 0.0,
        },
    }
}

/// The range limits are those of the SICK LMS 200 in Gazebo 0.7, the simulator of the paper's time.
fn laser() -> LaserSettings {
    LaserSettings {
        beams: 181,
        field_of_view_deg: 180.0,
        forward_m: 0.18,
        height_m: 0.38,
        tilt_deg: 0.0,
        min_range_m: 0.20,
        max_range_m: 8.192,
        noise_m: 0.005,
    }
}

/// Table 1 of the paper.
fn learner() -> LearnerSettings {
    LearnerSettings {
        kind: LearnerKind::Ttd,
        step_size: 0.2,
        discount: 0.99,
        trace_decay: 0.9,
        window: 3,
        temperature: 0.07,
        temperature_end: 0.009,
        cooling_visits: 500,
        initial_low: -1.0,
        initial_high: -0.9,
        failure_is_terminal: false,
        mirror: false,
        replay: 0,
        memory_steps: 12_000,
        memory_discount: 0.98,
        memory_lambda: 0.85,
    }
}
