//! What a port has to do, as numbers: filters, grids, the parts of a state, and the actions of each state in their order.

use engine::allowed::Allowed;
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::Plan;
use engine::geometry::Twist;
use engine::learner::Policy;
use engine::settings::{GridSettings, ViewSettings};
use engine::state::Grid;

use crate::stage::{Reads, Stage};

/// The most states whose actions are written: a table of that many bytes.
const MOST_STATES: usize = 1 << 16;
/// In the place of an action: nothing is known of the state.
pub(crate) const UNKNOWN: u8 = u8::MAX;

/// A policy as other programs do it.
#[derive(Debug, Clone)]
pub struct Model {
    pub(crate) behaviour: String,
    /// Width and height of the image, pixels.
    pub(crate) size_px: (usize, usize),
    /// Bytes of a pixel: 1 for brightness, 3 for red, green and blue.
    pub(crate) channels: usize,
    pub(crate) period_s: f64,
    pub(crate) views: Vec<View>,
    /// The lowest digit first.
    pub(crate) parts: Vec<Part>,
    pub(crate) states: usize,
    pub(crate) actions: Vec<Twist>,
    /// By state, its actions, the best first; [`UNKNOWN`] throughout where nothing is known.
    pub(crate) order: Vec<Vec<u8>>,
    /// By state, whether learning came to it.
    pub(crate) met: Vec<bool>,
    pub(crate) guards: Vec<Guard>,
    /// The place of the action that is taken where nothing is known: the slowest one.
    pub(crate) slowest: usize,
}

/// What is seen in one way.
#[derive(Debug, Clone)]
pub(crate) struct View {
    pub name: String,
    pub stages: Vec<Stage>,
    pub rows: usize,
    pub columns: usize,
    pub fill: bool,
    /// Values of a digit of its number.
    pub base: usize,
    pub row_edges: Vec<usize>,
    pub column_edges: Vec<usize>,
    /// By cell: the pixels from which it is occupied.
    pub least: Vec<u32>,
    /// For how many steps an empty column counts as gone; 0 if nothing is remembered.
    pub remembered_steps: u32,
}

/// A digit of the state.
#[derive(Debug, Clone)]
pub(crate) enum Part {
    /// The number of a view's grid, by its place.
    View { view: usize, values: usize },
    /// What the other program has to say itself, in the order in which it says them.
    Told { name: String, values: usize, how: Told },
}

/// How a digit that is told comes about.
#[derive(Debug, Clone)]
pub(crate) enum Told {
    /// How many of these edges a value has reached.
    Edges(Vec<f64>),
    /// 1 if it holds.
    Flag,
    /// The number of one of these stages.
    Stages(Vec<String>),
}

/// What must not be done while something holds.
#[derive(Debug, Clone)]
pub(crate) struct Guard {
    pub name: String,
    pub text: String,
    pub forbids: Allowed,
}

impl Part {
    pub(crate) const fn values(&self) -> usize {
        match self {
            Self::View { values, .. } | Self::Told { values, .. } => *values,
        }
    }
}

impl Model {
    /// Of a learned policy.
    ///
    /// # Errors
    /// `E-EXPORT` for what no port can do: policies that are used or combined, filters without a port, too many states.
    pub fn new(plan: &Plan, policy: &Policy) -> Result<Self> {
        if !plan.learns() || plan.behaviour.hands_over() {
            return Err(no_table(plan.behaviour.name()));
        }
        let settings = &plan.settings;
        let states = policy.states();
        if states > MOST_STATES {
            let message =
                format!("'{}' has {states} states, at most {MOST_STATES} are written out", plan.behaviour.name());
            return cannot(message, "learn with smaller grids or fewer ranges");
        }
        let size_px = (settings.camera.width_px as usize, settings.camera.height_px as usize);
        let (parts, views) = parts_and_views(plan)?;
        let views = views.iter().map(|view| View::new(plan, view, size_px)).collect::<Result<Vec<_>>>()?;
        let colour = views.iter().any(|view| view.stages.first().is_some_and(|stage| stage.reads() == Reads::Colour));
        let actions = settings.actions.clone();
        let guards = plan.behaviour.guards().zip(plan.behaviour.forbidden(&actions));
        let guard = |(text, forbids): (&engine::judge::RuleText, Allowed)| Guard {
            name: text.name.clone(),
            text: text.text.clone(),
            forbids,
        };
        Ok(Self {
            behaviour: plan.behaviour.name().to_owned(),
            size_px,
            channels: if colour { 3 } else { 1 },
            period_s: settings.run.period_s,
            views,
            parts,
            states,
            order: (0..states).map(|state| order(policy, state)).collect(),
            met: (0..states).map(|state| policy.is_met(state)).collect(),
            guards: guards.map(guard).collect(),
            slowest: slowest(&actions),
            actions,
        })
    }

    /// The names of the digits that the other program has to say, in their order.
    pub(crate) fn told(&self) -> impl Iterator<Item = (&str, usize, &Told)> {
        self.parts.iter().filter_map(|part| match part {
            Part::Told { name, values, how } => Some((name.as_str(), *values, how)),
            Part::View { .. } => None,
        })
    }

    /// The digits of a state that the other program has to say.
    pub(crate) fn digits_of(&self, state: usize) -> Vec<u8> {
        let (mut rest, mut digits) = (state, Vec::new());
        for part in &self.parts {
            if let Part::Told { values, .. } = part {
                digits.push((rest % values) as u8);
            }
            rest /= part.values();
        }
        digits
    }

    /// The action of a state under these guards, a bit for each.
    pub(crate) fn action(&self, state: usize, guards: u32) -> usize {
        let held = self.guards.iter().enumerate().filter(|(guard, _)| guards & 1 << guard != 0);
        let forbidden = held.fold(Allowed::NONE, |all, (_, guard)| Allowed::of_bits(all.bits() | guard.forbids.bits()));
        let fits = |action: &usize| *action < self.actions.len() && !forbidden.contains(*action);
        let known = self.order[state].iter().map(|action| usize::from(*action)).find(fits);
        known.or_else(|| slow_first(&self.actions).into_iter().find(fits)).unwrap_or(self.slowest)
    }
}

impl View {
    fn new(plan: &Plan, view: &ViewSettings, (width, height): (usize, usize)) -> Result<Self> {
        let stages = Stage::chain(plan, view, (width, height))?;
        let GridSettings { rows, columns, fill, occupied, remember_s } = view.grid;
        let grid =
            Grid::new(&view.grid, width, height).or_else(|error| cannot(error.0, "learn the behaviour again"))?;
        let (rows, columns) = (rows as usize, columns as usize);
        let edges = |cells: usize, pixels: usize| (0..=cells).map(|cell| cell * pixels / cells).collect();
        let least = |cell: usize| ((grid.area_px(cell) as f64 * occupied).ceil() as u32).max(1);
        let remembers = remember_s > 0.0;
        let steps = (remember_s / plan.settings.run.period_s - 1e-9).ceil().max(1.0) as u32;
        Ok(Self {
            name: view.name.clone(),
            stages,
            rows,
            columns,
            fill,
            base: if fill { rows + 1 + usize::from(remembers) } else { 2 },
            row_edges: edges(rows, height),
            column_edges: edges(columns, width),
            least: (0..rows * columns).map(least).collect(),
            remembered_steps: if remembers { steps } else { 0 },
        })
    }
}

/// The parts of the state, and the views that they are of.
fn parts_and_views(plan: &Plan) -> Result<(Vec<Part>, Vec<ViewSettings>)> {
    let map = plan.state_map()?;
    let table = map.to_table();
    let Some(parts) = table.get("part").and_then(|parts| parts.as_array()) else {
        return Ok((vec![Part::View { view: 0, values: map.states() }], vec![plan.settings.view.clone()]));
    };
    let (mut views, mut found) = (Vec::new(), Vec::new());
    for part in parts {
        let text = |key: &str| part.get(key).and_then(|value| value.as_str());
        let values = part.get("values").and_then(|values| values.as_integer()).unwrap_or(0) as usize;
        if let Some(name) = text("view") {
            let Some(view) = plan.settings.views().find(|view| view.name == name) else {
                return cannot(format!("there is no view '{name}'"), "learn the behaviour again");
            };
            found.push(Part::View { view: views.len(), values });
            views.push(view.clone());
        } else if let Some(name) = text("bins") {
            let edges = part.get("edges").and_then(|edges| edges.as_array()).into_iter().flatten();
            let edges: Vec<f64> = edges.filter_map(|edge| edge.as_float()).collect();
            let how = if edges.is_empty() { Told::Flag } else { Told::Edges(edges) };
            found.push(Part::Told { name: name.to_owned(), values, how });
        } else {
            let stages = part.get("stages").and_then(|stages| stages.as_array()).into_iter().flatten();
            let stages = stages.filter_map(|stage| stage.as_str()).map(str::to_owned).collect();
            found.push(Part::Told { name: "stage".to_owned(), values, how: Told::Stages(stages) });
        }
    }
    Ok((found, views))
}

/// The actions of a state, the one of greatest value first, of equals the first one.
fn order(policy: &Policy, state: usize) -> Vec<u8> {
    let Some(values) = policy.values_of(state) else { return vec![UNKNOWN; policy.actions()] };
    let mut order: Vec<u8> = (0..values.len() as u8).collect();
    let value = |action: &u8| values[usize::from(*action)];
    order.sort_by(|one, other| value(other).partial_cmp(&value(one)).unwrap_or(std::cmp::Ordering::Equal));
    order
}

/// The actions, the slowest forward first, of those the one that turns least.
pub(crate) fn slow_first(actions: &[Twist]) -> Vec<usize> {
    let speed = |action: &usize| {
        let Twist { linear_m_per_s, angular_rad_per_s } = actions[*action];
        (linear_m_per_s.abs(), angular_rad_per_s.abs())
    };
    let mut order: Vec<usize> = (0..actions.len()).collect();
    order.sort_by(|one, other| {
        let (one, other) = (speed(one), speed(other));
        one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
    });
    order
}

fn slowest(actions: &[Twist]) -> usize {
    slow_first(actions).first().copied().unwrap_or(0)
}

/// A behaviour that combines or uses policies has nothing to write down.
#[must_use]
pub fn no_table(behaviour: &str) -> Box<Diagnostic> {
    let message = format!("'{behaviour}' combines or uses policies: it has no table of its own");
    Box::new(Diagnostic::new("E-EXPORT", message).help("export the runs of those policies one by one"))
}

pub(crate) fn cannot<T>(message: impl Into<String>, help: &str) -> Result<T> {
    Diagnostic::new("E-EXPORT", message.into()).help(help).fail()
}
