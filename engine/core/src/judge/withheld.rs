//! What only the simulator knows, and people ask for first: the figure of the test that has it, and what is measured instead.

/// Words for one thing that a script is not told.
pub(crate) struct Withheld {
    words: &'static [&'static str],
    /// A condition of success that judges it.
    pub success: &'static str,
    /// The nearest that the robot measures.
    pub fact: &'static str,
}

/// Each such thing once.
pub(crate) const WITHHELD: &[Withheld] = &[
    Withheld {
        words: &["progress", "laps", "lap", "route", "waypoints", "closest_waypoints", "track_length", "is_reversed"],
        success: "test.laps > 3",
        fact: "odometry.forward_m, the way counted by the wheels",
    },
    Withheld {
        words: &["x", "y", "z", "pose", "position", "location", "heading", "yaw", "orientation", "distance"],
        success: "test.laps > 3",
        fact: "odometry.away_m and odometry.turned_deg, counted by the wheels",
    },
    Withheld {
        words: &["distance_from_center", "distance_from_centre", "is_left_of_center", "track_width", "route_offset"],
        success: "test.route_offset_m < 0.3",
        fact: "camera.line_offset_m, how far left of it the line passes that the view sees; between walls laser.left and laser.right",
    },
    Withheld {
        words: &["all_wheels_on_track", "is_offtrack", "off_track", "on_track", "off_route"],
        success: "test.off_route < 0.05",
        fact: "camera.seen, whether the filter sees anything",
    },
    Withheld {
        words: &["goal", "goals", "target_distance", "distance_to_goal", "goal_distance"],
        success: "test.goal_rate > 0.9",
        fact: "laser.front, the range ahead",
    },
    Withheld {
        words: &["objects_distance", "objects_location", "objects_heading", "closest_objects", "is_crashed_object"],
        success: "test.contacts_per_1000 < 1",
        fact: "laser.nearest, the least range",
    },
];

/// What is measured under another name.
pub(crate) const MEASURED: &[(&str, &str)] = &[
    ("speed", "robot.linear"),
    ("velocity", "robot.linear"),
    ("steering_angle", "action.angular"),
    ("steps", "time.since_recovery"),
    ("is_crashed", "robot.contact"),
];

/// The help for a word that stands for what a script is not told.
pub(crate) fn withheld(word: &str) -> Option<String> {
    let row = WITHHELD.iter().find(|row| row.words.contains(&word))?;
    Some(format!(
        "laps and places are judged by the test: success \"name\" when {}; the robot measures {}",
        row.success, row.fact
    ))
}

/// The fact that a word of other simulators stands for.
pub(crate) fn measured(word: &str) -> Option<&'static str> {
    MEASURED.iter().find(|(theirs, _)| *theirs == word).map(|(_, ours)| *ours)
}
