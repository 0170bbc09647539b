//! What a change of the reward changed: each state whose best action is another one, with both motions.

use super::canvas::units;
use super::picture::Picture;
use super::policy::{ICON_PX, PolicyState, explain_unsure, icon, motion, strength};
use super::sheet::{BELOW_TITLE_PX, MARGIN_PX, QUIET, SMALL_PX, Sheet, TEXT, centred, spot, words};
use engine::diagnostic::Result;

const WIDTH_PX: f64 = 1200.0;
/// States on a page, and in a row.
const MOST: usize = 60;
const ACROSS: usize = 4;
const STEP_X_PX: f64 = (WIDTH_PX - 2.0 * MARGIN_PX) / ACROSS as f64;
const STEP_Y_PX: f64 = 124.0;
/// From the icon to the first motion, and from there to the second, pixels.
const MOTION_PX: f64 = 60.0;
const APART_PX: f64 = 82.0;

/// What the picture shows.
#[derive(Debug, Clone, Copy)]
pub struct PolicyDiffData<'a> {
    /// The heading.
    pub title: &'a str,
    /// Rows of the grid.
    pub rows: usize,
    /// Columns of the grid.
    pub columns: usize,
    /// The changed states, the most visited first; of more than 60 the first are shown.
    pub states: &'a [StateChange],
}

/// A state whose best action changed.
#[derive(Debug, Clone, PartialEq)]
pub struct StateChange {
    /// The state with its old best action.
    pub before: PolicyState,
    /// That state with its new best action.
    pub after: PolicyState,
    /// How often the record tried the old and the new best action in this state.
    pub tried: [u64; 2],
}

/// Draws the changed states; the more visits, the stronger. 1200 pixels wide.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn policy_diff(data: &PolicyDiffData<'_>) -> Result<Picture> {
    let shown = &data.states[..data.states.len().min(MOST)];
    let top_px = BELOW_TITLE_PX + 44.0;
    let lines = shown.len().div_ceil(ACROSS).max(1);
    let mut sheet = Sheet::new(WIDTH_PX, top_px + lines as f64 * STEP_Y_PX + MARGIN_PX / 2.0, data.title);
    let most = shown.iter().map(|state| state.before.visits).max().unwrap_or(0);
    let both = || shown.iter().flat_map(|state| [&state.before, &state.after]);
    let fastest = both().map(|state| state.best.linear_m_per_s.abs()).fold(1e-9, f64::max);
    let note = match data.states.len() {
        0 => "no state changes its best action".to_owned(),
        count if count > MOST => format!("{MOST} of {count} states that change their best action, most visited first"),
        1 => "1 state changes its best action".to_owned(),
        count => format!("{count} states change their best action, most visited first"),
    };
    let below = "below: state, old value and visits; how often the record tried each motion there. Orange is backwards";
    explain_unsure(&mut sheet, spot(WIDTH_PX - MARGIN_PX, BELOW_TITLE_PX));
    sheet.text(words(&note, spot(MARGIN_PX, BELOW_TITLE_PX), SMALL_PX, QUIET));
    sheet.text(words(below, spot(MARGIN_PX, BELOW_TITLE_PX + 20.0), SMALL_PX, QUIET));
    for (index, change) in shown.iter().enumerate() {
        let x_px = MARGIN_PX + (index % ACROSS) as f64 * STEP_X_PX;
        let y_px = top_px + (index / ACROSS) as f64 * STEP_Y_PX;
        let PolicyState { visits, .. } = change.before;
        let size = (data.rows, data.columns);
        icon(&mut sheet, spot(x_px, y_px), size, &change.before, strength(visits, most));
        let below_px = y_px + ICON_PX + 13.0;
        sheet.text(words(&format!("{visits} visits"), spot(x_px, below_px + 17.0), SMALL_PX, QUIET));
        for (side, state) in [&change.before, &change.after].into_iter().enumerate() {
            let x_px = x_px + ICON_PX + MOTION_PX + side as f64 * APART_PX;
            let foot_px = if state.best.linear_m_per_s < 0.0 { 8.0 } else { ICON_PX - 8.0 };
            motion(&mut sheet, spot(x_px, y_px + foot_px), state, fastest);
            let name = ["before", "after"][side];
            sheet.text(centred(words(name, spot(x_px, below_px), SMALL_PX, TEXT)));
            let tried = format!("tried {}", change.tried[side]);
            sheet.text(centred(words(&tried, spot(x_px, below_px + 17.0), SMALL_PX, QUIET)));
        }
        let (from, to) = (x_px + ICON_PX + MOTION_PX + APART_PX / 2.0, y_px + 6.0);
        sheet.line(
            vec![spot(from, to), (units(from), units(to + ICON_PX - 12.0))],
            1.0,
            QUIET.towards(super::sheet::PAPER, 0.6),
        );
    }
    sheet.finish(&note)
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::geometry::Twist;

    fn change(state: usize) -> StateChange {
        let at = |speed, turn| PolicyState {
            state,
            cells: vec![true; 9],
            visits: 7 + state as u64,
            best: Twist::new(speed, turn),
            value: -0.5,
        };
        StateChange { before: at(0.4, 0.0), after: at(0.2, 0.6), tried: [5, 2] }
    }

    fn drawn(states: &[StateChange]) -> String {
        policy_diff(&PolicyDiffData { title: "what changed", rows: 3, columns: 3, states }).unwrap().svg
    }

    #[test]
    fn each_changed_state_says_how_much_the_record_knows_of_it() {
        let svg = drawn(&[change(1), change(23)]);
        for words in
            ["2 states change their best action", "30 visits", "tried 5", "tried 2", "before", "after", "unsure"]
        {
            assert!(svg.contains(words), "{words}");
        }
    }

    #[test]
    fn a_page_holds_the_most_visited_and_says_how_many_there_are() {
        let states: Vec<StateChange> = (0..100).map(change).collect();
        assert!(drawn(&states).contains("60 of 100 states"));
        assert!(drawn(&[]).contains("no state changes its best action"));
    }
}
