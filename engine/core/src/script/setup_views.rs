//! The set-up calls `view` and `state`, and `filter` and `grid` within them.

use super::setup::{Call, CallToken, SetupReader};
use super::setup_table::SETUP;
use super::state_parts::{BinsToken, WrittenBins};
use crate::diagnostic::{Result, nearest_name, printable};
use crate::judge::explain;
use crate::judge::views::number;
use crate::settings::{CONDITION, FilterSettings, PartSettings, UNNAMED_VIEW, Value, ViewSettings};
use rhai::{Dynamic, Map};

/// Most views, most filters of one, and most parts of a state.
const MAX_VIEWS: usize = 8;
const MAX_FILTERS: usize = 8;
const MAX_PARTS: usize = 8;
const VIEW_FORM: &str = "view(\"red\", filter(\"colour\"), grid(#{ rows: 2, columns: 3 }));";
const WHERE_FORM: &str = "filter(\"where\", \"r > 1.5 * g && r > 60\");";
const STATE_FORM: &str = "state(\"red\", bins(laser.front, [0.5, 1.0]));";

impl SetupReader<'_> {
    /// Takes the views with names, and what belongs to them, out of the calls.
    pub(super) fn views(&mut self, calls: &mut Vec<Call>) {
        let mut taken = vec![false; calls.len()];
        let mut views: Vec<ViewSettings> = Vec::new();
        for index in 0..calls.len() {
            if calls[index].name == "view" {
                taken[index] = true;
                self.call = calls[index].position;
                let arguments = std::mem::take(&mut calls[index].arguments);
                let mut view = ViewSettings::named("");
                if let Err(wrong) = self.view(&mut view, arguments, calls, &mut taken) {
                    self.mistakes.add(*wrong);
                    self.unread.all_of("view");
                }
                views.push(view);
                if views.len() == MAX_VIEWS + 1 {
                    let message = format!("a script may have {MAX_VIEWS} views");
                    let wrong =
                        explain::mistake(&self.code.source, "E-SCRIPT-LIMIT", self.call, message, "one too many");
                    self.mistakes.add(wrong);
                }
            }
        }
        let mut numbers = taken.into_iter();
        calls.retain(|_| numbers.next() == Some(false));
        if !views.is_empty() && self.code.views.index(UNNAMED_VIEW).is_none() {
            self.settings.view = views.remove(0);
        }
        self.settings.further_views = views;
    }

    fn view(
        &mut self,
        view: &mut ViewSettings,
        arguments: Vec<Dynamic>,
        calls: &mut [Call],
        taken: &mut [bool],
    ) -> Result<()> {
        let otherwise = |setup: &Self| {
            setup.wrong(setup.call, "a view is a name, filters, and a grid".to_owned(), "found this", VIEW_FORM)
        };
        let mut arguments = arguments.into_iter();
        match arguments.next() {
            Some(name) if name.is_string() => view.name = self.word(name, VIEW_FORM)?,
            _ => return otherwise(self),
        }
        let name = view.name.clone();
        self.mark(format!("view \"{name}\""), self.call)?;
        let mut grid = false;
        for argument in arguments {
            let Some(CallToken(part)) = argument.try_cast::<CallToken>() else { return otherwise(self) };
            let Some(call) = calls.get_mut(part).filter(|call| matches!(call.name, "filter" | "grid") && !grid) else {
                return otherwise(self);
            };
            if std::mem::replace(&mut taken[part], true) {
                let message = format!("this {} belongs to another view already", call.name);
                return self.wrong(self.call, message, "used again here", VIEW_FORM);
            }
            grid = call.name == "grid";
            let outer = std::mem::replace(&mut self.call, call.position);
            let arguments = std::mem::take(&mut call.arguments);
            let result = if grid { self.grid_of(view, arguments) } else { self.filter_of(view, arguments) };
            self.call = outer;
            result?;
        }
        match view.filters.len() {
            1..=MAX_FILTERS => Ok(()),
            found => {
                let message = format!("a view has 1 to {MAX_FILTERS} filters, found {found}");
                self.wrong(self.call, message, "set here", VIEW_FORM)
            }
        }
    }

    fn filter_of(&mut self, view: &mut ViewSettings, arguments: Vec<Dynamic>) -> Result<()> {
        let form = SETUP.iter().find(|row| row.name == "filter").map_or("", |row| row.form);
        let mut arguments = arguments.into_iter();
        match (arguments.next(), arguments.next(), arguments.next()) {
            (Some(name), parameters, None) if name.is_string() => self.filter(view, name, parameters, form),
            _ => self.wrong(self.call, "'filter' is written otherwise".to_owned(), "found this", form),
        }
    }

    fn grid_of(&mut self, view: &mut ViewSettings, arguments: Vec<Dynamic>) -> Result<()> {
        let form = "grid(#{ rows: 2, columns: 3 })";
        let mut arguments = arguments.into_iter();
        let (Some(map), None) = (arguments.next().and_then(Dynamic::try_cast::<Map>), arguments.next()) else {
            return self.wrong(self.call, "'grid' needs its settings by name".to_owned(), "found something else", form);
        };
        for (key, value) in map {
            let (at_key, at_value) = self.entry(&key);
            let known = crate::settings::SETTINGS.iter().any(|row| row.group == "grid" && row.key == key.as_str());
            let value = match (number(&value), value.as_bool(), value.into_string()) {
                (Some(number), ..) => Value::Number(number),
                (_, Ok(flag), _) => Value::Flag(flag),
                (.., text) => Value::Text(text.unwrap_or_default()),
            };
            let position = if known { at_value } else { at_key };
            let result = match view.set_grid(&key, &value) {
                Ok(()) => self.mark(view.place(&format!("grid.{key}")), position),
                Err(error) => {
                    let wrong =
                        explain::mistake(&self.code.source, "E-SCRIPT-SETTING", position, error.message, error.found);
                    match error.help {
                        Some(help) => wrong.help(help).fail(),
                        None => wrong.fail(),
                    }
                }
            };
            self.tell("grid", &key, result);
        }
        Ok(())
    }

    /// Does something with the view that has no name.
    pub(super) fn in_unnamed_view(
        &mut self,
        change: impl FnOnce(&mut Self, &mut ViewSettings) -> Result<()>,
    ) -> Result<()> {
        let mut view = std::mem::replace(&mut self.settings.view, ViewSettings::named(UNNAMED_VIEW));
        let result = change(self, &mut view);
        self.settings.view = view;
        result
    }

    /// `state(part, ...)`.
    pub(super) fn state(&mut self, parts: impl Iterator<Item = Dynamic>) -> Result<()> {
        self.mark("state".to_owned(), self.call)?;
        let (mut found, mut all_read) = (0, true);
        for part in parts {
            found += 1;
            if let Err(wrong) = self.part(part) {
                self.mistakes.add(*wrong);
                self.unread.all_of("state");
                all_read = false;
            }
        }
        match found {
            _ if !all_read => Ok(()),
            1..=MAX_PARTS => Ok(()),
            found => {
                let message = format!("a state has 1 to {MAX_PARTS} parts, found {found}");
                self.wrong(self.call, message, "set here", STATE_FORM)
            }
        }
    }

    fn part(&mut self, part: Dynamic) -> Result<()> {
        if part.is_string() {
            return self.part_of_view(part.into_string().unwrap_or_default());
        }
        let Some(token) = part.try_cast::<BinsToken>() else {
            let message = "a part of a state is the name of a view, or bins".to_owned();
            return self.wrong(self.call, message, "found something else", STATE_FORM);
        };
        let bins = WrittenBins::new(self.code, self.ast, &token)?;
        let (of, edges) = (bins.text.clone(), bins.edges.clone());
        self.settings.state.push(PartSettings::Bins { of, edges });
        self.bins.push(bins);
        Ok(())
    }

    fn part_of_view(&mut self, name: String) -> Result<()> {
        let part = PartSettings::View(name.clone());
        if self.settings.state.contains(&part) {
            let message = format!("the view \"{}\" is twice in the state", printable(&name));
            return self.wrong(self.call, message, "set here", STATE_FORM);
        }
        let views = self.code.views.all();
        if !views.contains(&name) {
            let message = format!("there is no view \"{}\"", printable(&name));
            let help = match nearest_name(&name, views.iter().map(String::as_str)) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!("there are: {}", views.join(", ")),
            };
            let wrong = explain::mistake(&self.code.source, "E-SCRIPT-VIEW", self.call, message, "not known");
            return wrong.help(help).fail();
        }
        self.settings.state.push(part);
        Ok(())
    }

    /// Adds a filter to a view's chain.
    pub(super) fn filter(
        &mut self,
        view: &mut ViewSettings,
        name: Dynamic,
        parameters: Option<Dynamic>,
        form: &str,
    ) -> Result<()> {
        let mut filter = FilterSettings::new(&self.word(name, form)?);
        let is_where = filter.name == "where";
        let form = if is_where { WHERE_FORM } else { form };
        let stage = view.place(&format!("filter:{}", view.filters.len()));
        self.mark(stage.clone(), self.call)?;
        let mut parameters = parameters.unwrap_or_else(|| Map::new().into());
        if parameters.is_string() {
            parameters = Map::from([(CONDITION.into(), parameters)]).into();
        }
        let Some(parameters) = parameters.try_cast::<Map>() else {
            return self.wrong(
                self.call,
                "a filter needs its parameters by name".to_owned(),
                "found something else",
                form,
            );
        };
        for (key, value) in parameters {
            let (_, position) = self.entry(&key);
            if let (CONDITION, Ok(condition)) = (key.as_str(), value.clone().into_immutable_string()) {
                filter.condition = Some(condition.to_string());
                self.mark(format!("{stage}.{key}"), position)?;
                continue;
            }
            if let (true, Ok(condition)) = (is_where, value.clone().into_immutable_string()) {
                let message = format!("'{}' is no parameter of filter \"where\"", printable(&key));
                let write = format!("filter(\"where\", \"{}\");", printable(&condition));
                let wrong = self.wrong(self.entry(&key).0, message, "the condition stands alone", &write);
                self.tell("filter", &key, wrong);
                continue;
            }
            let switch = value.as_bool().ok().map(|on| f64::from(u8::from(on)));
            match number(&value).or(switch).filter(|number| number.is_finite()) {
                Some(number) => filter.parameters.push((key.to_string(), number)),
                None => {
                    let message = format!("the parameter '{}' must be a number, false or true", printable(&key));
                    let wrong = self.wrong(position, message, "found something else", form);
                    self.tell("filter", &key, wrong);
                }
            }
            self.mark(format!("{stage}.{key}"), position)?;
        }
        view.filters.push(filter);
        Ok(())
    }
}
