//! Why a learner that remembers its steps values an action as it does, as text.

use engine::experiment::{TryReasons, ValueReasons};
use insight::words::short;

use crate::console::{Console, ConsoleError};

/// Of the steps behind a value so many are named.
const MOST_TRIES: usize = 8;

/// Prints what stands behind a value, the action's own tries last, and the steps that they are.
pub(super) fn value_chain(console: &mut Console, value: &ValueReasons) -> Result<(), ConsoleError> {
    console.line(&format!(
        "\nwhy this action was worth {} (a spread of {} is usual):",
        short(value.value),
        short(value.unit)
    ))?;
    let width = value.links.iter().map(|link| link.name.chars().count()).max().unwrap_or(0);
    for link in &value.links {
        let known = match link.mean {
            Some(mean) => format!("{:>6.1} tries, mean {:>8}", link.tries, short(mean)),
            None => format!("{:>6} tries {:14}", 0, ""),
        };
        console.line(&format!("  {:width$}  {known}  so far {:>8}", link.name, short(link.value)))?;
    }
    let one = |past: &TryReasons| {
        let earlier = if past.earlier { " of the run before" } else { "" };
        format!("{}{earlier} ({})", past.step, short(past.gain))
    };
    let shown: Vec<String> = value.tries.iter().take(MOST_TRIES).map(one).collect();
    if !shown.is_empty() {
        let more = value.own_tries.saturating_sub(shown.len());
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        console
            .line(&format!("  its own tries, as steps of learning (and what followed): {}{more}", shown.join(", ")))?;
    }
    Ok(())
}
