//! The keys of a world file: every name, what it may hold, and whether it must be there.

/// What a key may hold.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Form {
    /// Text.
    Text,
    /// True or false.
    Flag,
    /// A number from the first to the second, both included.
    Number(f64, f64),
    /// An array of so many numbers, each in the range.
    Numbers(usize, f64, f64),
    /// At least so many points `[x, y]`.
    Points(usize),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// One table.
    Table(&'static [Key]),
    /// Any number of tables up to the limit.
    Tables(&'static [Key], usize),
}

/// One key of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    /// In words; empty where there is none.
    pub(crate) unit: &'static str,
    pub(crate) form: Form,
    pub(crate) required: bool,
}

const fn must(name: &'static str, unit: &'static str, form: Form) -> Key {
    Key { name, unit, form, required: true }
}

const fn may(name: &'static str, unit: &'static str, form: Form) -> Key {
    Key { name, unit, form, required: false }
}

/// Coordinates and lengths end here: at 1000 m single precision still resolves a tenth of a millimetre.
const FAR: f64 = 1000.0;
const THIN: f64 = 0.001;
/// Most points of one array.
pub(crate) const MOST_POINTS: usize = 10_000;
/// Most solids of a world.
pub(crate) const MOST_SOLIDS: usize = 20_000;

const PLACE: Form = Form::Numbers(2, -FAR, FAR);
const SIZE: Form = Form::Numbers(3, THIN, FAR);
const LENGTH: Form = Form::Number(THIN, FAR);
const BOTTOM: Key = may("bottom_m", "metres", Form::Number(0.0, FAR));
const YAW: Key = may("yaw_deg", "degrees", Form::Number(-360.0, 360.0));
const MATERIAL: Key = may("material", "", Form::Text);
const CLOSED: Key = may("closed", "", Form::Flag);

const FLOOR: &[Key] = &[must("material", "", Form::Text)];
const LIGHT: &[Key] = &[
    may("towards", "", Form::Numbers(3, -1.0, 1.0)),
    may("ambient", "share", Form::Number(0.0, 1.0)),
    may("gain", "times", Form::Number(0.05, 5.0)),
];
const TEXTURE: &[Key] = &[
    must("kind", "", Form::Choice(&["plain", "checker", "stripes", "noise"])),
    may("amplitude", "grey levels", Form::Number(0.0, 127.0)),
    may("scale_m", "metres", LENGTH),
];
const MATERIALS: &[Key] = &[
    must("name", "", Form::Text),
    must("colour", "red, green, blue", Form::Numbers(3, 0.0, 255.0)),
    may("texture", "", Form::Table(TEXTURE)),
    may("laser", "", Form::Flag),
];
const WALL: &[Key] = &[
    must("points_m", "metres", Form::Points(2)),
    CLOSED,
    may("height_m", "metres", LENGTH),
    may("thickness_m", "metres", LENGTH),
    BOTTOM,
    MATERIAL,
];
const BOX: &[Key] = &[must("centre_m", "metres", PLACE), must("size_m", "metres", SIZE), YAW, BOTTOM, MATERIAL];
const CYLINDER: &[Key] = &[
    must("centre_m", "metres", PLACE),
    must("radius_m", "metres", LENGTH),
    must("height_m", "metres", LENGTH),
    BOTTOM,
    MATERIAL,
];
const PLATFORM: &[Key] = &[
    may("points_m", "metres", Form::Points(2)),
    CLOSED,
    may("width_m", "metres", LENGTH),
    may("height_m", "metres", LENGTH),
    may("centre_m", "metres", PLACE),
    may("size_m", "metres", SIZE),
    YAW,
    BOTTOM,
    MATERIAL,
];
const PAINT: &[Key] = &[
    may("points_m", "metres", Form::Points(2)),
    CLOSED,
    may("width_m", "metres", LENGTH),
    may("centre_m", "metres", PLACE),
    may("size_m", "metres", Form::Numbers(2, THIN, FAR)),
    YAW,
    MATERIAL,
];
const START: &[Key] = &[must("position_m", "metres", PLACE), YAW];
const ROUTE: &[Key] = &[
    must("name", "", Form::Text),
    must("points_m", "metres", Form::Points(2)),
    CLOSED,
    may("corner_radius_m", "metres", Form::Number(0.0, FAR)),
];
const MOVER_BOX: &[Key] =
    &[must("centre_m", "metres", Form::Numbers(3, -FAR, FAR)), must("size_m", "metres", SIZE), YAW, MATERIAL];
const MOVER: &[Key] = &[
    must("name", "", Form::Text),
    must("route", "", Form::Text),
    must("speed_m_per_s", "metres per second", Form::Number(0.0, 10.0)),
    may("offset_m", "metres", Form::Number(0.0, 100_000.0)),
    must("boxes", "", Form::Tables(MOVER_BOX, 64)),
];

/// The whole file.
pub(crate) const FILE: &[Key] = &[
    may("description", "", Form::Text),
    may("floor", "", Form::Table(FLOOR)),
    may("light", "", Form::Table(LIGHT)),
    may("material", "", Form::Tables(MATERIALS, 256)),
    may("wall", "", Form::Tables(WALL, MOST_SOLIDS)),
    may("box", "", Form::Tables(BOX, MOST_SOLIDS)),
    may("cylinder", "", Form::Tables(CYLINDER, MOST_SOLIDS)),
    may("platform", "", Form::Tables(PLATFORM, MOST_SOLIDS)),
    may("ramp", "", Form::Tables(BOX, MOST_SOLIDS)),
    may("paint", "", Form::Tables(PAINT, MOST_SOLIDS)),
    may("start", "", Form::Tables(START, 1000)),
    may("route", "", Form::Tables(ROUTE, 64)),
    may("mover", "", Form::Tables(MOVER, 64)),
];

impl Key {
    /// What it may hold, in words: `0.001 to 1000 (metres)`.
    pub(crate) fn allowed(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        match self.form {
            Form::Text => "text in quotes".to_owned(),
            Form::Flag => "true or false".to_owned(),
            Form::Number(low, high) => format!("a number from {low} to {high}{unit}"),
            Form::Numbers(count, low, high) => format!("{count} numbers in [ ], each from {low} to {high}{unit}"),
            Form::Points(least) => format!("at least {least} points [x, y], each number from -{FAR} to {FAR}{unit}"),
            Form::Choice(words) => words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", "),
            Form::Table(_) => format!("one table, written [{}] or {{ }}", self.name),
            Form::Tables(..) => format!("tables, written [[{}]] or [{{ }}]", self.name),
        }
    }

    /// Whether a coordinate of a point is in range.
    pub(crate) fn coordinate(value: f64) -> bool {
        value.abs() <= FAR
    }
}
