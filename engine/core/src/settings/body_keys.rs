//! The keys of a body file: every name, what it may hold, what it is.

/// What a key of a body file may hold.
#[derive(Debug, Clone, Copy)]
pub(crate) enum BodyForm {
    /// Text in quotes.
    Text,
    /// A number from the first to the second, both included.
    Number(f64, f64),
    /// One of these words.
    Word(&'static [&'static str]),
    /// A table with keys of its own, or the settings of the group of that name.
    Table,
    /// A list of pairs of numbers.
    Actions,
}

/// One key of a body file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyKey {
    /// The table that it stands in; empty for the file itself.
    pub table: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What it may hold.
    pub form: BodyForm,
    /// Whether it must be there; of the keys of a table that depends on its kind.
    pub required: bool,
    /// One sentence: what it is.
    pub purpose: &'static str,
}

const fn must(table: &'static str, name: &'static str, form: BodyForm, purpose: &'static str) -> BodyKey {
    BodyKey { table, name, form, required: true, purpose }
}

const fn may(table: &'static str, name: &'static str, form: BodyForm, purpose: &'static str) -> BodyKey {
    BodyKey { table, name, form, required: false, purpose }
}

use BodyForm::{Actions, Number, Table, Text, Word};

const LENGTH: BodyForm = Number(0.01, 5.0);

/// Every key of a body file, in the order of the reference page.
pub(crate) const BODY_KEYS: &[BodyKey] = &[
    may("", "description", Text, "What robot it is, and where its figures come from."),
    must("", "footprint", Table, "Its outline, seen from above."),
    must(
        "footprint",
        "shape",
        Word(&["round", "rectangle"]),
        "A circle around the point that it turns about, or a rectangle.",
    ),
    may("footprint", "radius_m", LENGTH, "Of a round one: the radius."),
    may("footprint", "length_m", LENGTH, "Of a rectangle: from its back to its front."),
    may("footprint", "width_m", LENGTH, "Of a rectangle: from its right to its left."),
    may(
        "footprint",
        "ahead_m",
        Number(-2.0, 2.0),
        "Of a rectangle: how far its middle lies ahead of the point that it turns about; 0 if it is not there.",
    ),
    must("", "height_m", Number(0.01, 5.0), "Its height above the ground."),
    must(
        "",
        "step_m",
        Number(0.0, 1.0),
        "The highest step that it climbs, and the deepest that it goes down without falling.",
    ),
    may(
        "",
        "slope_deg",
        Number(1.0, 90.0),
        "The steepest ramp that it climbs; steeper ones are walls. Without it, any.",
    ),
    may(
        "",
        "wheelbase_m",
        LENGTH,
        "Between the front and the rear wheels, about the middle of the outline. Without it, that of the bicycle or the length.",
    ),
    may("", "track_m", LENGTH, "Between the left and the right wheels. Without it, the width."),
    must("", "drive", Table, "How its wheels move it."),
    must(
        "drive",
        "kind",
        Word(&["differential", "skid", "bicycle"]),
        "Wheels that differ in speed; the same, skidding; or front wheels that steer.",
    ),
    may(
        "drive",
        "slip",
        Number(0.0, 0.5),
        "Of `skid`: the share of a turn that the skidding wheels lose, the setting `robot.slip`.",
    ),
    may(
        "drive",
        "wheelbase_m",
        LENGTH,
        "Of `bicycle`: from the rear axle, about whose middle it turns, to the front axle.",
    ),
    may("drive", "steer_deg", Number(1.0, 80.0), "Of `bicycle`: how far the front wheels turn to either side."),
    may("", "greatest_m_per_s", Number(0.01, 20.0), "The fastest that an action may drive; 2 if it is not there."),
    may("", "greatest_rad_per_s", Number(0.01, 20.0), "The fastest that an action may turn; 6 if it is not there."),
    may("", "lag_s", Number(0.0, 2.0), "How slowly it follows a command, the setting `robot.lag_s`."),
    may("", "camera", Table, "Settings of `camera`."),
    may("", "laser", Table, "Settings of `laser`."),
    may(
        "",
        "actions",
        Actions,
        "The actions, as in `actions(...)`. Without it those of every script, as far as it can do them.",
    ),
];

impl BodyKey {
    /// The keys of a table.
    pub(super) fn of(table: &'static str) -> impl Iterator<Item = &'static Self> {
        BODY_KEYS.iter().filter(move |key| key.table == table)
    }

    /// What it may hold, in words: `0.01 to 5`.
    pub(crate) fn allowed(&self) -> String {
        match self.form {
            Text => "text in quotes".to_owned(),
            Number(low, high) => format!("a number from {low} to {high}"),
            Word(words) => words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or "),
            Table => format!("a table, written [{}] or {{ }}", self.name),
            Actions => "a list of 1 to 64 pairs such as [[0.4, 0.2], [0.4, 0.0]], in m/s and rad/s".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::SHIPPED_BODIES;

    fn table() -> String {
        let row = |key: &BodyKey| {
            let name = if key.table.is_empty() { key.name.to_owned() } else { format!("{}.{}", key.table, key.name) };
            let must = if key.required { "yes" } else { "" };
            format!("| `{name}` | {} | {must} | {} |\n", key.allowed(), key.purpose)
        };
        let rows: String = BODY_KEYS.iter().map(row).collect();
        format!("| key | may be | must be there | what it is |\n|---|---|---|---|\n{rows}")
    }

    #[test]
    fn the_page_about_robots_has_every_key_and_every_body() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/README.md");
        let page = std::fs::read_to_string(&path).unwrap();
        let (before, rest) = page.split_once("<!-- keys -->\n").unwrap();
        let (_, after) = rest.split_once("<!-- end -->\n").unwrap();
        let made = format!("{before}<!-- keys -->\n{}<!-- end -->\n{after}", table());
        if std::env::var_os("UPDATE_PAGES").is_some() {
            std::fs::write(&path, &made).unwrap();
        }
        assert!(std::fs::read_to_string(&path).unwrap() == made, "run the tests with UPDATE_PAGES=1");
        assert!(SHIPPED_BODIES.iter().all(|(name, _)| made.contains(&format!("| [{name}]({name}.toml) |"))));
    }
}
