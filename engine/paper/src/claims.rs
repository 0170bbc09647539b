//! The paper's claims, in our own words: one table. A row more is one entry more.
//!
//! Quintía, Domenech, Gamallo and Regueiro, "Methodology for learning visual reactive behaviours in robotics through
//! reinforcement and image-based states", ICINCO 2007.

use super::job::{Learn, Metric, Trial};
use super::looks::Look;
use super::verdict::Rule;

/// One claim, and how it is measured and judged.
#[derive(Debug, Clone, Copy)]
pub struct Claim {
    /// A short name, for `--only`.
    pub id: &'static str,
    /// The section of the paper; "-" is ours.
    pub section: &'static str,
    /// The claim in our own words.
    pub said: &'static str,
    /// The paper's number.
    pub paper: &'static str,
    /// What is learned.
    pub learn: Learn,
    /// In which further test it is looked at; `None` is the script's own.
    pub trial: Option<Trial>,
    /// The number of each seed.
    pub metric: Metric,
    /// The job whose numbers it is compared with.
    pub against: Option<(Learn, Option<Trial>)>,
    /// How numbers become a verdict.
    pub rule: Rule,
    /// Why the numbers are what they are, or what else to know.
    pub note: &'static str,
}

impl Claim {
    /// The jobs that it needs.
    pub fn jobs(&self) -> impl Iterator<Item = (Learn, Option<Trial>)> + use<> {
        std::iter::once((self.learn, self.trial)).chain(self.against)
    }

    const fn test(self, trial: Trial) -> Self {
        Self { trial: Some(trial), ..self }
    }

    const fn against(self, learn: Learn, trial: Option<Trial>) -> Self {
        Self { against: Some((learn, trial)), ..self }
    }

    const fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }

    const fn paper(self, section: &'static str, paper: &'static str) -> Self {
        Self { section, paper, ..self }
    }
}

const fn claim(id: &'static str, said: &'static str, learn: Learn, metric: Metric, rule: Rule) -> Claim {
    Claim { id, section: "-", said, paper: "", learn, trial: None, metric, against: None, rule, note: "" }
}

pub(super) const WALL: Learn = Learn::script("wall");
pub(super) const CORRIDOR: Learn = Learn::script("corridor");
pub(super) const PLATFORM: Learn = Learn::script("platform");
pub(super) const OBJECT: Learn = Learn::script("object");
const INSTANT: Learn = Learn::script("wall-instant");
const FAST: Learn = Learn::script("corridor-speed").seeds(15);
const WRONG: Learn = Learn::script("corridor-erroneous").seeds(15);
const ONE_STEP: Learn = Learn::script("wall").set(&["learner.kind=q"]).long(20_000, 10);
const ONE_STEP_8X4: Learn =
    Learn::script("wall").set(&["learner.kind=q", "grid.rows=8", "grid.columns=4"]).long(80_000, 4);
const GRID_3X5: Learn = Learn::script("wall").set(&["grid.rows=3", "grid.columns=5"]).long(12_000, 8);
const GRID_4X4: Learn = Learn::script("wall").set(&["grid.rows=4", "grid.columns=4"]).long(12_000, 8);
const GRID_5X3: Learn = Learn::script("wall").set(&["grid.rows=5", "grid.columns=3"]).long(12_000, 8);
const WINDOW_6: &[&str] = &["learner.window=6", "learner.trace_decay=0.95"];
const WINDOW_10: &[&str] = &["learner.window=10", "learner.trace_decay=0.97"];
const MIRROR: &[&str] = &["learner.window=10", "learner.trace_decay=0.97", "learner.mirror=true"];
const REPLAY: &[&str] = &["learner.window=10", "learner.trace_decay=0.97", "learner.mirror=true", "learner.replay=3"];

const fn trial(world: Option<&'static str>, set: &'static [&'static str]) -> Trial {
    Trial { world, set, steps: 2_000, look: Look::Figures }
}

const fn looking(world: Option<&'static str>, look: Look) -> Trial {
    Trial { world, set: &[], steps: 2_000, look }
}

const fn robust(id: &'static str, said: &'static str, world: &'static str, rule: Rule) -> Claim {
    claim(id, said, WALL, Metric::Failures, rule).test(trial(Some(world), &[])).against(WALL, None)
}

const fn light(id: &'static str, said: &'static str, world: &'static str) -> Claim {
    robust(id, said, world, Rule::Degrades(1.0))
        .paper("4.1.1", "sensitive")
        .note("The paper warns of it without a number; how much light or texture changes here is our choice.")
}

const fn follows(id: &'static str, said: &'static str, set: &'static [&'static str], rule: Rule) -> Claim {
    claim(id, said, OBJECT, Metric::NeverLost, rule)
        .test(trial(None, set))
        .paper("4.5.2", "follows below 0.35 m/s")
        .note("A failure is to lose it from view or to come nearer than 30 cm, once in 11 minutes.")
}

const fn beyond(id: &'static str, said: &'static str, learn: Learn, paper: Learn) -> Claim {
    let note = "Not in the paper. Beside it, the paper's learner on the same seeds; options chosen on other seeds.";
    claim(id, said, learn, Metric::LearnedAt, Rule::Beats).against(paper, None).note(note)
}

/// The frame of states that look alike is drawn from this trial.
pub(super) const ALIASES: Trial = looking(None, Look::States);
pub(super) const CROSSINGS: Trial = looking(Some("corridor-crossings"), Look::Crossings);
const BENDS: Trial = looking(None, Look::Bends);

/// Every claim, in the order of the paper.
pub const CLAIMS: &[Claim] = &[
    claim("states", "A 3x3 grid makes 64 states", WALL, Metric::States, Rule::Within(64.0, 0.0)).paper("4.1.1", "64"),
    claim("wall-learned", "The wall is learned within 2,000 steps", WALL, Metric::LearnedAt, Rule::Near(2_000.0, 1.5))
        .paper("4.2.2, Fig. 3", "2,000 steps"),
    claim(
        "wall-first-point",
        "The first 400 steps cost 12 punishments",
        WALL,
        Metric::FirstWindow,
        Rule::Near(-12.0, 1.5),
    )
    .paper("4.2.2, Fig. 3", "−12 per 400 steps")
    .note("The paper does not state its control period; here it is 0.5 s, and a longer period holds more failures."),
    claim("wall-converges", "The curve ends without punishment", WALL, Metric::LastWindows, Rule::AtLeast(-1.0))
        .paper("4.2.2, Fig. 3", "towards 0")
        .note("Measured while still learning, over the last four windows."),
    claim(
        "wall-instant",
        "Delayed reinforcement is more robust than instant",
        INSTANT,
        Metric::LearnedAt,
        Rule::None,
    )
    .paper("4.2.1", "delayed is better")
    .against(WALL, None)
    .note(
        "Ours is the instant one, the reference the delayed one. Each is measured by its own reinforcement, and the \
         instant one punishes more often: the steps do not say which behaviour is more robust.",
    ),
    claim(
        "q-3x3",
        "One-step Q-learning needs more steps, with the same grid",
        ONE_STEP,
        Metric::LearnedAt,
        Rule::Slower(0.5),
    )
    .paper("4.2.2", "slower")
    .against(WALL, None)
    .note("At most 10 seeds, 20,000 steps."),
    claim(
        "q-8x4",
        "One-step Q-learning with an 8x4 grid needs 80,000 steps",
        ONE_STEP_8X4,
        Metric::LearnedAt,
        Rule::Near(80_000.0, 1.5),
    )
    .paper("4.2.2", "80,000 steps")
    .note(
        "At most 4 seeds, 80,000 steps, 8 rows and 4 columns: 6,561 states. Temperature falls with the visits of each \
         state, and so many states stay hot; the settings of the earlier work are not known.",
    ),
    claim(
        "corridor-learned",
        "The corridor is learned within 800 steps",
        CORRIDOR,
        Metric::LearnedAt,
        Rule::Near(800.0, 1.5),
    )
    .paper("4.3.2, Fig. 5", "800 steps"),
    claim("corridor-progress", "It gets along the corridor", CORRIDOR, Metric::NetSpeed, Rule::Share(0.5))
        .paper("4.3.2, Fig. 6", "drawn, no number")
        .note("The reinforcement cannot see a robot that turns round; the truth can."),
    claim(
        "corridor-side",
        "The final behaviour tends to turn to one side",
        CORRIDOR,
        Metric::CommonerSide,
        Rule::AtLeast(0.8),
    )
    .test(CROSSINGS)
    .paper("4.3.2", "a tendency")
    .note("The share of the commoner side among the turns at crossings. A seed makes few turns, and chance alone often gives 0.7."),
    claim(
        "corridor-crossings",
        "At crossings it makes no decision",
        CORRIDOR,
        Metric::CommonestChoice,
        Rule::AtMost(0.9),
    )
    .test(CROSSINGS)
    .paper("4.3", "no decision")
    .note("The share of the commonest of left, right and straight on; from 0.9 it would be a decision."),
    claim(
        "corridor-speed",
        "A speed reinforcement changes little",
        FAST,
        Metric::Failures,
        Rule::NoWorse(1.0),
    )
    .paper("4.3.1", "no significant change")
    .against(CORRIDOR, None)
    .note("A reward in every step outweighs differences of 0.1 between actions at the paper's temperature of 0.009. At most 15 seeds."),
    claim(
        "corridor-erroneous",
        "Even an erroneous reinforcement learns",
        WRONG,
        Metric::Failures,
        Rule::NoWorse(1.0),
    )
    .paper("4.3.1", "learned all the same")
    .against(CORRIDOR, None)
    .note("Slow and turning is rewarded, straight and fast is punished. At most 15 seeds."),
    claim(
        "platform-learned",
        "The platform is learned within 2,000 steps",
        PLATFORM,
        Metric::LearnedAt,
        Rule::Near(2_000.0, 1.5),
    )
    .paper("4.4.2, Fig. 7", "2,000 steps"),
    claim("platform-progress", "It gets along the platform", PLATFORM, Metric::NetSpeed, Rule::Share(0.5))
        .paper("4.4.2, Fig. 8", "drawn, no number"),
    claim("object-learned", "Following is learned within 10,500 steps", OBJECT, Metric::LearnedAt, Rule::Near(10_500.0, 1.5))
        .paper("4.5.2, Fig. 9", "10,500 steps")
        .note("The paper's prey follows a line on a path that is not given; ours keeps an even speed on rounded corners."),
    claim(
        "object-distance",
        "It keeps 0.9 m from a prey at 0.2 m/s",
        OBJECT,
        Metric::PreyDistance,
        Rule::Within(0.9, 0.3),
    )
    .paper("4.5.2", "0.9 m")
    .note("Ours is from centre to centre; the paper does not say between which points."),
    follows("object-0.20", "Follows at 0.20 m/s without loss", &["movers.speed=1.0"], Rule::Share(0.5)),
    follows("object-0.25", "Follows at 0.25 m/s without loss", &["movers.speed=1.25"], Rule::Share(0.5)),
    follows("object-0.30", "Follows at 0.30 m/s without loss", &["movers.speed=1.5"], Rule::Share(0.5)),
    follows("object-0.33", "Follows at 0.33 m/s without loss", &["movers.speed=1.65"], Rule::Share(0.5)),
    follows("object-0.35", "At the limit itself: 0.35 m/s", &["movers.speed=1.75"], Rule::None),
    follows("object-0.37", "Is lost at 0.37 m/s", &["movers.speed=1.85"], Rule::Loses(0.5)),
    follows("object-0.39", "Is lost at 0.39 m/s", &["movers.speed=1.95"], Rule::Loses(0.5)),
    claim("object-smooth", "Its path turns less than the prey's", OBJECT, Metric::TurningShare, Rule::AtMost(1.0))
        .test(BENDS)
        .paper("4.5.2, Fig. 10", "smoother")
        .note("Mean turning per metre between pieces of 0.5 m. Our prey drives on straight lines and arcs, without swerving."),
    claim("object-bends", "Its sharpest bends are milder than the prey's", OBJECT, Metric::SharpestShare, Rule::AtMost(1.0))
        .test(BENDS)
        .paper("4.5.2, Fig. 10", "smoother")
        .note("The bend between pieces of 0.5 m that only one in twenty exceeds."),
    robust("hallway", "It works in a real corridor that is narrower", "hallway", Rule::NoWorse(1.0))
        .paper("4.6, Fig. 11", "works perfectly")
        .note("A simulated hallway with bins, radiators, plants, doors and glass; there is no real robot here."),
    claim("grid-3x5", "A 3x5 grid learns the same, but slower", GRID_3X5, Metric::LearnedAt, Rule::Slower(0.5))
        .paper("5", "slower")
        .against(WALL, None)
        .note("At most 8 seeds, 12,000 steps."),
    claim("grid-4x4", "A 4x4 grid learns the same, but slower", GRID_4X4, Metric::LearnedAt, Rule::Slower(0.5))
        .paper("5", "slower")
        .against(WALL, None)
        .note("At most 8 seeds, 12,000 steps."),
    claim("grid-5x3", "A 5x3 grid learns the same, but slower", GRID_5X3, Metric::LearnedAt, Rule::Slower(0.5))
        .paper("5", "slower")
        .against(WALL, None)
        .note("At most 8 seeds, 12,000 steps."),
    claim("aliasing", "There is some perceptual aliasing, yet it converges", WALL, Metric::Aliased, Rule::AtLeast(0.05))
        .test(ALIASES)
        .paper("5", "a certain degree")
        .note("The share of often-met states after which, under their commonest action, no state follows in half of the cases."),
    robust("low-obstacles", "It avoids obstacles that the laser cannot see", "room-low-obstacles", Rule::NoWorse(1.0))
        .paper("5", "optimal"),
    robust("gaps-20", "Gaps of 20 cm in the wall do no harm", "room-gaps-20", Rule::NoWorse(1.0)).paper("5", "optimal"),
    robust("gaps-40", "Gaps of 40 cm in the wall do no harm", "room-gaps-40", Rule::NoWorse(1.0)).paper("5", "optimal"),
    robust("gaps-60", "Gaps of 60 cm make it worse", "room-gaps-60", Rule::Degrades(1.0)).paper("5", "deteriorates"),
    robust("gaps-100", "Gaps of 100 cm make it worse", "room-gaps-100", Rule::Degrades(1.0)).paper("5", "deteriorates"),
    light("light-bright", "Edges are sensitive to light: brighter", "room-bright"),
    light("light-dark", "Edges are sensitive to light: darker", "room-dark"),
    light("light-side", "Edges are sensitive to light: from the side", "room-side-light"),
    light("texture", "Edges are sensitive to texture on the floor", "room-textured"),
    claim("noise", "Pixel noise of 5 grey levels", WALL, Metric::Failures, Rule::None)
        .test(trial(None, &["camera.noise=5"]))
        .against(WALL, None)
        .note("The paper says nothing of noise; learned with 2 grey levels."),
    beyond("window-wall", "A window of 6 states: the wall", WALL.set(WINDOW_6), WALL),
    beyond("window-corridor", "A window of 10 states: the corridor", CORRIDOR.set(WINDOW_10), CORRIDOR),
    beyond("window-platform", "A window of 10 states: the platform", PLATFORM.set(WINDOW_10), PLATFORM),
    beyond("window-object", "A window of 10 states: the object", OBJECT.set(WINDOW_10), OBJECT),
    beyond("mirror-platform", "... and each step learned left for right: the platform", PLATFORM.set(MIRROR), PLATFORM),
    beyond("mirror-object", "... and each step learned left for right: the object", OBJECT.set(MIRROR), OBJECT),
    beyond("replay-corridor", "... and replayed three times: the corridor", CORRIDOR.set(REPLAY), CORRIDOR),
    beyond("replay-platform", "... and replayed three times: the platform", PLATFORM.set(REPLAY), PLATFORM),
];
