//! What a script's settings are made into, each part checked by itself: chain, grid, judge, mirror.

use std::ops::Range;

use super::combination;
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::filter::{Catalogue, Chain, ChainError};
use crate::geometry::Twist;
use crate::judge::Judge;
use crate::learner::Mirror;
use crate::script::{Behaviour, Unread};
use crate::settings::Settings;
use crate::state::{ComposedMap, Grid, GridMap, MAX_STATES, StateMap, StatePart};

/// A behaviour with its settings and the filters that it may use.
pub(super) struct Parts<'a> {
    pub behaviour: &'a Behaviour,
    pub settings: &'a Settings,
    pub filters: &'a Catalogue,
}

impl Parts<'_> {
    /// Tries every part whose settings are read. Gives whether the robot will see: there are a chain and a grid.
    pub(super) fn check(&self, unread: &Unread, mistakes: &mut Mistakes) -> bool {
        if !unread.any_of("policy") && !unread.any_of("combine") {
            mistakes.take(combination::check_policies(self.behaviour, self.settings));
        }
        let camera = !unread.has("camera", "width_px") && !unread.has("camera", "height_px");
        let chain = camera && !unread.any_of("filter") && mistakes.take(self.tried_chain()).is_some();
        let grid = camera && !unread.any_of("grid") && mistakes.take(self.grid()).is_some();
        if !unread.has("laser", "beams") {
            mistakes.take(self.judge());
        }
        if grid && !unread.any_of("actions") && !unread.any_of("learner") {
            mistakes.take(self.state_map().and_then(|map| self.mirror(&*map)));
        }
        chain && grid && !unread.any_of("camera")
    }

    /// A fresh filter chain.
    pub(super) fn chain(&self) -> Result<Chain> {
        let camera = &self.settings.camera;
        let (width_px, height_px) = (camera.width_px as usize, camera.height_px as usize);
        Chain::new(&self.settings.filters, width_px, height_px, self.filters).map_err(|error| self.in_chain(error))
    }

    /// A fresh filter chain, or all that is wrong in it.
    fn tried_chain(&self) -> Result<Chain> {
        self.chain().map_err(|first| {
            let mut mistakes = Mistakes::new(self.behaviour.source());
            let faults = Chain::faults(&self.settings.filters, self.filters);
            faults.into_iter().for_each(|fault| mistakes.add(*self.in_chain(fault)));
            // What is written may be well, and a filter refuse it.
            if mistakes.is_empty() { first } else { mistakes.end().err().unwrap_or(first) }
        })
    }

    fn in_chain(&self, error: ChainError) -> Box<Diagnostic> {
        let stage = format!("filter:{}", error.stage);
        let place = error.parameter.map_or(stage.clone(), |parameter| format!("{stage}.{parameter}"));
        match error.within {
            Some(within) => self.in_condition(*error.error, error.stage, &place, within),
            None => self.point(*error.error, &place, "here", None),
        }
    }

    /// A mistake within a condition: at its place if the script has the condition as it stands, else with the words about it.
    fn in_condition(
        &self,
        error: Diagnostic,
        stage: usize,
        place: &str,
        (within, label): (Range<usize>, &str),
    ) -> Box<Diagnostic> {
        let source = self.behaviour.source();
        let condition = self.settings.filters.get(stage).and_then(|filter| filter.condition.as_deref()).unwrap_or("");
        let literal = self.behaviour.place_of(place).map_or(0, |span| span.start + 1);
        if source.text.get(literal..).is_some_and(|text| !condition.is_empty() && text.starts_with(condition)) {
            return Box::new(error.at(source, literal + within.start..literal + within.end, label));
        }
        let (before, after) = (&condition[..within.start], &condition[within.start..]);
        let after = if after.is_empty() { "its end".to_owned() } else { format!("'{}'", printable(after)) };
        let message = match before.is_empty() {
            true => format!("{}: at {after}", error.message),
            false => format!("{}: behind '{}' at {after}", error.message, printable(before)),
        };
        self.point(Diagnostic { message, ..error }, place, "in this condition", None)
    }

    /// A fresh grid.
    pub(super) fn grid(&self) -> Result<Grid> {
        let camera = &self.settings.camera;
        Grid::new(&self.settings.grid, camera.width_px as usize, camera.height_px as usize).map_err(|error| {
            let help = Some("use fewer rows or columns".to_owned());
            self.point(Diagnostic::new("E-GRID", error.0), "grid.rows", "this many rows", help)
        })
    }

    /// A fresh map from what is perceived to states.
    pub(super) fn state_map(&self) -> Result<Box<dyn StateMap>> {
        let view = GridMap::new(&self.settings.grid, self.grid()?);
        if self.settings.stages.is_empty() {
            return Ok(Box::new(view));
        }
        let labels = self.settings.stages.iter().map(|stage| format!("\"{stage}\"")).collect();
        let map = ComposedMap::new(vec![
            StatePart::View { name: "camera".to_owned(), view: 0, map: view },
            StatePart::Digit { name: "stage".to_owned(), digit: 0, labels },
        ]);
        match map.count() {
            Some(count) if count <= MAX_STATES => Ok(Box::new(map)),
            _ => {
                let message = format!("the grid and the stages make more than {MAX_STATES} states");
                let help = Some("use fewer rows, columns or stages".to_owned());
                Err(self.point(Diagnostic::new("E-GRID", message), "stages", "too many states", help))
            }
        }
    }

    /// The mirror that `learner.mirror` asks for.
    pub(super) fn mirror(&self, map: &dyn StateMap) -> Result<Option<Mirror>> {
        if !self.settings.learner.mirror {
            return Ok(None);
        }
        let states = (0..map.states()).map(|state| map.mirrored(state)).collect::<Option<Vec<_>>>();
        let Some(states) = states else {
            let error = Diagnostic::new("E-MIRROR", "the states of this behaviour have no mirror images");
            let help = Some("leave 'mirror' out".to_owned());
            return Err(self.point(error, "learner.mirror", "asks for mirrored learning", help));
        };
        Mirror::new(states, &self.settings.actions).map(Some).map_err(|index| {
            let Twist { linear_m_per_s: linear, angular_rad_per_s: angular } = self.settings.actions[index];
            let message =
                format!("action {index} ({linear} m/s, {angular} rad/s) has no mirror image among the actions");
            let help = format!("add the action [{linear}, {}], or leave 'mirror' out", -angular);
            let error = Diagnostic::new("E-MIRROR", message);
            self.point(error, "learner.mirror", "asks for mirrored learning", Some(help))
        })
    }

    /// A fresh judge.
    pub(super) fn judge(&self) -> Result<Judge> {
        let (run, laser, actions) = (&self.settings.run, &self.settings.laser, &self.settings.actions);
        self.behaviour.check_guards(actions)?;
        Ok(self.behaviour.judge(run.period_s, laser.beams as usize)?.with_actions(actions))
    }

    fn point(&self, error: Diagnostic, place: &str, label: &str, help: Option<String>) -> Box<Diagnostic> {
        let error = match self.behaviour.place_of(place) {
            Some(span) => error.at(self.behaviour.source(), span, label),
            None => error,
        };
        Box::new(match help {
            Some(help) => error.help(help),
            None => error,
        })
    }
}
