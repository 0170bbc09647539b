//! The names by which scripts ask for the figures of a test, and where each comes from.

use super::asked::Probe;
use super::measured::TestFigures;
use super::totals::{MeasureTotal, RuleTotal, StageTotal};
use super::window::WindowCounts;

/// Where a figure comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source {
    /// Every test has it.
    Test(fn(&TestFigures) -> f64),
    /// Only a test in a world with a lap route has it.
    Route(fn(&TestFigures) -> Option<f64>),
    /// Only a test in which an attempt lasted 20 s has it.
    Spells(fn(&TestFigures) -> f64),
    /// Only a test in which an attempt reached its goal has it; else it counts as the whole test's time.
    Goal(fn(&TestFigures) -> Option<f64>),
    /// Of the rule that is named.
    Rule(fn(&TestFigures, &RuleTotal) -> f64),
    /// Of the stage that is named.
    Stage(fn(&StageTotal) -> f64),
    /// Of the measure that is named.
    Measure(fn(&MeasureTotal) -> f64),
    /// Measured where a condition asks for it.
    Asked(Probe),
}

/// What stands in a figure's parentheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Takes {
    /// There are none.
    Nothing,
    /// The name of a rule.
    Rule,
    /// The name of a stage.
    Stage,
    /// The name of a measure.
    Measure,
    /// The name of a mover of the world.
    Mover,
    /// The name of a mover, and a distance in metres.
    MoverAndMetres,
    /// The name of a place of the world.
    Place,
}

impl Takes {
    /// How a figure is written that takes this.
    pub(crate) fn form(self, figure: &str) -> String {
        match self {
            Self::Nothing => figure.to_owned(),
            Self::Rule => format!("{figure}(\"rule\")"),
            Self::Stage => format!("{figure}(\"stage\")"),
            Self::Measure => format!("{figure}(\"measure\")"),
            Self::Mover => format!("{figure}(\"mover\")"),
            Self::Place => format!("{figure}(\"place\")"),
            Self::MoverAndMetres => format!("{figure}(\"mover\", 0.8)"),
        }
    }
}

/// A figure that scripts can ask for: `test.NAME`, `untrained.NAME`.
#[derive(Debug)]
pub struct TestFigure {
    /// Its name.
    pub name: &'static str,
    /// The unit, in words; empty for numbers without one.
    pub unit: &'static str,
    /// What it is, in one sentence.
    pub about: &'static str,
    pub(crate) source: Source,
    /// Reads the figure of a window of learning, where that is defined.
    pub(crate) window: Option<fn(&WindowCounts<'_>, usize) -> f64>,
}

impl TestFigure {
    /// The figure of a name.
    #[must_use]
    pub fn of(name: &str) -> Option<&'static Self> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// What stands in its parentheses.
    #[must_use]
    pub(crate) fn takes(&self) -> Takes {
        match self.source {
            Source::Test(_) | Source::Route(_) | Source::Spells(_) | Source::Goal(_) => Takes::Nothing,
            Source::Asked(Probe::FloorCovered | Probe::Gates | Probe::GateErrors) => Takes::Nothing,
            Source::Asked(Probe::Visits) => Takes::Place,
            Source::Rule(_) => Takes::Rule,
            Source::Stage(_) => Takes::Stage,
            Source::Measure(_) => Takes::Measure,
            Source::Asked(Probe::GapError) => Takes::MoverAndMetres,
            Source::Asked(Probe::Gap | Probe::ContactsWith) => Takes::Mover,
        }
    }

    /// What is measured for it on request.
    #[must_use]
    pub(crate) fn probe(&self) -> Option<Probe> {
        if let Source::Asked(probe) = self.source { Some(probe) } else { None }
    }

    /// Whether only a world with a lap route has it.
    #[must_use]
    pub(crate) fn needs_route(&self) -> bool {
        matches!(self.source, Source::Route(_))
    }

    /// Whether a window of learning has it too.
    #[must_use]
    pub(crate) fn is_of_windows(&self) -> bool {
        self.window.is_some()
    }
}

const fn test(name: &'static str, unit: &'static str, get: fn(&TestFigures) -> f64, about: &'static str) -> TestFigure {
    TestFigure { name, unit, about, source: Source::Test(get), window: None }
}

const fn route(
    name: &'static str,
    unit: &'static str,
    get: fn(&TestFigures) -> Option<f64>,
    about: &'static str,
) -> TestFigure {
    TestFigure { name, unit, about, source: Source::Route(get), window: None }
}

const fn spells(name: &'static str, get: fn(&TestFigures) -> f64, about: &'static str) -> TestFigure {
    TestFigure { name, unit: "share", about, source: Source::Spells(get), window: None }
}

const fn of_measure(name: &'static str, get: fn(&MeasureTotal) -> f64, about: &'static str) -> TestFigure {
    TestFigure { name, unit: "of the measure", about, source: Source::Measure(get), window: None }
}

const fn asked(name: &'static str, unit: &'static str, probe: Probe, about: &'static str) -> TestFigure {
    TestFigure { name, unit, about, source: Source::Asked(probe), window: None }
}

impl TestFigure {
    const fn and_of_windows(self, window: fn(&WindowCounts<'_>, usize) -> f64) -> Self {
        Self { window: Some(window), ..self }
    }
}

/// Every figure, in the order of the reference.
pub const FIGURES: &[TestFigure] = &[
    test("attempts", "", |test| test.attempts() as f64, "How many attempts ended."),
    test("failures_per_1000", "", |test| test.failures_per_1000, "Failures in 1,000 steps.")
        .and_of_windows(|counts, _| counts.per_1000(counts.window.endings.failures)),
    test("goals_per_1000", "", |test| test.per_1000(test.goals), "Goals in 1,000 steps.")
        .and_of_windows(|counts, _| counts.per_1000(counts.window.endings.goals)),
    test("restarts_per_1000", "", |test| test.per_1000(test.restarts), "Restarts in 1,000 steps.")
        .and_of_windows(|counts, _| counts.per_1000(counts.window.endings.restarts)),
    test(
        "goal_rate",
        "share",
        |test| test.goal_rate,
        "Goals as a share of the attempts that ended, broken off ones included; 0 if none did.",
    )
    .and_of_windows(|counts, _| counts.goal_rate()),
    test(
        "goal_crashes",
        "share",
        TestFigures::goal_crash_rate,
        "Goals in whose last step the body touched something or fell, as a share of the goals.",
    ),
    TestFigure {
        name: "goal_s",
        unit: "seconds",
        about: "Median duration of the attempts that reached a goal; the time of the whole test if none did.",
        source: Source::Goal(|test| test.goal_s),
        window: None,
    },
    test("stages_per_1000", "", |test| test.per_1000(test.stages), "Changes of the stage by rules in 1,000 steps.")
        .and_of_windows(|counts, _| counts.per_1000(counts.window.stages)),
    test(
        "rounds_per_1000",
        "",
        |test| test.per_1000(test.rounds),
        "Changes to the first stage by rules in 1,000 steps.",
    )
    .and_of_windows(|counts, _| counts.per_1000(counts.window.rounds)),
    TestFigure {
        name: "stage_rate",
        unit: "share",
        about: "Share of the attempts in which a rule entered that stage, the unfinished attempt included.",
        source: Source::Stage(|stage| stage.rate),
        window: None,
    },
    of_measure("mean", |measure| measure.mean, "Mean of a measure over all steps; true counts 1, false 0."),
    of_measure("least", |measure| measure.least, "Its least value."),
    of_measure("greatest", |measure| measure.greatest, "Its greatest value."),
    test("reward_per_1000", "", |test| test.reinforcement_per_1000, "Sum of the rewards in 1,000 steps.")
        .and_of_windows(|counts, _| counts.window.reinforcement * 1000.0 / counts.window.steps.max(1) as f64),
    TestFigure {
        name: "per_1000",
        unit: "",
        about: "How often a rule fired in 1,000 steps: test.per_1000(\"too close\").",
        source: Source::Rule(|test, rule| test.per_1000(rule.fired)),
        window: None,
    }
    .and_of_windows(|counts, rule| counts.per_1000(u64::from(counts.fired.get(rule).copied().unwrap_or(0)))),
    test(
        "contacts_per_1000",
        "",
        |test| test.per_1000(test.contacts),
        "Steps in 1,000 in which the body touched something.",
    )
    .and_of_windows(|counts, _| counts.per_1000(counts.window.contacts)),
    test(
        "forbidden_per_1000",
        "",
        |test| test.forbidden_per_1000.unwrap_or(0.0),
        "Steps in 1,000 in whose choice a guard took an action away.",
    )
    .and_of_windows(|counts, _| counts.per_1000(counts.window.guarded)),
    test("distance_m", "metres", |test| test.distance_m, "Length of the path."),
    test("mean_speed", "m/s", |test| test.mean_speed, "Length of the path over time."),
    route(
        "net_route_m",
        "metres",
        |test| test.net_route_m,
        "Signed progress along the route, on it and between interventions.",
    ),
    route("laps", "laps", |test| test.laps, "Signed progress along the route in lengths of it."),
    route("off_route", "share", |test| test.off_route, "Steps that end farther from the route than its half width."),
    route("route_offset_m", "metres", |test| test.route_offset_m, "Mean distance from the route."),
    test(
        "metres_per_failure",
        "metres",
        |test| test.metres_per_failure,
        "Progress along the route in either direction, without a route the path, over failures + 1.",
    ),
    test(
        "metres_per_intervention",
        "metres",
        |test| test.metres_per_intervention,
        "Such progress over failures + restarts + 1: what the robot does by itself.",
    ),
    spells("spinning", |test| test.spinning, "Spells of 20 s with a full turn on a radius below 0.3 m."),
    spells("standing", |test| test.standing, "Spells of 20 s with less than 0.2 m of path."),
    spells("circling", |test| test.circling, "Spells of 20 s that went round in a wider circle."),
    spells("returning", |test| test.returning, "Other spells of 20 s that end near where they began: to and fro."),
    spells("lingering", |test| test.lingering, "Other spells of 20 s that stay within a circle of 0.6 m."),
    spells("idle", TestFigures::idle, "Spells spinning, standing, circling, returning or lingering."),
    route("backwards", "share", |test| test.backwards, "Spells of 20 s with backward progress along the route."),
    asked(
        "gap_m",
        "metres",
        Probe::Gap,
        "Median over all steps of the gap between the robot's body and a mover's, seen from above.",
    ),
    asked(
        "gap_error_m",
        "metres",
        Probe::GapError,
        "Mean over all steps of how far that gap is from the one that is named.",
    ),
    asked("contacts_with", "steps", Probe::ContactsWith, "Steps in which the body touched that mover."),
    asked(
        "visits_per_1000",
        "",
        Probe::Visits,
        "How often the robot's centre came into the circle of a place in 1,000 steps: test.visits_per_1000(\"red\").",
    ),
    asked("gates_per_1000", "", Probe::Gates, "Gates passed in order and direction in 1,000 steps."),
    asked(
        "gate_errors",
        "share",
        Probe::GateErrors,
        "Gates passed out of order or backwards, of all that were passed; 0 if none was.",
    ),
    asked(
        "floor_covered",
        "share",
        Probe::FloorCovered,
        "Squares of 0.25 m whose middle the body has covered, of those that it can reach from the starts.",
    ),
];
