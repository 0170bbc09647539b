//! The learning curve as comma-separated values.

use std::fmt::Write;

use engine::diagnostic::for_table;

/// One window of the learning curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveRow {
    /// Steps at the end of the window.
    pub step: u64,
    /// Sum of the rewards in the window.
    pub reinforcement: f64,
    /// The part of that sum that each rule gave, in the order of the rules.
    pub by_rule: Vec<f64>,
}

/// The table: `step`, `reinforcement_per_<window>_steps`, then one column for each rule; a missing value is empty.
#[must_use]
pub fn curve_csv(window_steps: u64, rules: &[String], rows: &[CurveRow]) -> String {
    let own = ["step".to_owned(), format!("reinforcement_per_{window_steps}_steps")];
    let mut out = own.join(",");
    for rule in rules {
        out.push(',');
        // No two columns have one name.
        out.push_str(&for_table(&if own.contains(rule) { format!("{rule} (rule)") } else { rule.clone() }));
    }
    out.push('\n');
    for row in rows {
        // Writing into a String cannot fail.
        let _ = write!(out, "{},{}", row.step, row.reinforcement);
        for rule in 0..rules.len() {
            out.push(',');
            if let Some(value) = row.by_rule.get(rule) {
                let _ = write!(out, "{value}");
            }
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_become_columns_and_odd_names_are_quoted() {
        let rows = [
            CurveRow { step: 500, reinforcement: -20.5, by_rule: vec![-20.5, 0.0] },
            CurveRow { step: 1000, reinforcement: -1.0, by_rule: vec![-1.0] },
        ];
        let table = curve_csv(500, &["contact".to_owned(), "near, \"left\"".to_owned()], &rows);
        assert_eq!(
            table,
            "step,reinforcement_per_500_steps,contact,\"near, \"\"left\"\"\"\n500,-20.5,-20.5,0\n1000,-1,-1,\n"
        );
    }

    #[test]
    fn a_name_is_neither_a_formula_nor_a_command_to_the_terminal() {
        let rules = ["=cmd|' /C calc'!A0", "\u{1b}[2J"].map(str::to_owned);
        let heading = "step,reinforcement_per_10_steps,'=cmd|' /C calc'!A0,\\u{1b}[2J\n";
        assert_eq!(curve_csv(10, &rules, &[]), heading);
    }

    #[test]
    fn a_rule_with_the_name_of_a_column_has_a_column_of_its_own() {
        let rules = ["step", "reinforcement_per_10_steps"].map(str::to_owned);
        let heading = "step,reinforcement_per_10_steps,step (rule),reinforcement_per_10_steps (rule)\n";
        assert_eq!(curve_csv(10, &rules, &[]), heading);
    }

    #[test]
    fn no_rows_give_the_heading_alone() {
        assert_eq!(curve_csv(10, &[], &[]), "step,reinforcement_per_10_steps\n");
    }
}
