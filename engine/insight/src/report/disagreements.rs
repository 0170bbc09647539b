//! Where combined policies disagree, as comma-separated values.

use std::fmt::Write;

use engine::diagnostic::for_table;
use engine::experiment::Disagreements;
use engine::geometry::Twist;

/// The table, the most frequent first: the two policies, the state that each perceived, the action that each wanted (its
/// number, m/s, rad/s), in how many steps, and in how many of these the combination preferred either.
#[must_use]
pub fn disagreements_csv(names: &[&str], actions: &[Twist], disagreements: &Disagreements) -> String {
    let mut out = "first_policy,second_policy,first_state,second_state,\
                   first_action,first_m_per_s,first_rad_per_s,second_action,second_m_per_s,second_rad_per_s,\
                   steps,first_won,second_won\n"
        .to_owned();
    for row in disagreements.by_frequency() {
        let [first, second] = row.policies.map(|policy| for_table(names.get(policy).copied().unwrap_or_default()));
        let [a, b] = row.actions.map(|action| {
            let twist = actions.get(action).copied().unwrap_or_default();
            format!("{action},{},{}", twist.linear_m_per_s, twist.angular_rad_per_s)
        });
        let ([p, q], [won, lost]) = (row.states, row.won);
        // Writing into a String cannot fail.
        let _ = writeln!(out, "{first},{second},{p},{q},{a},{b},{},{won},{lost}", row.steps);
    }
    out
}
