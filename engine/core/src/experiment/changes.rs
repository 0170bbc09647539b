//! What the command line changes in a behaviour's settings.

use std::sync::Arc;

use super::Overrides;
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::script::{Behaviour, Param, ParamValues, no_param};
use crate::settings::{
    CONDITION, LearnerKind, SETTINGS, SettingError, Settings, UNNAMED_VIEW, Value, Varied, ViewSettings, WorldShare,
    apply,
};

impl Overrides {
    /// The numbers that it sets and that are no setting: parameters of the script, if it has them.
    pub(super) fn params(&self) -> ParamValues {
        let pairs = self.set.iter().filter_map(|pair| pair.split_once('='));
        let named = pairs.filter(|(name, _)| !name.contains('.'));
        named.filter_map(|(name, text)| Some((name.trim().to_owned(), text.trim().parse().ok()?))).collect()
    }
}

/// A script with the parameters that the command line sets; those that it does not have are told by [`changed`].
pub(super) fn with_params(behaviour: Arc<Behaviour>, overrides: &Overrides) -> Result<Arc<Behaviour>> {
    let mut values = overrides.params();
    values.retain(|name, value| {
        behaviour.params().iter().any(|param| param.name == *name && param.check(*value).is_ok())
    });
    if values.is_empty() { Ok(behaviour) } else { behaviour.with_values(&values).map(Arc::new) }
}

/// The settings with the changes.
pub(super) fn changed(settings: &Settings, params: &[Param], overrides: &Overrides) -> Result<Settings> {
    let mut settings = settings.clone();
    refuse_repeated(overrides)?;
    for pair in &overrides.set {
        set(&mut settings, params, pair)?;
    }
    if let Some(steps) = overrides.steps {
        settings.run.steps = steps;
    }
    if let Some(steps) = overrides.test_steps {
        settings.run.test_steps = steps;
    }
    if let Some(world) = &overrides.world {
        settings.world.clone_from(world);
        settings.worlds.clear();
    }
    if !overrides.worlds.is_empty() {
        let share = |name: &String| WorldShare { name: name.clone(), weight: 1 };
        settings.worlds = overrides.worlds.iter().map(share).collect();
    }
    if overrides.plain {
        settings.randomise.clear();
    }
    refuse_drawn(&settings, overrides)?;
    refuse_unread(&settings, overrides)?;
    Ok(settings)
}

/// Refuses two values of one key: which of them was meant, nobody can tell.
fn refuse_repeated(overrides: &Overrides) -> Result<()> {
    let key = |pair: &str| pair.split_once('=').map_or(pair, |(key, _)| key).trim().to_owned();
    for (index, pair) in overrides.set.iter().enumerate() {
        if let Some(before) = overrides.set[..index].iter().find(|before| key(before) == key(pair)) {
            let [key, before, pair] = [&key(pair), before, pair].map(|text| printable(text));
            let message = format!("'{key}' is set twice: '{before}' and '{pair}'");
            return Diagnostic::new("E-SET", message).help("keep one of the two").fail();
        }
    }
    Ok(())
}

/// The names of what is set, as written.
fn keys(overrides: &Overrides) -> impl Iterator<Item = &str> {
    overrides.set.iter().filter_map(|pair| pair.split_once('=')).map(|(key, _)| key.trim())
}

/// Refuses to set what the learner does not read; a combination of policies has none.
fn refuse_unread(settings: &Settings, overrides: &Overrides) -> Result<()> {
    if !settings.policies.is_empty() {
        return Ok(());
    }
    let learning = keys(overrides).filter_map(|key| key.strip_prefix("learner."));
    let Some((key, (why, _))) = learning.filter_map(|key| Some((key, settings.learner.unread(key)?))).next() else {
        return Ok(());
    };
    let kind = if key.starts_with("memory_") { LearnerKind::Memory } else { LearnerKind::Ttd };
    let help = format!("leave it out, or set the learner too: --set learner.kind={}", kind.word());
    Diagnostic::new("E-SET", format!("'learner.{key}' would have no effect: {why}")).help(help).fail()
}

/// Refuses to set what is drawn anew for each attempt.
fn refuse_drawn(settings: &Settings, overrides: &Overrides) -> Result<()> {
    let drawn = settings.randomise.iter().find(|varied| keys(overrides).any(|key| key == varied.key));
    let Some(Varied { key, .. }) = drawn else { return Ok(()) };
    let message = format!("'{key}' is drawn anew for each attempt: it cannot be set to one value");
    Diagnostic::new("E-SET", message).help(format!("take {key} out of randomise, or change its range there")).fail()
}

/// Carries out one `--set KEY=VALUE`.
fn set(settings: &mut Settings, params: &[Param], pair: &str) -> Result<()> {
    let wrong = |message: String, help: String| Diagnostic::new("E-SET", message).help(help).fail();
    let Some((name, text)) = pair.split_once('=') else {
        let message = format!("'{}' is not KEY=VALUE", printable(pair));
        return wrong(message, "write for example: --set camera.tilt_deg=40".to_owned());
    };
    let Some((group, key)) = name.trim().split_once('.') else {
        if let Some(param) = params.iter().find(|param| param.name == name.trim()) {
            return param.check(text.trim().parse().unwrap_or(f64::NAN));
        }
        let keys: Vec<_> = SETTINGS.iter().map(|row| row.name()).collect();
        let suffix = format!(".{}", name.trim());
        let near = keys.iter().find(|key| key.ends_with(&suffix)).map(String::as_str);
        if near.is_none() && !params.is_empty() {
            return no_param(params, name.trim()).fail();
        }
        let near = near.or_else(|| nearest_name(name, keys.iter().map(String::as_str))).unwrap_or("camera.tilt_deg");
        return wrong(format!("there is no setting '{}'", printable(name)), format!("did you mean '{near}'?"));
    };
    let value = parse(text.trim());
    if group == "filter" {
        return set_filter(&mut settings.view, key, &value, "filter.");
    }
    if let Some(view) = settings.views_mut().find(|view| view.name == group && group != UNNAMED_VIEW) {
        return match key.strip_prefix("filter.") {
            Some(key) => set_filter(view, key, &value, &format!("{group}.filter.")),
            None => view.set_grid(key, &value).map_err(|error| Box::new(refused(error, pair))),
        };
    }
    if group == "view" {
        return of_no_view(settings, key, pair).fail();
    }
    apply(settings, group, key, &value).map_err(|error| Box::new(refused(error, pair)))
}

/// For who writes `view.red.rows`: the settings of a view stand under its own name.
fn of_no_view(settings: &Settings, key: &str, pair: &str) -> Diagnostic {
    let names: Vec<&str> =
        settings.views().map(|view| view.name.as_str()).filter(|name| *name != UNNAMED_VIEW).collect();
    let (name, rest) = key.split_once('.').unwrap_or(("", key));
    let help = match names.iter().find(|known| **known == name) {
        Some(known) => format!(
            "write --set {known}.{}",
            printable(pair.split_once("view.").map_or(rest, |of| &of.1[name.len() + 1..]))
        ),
        None if names.is_empty() => {
            "the script has no named views: write --set grid.rows=3 or --set filter.NAME.PARAMETER=60".to_owned()
        }
        None => format!("settings of a view stand under its name; there are: {}", names.join(", ")),
    };
    Diagnostic::new("E-SET", format!("there is no group of settings 'view': '{}'", printable(pair))).help(help)
}

fn refused(error: SettingError, pair: &str) -> Diagnostic {
    let diagnostic = Diagnostic::new("E-SET", format!("{}: '{}'", error.message, printable(pair)));
    match error.help {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// Sets a parameter of one of a view's filters, which is named or counted from 0: `sobel.threshold`, `0.threshold`.
fn set_filter(view: &mut ViewSettings, key: &str, value: &Value, prefix: &str) -> Result<()> {
    let names: Vec<_> = view.filters.iter().map(|filter| filter.name.clone()).collect();
    let stage = key.split_once('.').and_then(|(name, parameter)| {
        let number = name.parse().ok().filter(|number: &usize| *number < names.len());
        let number = names.iter().position(|known| known == name).or(number)?;
        Some((view.filters.get_mut(number)?, parameter))
    });
    match (stage, value) {
        (Some((filter, CONDITION)), Value::Text(condition)) => filter.condition = Some(condition.clone()),
        (Some((filter, parameter)), Value::Number(number)) => {
            filter.parameters.retain(|(name, _)| name != parameter);
            filter.parameters.push((parameter.to_owned(), *number));
        }
        _ => {
            let message = format!("'{prefix}{}' is not a number of one of the behaviour's filters", printable(key));
            let help = format!("write {prefix}NAME.PARAMETER=NUMBER; the filters are: {}", names.join(", "));
            return Diagnostic::new("E-SET", message).help(help).fail();
        }
    }
    Ok(())
}

fn parse(text: &str) -> Value {
    match (text, text.parse::<f64>()) {
        ("true" | "false", _) => Value::Flag(text == "true"),
        (_, Ok(number)) => Value::Number(number),
        _ => Value::Text(text.trim_matches('"').to_owned()),
    }
}
