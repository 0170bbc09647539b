//! The policy as C99: `policy.h`, `policy.c`, and `check.c`, which holds them against the engine's frames.

use std::fmt::Write;

use crate::model::{Model, Part, Told, UNKNOWN, View, slow_first};
use crate::names;
use crate::stage::Stage;
use crate::text::{filled, plain, rows_of};

const HEADER: &str = include_str!("../templates/policy.h");
const SOURCE: &str = include_str!("../templates/policy.c");
const CHECK: &str = include_str!("../templates/check.c");
const FILL: &str = include_str!("../templates/number_fill.c");
const CELLS: &str = include_str!("../templates/number_cells.c");
const GONE: &str = include_str!("../templates/number_gone.c");

/// `policy.h`, `policy.c` and `check.c`.
pub(crate) fn c_sources(model: &Model) -> [(&'static str, String); 3] {
    let digits = names::digits(model).len();
    let (with_digits, with_guards) = (digits > 0, !model.guards.is_empty());
    let either = |holds: bool, text: &'static str| if holds { text } else { "" };
    let common = [
        ("BEHAVIOUR", plain(&model.behaviour)),
        ("DIGITS_PARAMETER", either(with_digits, ", const uint8_t digits[BEHAVIOUR_DIGITS]").to_owned()),
        ("GUARDS_PARAMETER", either(with_guards, ", uint32_t guards").to_owned()),
        ("DIGITS_ARGUMENT", either(with_digits, ", digits").to_owned()),
        ("GUARDS_ARGUMENT", either(with_guards, ", guards").to_owned()),
        ("DIGITS_PASSED", either(with_digits, ", digits").to_owned()),
        ("GUARDS_PASSED", either(with_guards, ", guards").to_owned()),
        ("OF_ALLOWED", either(with_guards, " among those that no guard forbids which holds").to_owned()),
        ("DIGIT_COUNT", digits.to_string()),
    ];
    let fill = |template: &str, own: &[(&str, String)]| {
        let values: Vec<(&str, &str)> = own.iter().chain(&common).map(|(name, text)| (*name, text.as_str())).collect();
        filled(template, &values)
    };
    [
        ("policy.h", fill(HEADER, &header(model))),
        ("policy.c", fill(SOURCE, &source(model))),
        ("check.c", fill(CHECK, &[])),
    ]
}

fn header(model: &Model) -> Vec<(&'static str, String)> {
    let room = model.views.iter().enumerate().fold(room_of(model), |mut text, (index, view)| {
        if view.remembered_steps > 0 {
            let _ = writeln!(text, "    uint32_t since_{index}[{}];", view.columns);
        }
        text
    });
    let declared = edged(model).fold(String::new(), |mut text, (name, script, _)| {
        let _ = writeln!(text, "/* The digit of {script}. */\nuint8_t behaviour_{name}(double value);");
        text
    });
    vec![
        ("WIDTH", model.size_px.0.to_string()),
        ("HEIGHT", model.size_px.1.to_string()),
        ("CHANNELS", model.channels.to_string()),
        ("PERIOD", format!("{:?}", model.period_s)),
        ("STATES", model.states.to_string()),
        ("ACTIONS", model.actions.len().to_string()),
        ("VIEWS", model.views.len().max(1).to_string()),
        ("CELLS", model.views.iter().map(|view| view.least.len()).sum::<usize>().max(1).to_string()),
        ("DIGITS", digits_of(model)),
        ("GUARDS", guards_of(model)),
        ("ROOM", room),
        ("EDGES_DECLARED", declared),
    ]
}

/// Frames between filters: two in turn, and the sums of a blur.
fn room_of(model: &Model) -> String {
    let stages = || model.views.iter().flat_map(|view| &view.stages);
    let most = model.views.iter().map(|view| view.stages.len()).max().unwrap_or(0);
    let mut text = String::new();
    if most > 1 {
        text.push_str("    uint8_t frame[2][BEHAVIOUR_WIDTH * BEHAVIOUR_HEIGHT];\n");
    }
    if stages().any(|stage| matches!(stage, Stage::Blur { .. })) {
        text.push_str("    uint32_t sums[BEHAVIOUR_WIDTH * BEHAVIOUR_HEIGHT];\n");
    }
    text
}

fn digits_of(model: &Model) -> String {
    let digits = names::digits(model);
    let mut text = String::new();
    if digits.is_empty() {
        return text;
    }
    let _ = writeln!(
        text,
        "/* What the program measures itself, in this order. */\n#define BEHAVIOUR_DIGITS {}",
        digits.len()
    );
    for (place, digit) in digits.iter().enumerate() {
        let upper = digit.name.to_uppercase();
        let how = match &digit.how {
            Told::Edges(_) => format!("behaviour_{} makes it of the value", digit.name),
            Told::Flag => "1 where it holds, else 0".to_owned(),
            Told::Stages(_) => "the stage, below".to_owned(),
        };
        let (script, values) = (&digit.script, digit.values);
        let _ = writeln!(text, "#define BEHAVIOUR_{upper} {place} /* {script}, {values} values: {how} */");
        if let Told::Stages(stages) = &digit.how {
            for (number, stage) in names::stages(stages).iter().enumerate() {
                let _ = writeln!(text, "#define BEHAVIOUR_{upper}_{} {number}", stage.to_uppercase());
            }
        }
    }
    text
}

fn guards_of(model: &Model) -> String {
    let mut text = String::new();
    let guards = names::guards(model);
    if guards.is_empty() {
        return text;
    }
    text.push_str("/* What actions are forbidden by: set the bit of each whose condition holds now. The program asks the conditions. */\n");
    for (bit, (name, script, condition)) in guards.iter().enumerate() {
        let _ = writeln!(
            text,
            "#define BEHAVIOUR_GUARD_{} {}u /* {script}: {condition} */",
            name.to_uppercase(),
            1_u32 << bit
        );
    }
    text
}

/// Digits that are told apart by edges.
fn edged(model: &Model) -> impl Iterator<Item = (String, String, Vec<f64>)> {
    names::digits(model).into_iter().filter_map(|digit| match digit.how {
        Told::Edges(edges) => Some((digit.name, digit.script, edges)),
        Told::Flag | Told::Stages(_) => None,
    })
}

fn source(model: &Model) -> Vec<(&'static str, String)> {
    let actions = model.actions.iter().fold(String::new(), |mut text, twist| {
        let _ = writeln!(text, "    {{{:?}, {:?}}},", twist.linear_m_per_s, twist.angular_rad_per_s);
        text
    });
    let start = model.views.iter().enumerate().filter(|(_, view)| view.remembered_steps > 0);
    let start = start.fold(String::new(), |mut text, (index, _)| {
        let _ = writeln!(text, "    memset(robot->since_{index}, 0xff, sizeof robot->since_{index});");
        text
    });
    let edges = edged(model).fold(String::new(), |mut text, (name, _, edges)| {
        let reached: Vec<String> = edges.iter().map(|edge| format!("(value >= {edge:?})")).collect();
        let _ = writeln!(
            text,
            "\nuint8_t behaviour_{name}(double value)\n{{\n    return (uint8_t)({});\n}}",
            reached.join(" + ")
        );
        text
    });
    let numbers = [
        (FILL, model.views.iter().any(|view| view.fill)),
        (CELLS, model.views.iter().any(|view| !view.fill)),
        (GONE, model.views.iter().any(|view| view.remembered_steps > 0)),
    ];
    vec![
        ("ACTION_ROWS", actions),
        ("TABLES", tables(model)),
        ("FILTERS", filters(model)),
        ("NUMBERS", numbers.iter().filter(|(_, used)| *used).map(|(text, _)| *text).collect()),
        ("START", start),
        ("STATE", state(model)),
        ("ACTION", action(model)),
        ("EDGES_DEFINED", edges),
    ]
}

fn tables(model: &Model) -> String {
    let mut text = if model.guards.is_empty() { best(model) } else { order(model) };
    let bytes = model.met.chunks(8).map(|eight| eight.iter().rev().fold(0_u8, |byte, met| byte << 1 | u8::from(*met)));
    let bytes = rows_of(bytes.map(|byte| format!("0x{byte:02x}")), "    ");
    let _ = write!(
        text,
        "/* A bit for each state that learning came to. */\nstatic const uint8_t met[(BEHAVIOUR_STATES + 7) / 8] = {{\n{bytes}}};\n"
    );
    model.views.iter().enumerate().for_each(|(index, view)| view_tables(index, view, &mut text));
    text
}

fn best(model: &Model) -> String {
    let best = rows_of(model.order.iter().map(|order| order.first().unwrap_or(&UNKNOWN).to_string()), "    ");
    format!(
        "/* The best action of each state; 255 where nothing is known. */\nstatic const uint8_t best[BEHAVIOUR_STATES] = {{\n{best}}};\n"
    )
}

/// Where guards may forbid the best action: all of them in their order, and what each guard forbids.
fn order(model: &Model) -> String {
    let mut text = "/* The actions of each state, the best first; 255 where nothing is known. */\n\
                    static const uint8_t order[BEHAVIOUR_STATES][BEHAVIOUR_ACTIONS] = {\n"
        .to_owned();
    for order in &model.order {
        let numbers: Vec<String> = order.iter().map(u8::to_string).collect();
        let _ = writeln!(text, "    {{{}}},", numbers.join(", "));
    }
    let slow = rows_of(slow_first(&model.actions).iter().map(usize::to_string), "    ");
    let actions = u64::MAX >> (64 - model.actions.len().clamp(1, 64));
    let forbids = model.guards.iter().map(|guard| format!("{:#x}u", guard.forbids.bits() & actions));
    let _ = write!(
        text,
        "}};\n/* All actions, the slowest first. */\nstatic const uint8_t slow_first[BEHAVIOUR_ACTIONS] = {{\n{slow}}};\n\
         /* A bit for each action that a guard forbids. */\nstatic const uint64_t forbids[{}] = {{\n{}}};\n",
        model.guards.len(),
        rows_of(forbids, "    ")
    );
    text
}

/// The edges of a view's cells, the pixels from which each is occupied, and what its filters look up.
fn view_tables(index: usize, view: &View, text: &mut String) {
    let mut table = |kind: &str, name: &str, numbers: Vec<String>| {
        let count = numbers.len();
        let rows = rows_of(numbers.into_iter(), "    ");
        let _ = write!(text, "static const {kind} {name}_{index}[{count}] = {{\n{rows}}};\n");
    };
    let numbers = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect();
    let wide = |numbers: &[u32]| numbers.iter().map(u32::to_string).collect();
    table("uint16_t", "row_edges", numbers(&view.row_edges));
    table("uint16_t", "column_edges", numbers(&view.column_edges));
    table("uint32_t", "least", wide(&view.least));
    for (stage, filter) in view.stages.iter().enumerate() {
        match filter {
            Stage::Horizon { cleared } => table("uint16_t", &format!("cleared_{stage}"), numbers(cleared)),
            Stage::Blur { weights } => table("uint32_t", &format!("weights_{stage}"), wide(weights)),
            _ => {}
        }
    }
}

/// The functions of the filters that are used, each once.
fn filters(model: &Model) -> String {
    let all = [
        ("luma", include_str!("../templates/filters/luma.c")),
        ("edges", include_str!("../templates/filters/edges.c")),
        ("threshold", include_str!("../templates/filters/threshold.c")),
        ("colour", include_str!("../templates/filters/colour.c")),
        ("chroma", include_str!("../templates/filters/chroma.c")),
        ("horizon", include_str!("../templates/filters/horizon.c")),
        ("blur", include_str!("../templates/filters/blur.c")),
    ];
    let used = |name: &str| model.views.iter().flat_map(|view| &view.stages).any(|stage| stage.function() == name);
    all.iter().filter(|(name, _)| used(name)).map(|(_, text)| format!("{text}\n")).collect()
}

/// The calls that filter an image for one view, the last one into its mask.
fn chain(view: &View, index: usize) -> String {
    let mut text = String::new();
    let mut from = "pixels".to_owned();
    for (place, stage) in view.stages.iter().enumerate() {
        let last = place + 1 == view.stages.len();
        let to = if last { format!("robot->mask[{index}]") } else { format!("robot->frame[{}]", place % 2) };
        let rest = match stage {
            Stage::Luma => String::new(),
            Stage::Edges { side, middle, least } => format!(", {side}, {middle}, {least}"),
            Stage::Threshold { least, bright, dark } => format!(", {least}, {bright}, {dark}"),
            Stage::Colour { hue, width, saturation, dark } => format!(", {hue}, {width}, {saturation}, {dark}"),
            Stage::Chroma { rows, columns, left, tolerance } => format!(", {rows}, {columns}, {left}, {tolerance}"),
            Stage::Horizon { .. } => format!(", cleared_{place}_{index}"),
            Stage::Blur { weights } => format!(", robot->sums, weights_{place}_{index}, {}", weights.len() / 2),
        };
        let _ = writeln!(text, "    {}({from}, {to}{rest});", stage.function());
        from = to;
    }
    text
}

fn state(model: &Model) -> String {
    let mut text = String::new();
    let mut first = 0;
    for (index, view) in model.views.iter().enumerate() {
        text.push_str(&chain(view, index));
        let View { rows, columns, base, .. } = view;
        let count = format!("robot->count + {first}");
        let _ = writeln!(
            text,
            "    count_cells(robot->mask[{index}], {count}, {rows}, {columns}, row_edges_{index}, column_edges_{index});"
        );
        let number = if view.fill {
            format!("height_number({count}, least_{index}, {rows}, {columns}, {base})")
        } else {
            format!("cell_number({count}, least_{index}, {})", rows * columns)
        };
        let number = match view.remembered_steps {
            0 => number,
            steps => format!("with_gone({number}, robot->since_{index}, {columns}, {base}, {steps})"),
        };
        let _ = writeln!(text, "    uint32_t view_{index} = {number};");
        first += rows * columns;
    }
    if model.views.is_empty() {
        text.push_str("    (void)robot;\n    (void)pixels;\n");
    }
    let mut told = 0;
    let parts: Vec<(String, usize)> = model
        .parts
        .iter()
        .map(|part| match part {
            Part::View { view, values } => (format!("view_{view}"), *values),
            Part::Told { values, .. } => {
                told += 1;
                let digit = format!("digits[{}]", told - 1);
                (format!("(uint32_t)({digit} < {values} ? {digit} : {})", values - 1), *values)
            }
        })
        .collect();
    let number = parts.iter().rev().fold(String::new(), |rest, (part, values)| match rest.is_empty() {
        true => part.clone(),
        false => format!("{part} + {values} * ({rest})"),
    });
    let _ = writeln!(text, "    return {number};");
    text
}

fn action(model: &Model) -> String {
    let slowest = model.slowest;
    if model.guards.is_empty() {
        return format!(
            "    return state < BEHAVIOUR_STATES && best[state] < BEHAVIOUR_ACTIONS ? best[state] : {slowest};\n"
        );
    }
    let guards = model.guards.len();
    format!(
        "    uint64_t forbidden = 0;\n    for (int guard = 0; guard < {guards}; guard++)\n        if (guards >> guard & 1)\n            \
         forbidden |= forbids[guard];\n    for (int place = 0; state < BEHAVIOUR_STATES && place < BEHAVIOUR_ACTIONS; place++) {{\n        \
         uint8_t action = order[state][place];\n        if (action < BEHAVIOUR_ACTIONS && !(forbidden >> action & 1))\n            \
         return action;\n    }}\n    for (int place = 0; place < BEHAVIOUR_ACTIONS; place++)\n        if (!(forbidden >> slow_first[place] & 1))\n            \
         return slow_first[place];\n    return {slowest};\n"
    )
}
