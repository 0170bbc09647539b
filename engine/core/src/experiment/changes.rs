//! What the command line changes in a behaviour's settings.

use super::Overrides;
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::settings::{SETTINGS, SettingError, Settings, UNNAMED_VIEW, Value, ViewSettings, apply};

/// The settings with the changes.
pub(super) fn changed(settings: &Settings, overrides: &Overrides) -> Result<Settings> {
    let mut settings = settings.clone();
    for pair in &overrides.set {
        set(&mut settings, pair)?;
    }
    if let Some(steps) = overrides.steps {
        settings.run.steps = steps;
    }
    if let Some(steps) = overrides.test_steps {
        settings.run.test_steps = steps;
    }
    if let Some(world) = &overrides.world {
        settings.world.clone_from(world);
    }
    Ok(settings)
}

/// Carries out one `--set KEY=VALUE`.
fn set(settings: &mut Settings, pair: &str) -> Result<()> {
    let wrong = |message: String, help: String| Diagnostic::new("E-SET", message).help(help).fail();
    let Some((name, text)) = pair.split_once('=') else {
        let message = format!("'{}' is not KEY=VALUE", printable(pair));
        return wrong(message, "write for example: --set camera.tilt_deg=40".to_owned());
    };
    let Some((group, key)) = name.trim().split_once('.') else {
        let keys: Vec<_> = SETTINGS.iter().map(|row| row.name()).collect();
        let suffix = format!(".{}", name.trim());
        let near = keys.iter().find(|key| key.ends_with(&suffix)).map(String::as_str);
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
    apply(settings, group, key, &value).map_err(|error| Box::new(refused(error, pair)))
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
    let (Some((filter, parameter)), Value::Number(number)) = (stage, value) else {
        let message = format!("'{prefix}{}' is not a number of one of the behaviour's filters", printable(key));
        let help = format!("write {prefix}NAME.PARAMETER=NUMBER; the filters are: {}", names.join(", "));
        return Diagnostic::new("E-SET", message).help(help).fail();
    };
    filter.parameters.retain(|(name, _)| name != parameter);
    filter.parameters.push((parameter.to_owned(), *number));
    Ok(())
}

fn parse(text: &str) -> Value {
    match (text, text.parse::<f64>()) {
        ("true" | "false", _) => Value::Flag(text == "true"),
        (_, Ok(number)) => Value::Number(number),
        _ => Value::Text(text.trim_matches('"').to_owned()),
    }
}
