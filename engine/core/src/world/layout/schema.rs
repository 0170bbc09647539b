//! The keys of a world file: every name, what it may hold, and whether it must be there.

use crate::world::light::WIDEST_SUN_DEG;

/// What a key may hold.
#[derive(Debug, Clone, Copy)]
pub(crate) enum KeyForm {
    /// Text.
    Text,
    /// True or false.
    Flag,
    /// A number from the first to the second, both included.
    Number(f64, f64),
    /// A number in the range, or two in an array: from the first to the second.
    Span(f64, f64),
    /// An array of so many numbers, each in the range.
    Numbers(usize, f64, f64),
    /// At least so many points `[x, y]`.
    Points(usize),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One table.
    Table(&'static [FileKey]),
    /// Any number of tables up to the limit.
    Tables(&'static [FileKey], usize),
}

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FileKey {
    pub(crate) name: &'static str,
    /// In words; empty where there is none.
    pub(crate) unit: &'static str,
    pub(crate) form: KeyForm,
    pub(crate) required: bool,
}

const fn must(name: &'static str, unit: &'static str, form: KeyForm) -> FileKey {
    FileKey { name, unit, form, required: true }
}

const fn may(name: &'static str, unit: &'static str, form: KeyForm) -> FileKey {
    FileKey { name, unit, form, required: false }
}

/// Coordinates and lengths end here: at 1000 m single precision still resolves a tenth of a millimetre.
const FAR: f64 = 1000.0;
const THIN: f64 = 0.001;
/// Most points of one array.
pub(crate) const MOST_POINTS: usize = 10_000;
/// Most solids of a world.
pub(crate) const MOST_SOLIDS: usize = 20_000;

const PLACE: KeyForm = KeyForm::Numbers(2, -FAR, FAR);
const SIZE: KeyForm = KeyForm::Numbers(3, THIN, FAR);
const LENGTH: KeyForm = KeyForm::Number(THIN, FAR);
const BOTTOM: FileKey = may("bottom_m", "metres", KeyForm::Number(0.0, FAR));
const YAW: FileKey = may("yaw_deg", "degrees", KeyForm::Number(-360.0, 360.0));
const MATERIAL: FileKey = may("material", "", KeyForm::Text);
const CLOSED: FileKey = may("closed", "", KeyForm::Flag);

const FLOOR: &[FileKey] = &[must("material", "", KeyForm::Text)];
const LIGHT: &[FileKey] = &[
    may("towards", "", KeyForm::Numbers(3, -1.0, 1.0)),
    may("ambient", "share", KeyForm::Number(0.0, 1.0)),
    may("gain", "times", KeyForm::Number(0.05, 5.0)),
    may("shadows", "", KeyForm::Flag),
    may("softness_deg", "degrees", KeyForm::Number(0.0, WIDEST_SUN_DEG)),
];
const TEXTURE: &[FileKey] = &[
    must("kind", "", KeyForm::Choice(&["plain", "checker", "stripes", "noise", "tiles", "bricks"])),
    may("amplitude", "grey levels", KeyForm::Number(0.0, 127.0)),
    may("scale_m", "metres", LENGTH),
    may("joint_m", "metres", LENGTH),
    may("joint", "grey levels", KeyForm::Number(0.0, 127.0)),
];
const MATERIALS: &[FileKey] = &[
    must("name", "", KeyForm::Text),
    must("colour", "red, green, blue", KeyForm::Numbers(3, 0.0, 255.0)),
    may("texture", "", KeyForm::Table(TEXTURE)),
    may("laser", "", KeyForm::Flag),
];
const WALL: &[FileKey] = &[
    must("points_m", "metres", KeyForm::Points(2)),
    CLOSED,
    may("height_m", "metres", LENGTH),
    may("thickness_m", "metres", LENGTH),
    BOTTOM,
    MATERIAL,
];
const BOX: &[FileKey] = &[must("centre_m", "metres", PLACE), must("size_m", "metres", SIZE), YAW, BOTTOM, MATERIAL];
const CYLINDER: &[FileKey] = &[
    must("centre_m", "metres", PLACE),
    must("radius_m", "metres", LENGTH),
    must("height_m", "metres", LENGTH),
    BOTTOM,
    MATERIAL,
];
const PLATFORM: &[FileKey] = &[
    may("points_m", "metres", KeyForm::Points(2)),
    CLOSED,
    may("width_m", "metres", LENGTH),
    may("height_m", "metres", LENGTH),
    may("centre_m", "metres", PLACE),
    may("size_m", "metres", SIZE),
    YAW,
    BOTTOM,
    MATERIAL,
];
const PAINT: &[FileKey] = &[
    may("points_m", "metres", KeyForm::Points(2)),
    CLOSED,
    may("width_m", "metres", LENGTH),
    may("centre_m", "metres", PLACE),
    may("size_m", "metres", KeyForm::Numbers(2, THIN, FAR)),
    YAW,
    MATERIAL,
];
const START: &[FileKey] =
    &[may("name", "", KeyForm::Text), must("position_m", "metres", PLACE), YAW, may("gate", "", KeyForm::Text)];
const CIRCLE: &[FileKey] =
    &[must("name", "", KeyForm::Text), must("position_m", "metres", PLACE), must("radius_m", "metres", LENGTH)];
const GATE: &[FileKey] =
    &[may("name", "", KeyForm::Text), must("right_m", "metres", PLACE), must("left_m", "metres", PLACE)];
const ROUTE: &[FileKey] = &[
    must("name", "", KeyForm::Text),
    must("points_m", "metres", KeyForm::Points(2)),
    CLOSED,
    may("corner_radius_m", "metres", KeyForm::Number(0.0, FAR)),
    may("half_width_m", "metres", KeyForm::Number(0.05, FAR)),
];
const MOVER_BOX: &[FileKey] =
    &[must("centre_m", "metres", KeyForm::Numbers(3, -FAR, FAR)), must("size_m", "metres", SIZE), YAW, MATERIAL];
const PACE: &[FileKey] = &[
    must("from_m", "metres", KeyForm::Number(0.0, 100_000.0)),
    must("m_per_s", "metres per second", KeyForm::Number(0.001, 10.0)),
];
const PAUSE: &[FileKey] = &[
    must("at_m", "metres", KeyForm::Number(0.0, 100_000.0)),
    must("for_s", "seconds", KeyForm::Number(0.001, 100_000.0)),
];
const MOVER: &[FileKey] = &[
    must("name", "", KeyForm::Text),
    must("route", "", KeyForm::Text),
    may("speed_m_per_s", "metres per second", KeyForm::Span(0.0, 10.0)),
    may("offset_m", "metres", KeyForm::Number(0.0, 100_000.0)),
    may("speeds", "", KeyForm::Tables(PACE, 64)),
    may("pauses", "", KeyForm::Tables(PAUSE, 64)),
    may("returns", "", KeyForm::Flag),
    may("starts_within_m", "metres", KeyForm::Number(THIN, FAR)),
    may("at_recovery", "", KeyForm::Choice(&["stays", "begins"])),
    must("boxes", "", KeyForm::Tables(MOVER_BOX, 64)),
];

/// The whole file.
pub(crate) const FILE: &[FileKey] = &[
    may("description", "", KeyForm::Text),
    may("floor", "", KeyForm::Table(FLOOR)),
    may("light", "", KeyForm::Table(LIGHT)),
    may("material", "", KeyForm::Tables(MATERIALS, 256)),
    may("wall", "", KeyForm::Tables(WALL, MOST_SOLIDS)),
    may("box", "", KeyForm::Tables(BOX, MOST_SOLIDS)),
    may("cylinder", "", KeyForm::Tables(CYLINDER, MOST_SOLIDS)),
    may("platform", "", KeyForm::Tables(PLATFORM, MOST_SOLIDS)),
    may("ramp", "", KeyForm::Tables(BOX, MOST_SOLIDS)),
    may("paint", "", KeyForm::Tables(PAINT, MOST_SOLIDS)),
    may("start", "", KeyForm::Tables(START, 1000)),
    may("place", "", KeyForm::Tables(CIRCLE, 64)),
    may("gate", "", KeyForm::Tables(GATE, 64)),
    may("route", "", KeyForm::Tables(ROUTE, 64)),
    may("mover", "", KeyForm::Tables(MOVER, 64)),
];

impl FileKey {
    /// What it may hold, in words: `0.001 to 1000 (metres)`.
    pub(crate) fn allowed(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        match self.form {
            KeyForm::Text => "text in quotes".to_owned(),
            KeyForm::Flag => "true or false".to_owned(),
            KeyForm::Number(low, high) => format!("a number from {low} to {high}{unit}"),
            KeyForm::Span(low, high) => format!("a number from {low} to {high}{unit}, or [least, greatest]"),
            KeyForm::Numbers(count, low, high) => format!("{count} numbers in [ ], each from {low} to {high}{unit}"),
            KeyForm::Points(least) => format!("at least {least} points [x, y], each number from -{FAR} to {FAR}{unit}"),
            KeyForm::Choice(words) => words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", "),
            KeyForm::Table(_) => format!("one table, written [{}] or {{ }}", self.name),
            KeyForm::Tables(..) => format!("tables, written [[{}]] or [{{ }}]", self.name),
        }
    }

    /// Whether a coordinate of a point is in range.
    pub(crate) fn coordinate(value: f64) -> bool {
        value.abs() <= FAR
    }
}
