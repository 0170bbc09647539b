//! Steps, motions, states and facts in words for a terminal.

use engine::diagnostic::printable;
use engine::experiment::FactReasons;
use insight::words::short;

/// `0.25 m/s, 0.4 rad/s left`.
pub(super) fn motion([linear, angular]: [f64; 2]) -> String {
    let turn = match angular {
        0.0 => "straight".to_owned(),
        turn if turn > 0.0 => format!("{turn} rad/s left"),
        turn => format!("{} rad/s right", -turn),
    };
    format!("{linear} m/s, {turn}")
}

/// A state's cells, one line for each row from the top.
pub(super) fn icon(cells: &[bool], columns: usize) -> Vec<String> {
    let row = |row: &[bool]| row.iter().map(|filled| if *filled { "■" } else { "·" }).collect::<Vec<_>>().join(" ");
    cells.chunks(columns.max(1)).map(row).collect()
}

/// `laser.nearest = 0.241 m: beam 37, 53° right of ahead`.
pub(super) fn fact(fact: &FactReasons) -> String {
    let value = match (fact.unit, fact.value) {
        ("", 0.0) => "false".to_owned(),
        ("", 1.0) => "true".to_owned(),
        ("metres", value) => format!("{} m", short(value)),
        ("share", value) => format!("{:.2} %", 100.0 * value),
        ("" | "number" | "beam" | "state" | "action", value) => short(value),
        (unit, value) => format!("{} {unit}", short(value)),
    };
    let beam = match (fact.beam, fact.angle_deg) {
        (Some(beam), Some(angle_deg)) => format!(" (beam {beam}, {})", direction(angle_deg)),
        _ => String::new(),
    };
    format!("{} = {value}{beam}", printable(&fact.name))
}

/// Where a beam looks.
pub(super) fn direction(angle_deg: f64) -> String {
    match short(angle_deg.abs()) {
        angle if angle == "0" => "straight ahead".to_owned(),
        angle => format!("{angle}° {} of ahead", if angle_deg > 0.0 { "left" } else { "right" }),
    }
}

/// A change: with its sign.
pub(super) fn signed(value: f64) -> String {
    if value > 0.0 { format!("+{}", short(value)) } else { short(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fact_names_its_beam_and_where_it_looks() {
        let shown = FactReasons {
            name: "laser.nearest".to_owned(),
            value: 0.241,
            unit: "metres",
            beam: Some(37),
            angle_deg: Some(-53.0),
        };
        assert_eq!(fact(&shown), "laser.nearest = 0.241 m (beam 37, 53° right of ahead)");
        let flag = FactReasons { name: "camera.seen".to_owned(), value: 0.0, unit: "", beam: None, angle_deg: None };
        assert_eq!(fact(&flag), "camera.seen = false");
    }

    #[test]
    fn motions_say_which_way_they_turn() {
        assert_eq!(motion([0.4, 0.2]), "0.4 m/s, 0.2 rad/s left");
        assert_eq!(motion([0.4, -0.2]), "0.4 m/s, 0.2 rad/s right");
        assert_eq!(motion([0.4, 0.0]), "0.4 m/s, straight");
    }

    #[test]
    fn a_state_is_drawn_row_by_row() {
        assert_eq!(icon(&[true, false, false, true], 2), ["■ ·", "· ■"]);
    }
}
