//! The measures of a script, checked and compiled: expressions that are worked out before the rules, top to bottom.

use super::compile::{Compiler, LONGEST_WINDOW_S};
use super::positions::{first, span};
use super::rules::not_remembered;
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{WrittenMeasure, written_measures};
use crate::diagnostic::{Diagnostic, Mistakes, nearest_name, printable};
use crate::judge::explain;
use crate::judge::fact_table::is_group;
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use crate::judge::memory::{Measure, Remembered};
use rhai::{AST, ASTNode, Expr, Position};

/// Most measures, and most windows, of one script.
const MOST_MEASURES: usize = 32;
const MOST_WINDOWS: usize = 64;

/// Adds every measure without a mistake in it to what the compiler remembers.
pub(super) fn measures(
    code: &Code,
    ast: &AST,
    variables: &[String],
    compiler: &mut Compiler<'_>,
    spoilt: &mut Spoilt<'_>,
    mistakes: &mut Mistakes,
) {
    let written = written_measures(ast.statements());
    let mut known: Vec<&str> = Vec::new();
    for (number, measure) in written.iter().enumerate() {
        let count = mistakes.count();
        if let Some(wrong) = misnamed(code, measure, &known, variables) {
            mistakes.add(wrong);
            if reads(measure.expression, measure.name) {
                spoilt.insert(measure.name);
            }
        }
        known.push(measure.name);
        let later = written[number + 1..].iter().find(|later| reads(measure.expression, later.name));
        if let Some(later) = later.filter(|later| !known.contains(&later.name)) {
            mistakes.add(reads_a_later_one(code, measure, later));
            spoilt.insert(measure.name);
            continue;
        }
        let bytes = span(code, measure.expression);
        if spoilt.touches(&bytes, mistakes) {
            spoilt.insert(measure.name);
            continue;
        }
        match compiler.clause(measure.expression) {
            Some(typed) if mistakes.count() == count => {
                let name = measure.name.to_owned();
                compiler.script.remembered.push(Remembered::Measure(Measure { name, typed }));
            }
            Some(_) => {}
            None => {
                let help = "write a measure with facts, numbers and the functions of the table; what is longer stands in 'fn reward'";
                mistakes.add(not_remembered(code, first(measure.expression)).help(help));
                spoilt.insert(measure.name);
            }
        }
    }
    if let Some(one_too_many) = written.get(MOST_MEASURES) {
        let message = format!("a script may have {MOST_MEASURES} measures");
        mistakes.add(explain::mistake(
            &code.source,
            "E-SCRIPT-LIMIT",
            one_too_many.name_position,
            message,
            "one too many",
        ));
    }
}

fn misnamed(code: &Code, measure: &WrittenMeasure<'_>, known: &[&str], variables: &[String]) -> Option<Diagnostic> {
    let name = measure.name;
    let message = match () {
        () if known.contains(&name) => format!("there are two measures called '{name}'"),
        () if is_group(name)
            || code.views.group_of(name).is_some()
            || matches!(name, "facts" | "calibrated" | "test" | "untrained") =>
        {
            format!("'{name}' is the name of facts")
        }
        () if variables.iter().any(|variable| variable == name) => format!("there is a variable called '{name}'"),
        () if reads(measure.expression, name) => format!("measure '{name}' reads itself"),
        () if FUNCTIONS.iter().chain(WINDOWS).any(|row| row.name == name) => {
            format!("'{name}' is the name of one of the engine's functions")
        }
        () => return None,
    };
    let wrong = explain::mistake(&code.source, "E-SCRIPT-NAME", measure.name_position, message, "defined here");
    let itself = reads(measure.expression, name);
    Some(wrong.help(if itself {
        "name something else: a measure is worked out anew in every step"
    } else {
        "choose another name"
    }))
}

fn reads_a_later_one(code: &Code, measure: &WrittenMeasure<'_>, later: &WrittenMeasure<'_>) -> Diagnostic {
    let message = format!("measure '{}' reads '{}', which is worked out after it", measure.name, later.name);
    let at = first(measure.expression);
    let wrong = explain::mistake(&code.source, "E-SCRIPT-WINDOW", at, message, "reads what stands below");
    wrong.help(format!("move measure '{}' above measure '{}'", later.name, measure.name))
}

/// Whether an expression names a variable.
fn reads(expr: &Expr, name: &str) -> bool {
    let mut found = false;
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        found |= matches!(path.last(), Some(ASTNode::Expr(Expr::Variable(variable, ..))) if variable.1 == name);
        !found
    });
    found
}

/// Adds what is wrong with every window of a script, wherever it stands: the time, the rule that is named, their number.
pub(super) fn check_windows(code: &Code, ast: &AST, rules: &[String], own: &[String], mistakes: &mut Mistakes) {
    let mut windows = 0;
    ast.clone_statements_only().walk(&mut |path: &[ASTNode<'_>]| {
        let Some(ASTNode::Expr(Expr::FnCall(call, position))) = path.last() else { return true };
        let name = call.name.as_str();
        if own.iter().any(|own| own == name) {
            return true;
        }
        match (name, call.args.as_slice()) {
            ("fired" | "since", [of]) => mistakes_of_rule(code, name, of, rules, mistakes),
            ("change" | "average", [_, time]) => {
                windows += 1;
                mistakes_of_time(code, time, mistakes);
            }
            ("change", _) => windows += 1,
            _ => return true,
        }
        if windows == MOST_WINDOWS + 1 {
            windows += 1;
            let message = format!("a script may have {MOST_WINDOWS} windows");
            mistakes.add(explain::mistake(&code.source, "E-SCRIPT-LIMIT", *position, message, "one too many"));
        }
        true
    });
}

fn mistakes_of_rule(code: &Code, name: &str, of: &Expr, rules: &[String], mistakes: &mut Mistakes) {
    let wrong = |at: Position, message: String, label: &str| {
        explain::mistake(&code.source, "E-SCRIPT-WINDOW", at, message, label)
    };
    let Expr::StringConstant(rule, at) = of else {
        let message = format!("'{name}' needs the name of a rule");
        mistakes.add(wrong(first(of), message, "here").help(format!("write {name}(\"name of the rule\")")));
        return;
    };
    if rules.iter().any(|known| known == rule.as_str()) {
        return;
    }
    let help = match nearest_name(rule, rules.iter().map(String::as_str)) {
        Some(near) => format!("did you mean \"{}\"?", printable(near)),
        None => format!("there are: {}", printable(&rules.join(", "))),
    };
    mistakes.add(wrong(*at, format!("there is no rule \"{}\"", printable(rule)), "not known").help(help));
}

fn mistakes_of_time(code: &Code, time: &Expr, mistakes: &mut Mistakes) {
    let seconds = match time {
        Expr::FloatConstant(seconds, _) => **seconds,
        Expr::IntegerConstant(seconds, _) => *seconds as f64,
        // A constant of the script is looked at where it is compiled.
        _ => return,
    };
    if !(seconds > 0.0 && seconds <= LONGEST_WINDOW_S) {
        let message = format!("the time of a window is more than 0 and at most {LONGEST_WINDOW_S} seconds");
        let wrong = explain::mistake(&code.source, "E-SCRIPT-WINDOW", first(time), message, format!("found {seconds}"));
        mistakes.add(wrong.help("write change(x, 10) for ten seconds, change(x) for one step"));
    }
}
