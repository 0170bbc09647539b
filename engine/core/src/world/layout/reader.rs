//! Reads a world file against its schema: syntax, names, types and ranges, each error at the user's own place.

use super::movers::pushable;
use super::schema::{FILE, FileKey, KeyForm, MOST_POINTS};
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, nearest_name, printable};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Written<'a> = Spanned<DeValue<'a>>;

/// A checked value.
#[derive(Debug)]
pub(super) enum Field {
    Text(String),
    Flag(bool),
    Numbers(Vec<f64>),
    /// Points with their places.
    Points(Vec<([f64; 2], Range<usize>)>),
    Rows(Vec<FileRow>),
}

/// A checked table.
#[derive(Debug)]
pub(super) struct FileRow {
    /// Where it begins.
    pub(super) span: Range<usize>,
    /// Whether there is no mistake in it.
    pub(super) sound: bool,
    /// Whether it has a key that is not known, which may be any other key misspelt.
    pub(super) misspelt: bool,
    fields: Vec<(&'static str, Range<usize>, Field)>,
    unusable: Vec<&'static str>,
}

impl FileRow {
    fn field(&self, key: &str) -> Option<&Field> {
        self.fields.iter().find(|(name, ..)| *name == key).map(|(.., field)| field)
    }

    /// The place of a key's value; the table's if the key is not there.
    pub(super) fn span_of(&self, key: &str) -> Range<usize> {
        self.fields.iter().find(|(name, ..)| *name == key).map_or(self.span.clone(), |(_, span, _)| span.clone())
    }

    /// Whether a key is there.
    pub(super) fn has(&self, key: &str) -> bool {
        self.field(key).is_some()
    }

    pub(super) fn text(&self, key: &str) -> Option<&str> {
        if let Some(Field::Text(text)) = self.field(key) { Some(text) } else { None }
    }

    pub(super) fn flag(&self, key: &str) -> Option<bool> {
        if let Some(Field::Flag(flag)) = self.field(key) { Some(*flag) } else { None }
    }

    /// The numbers of an array; none if the key is not there.
    pub(super) fn numbers(&self, key: &str) -> &[f64] {
        if let Some(Field::Numbers(numbers)) = self.field(key) { numbers } else { &[] }
    }

    pub(super) fn number(&self, key: &str) -> Option<f64> {
        self.numbers(key).first().copied()
    }

    pub(super) fn points(&self, key: &str) -> &[([f64; 2], Range<usize>)] {
        if let Some(Field::Points(points)) = self.field(key) { points } else { &[] }
    }

    /// The tables of a section that have no mistake.
    pub(super) fn sound_rows(&self, key: &str) -> impl Iterator<Item = &Self> {
        self.rows(key).iter().filter(|row| row.sound)
    }

    /// Whether a key is written whose value cannot be used.
    pub(super) fn lacks(&self, key: &str) -> bool {
        self.unusable.contains(&key)
    }

    /// The tables of a section; none if it is not there.
    pub(super) fn rows(&self, key: &str) -> &[Self] {
        if let Some(Field::Rows(rows)) = self.field(key) { rows } else { &[] }
    }
}

/// Reads the whole file, and adds what is wrong in its keys and values to `mistakes`.
///
/// # Errors
/// If it is not TOML.
pub(super) fn read(source: &SourceText, mistakes: &mut Mistakes) -> Result<FileRow> {
    let table = match DeTable::parse(&source.text) {
        Ok(table) => table,
        Err(error) if !is_double(&error) => return syntax(source, &error).fail(),
        Err(first) => {
            let (table, errors) = DeTable::parse_recoverable(&source.text);
            // Behind any other mistake a key may be there twice only because a table's head is lost.
            if !errors.iter().all(is_double) {
                return syntax(source, errors.iter().find(|error| !is_double(error)).unwrap_or(&first)).fail();
            }
            errors.iter().for_each(|error| mistakes.add(syntax(source, error)));
            table
        }
    };
    Ok(FileReader { source, mistakes }.row(table.get_ref(), 0..0, "", FILE))
}

fn is_double(error: &toml::de::Error) -> bool {
    error.message().contains("duplicate key")
}

fn syntax(source: &SourceText, error: &toml::de::Error) -> Diagnostic {
    let span = error.span().unwrap_or(0..0);
    let word = source.text.get(span.clone()).unwrap_or_default().trim();
    let (message, help) = if error.message().contains("recursion limit") {
        ("the file is nested too deeply", "a world needs three levels: a list of points, a point, a number")
    } else if is_double(error) {
        ("a key is there twice", "keep one of the two; tables that may repeat are written [[name]]")
    } else if ["yes", "on", "True", "TRUE"].contains(&word) {
        ("this is not TOML", "write true")
    } else if ["no", "off", "False", "FALSE"].contains(&word) {
        ("this is not TOML", "write false")
    } else {
        ("this is not TOML", "values stand after '=', text in quotes, lists in [ ]; see worlds/README.md")
    };
    Diagnostic::new("E-WORLD-SYNTAX", message)
        .at(source, span, printable(&error.message().replace('\n', ", ")))
        .help(help)
}

struct FileReader<'a> {
    source: &'a SourceText,
    mistakes: &'a mut Mistakes,
}

impl FileReader<'_> {
    fn row(&mut self, table: &DeTable<'_>, span: Range<usize>, section: &str, keys: &'static [FileKey]) -> FileRow {
        let mut row = FileRow { span, sound: true, misspelt: false, fields: Vec::new(), unusable: Vec::new() };
        let mut entries: Vec<_> = table.iter().collect();
        entries.sort_by_key(|(name, _)| name.span().start);
        for (name, value) in entries {
            let Some(key) = keys.iter().find(|key| key.name == name.get_ref().as_ref()) else {
                if self.mistakes.wants(self.source, name.span().start) {
                    self.mistakes.add(self.unknown(name, section, keys));
                }
                (row.sound, row.misspelt) = (false, true);
                continue;
            };
            match self.value(key, value) {
                Some(field) => {
                    row.sound &= !matches!(&field, Field::Rows(rows) if rows.iter().any(|row| !row.sound));
                    row.fields.push((key.name, value.span(), field));
                }
                None => {
                    row.sound = false;
                    row.unusable.push(key.name);
                }
            }
        }
        let mut missing = keys.iter().filter(|key| key.required && !table.contains_key(key.name));
        if let Some(key) = missing.next() {
            row.sound = false;
            // A key that is not known may be the one that is missing.
            if !row.misspelt {
                let message = format!("{} has no '{}'", of(section), key.name);
                let more: String = missing.map(|key| format!("; it needs '{}' too", key.name)).collect();
                let help = format!("add '{} = ...': {}{more}", key.name, key.allowed());
                let wrong = Diagnostic::new("E-WORLD-KEY", message);
                let label = format!("needs '{}'", key.name);
                self.mistakes.add(wrong.at(self.source, row.span.clone(), label).help(help));
            }
        }
        row
    }

    fn unknown(
        &self,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        section: &str,
        keys: &'static [FileKey],
    ) -> Diagnostic {
        let written = name.get_ref();
        let stem = written.rsplit_once('_').map_or(written.as_ref(), |(stem, _)| stem);
        // `height_cm` and `height` both mean `height_m`: the stem is right, the unit is not.
        let same = keys.iter().find(|key| {
            !key.unit.is_empty()
                && key.name.rsplit_once('_').is_some_and(|(own, unit)| {
                    let own = own.strip_suffix("_m_per").map_or(own, |own| own);
                    unit.len() <= 3 && (own == written.as_ref() || own == stem || own == stem.trim_end_matches("_per"))
                })
        });
        let near = nearest_name(written, keys.iter().map(|key| key.name));
        let help = match (same, near) {
            _ if pushable(written).is_some() => pushable(written).unwrap_or_default().to_owned(),
            (Some(key), _) => format!("write '{}', in {}", key.name, key.unit),
            (None, Some(near)) => format!("did you mean '{near}'?"),
            _ => format!("it has: {}", keys.iter().map(|key| key.name).collect::<Vec<_>>().join(", ")),
        };
        let message = format!("{} has no key '{}'", of(section), printable(written));
        Diagnostic::new("E-WORLD-KEY", message).at(self.source, name.span(), "not known").help(help)
    }

    fn wrong(&self, key: &FileKey, value: &Written<'_>, label: impl Into<String>) -> Diagnostic {
        Diagnostic::new("E-WORLD-VALUE", format!("'{}' must be {}", key.name, key.allowed())).at(
            self.source,
            value.span(),
            label,
        )
    }

    fn value(&mut self, key: &'static FileKey, value: &Written<'_>) -> Option<Field> {
        let found = |reader: &Self| reader.wrong(key, value, format!("found {}", shown(value.get_ref())));
        match key.form {
            KeyForm::Table(keys) => match value.get_ref().as_table() {
                Some(table) => Some(Field::Rows(vec![self.row(table, value.span(), &format!("[{}]", key.name), keys)])),
                None => {
                    self.mistakes.add(found(self));
                    None
                }
            },
            KeyForm::Tables(keys, most) => self.tables(key, value, keys, most),
            _ => {
                let field = self.plain(key, value);
                self.mistakes.take(field)
            }
        }
    }

    fn tables(
        &mut self,
        key: &'static FileKey,
        value: &Written<'_>,
        keys: &'static [FileKey],
        most: usize,
    ) -> Option<Field> {
        let Some(tables) = value.get_ref().as_array() else {
            self.mistakes.add(self.wrong(key, value, format!("found {}", shown(value.get_ref()))));
            return None;
        };
        if tables.len() > most {
            let label = format!("there are {}, at most {most} are allowed", tables.len());
            self.mistakes.add(self.wrong(key, value, label));
            return None;
        }
        let section = format!("[[{}]]", key.name);
        let (mut rows, mut whole) = (Vec::with_capacity(tables.len()), true);
        for row in tables.iter() {
            if let Some(table) = row.get_ref().as_table() {
                rows.push(self.row(table, row.span(), &section, keys));
            } else {
                self.mistakes.add(self.wrong(key, row, format!("found {}", shown(row.get_ref()))));
                whole = false;
            }
        }
        whole.then_some(Field::Rows(rows))
    }

    fn plain(&self, key: &'static FileKey, value: &Written<'_>) -> Result<Field> {
        let found = || self.wrong(key, value, format!("found {}", shown(value.get_ref())));
        Ok(match key.form {
            KeyForm::Text => Field::Text(value.get_ref().as_str().ok_or_else(found)?.to_owned()),
            KeyForm::Flag => Field::Flag(value.get_ref().as_bool().ok_or_else(found)?),
            KeyForm::Choice(words) => {
                let word = value.get_ref().as_str().ok_or_else(found)?;
                if !words.contains(&word) {
                    let near = nearest_name(word, words.iter().copied());
                    let error = found();
                    return match near {
                        Some(near) => error.help(format!("did you mean \"{near}\"?")).fail(),
                        None => error.fail(),
                    };
                }
                Field::Text(word.to_owned())
            }
            KeyForm::Number(low, high) => Field::Numbers(vec![self.number(key, value, |n| (low..=high).contains(&n))?]),
            KeyForm::Span(low, high) if value.get_ref().as_array().is_some() => {
                let span = self.array(key, value, 2..=2, |n| (low..=high).contains(&n))?;
                if span[0] > span[1] {
                    let help = format!("write [{}, {}]", span[1], span[0]);
                    return self.wrong(key, value, "the second is less than the first").help(help).fail();
                }
                Field::Numbers(span)
            }
            KeyForm::Span(low, high) => Field::Numbers(vec![self.number(key, value, |n| (low..=high).contains(&n))?]),
            KeyForm::Numbers(count, low, high) => {
                Field::Numbers(self.array(key, value, count..=count, |n| (low..=high).contains(&n))?)
            }
            KeyForm::Points(least) => Field::Points(self.points(key, value, least)?),
            KeyForm::Table(_) | KeyForm::Tables(..) => return found().fail(),
        })
    }

    fn number(&self, key: &FileKey, value: &Written<'_>, allowed: impl Fn(f64) -> bool) -> Result<f64> {
        let number = match value.get_ref() {
            DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(|n| n as f64),
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        };
        match number {
            // Not a number lies in no range.
            Some(number) if allowed(number) => Ok(number + 0.0),
            _ => self.wrong(key, value, format!("found {}", shown(value.get_ref()))).fail(),
        }
    }

    fn array(
        &self,
        key: &FileKey,
        value: &Written<'_>,
        count: std::ops::RangeInclusive<usize>,
        allowed: impl Fn(f64) -> bool,
    ) -> Result<Vec<f64>> {
        let Some(array) = value.get_ref().as_array() else {
            return self.wrong(key, value, format!("found {}", shown(value.get_ref()))).fail();
        };
        if !count.contains(&array.len()) {
            let help = match (key.name, count.start()) {
                ("size_m", 3) => "a solid needs [length, width, height], such as [4.0, 4.0, 0.5]",
                _ => "",
            };
            return self.wrong(key, value, format!("found {} numbers", array.len())).help(help).fail();
        }
        array.iter().map(|number| self.number(key, number, &allowed)).collect()
    }

    fn points(&self, key: &FileKey, value: &Written<'_>, least: usize) -> Result<Vec<([f64; 2], Range<usize>)>> {
        let Some(array) = value.get_ref().as_array() else {
            return self.wrong(key, value, format!("found {}", shown(value.get_ref()))).fail();
        };
        if !(least..=MOST_POINTS).contains(&array.len()) {
            return self.wrong(key, value, format!("found {} points, at most {MOST_POINTS}", array.len())).fail();
        }
        let mut points: Vec<([f64; 2], Range<usize>)> = Vec::with_capacity(array.len());
        for point in array {
            let pair = self.array(key, point, 2..=2, FileKey::coordinate)?;
            let here = [pair[0], pair[1]];
            let (x, y) = points.last().map_or((f64::MAX, 0.0), |(last, _)| (here[0] - last[0], here[1] - last[1]));
            if x.abs().max(y.abs()) < 1e-6 {
                return Diagnostic::new("E-WORLD-VALUE", format!("two points of '{}' are the same", key.name))
                    .at(self.source, point.span(), "the same point as the one before")
                    .help("delete one of the two: a segment needs a length")
                    .fail();
            }
            points.push((here, point.span()));
        }
        Ok(points)
    }
}

fn of(section: &str) -> String {
    if section.is_empty() { "a world file".to_owned() } else { section.to_owned() }
}

/// A value in the words of the file, without its content where that may be long.
fn shown(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the text \"{}\"", printable(text)),
        DeValue::Integer(whole) => whole.to_string(),
        DeValue::Float(float) => float.to_string(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(array) => format!("an array of {}", array.len()),
        DeValue::Table(_) => "one table".to_owned(),
    }
}
