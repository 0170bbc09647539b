//! The policy as Python with numpy: `policy.py`, and `check.py`, which holds it against the engine's frames.

use std::fmt::Write;

use crate::model::{Model, Part, Told, View, slow_first};
use crate::names;
use crate::stage::Stage;
use crate::text::{filled, plain};

const SOURCE: &str = include_str!("../templates/policy.py");
const CHECK: &str = include_str!("../templates/check.py");
const FILTERS: &str = include_str!("../templates/filters.py");

/// `policy.py` and `check.py`.
pub(crate) fn numpy_sources(model: &Model) -> [(&'static str, String); 2] {
    let (digits, guards) = (names::digits(model), names::guards(model));
    let either = |holds: bool, text: &str| if holds { text.to_owned() } else { String::new() };
    let (with_digits, with_guards) = (!digits.is_empty(), !guards.is_empty());
    let actions = model.actions.iter().fold(String::new(), |mut text, twist| {
        let _ = writeln!(text, "    ({:?}, {:?}),", twist.linear_m_per_s, twist.angular_rad_per_s);
        text
    });
    let met = model.met.chunks(8).map(|eight| eight.iter().rev().fold(0, |byte, met| byte << 1 | u8::from(*met)));
    let values = [
        ("BEHAVIOUR", plain(&model.behaviour)),
        ("WIDTH", model.size_px.0.to_string()),
        ("HEIGHT", model.size_px.1.to_string()),
        ("CHANNELS", model.channels.to_string()),
        ("PERIOD", format!("{:?}", model.period_s)),
        ("STATES", model.states.to_string()),
        ("ACTION_ROWS", actions),
        ("DIGITS", digit_names(model)),
        ("GUARDS", guard_names(&guards)),
        ("TABLE", table(model)),
        ("MET", hexadecimal(met)),
        ("FORBIDS", either(with_guards, &forbids(model))),
        ("FILTERS", filters(model)),
        ("VIEWS", model.views.iter().map(view).collect()),
        ("STATE", state(model)),
        ("EDGES", edges(&digits)),
        ("DIGITS_ARGUMENT", either(with_digits, ", digits")),
        ("DIGITS_PARAMETER", either(with_digits, ", digits")),
        ("DIGITS_TOLD", either(with_digits, ", [int(digit) for digit in told]")),
        ("GUARDS_ARGUMENT", either(with_guards, ", guards")),
        ("GUARDS_PARAMETER", either(with_guards, ", guards")),
        ("GUARDS_TOLD", either(with_guards, ", guards")),
        ("OF_ALLOWED", either(with_guards, " among those that no guard forbids which holds")),
        ("CHOICE", choice(model)),
    ];
    let values: Vec<(&str, &str)> = values.iter().map(|(name, text)| (*name, text.as_str())).collect();
    [("policy.py", filled(SOURCE, &values)), ("check.py", filled(CHECK, &values))]
}

fn forbids(model: &Model) -> String {
    let actions = u64::MAX >> (64 - model.actions.len().clamp(1, 64));
    let bits: Vec<u64> = model.guards.iter().map(|guard| guard.forbids.bits() & actions).collect();
    let slow = slow_first(&model.actions);
    format!(
        "# A bit for each action that a guard forbids.\nFORBIDS = {bits:?}\n# All actions, the slowest first.\nSLOW_FIRST = {slow:?}\n"
    )
}

fn choice(model: &Model) -> String {
    let slowest = model.slowest;
    if model.guards.is_empty() {
        return format!("        return BEST[state] if BEST[state] < len(ACTIONS) else {slowest}\n");
    }
    format!(
        "        forbidden = 0\n        for guard, actions in enumerate(FORBIDS):\n            forbidden |= actions if guards >> guard & 1 else 0\n        \
         own = ORDER[state * len(ACTIONS):(state + 1) * len(ACTIONS)]\n        \
         fit = (action for action in [*own, *SLOW_FIRST] if action < len(ACTIONS) and not forbidden >> action & 1)\n        \
         return next(fit, {slowest})\n"
    )
}

/// The best action of each state; all in their order where guards may forbid some.
fn table(model: &Model) -> String {
    let (words, name, each) = match model.guards.is_empty() {
        true => ("The best action of each state", "BEST", 1),
        false => ("The actions of each state, the best first", "ORDER", model.actions.len()),
    };
    let bytes = model.order.iter().flat_map(|order| order.iter().copied().take(each));
    format!(
        "# {words}, as hexadecimal digits; 255 where nothing is known.\n{name} = bytes.fromhex(\"\"\"\n{}\"\"\")\n",
        hexadecimal(bytes)
    )
}

/// Bytes as hexadecimal digits, 48 in a line.
fn hexadecimal(bytes: impl Iterator<Item = u8>) -> String {
    let bytes: Vec<u8> = bytes.collect();
    let line = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>() + "\n";
    bytes.chunks(48).map(line).collect()
}

fn digit_names(model: &Model) -> String {
    let mut text = String::new();
    for (place, digit) in names::digits(model).iter().enumerate() {
        if place == 0 {
            text.push_str("# The digits that the program measures itself, in this order.\n");
        }
        let upper = digit.name.to_uppercase();
        let how = match &digit.how {
            Told::Edges(_) => format!("digit_of_{}(value)", digit.name),
            Told::Flag => "1 where it holds, else 0".to_owned(),
            Told::Stages(_) => "the stage".to_owned(),
        };
        let _ = writeln!(text, "{upper} = {place}  # {}, {} values: {how}", digit.script, digit.values);
        if let Told::Stages(stages) = &digit.how {
            for (number, stage) in names::stages(stages).iter().enumerate() {
                let _ = writeln!(text, "{upper}_{} = {number}", stage.to_uppercase());
            }
        }
    }
    text
}

fn guard_names(guards: &[(String, String, String)]) -> String {
    let mut text = String::new();
    for (bit, (name, script, condition)) in guards.iter().enumerate() {
        if bit == 0 {
            text.push_str(
                "# The bit of each guard, to be set while its condition holds. The program asks the conditions.\n",
            );
        }
        let _ = writeln!(text, "GUARD_{} = {}  # {script}: {condition}", name.to_uppercase(), 1_u32 << bit);
    }
    text
}

/// The functions of the filters that are used.
fn filters(model: &Model) -> String {
    let used = |name: &str| model.views.iter().flat_map(|view| &view.stages).any(|stage| stage.function() == name);
    let functions = FILTERS.split("\n\n\n");
    let kept = functions.filter(|function| {
        let name = function.trim_start().strip_prefix("def ").and_then(|rest| rest.split('(').next());
        name.is_some_and(used)
    });
    kept.map(|function| format!("{}\n\n\n", function.trim_end())).collect::<String>().trim_end().to_owned() + "\n"
}

fn view(view: &View) -> String {
    let calls = view.stages.iter().map(|stage| match stage {
        Stage::Luma => "luma".to_owned(),
        Stage::Edges { side, middle, least } => format!("lambda image: edges(image, {side}, {middle}, {least})"),
        Stage::Threshold { least, bright, dark } => {
            format!("lambda image: threshold(image, {least}, {bright}, {dark})")
        }
        Stage::Colour { hue, width, saturation, dark } => {
            format!("lambda image: colour(image, {hue}, {width}, {saturation}, {dark})")
        }
        Stage::Chroma { rows, columns, left, tolerance } => {
            format!("lambda image: chroma(image, {rows}, {columns}, {left}, {tolerance})")
        }
        Stage::Horizon { cleared } => format!("lambda image: horizon(image, {cleared:?})"),
        Stage::Blur { weights } => format!("lambda image: blur(image, {weights:?})"),
    });
    let calls: Vec<String> = calls.collect();
    let fill = if view.fill { "True" } else { "False" };
    let View { name, rows, columns, base, least, remembered_steps, .. } = view;
    format!(
        "            # {}\n            View([{}], {rows}, {columns}, {fill}, {base}, {least:?}, {remembered_steps}),\n",
        plain(name),
        calls.join(", ")
    )
}

fn state(model: &Model) -> String {
    let mut told = 0;
    let part = |part: &Part| match part {
        Part::View { view, values } => (format!("numbers[{view}]"), *values),
        Part::Told { values, .. } => {
            told += 1;
            (format!("min(digits[{}], {})", told - 1, values - 1), *values)
        }
    };
    let parts: Vec<(String, usize)> = model.parts.iter().map(part).collect();
    parts.iter().rev().fold(String::new(), |rest, (part, values)| match rest.is_empty() {
        true => part.clone(),
        false => format!("{part} + {values} * ({rest})"),
    })
}

fn edges(digits: &[names::DigitName]) -> String {
    let mut text = String::new();
    for digit in digits {
        if let Told::Edges(edges) = &digit.how {
            let _ = write!(
                text,
                "\n\ndef digit_of_{}(value):\n    \"\"\"The digit of {}: how many of these edges it has reached.\"\"\"\n    \
                 return sum(value >= edge for edge in {edges:?})\n",
                digit.name, digit.script
            );
        }
    }
    text
}
