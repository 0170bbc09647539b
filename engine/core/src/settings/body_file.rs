//! A body file, read and checked: a robot's body and drive, and its defaults for settings and actions.

use super::body_keys::{BodyForm, BodyKey};
use super::{Bicycle, BodyShape, Footprint, Settings, Value, apply};
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, nearest_name, printable};
use crate::geometry::Twist;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Most actions of a behaviour.
pub(crate) const MAX_ACTIONS: usize = 64;

type Written<'a> = Spanned<DeValue<'a>>;

/// Reads a body file into settings, which have the defaults of the engine where it says nothing. Tells whether it lists
/// actions.
///
/// # Errors
/// `E-ROBOT-SYNTAX`, `-KEY`, `-VALUE`: all that is wrong, each at its place in the file.
pub(crate) fn read_body(source: &SourceText, settings: &mut Settings) -> Result<bool> {
    let table = DeTable::parse(&source.text).map_err(|error| {
        let label = printable(&error.message().replace('\n', ", "));
        let wrong = Diagnostic::new("E-ROBOT-SYNTAX", "this is not TOML");
        let help = "values stand after '=', text in quotes, lists in [ ]; see robots/README.md";
        Box::new(wrong.at(source, error.span().unwrap_or(0..0), label).help(help))
    })?;
    let mut reader = BodyReader { source, mistakes: Mistakes::new(source) };
    let listed = reader.file(table.get_ref(), settings);
    reader.mistakes.end().map(|()| listed)
}

/// Checked values of one table.
#[derive(Default)]
struct Fields {
    numbers: Vec<(&'static str, f64)>,
    word: Option<String>,
}

impl Fields {
    fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(key, _)| *key == name).map(|(_, number)| *number)
    }
}

struct BodyReader<'a> {
    source: &'a SourceText,
    mistakes: Mistakes,
}

impl BodyReader<'_> {
    fn file(&mut self, table: &DeTable<'_>, settings: &mut Settings) -> bool {
        let own = self.fields(table, "", 0..0);
        let inner = |name: &str| table.get(name).and_then(|value| Some((value.get_ref().as_table()?, value.span())));
        let footprint = inner("footprint").and_then(|(table, span)| self.footprint(table, span));
        if let Some((table, span)) = inner("drive") {
            self.drive(table, span, settings);
        }
        let limits = &mut settings.robot.drive;
        limits.greatest_m_per_s = own.number("greatest_m_per_s").unwrap_or(limits.greatest_m_per_s);
        limits.greatest_rad_per_s = own.number("greatest_rad_per_s").unwrap_or(limits.greatest_rad_per_s);
        settings.robot.lag_s = own.number("lag_s").unwrap_or(settings.robot.lag_s);
        settings.camera.deck_m = own.number("height_m").unwrap_or(settings.camera.deck_m);
        for group in ["camera", "laser"] {
            if let Some((table, _)) = inner(group) {
                self.group(group, table, settings);
            }
        }
        if let (Some(footprint), Some(height_m), Some(step_m)) =
            (footprint, own.number("height_m"), own.number("step_m"))
        {
            let [x, y] = footprint.wheels_m();
            let bicycle = settings.robot.drive.bicycle.map(|bicycle| bicycle.wheelbase_m);
            settings.robot.body = BodyShape {
                footprint,
                height_m,
                step_m,
                steepest: own.number("slope_deg").map_or(f64::INFINITY, |slope_deg| libm::tan(slope_deg.to_radians())),
                wheelbase_m: own.number("wheelbase_m").or(bicycle).unwrap_or(x),
                track_m: own.number("track_m").unwrap_or(y),
            };
        }
        match table.get("actions") {
            Some(actions) => self.actions(actions, settings),
            None => return false,
        }
        true
    }

    fn footprint(&mut self, table: &DeTable<'_>, span: Range<usize>) -> Option<Footprint> {
        let fields = self.fields(table, "footprint", span.clone());
        match fields.word.as_deref()? {
            "round" => {
                let [radius_m] = self.exactly(table, "footprint", "round", ["radius_m"], &fields, &span)?;
                Some(Footprint::Round { radius_m })
            }
            _ => {
                let ahead_m = fields.number("ahead_m").unwrap_or(0.0);
                let names = ["length_m", "width_m"];
                let [length_m, width_m] = self.exactly(table, "footprint", "rectangle", names, &fields, &span)?;
                Some(Footprint::Rectangle { length_m, width_m, ahead_m })
            }
        }
    }

    fn drive(&mut self, table: &DeTable<'_>, span: Range<usize>, settings: &mut Settings) {
        let fields = self.fields(table, "drive", span.clone());
        let Some(kind) = fields.word.as_deref() else { return };
        match kind {
            "bicycle" => {
                let names = ["wheelbase_m", "steer_deg"];
                if let Some([wheelbase_m, steer_deg]) = self.exactly(table, "drive", kind, names, &fields, &span) {
                    settings.robot.drive.bicycle = Some(Bicycle { wheelbase_m, steer_deg });
                }
            }
            "skid" => {
                if let Some([slip]) = self.exactly(table, "drive", kind, ["slip"], &fields, &span) {
                    settings.robot.slip = slip;
                }
            }
            _ => drop(self.exactly(table, "drive", kind, [], &fields, &span)),
        }
    }

    /// The numbers that a kind of a table needs; it must not have those of another kind.
    fn exactly<const N: usize>(
        &mut self,
        table: &DeTable<'_>,
        section: &'static str,
        kind: &str,
        names: [&'static str; N],
        fields: &Fields,
        span: &Range<usize>,
    ) -> Option<[f64; N]> {
        let fine = |name: &str| {
            names.contains(&name) || matches!(name, "shape" | "kind") || (kind, name) == ("rectangle", "ahead_m")
        };
        for (name, _) in table.iter().filter(|(name, _)| !fine(name.get_ref())) {
            if BodyKey::of(section).any(|key| key.name == name.get_ref()) {
                let wrong =
                    Diagnostic::new("E-ROBOT-KEY", format!("'{}' does not belong to \"{kind}\"", name.get_ref()));
                let help = match names.join("', '") {
                    needed if needed.is_empty() => "leave it out".to_owned(),
                    needed => format!("leave it out; \"{kind}\" has '{needed}'"),
                };
                self.mistakes.add(wrong.at(self.source, name.span(), "of another kind").help(help));
            }
        }
        for name in names {
            if !table.contains_key(name) {
                let wrong = Diagnostic::new("E-ROBOT-KEY", format!("[{section}] \"{kind}\" has no '{name}'"));
                let allowed =
                    BodyKey::of(section).find(|key| key.name == name).map(BodyKey::allowed).unwrap_or_default();
                let help = format!("add {name} = ...: {allowed}");
                self.mistakes.add(wrong.at(self.source, span.clone(), format!("needs '{name}'")).help(help));
            }
        }
        let mut found = [0.0; N];
        for (place, name) in found.iter_mut().zip(names) {
            *place = fields.number(name)?;
        }
        Some(found)
    }

    /// The plain values of a table, and that it has all that it must have and nothing else.
    fn fields(&mut self, table: &DeTable<'_>, section: &'static str, span: Range<usize>) -> Fields {
        let (mut fields, mut misspelt) = (Fields::default(), false);
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        for (name, value) in entries {
            let Some(key) = BodyKey::of(section).find(|key| key.name == name.get_ref()) else {
                self.unknown(name.get_ref(), name.span(), section);
                misspelt = true;
                continue;
            };
            match (key.form, value.get_ref()) {
                (BodyForm::Number(low, high), value) if number(value).is_some_and(|n| (low..=high).contains(&n)) => {
                    fields.numbers.extend(number(value).map(|number| (key.name, number)));
                }
                (BodyForm::Word(words), DeValue::String(word)) if words.contains(&word.as_ref()) => {
                    fields.word = Some(word.to_string());
                }
                (BodyForm::Text, DeValue::String(_)) | (BodyForm::Table, DeValue::Table(_)) => {}
                (BodyForm::Actions, DeValue::Array(_)) => {}
                _ => self.wrong(format!("'{}' must be {}", key.name, key.allowed()), value),
            }
        }
        // A key that is not known may be the one that is missing.
        let missing = |key: &&BodyKey| key.required && !misspelt && !table.contains_key(key.name);
        for key in BodyKey::of(section).filter(missing) {
            let of = if section.is_empty() { "a body file".to_owned() } else { format!("[{section}]") };
            let wrong = Diagnostic::new("E-ROBOT-KEY", format!("{of} has no '{}'", key.name));
            let help = format!("add '{}': {}. {}", key.name, key.allowed(), key.purpose);
            self.mistakes.add(wrong.at(self.source, span.clone(), format!("needs '{}'", key.name)).help(help));
        }
        fields
    }

    fn unknown(&mut self, name: &str, span: Range<usize>, section: &'static str) {
        let of = if section.is_empty() { "a body file".to_owned() } else { format!("[{section}]") };
        let names = || BodyKey::of(section).map(|key| key.name);
        let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
        let same = names().find(|known| known.rsplit_once('_').is_some_and(|(own, _)| own == name || own == stem));
        let help = match same.or_else(|| nearest_name(name, names())) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!("it has: {}", names().collect::<Vec<_>>().join(", ")),
        };
        let wrong = Diagnostic::new("E-ROBOT-KEY", format!("{of} has no key '{}'", printable(name)));
        self.mistakes.add(wrong.at(self.source, span, "not known").help(help));
    }

    fn wrong(&mut self, message: String, value: &Written<'_>) {
        let found = match value.get_ref() {
            DeValue::String(text) => format!("found the text \"{}\"", printable(text)),
            DeValue::Integer(_) | DeValue::Float(_) | DeValue::Boolean(_) => {
                format!("found {}", printable(&self.source.text[value.span()]))
            }
            DeValue::Array(array) => format!("found a list of {}", array.len()),
            _ => "found something else".to_owned(),
        };
        self.mistakes.add(Diagnostic::new("E-ROBOT-VALUE", message).at(self.source, value.span(), found));
    }

    /// The settings of a group.
    fn group(&mut self, group: &str, table: &DeTable<'_>, settings: &mut Settings) {
        for (name, written) in table {
            let value = match written.get_ref() {
                DeValue::Boolean(flag) => Value::Flag(*flag),
                DeValue::String(text) => Value::Text(text.to_string()),
                other => Value::Number(number(other).unwrap_or(f64::NAN)),
            };
            if let Err(error) = apply(settings, group, name.get_ref(), &value) {
                let known = super::SETTINGS.iter().any(|row| row.group == group && row.key == name.get_ref());
                let (code, span) = if known { ("E-ROBOT-VALUE", written.span()) } else { ("E-ROBOT-KEY", name.span()) };
                let mut wrong = Diagnostic::new(code, error.message).at(self.source, span, error.found);
                wrong.help = error.help;
                self.mistakes.add(wrong);
            }
        }
    }

    fn actions(&mut self, written: &Written<'_>, settings: &mut Settings) {
        let Some(list) = written.get_ref().as_array() else { return };
        if list.is_empty() || list.len() > MAX_ACTIONS {
            return self.wrong(format!("there must be 1 to {MAX_ACTIONS} actions"), written);
        }
        let mut twists = Vec::with_capacity(list.len());
        for (index, action) in list.iter().enumerate() {
            let pair =
                action.get_ref().as_array().map(|pair| pair.iter().map(|n| number(n.get_ref())).collect::<Vec<_>>());
            let Some([Some(linear), Some(angular)]) = pair.as_deref() else {
                self.wrong(format!("action {index} is not a pair of numbers"), action);
                continue;
            };
            let twist = Twist::new(*linear, *angular);
            if let Some(why) = settings.robot.drive.refuses(twist) {
                let wrong = Diagnostic::new("E-ROBOT-VALUE", format!("action {index} is {why}"));
                self.mistakes.add(wrong.at(self.source, action.span(), "this robot cannot do that"));
            }
            twists.push(twist);
        }
        settings.actions = twists;
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(|number| number as f64),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}
