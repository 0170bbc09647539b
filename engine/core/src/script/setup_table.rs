//! The one list of set-up calls: scripts, near names, the reference page and editors read it.

/// One row of the list of set-up calls.
#[derive(Debug, Clone, Copy)]
pub(super) struct SetupCall {
    /// Its name: `camera`.
    pub name: &'static str,
    /// How it is written.
    pub form: &'static str,
    /// One sentence: what it sets.
    pub purpose: &'static str,
}

const fn row(name: &'static str, form: &'static str, purpose: &'static str) -> SetupCall {
    SetupCall { name, form, purpose }
}

/// Every set-up call.
pub(super) const SETUP: &[SetupCall] = &[
    row(
        "edition",
        "edition(2);",
        "The edition of the language whose defaults the script has; without it the newest, in a pack that of the pack.",
    ),
    row("world", "world(\"room\");", "The world to learn in: its name, or the path of a world file."),
    row(
        "worlds",
        "worlds(#{ \"room\": 3, \"corridors:1-12\": 1 });",
        "Several worlds, equally likely or by weights: after each attempt the next one is drawn. `corridors:7` is made by rule, `corridors:1-12` are twelve that share one weight.",
    ),
    row(
        "randomise",
        "randomise(#{ \"camera.tilt_deg\": [40, 44] });",
        "What is drawn anew for each attempt: from a range of two numbers, or one of three or more numbers, of words or of flags.",
    ),
    row(
        "filter",
        "filter(\"sobel\", #{ threshold: 60 });",
        "One stage of the filter chain; several calls make a chain.",
    ),
    row(
        "view",
        "view(\"red\", filter(\"colour\"), grid(#{ rows: 2, columns: 3 }));",
        "One more way of looking at the image: a name, a chain of filters, a grid. Its facts are read by its name: `red.seen`.",
    ),
    row(
        "state",
        "state(\"red\", bins(laser.front, [0.5, 1.0]));",
        "What the learner sees: views by their names, and values told apart by ranges. Without it, all views.",
    ),
    row("actions", "actions([[0.4, 0.2], [0.4, 0.0]]);", "The actions: forward speed in m/s, turning speed in rad/s."),
    row(
        "stages",
        "stages([\"search\", \"approach\"]);",
        "What the robot can be about: it begins with the first, also after every recovery. The stage is one more digit of the state.",
    ),
    row(
        "param",
        "const near = param(0.25, #{ low: 0.15, high: 0.5, unit: \"m\" });",
        "A parameter: a constant that may be set from outside, within its range, as `--set near=0.3`.",
    ),
    row(
        "starts",
        "starts([\"near\", \"far\"], #{ widen: 0.8 });",
        "The world's starts that are used, by name. With `widen` the first alone, until of 20 attempts that share went well; then the next joins, and so on.",
    ),
    row("run", "run(#{ steps: 5200 });", "The length and the rhythm of a run."),
    row(
        "robot",
        "robot(\"turtlebot3\", #{ lag_s: 0.15 });",
        "The robot: the name of its body, and how it moves. Without a name it is `pioneer2at`.",
    ),
    row("camera", "camera(#{ tilt_deg: 42 });", "The camera and its mount."),
    row("light", "light(#{ shadows: true });", "What becomes of the light that the world file says."),
    row("laser", "laser(#{ tilt_deg: 45 });", "The laser and its mount."),
    row("ground", "ground(#{ ahead_m: 0.1, aside_m: 0.15 });", "Three sensors that look down at paint and floor."),
    row("grid", "grid(#{ rows: 3, columns: 3 });", "How a filtered image becomes a state."),
    row("learner", "learner(\"ttd\", #{ step_size: 0.2 });", "The way of learning and its parameters."),
    row("recovery", "recovery(\"nearest\", #{ yaw_deg: 8.6 });", "What `then recover` does."),
    row("movers", "movers(#{ speed: 1.5 });", "What drives by itself in the world."),
    row(
        "policy",
        "policy(\"avoid\", \"runs/avoid/1\");",
        "A learned policy to use or to combine: a name, and its run.",
    ),
    row("combine", "combine(\"priority\", #{ margin: 0.05 });", "How two or more policies become one."),
];
