//! What a mover does besides driving on is checked against its route.

use super::{START, expect};

fn mover(lines: &str, closed: bool) -> String {
    format!(
        "[[start]]\nposition_m = [0, 9]\n[[route]]\nname = \"way\"\npoints_m = [[0, 0], [4, 0], [4, 4]]\nclosed = {closed}\n\
         [[mover]]\nname = \"a\"\nroute = \"way\"\n{lines}\nboxes = []\n"
    )
}

fn wrong(lines: &str, closed: bool, marked: &str, words: &str) {
    expect(&mover(lines, closed), "E-WORLD-VALUE", marked, words);
}

#[test]
fn a_mover_has_one_speed_or_speeds() {
    let none = mover("", false);
    let found = super::mistake(&none);
    assert!(found.0 == "E-WORLD-KEY" && found.3.contains("has no speed; write 'speed_m_per_s = 0.2'"), "{found:?}");
    let both = mover("speed_m_per_s = 1\nspeeds = [{ from_m = 0, m_per_s = 1 }]", false);
    expect(&both, "E-WORLD-KEY", "[{ from_m = 0, m_per_s = 1 }]", "has 'speed_m_per_s' and 'speeds'");
    wrong("speed_m_per_s = [0.3, 0.1]", false, "[0.3, 0.1]", "write [0.1, 0.3]");
    wrong("speed_m_per_s = [0.3]", false, "[0.3]", "found 1 number");
    wrong("speed_m_per_s = \"fast\"", false, "\"fast\"", "or [least, greatest]");
}

#[test]
fn places_lie_on_the_route_and_rise() {
    let pauses = |at: &str| format!("speed_m_per_s = 1\npauses = [{at}]");
    wrong(&pauses("{ at_m = 8.5, for_s = 1 }"), false, "8.5", "the route 'way' is 8 m long");
    // An open route has an end to pause at; that of a closed one is its beginning.
    assert!(super::parse(&mover(&pauses("{ at_m = 8, for_s = 1 }"), false)).is_ok());
    wrong(&pauses("{ at_m = 13.7, for_s = 1 }"), true, "13.7", "13.656 m long");
    let falling = pauses("{ at_m = 3, for_s = 1 }, { at_m = 3, for_s = 1 }");
    wrong(&falling, false, "3", "'at_m' must rise from table to table");
    wrong("speeds = [{ from_m = 1, m_per_s = 1 }]", false, "1", "begin with { from_m = 0, m_per_s = ... }");
    wrong("speeds = [{ from_m = 0, m_per_s = 0 }]", false, "0", "0.001 to 10 (metres per second)");
}

#[test]
fn what_cannot_be_is_refused_with_its_reason() {
    wrong("speed_m_per_s = 1\nreturns = true", true, "true", "nothing comes back on it");
    wrong("speed_m_per_s = 1\nat_recovery = \"begin\"", false, "\"begin\"", "did you mean \"begins\"?");
    let pushed = format!("{START}[[box]]\ncentre_m = [2, 2]\nsize_m = [1, 1, 1]\npushable = true\n");
    expect(&pushed, "E-WORLD-KEY", "pushable", "nothing can be pushed here: that needs friction");
}
