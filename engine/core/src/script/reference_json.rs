//! The script language as data, for editors and other tools: the tables that the engine itself uses.

use super::setup_table::SETUP;
use crate::diagnostic::{all_codes, code_page};
use crate::judge::Reach;
use crate::judge::fact_columns::Getter;
use crate::judge::fact_table::{FACTS, Fact, GROUPS};
use crate::judge::functions::{FUNCTIONS, Function, WINDOWS};
use crate::settings::{Edition, SETTINGS, Setting, SettingShape, Settings, Value};
use crate::verdict::{FIGURES, TestFigure};
use serde_json::{Value as Json, json};

/// The number of this form; what is only added does not change it.
const FORMAT: u32 = 1;

/// The statements that the language adds to Rhai: first word, form, what it is for.
pub(super) const STATEMENTS: &[(&str, &str, &str)] = &[
    (
        "rule",
        "rule \"name\" [in \"stage\", ...] when CONDITION [for N steps | for N seconds] [once] => VALUE [per second] [then recover | fail | goal | restart [to \"place\"]] [then stage \"name\"];",
        "What is good and what is bad: while the condition holds, the value is added to the reward of the step.",
    ),
    ("success", "success \"name\" when CONDITION;", "When the behaviour is done, by figures of the test."),
    (
        "measure",
        "measure name = EXPRESSION;",
        "A value with a name, for rules, states, functions, the page and the test.",
    ),
    (
        "forbid",
        "forbid \"name\" when CONDITION => CONDITION OF THE ACTION;",
        "What an action must never do while something holds.",
    ),
    (
        "use",
        "use \"policy\" [in \"stage\", ...] [when CONDITION];",
        "Which learned policy drives while something holds.",
    ),
    ("bins", "bins(VALUE, [EDGES])", "A part of a state: a value told apart by ranges; stands within state(...)."),
];

/// The language as data.
#[must_use]
pub fn reference_json() -> Json {
    let editions = Edition::all().map(|edition| {
        let defaults = edition.defaults().map(|(group, key, word)| (format!("{group}.{key}"), json!(word)));
        json!({ "number": edition.number(), "defaults": Json::Object(defaults.collect()) })
    });
    let codes = all_codes().map(|code| json!({ "code": code, "page": code_page(code) }));
    let groups = GROUPS.iter().map(|(name, about)| json!({ "name": name, "about": about }));
    let statement = |(word, form, about): &(&str, &str, &str)| json!({ "word": word, "form": form, "about": about });
    json!({
        "format": FORMAT,
        "engine": env!("CARGO_PKG_VERSION"),
        "editions": editions.collect::<Vec<_>>(),
        "statements": STATEMENTS.iter().map(statement).collect::<Vec<_>>(),
        "setup_calls": SETUP.iter().map(|row| json!({ "name": row.name, "form": row.form, "about": row.purpose })).collect::<Vec<_>>(),
        "settings": SETTINGS.iter().map(setting).collect::<Vec<_>>(),
        "fact_groups": groups.collect::<Vec<_>>(),
        "facts": FACTS.iter().map(fact).collect::<Vec<_>>(),
        "functions": functions(FUNCTIONS),
        "windows": functions(WINDOWS),
        "test_figures": FIGURES.iter().map(figure).collect::<Vec<_>>(),
        "codes": codes.collect::<Vec<_>>(),
    })
}

fn setting(row: &Setting) -> Json {
    let default = match (row.get)(&Settings::default()) {
        Value::Number(number) => json!(number),
        Value::Flag(flag) => json!(flag),
        Value::Text(text) => json!(text),
    };
    let (kind, least, greatest, words) = match row.shape {
        SettingShape::Number(least, greatest) => ("number", json!(least), json!(greatest), Json::Null),
        SettingShape::Whole(least, greatest) => ("whole number", json!(least), json!(greatest), Json::Null),
        SettingShape::Flag => ("flag", Json::Null, Json::Null, Json::Null),
        SettingShape::Choice(words) => ("word", Json::Null, Json::Null, json!(words)),
    };
    json!({
        "group": row.group, "key": row.key, "unit": row.unit, "kind": kind, "least": least, "greatest": greatest,
        "words": words, "default": default, "about": row.purpose,
    })
}

fn fact(fact: &Fact) -> Json {
    let (least, greatest, unseen) = match fact.reach {
        Reach::Between(least, greatest) => (json!(least), json!(greatest), Json::Null),
        Reach::Seen(least, greatest, unseen) => (json!(least), json!(greatest), json!(unseen)),
        Reach::Actions | Reach::States | Reach::Beams | Reach::Steps => (json!(0), Json::Null, Json::Null),
        _ => (Json::Null, Json::Null, Json::Null),
    };
    json!({
        "group": fact.group, "key": fact.key, "form": fact.form().map(|(form, _)| form), "kind": fact.kind(),
        "unit": fact.unit.words(), "least": least, "greatest": greatest, "unseen": unseen, "cost": cost(fact),
        "values": fact.reach.words(), "about": fact.purpose,
    })
}

/// What reading it costs: `field`, `call`, `scan` (a pass over the scan) or `mask` (one over the mask, once in a step).
fn cost(fact: &Fact) -> &'static str {
    match fact.get {
        _ if fact.id.look().is_some() => "mask",
        Getter::Sector(_) | Getter::Hits => "scan",
        Getter::Call(..) => "call",
        _ => "field",
    }
}

fn functions(rows: &[Function]) -> Vec<Json> {
    let row = |row: &Function| {
        let (least, most) = row.arguments;
        json!({ "name": row.name, "form": row.form, "arguments": [least, most], "about": row.purpose })
    };
    rows.iter().map(row).collect()
}

fn figure(figure: &TestFigure) -> Json {
    json!({
        "name": figure.name, "form": figure.takes().form(figure.name), "unit": figure.unit,
        "needs_route": figure.needs_route(), "of_windows": figure.is_of_windows(), "about": figure.about,
    })
}
