//! What a script's settings are made into, each part checked by itself: chain, grid, judge, mirror.

use std::ops::Range;

use super::{Eyes, combination};
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::filter::{Catalogue, Chain, ChainError};
use crate::geometry::Twist;
use crate::judge::Judge;
use crate::learner::Mirror;
use crate::script::{Behaviour, Unread};
use crate::settings::{LearnerKind, Lens, PartSettings, Settings, ViewSettings};
use crate::state::{ComposedMap, DigitKind, Grid, GridMap, MAX_POOLED_STATES, MAX_STATES, StateMap, StatePart};

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
        let views = camera && !unread.any_of("view");
        let every = |try_one: &mut dyn FnMut(&ViewSettings) -> bool| self.settings.views().all(try_one);
        let chain =
            views && !unread.any_of("filter") && every(&mut |view| mistakes.take(self.tried_chain(view)).is_some());
        let grid = views && !unread.any_of("grid") && every(&mut |view| mistakes.take(self.grid(view)).is_some());
        if !unread.has("laser", "beams") && !unread.has("laser", "field_of_view_deg") {
            mistakes.take(self.judge());
        }
        if grid && !["actions", "learner", "state", "stages"].iter().any(|call| unread.any_of(call)) {
            mistakes.take(self.state_map().and_then(|map| self.mirror(&*map)));
        }
        chain && grid && !unread.any_of("camera") && self.looks()
    }

    /// The fresh filter chain of a view.
    pub(super) fn chain(&self, view: &ViewSettings) -> Result<Chain> {
        let (width_px, height_px) = self.image_px();
        let chain = Chain::new(&view.filters, width_px, height_px, self.filters);
        let chain = chain.map_err(|error| self.in_chain(view, error))?;
        self.check_depth(view, &chain)?;
        let mounted = chain.mounted(&self.settings.camera);
        mounted.map_err(|error| self.point(*error, &view.place("filter:0"), "cannot work with this camera", None))
    }

    /// A chain that reads depth needs a camera that measures it.
    fn check_depth(&self, view: &ViewSettings, chain: &Chain) -> Result<()> {
        let camera = &self.settings.camera;
        if camera.depth && camera.lens == Lens::Fisheye {
            let error = Diagnostic::new("E-FILTER-SETTING", "a depth camera has a pinhole lens, not a fisheye");
            return Err(self.point(
                error,
                "camera.depth",
                "asks for depth",
                Some("leave one of the two out".to_owned()),
            ));
        }
        if !chain.reads_depth() || camera.depth {
            return Ok(());
        }
        let name = view.filters.first().map_or("", |filter| &filter.name);
        let error =
            Diagnostic::new("E-FILTER-SETTING", format!("filter '{name}' reads depth, and the camera measures none"));
        let help = "write camera(#{ depth: true });".to_owned();
        Err(self.point(error, &view.place("filter:0"), "reads depth", Some(help)))
    }

    /// A fresh filter chain, or all that is wrong in it.
    fn tried_chain(&self, view: &ViewSettings) -> Result<Chain> {
        self.chain(view).map_err(|first| {
            let mut mistakes = Mistakes::new(self.behaviour.source());
            let faults = Chain::faults(&view.filters, self.filters);
            faults.into_iter().for_each(|fault| mistakes.add(*self.in_chain(view, fault)));
            // What is written may be well, and a filter refuse it.
            if mistakes.is_empty() { first } else { mistakes.end().err().unwrap_or(first) }
        })
    }

    fn in_chain(&self, view: &ViewSettings, error: ChainError) -> Box<Diagnostic> {
        // What --set changed does not stand in the script.
        if self.behaviour.settings().views().all(|own| own.filters != view.filters) {
            return error.error;
        }
        let stage = view.place(&format!("filter:{}", error.stage));
        let place = error.parameter.map_or(stage.clone(), |parameter| format!("{stage}.{parameter}"));
        let condition = view.filters.get(error.stage).and_then(|filter| filter.condition.as_deref());
        match error.within {
            Some(within) => self.in_condition(*error.error, condition.unwrap_or(""), &place, within),
            None => self.point(*error.error, &place, "here", None),
        }
    }

    /// A mistake within a condition: at its place if the script has the condition as it stands, else with the words about it.
    fn in_condition(
        &self,
        error: Diagnostic,
        condition: &str,
        place: &str,
        (within, label): (Range<usize>, &str),
    ) -> Box<Diagnostic> {
        let source = self.behaviour.source();
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

    fn image_px(&self) -> (usize, usize) {
        (self.settings.camera.width_px as usize, self.settings.camera.height_px as usize)
    }

    /// The fresh grid of a view.
    pub(super) fn grid(&self, view: &ViewSettings) -> Result<Grid> {
        let (width_px, height_px) = self.image_px();
        let grid = Grid::new(&view.grid, width_px, height_px).map_err(|error| {
            let without_fill = view.grid.remember_s > 0.0 && !view.grid.fill;
            let (place, label, help) = match without_fill {
                true => ("grid.remember_s", "asks to remember", "take it out, or leave out fill: false"),
                false => ("grid.rows", "this many rows", "use fewer rows or columns"),
            };
            self.point(Diagnostic::new("E-GRID", error.0), &view.place(place), label, Some(help.to_owned()))
        })?;
        Ok(grid.with_period(self.settings.run.period_s))
    }

    /// Fresh eyes: a chain and a grid for each view, and the map.
    pub(super) fn eyes(&self) -> Result<Eyes> {
        let chains = self.settings.views().map(|view| self.chain(view)).collect::<Result<Vec<_>>>()?;
        let grids = self.settings.views().map(|view| self.grid(view)).collect::<Result<Vec<_>>>()?;
        let eyes = Eyes::new(chains, grids, self.state_map()?, self.settings);
        Ok(if self.looks() { eyes } else { eyes.closed() })
    }

    /// Whether anything reads what the camera sees: the states, or the script.
    pub(super) fn looks(&self) -> bool {
        self.settings.sees() || self.behaviour.reads_views()
    }

    /// A fresh map from what is perceived to states.
    pub(super) fn state_map(&self) -> Result<Box<dyn StateMap>> {
        let Settings { state, stages, view, .. } = self.settings;
        if !self.settings.has_parts() {
            return Ok(Box::new(GridMap::new(&view.grid, self.grid(view)?)));
        }
        let of_view = |(view, settings): (usize, &ViewSettings)| {
            let map = Box::new(GridMap::new(&settings.grid, self.grid(settings)?));
            Ok(StatePart::View { name: settings.name.clone(), view, map })
        };
        let views = || self.settings.views().enumerate();
        let mut parts = match state.is_empty() {
            true => views().map(of_view).collect::<Result<Vec<_>>>()?,
            false => Vec::new(),
        };
        let mut digits = 0..;
        for part in state {
            match part {
                PartSettings::View(name) => {
                    let view = views().find(|(_, view)| view.name == *name).map(of_view).transpose()?;
                    parts.extend(view);
                }
                PartSettings::Bins { of, edges } => {
                    let (digit, kind) = (digits.next().unwrap_or_default(), DigitKind::Bins(edges.clone()));
                    parts.push(StatePart::Digit { name: of.clone(), digit, labels: part.labels(), kind });
                }
            }
        }
        if !stages.is_empty() {
            let (name, digit) = ("stage".to_owned(), digits.next().unwrap_or_default());
            let labels = stages.iter().map(|stage| format!("\"{stage}\"")).collect();
            parts.push(StatePart::Digit { name, digit, labels, kind: DigitKind::Stages(stages.clone()) });
        }
        let map = ComposedMap::new(parts);
        // A table has a row for each; what remembers its steps has rows of those that were met.
        let pools = self.settings.learner.kind == LearnerKind::Memory;
        let most = if pools { MAX_POOLED_STATES } else { MAX_STATES };
        match map.count() {
            Some(count) if count <= most => Ok(Box::new(map)),
            _ => Err(self.too_many_states(&map, most)),
        }
    }

    fn too_many_states(&self, map: &ComposedMap, most: usize) -> Box<Diagnostic> {
        let message = format!("{} make more than {most} states", map.factors());
        let place = ["state", "stages"].into_iter().find(|place| self.behaviour.place_of(place).is_some());
        let fewer = "use fewer parts, smaller grids, fewer edges or fewer stages";
        let help = Some(match most {
            MAX_STATES => format!("{fewer}, or learner(#{{ kind: \"memory\" }})"),
            _ => fewer.to_owned(),
        });
        self.point(Diagnostic::new("E-GRID", message), place.unwrap_or_default(), "too many states", help)
    }

    /// The mirror that `learner.mirror` asks for.
    pub(super) fn mirror(&self, map: &dyn StateMap) -> Result<Option<Mirror>> {
        if !self.settings.learner.mirror {
            return Ok(None);
        }
        let few = map.states() <= MAX_STATES;
        let states = few
            .then(|| {
                (0..map.states())
                    .map(|state| map.mirrored(state).filter(|other| *other < map.states()))
                    .collect::<Option<Vec<_>>>()
            })
            .flatten();
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
        Ok(self.behaviour.judge(run.period_s, laser.fan())?.with_actions(actions, actions.len()))
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
