//! Every mistake in a world file is told at its place, with what to write instead.

mod marks;
mod movers;

use super::schema::{FILE, FileKey, KeyForm};
use super::*;
use crate::diagnostic::Kind;
use crate::world::scene::{Shape, Texture};

const PIONEER: BodyShape = BodyShape::pioneer2at();
const START: &str = "[[start]]\nposition_m = [0, 0]\n";

fn parse(text: &str) -> Result<Layout> {
    Layout::parse(SourceText::new("worlds/test.toml", text), &PIONEER)
}

/// The code, the underlined text, the words beside it and the next step.
fn mistake(text: &str) -> (&'static str, String, String, String) {
    let error = *parse(text).unwrap_err();
    assert_eq!(error.kind(), Kind::Input);
    assert!(error.others.is_empty(), "one cause, one error: {text}: {:?}", error.others);
    let place = error.place.unwrap_or_else(|| panic!("no place: {}", error.message));
    let marked = place.source.text[place.span].to_owned();
    (error.code, marked, place.label, format!("{}; {}", error.message, error.help.unwrap_or_default()))
}

fn expect(text: &str, code: &str, marked: &str, words: &str) {
    let found = mistake(text);
    assert_eq!((found.0, found.1.as_str()), (code, marked), "{found:?}");
    assert!(format!("{}; {}", found.3, found.2).contains(words), "{found:?}");
}

fn wall(line: &str) -> String {
    format!("{START}[[wall]]\npoints_m = [[1, 1], [2, 1]]\n{line}\n")
}

fn shipped() -> Vec<Layout> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../worlds");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    paths
        .iter()
        .map(|path| Layout::load(path, &PIONEER).unwrap_or_else(|error| panic!("{}: {error:?}", path.display())))
        .collect()
}

#[test]
fn every_shipped_world_loads_and_can_be_driven_along_its_lap_if_it_has_one() {
    let layouts = shipped();
    assert!(layouts.len() >= 6);
    for layout in &layouts {
        // Some are made to wander in or to park in.
        let Some(lap) = layout.lap.map(|lap| &layout.routes[lap]) else { continue };
        for piece in 0..200 {
            let pose = lap.pose_at(lap.length_m() * f64::from(piece) / 200.0);
            assert_eq!(layout.obstruction(&PIONEER, pose), None, "{} at {pose:?}", layout.name);
        }
        for start in &layout.starts {
            let distance = lap.nearest(crate::geometry::Point2::new(start.pose.x_m, start.pose.y_m)).1;
            assert!(distance < 1e-9, "{}: {start:?}", layout.name);
        }
    }
    let length = |name: &str| {
        let layout = layouts.iter().find(|layout| layout.name == name).unwrap();
        layout.routes[layout.lap.unwrap()].length_m()
    };
    for (name, metres) in [("room", 41.2), ("corridor", 52.0), ("platform", 52.0), ("rectangle", 23.2)] {
        assert!((length(name) - metres).abs() < 1e-9, "{name}");
    }
    assert!((length("object") - (83.2 - 8.0 * (1.2 - 0.3 * std::f64::consts::PI))).abs() < 0.01);
}

#[test]
fn a_wall_is_a_box_on_every_segment_with_square_corners() {
    let layout = parse(&format!("{START}[[wall]]\npoints_m = [[1, 1], [4, 1], [4, 3]]\nthickness_m = 0.2\n")).unwrap();
    let solids = &layout.scene.parts().solids;
    assert_eq!(solids.len(), 2);
    assert_eq!((solids[0].centre.x, solids[0].centre.z), (2.5, 0.5));
    let Shape::Box { half_m } = solids[0].shape else { panic!("not a box") };
    assert!((half_m.x - 1.6).abs() < 1e-12 && half_m.y == 0.1 && half_m.z == 0.5);
    assert!((solids[1].yaw_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn materials_textures_and_paint_are_read() {
    let text = format!(
        "{START}[[material]]\nname = \"glass\"\ncolour = [1, 2, 3]\nlaser = false\n\
         texture = {{ kind = \"checker\", amplitude = 5, scale_m = 0.5 }}\n\
         [[paint]]\ncentre_m = [0, 0]\nsize_m = [1, 2]\nmaterial = \"glass\"\n"
    );
    let layout = parse(&text).unwrap();
    let parts = layout.scene.parts();
    assert_eq!(parts.materials[0].texture, Texture::Checker { amplitude: 5.0, scale_m: 0.5 });
    assert!(!parts.materials[0].laser && parts.materials[0].colour == [1, 2, 3]);
    assert!(!parts.solids[0].collides && parts.solids[0].material == 0);
}

#[test]
fn a_wrong_or_missing_unit_is_answered_with_the_right_one() {
    expect(&wall("height_cm = 80"), "E-WORLD-KEY", "height_cm", "write 'height_m', in metres");
    expect(&wall("height = 0.8"), "E-WORLD-KEY", "height", "write 'height_m', in metres");
    expect(&format!("{START}yaw_rad = 1\n"), "E-WORLD-KEY", "yaw_rad", "write 'yaw_deg', in degrees");
    let mover = "[[mover]]\nname = \"a\"\nroute = \"b\"\nspeed = 1\nboxes = []\n";
    expect(&format!("{START}{mover}"), "E-WORLD-KEY", "speed", "write 'speed_m_per_s', in metres per second");
}

#[test]
fn a_misspelt_key_is_answered_with_the_nearest() {
    expect(&wall("closde = true"), "E-WORLD-KEY", "closde", "[[wall]] has no key 'closde'; did you mean 'closed'?");
    expect(&format!("{START}[[rute]]\n"), "E-WORLD-KEY", "rute", "did you mean 'route'?");
    expect(&format!("{START}[[wall]]\n"), "E-WORLD-KEY", "[[wall]]", "add 'points_m = ...'");
    expect(&format!("{START}[wall]\npoints_m = [[1, 1], [2, 1]]\n"), "E-WORLD-VALUE", "[wall]", "[[wall]]");
    let both = "[[platform]]\nwidth_m = 1\ncentre_m = [0, 0]\n";
    expect(&format!("{START}{both}"), "E-WORLD-KEY", "[[platform]]", "one solid has centre_m, size_m");
}

#[test]
fn a_value_out_of_its_range_or_of_the_wrong_kind_is_marked() {
    for bad in ["0", "-1.0", "nan", "inf", "-inf", "1e30", "99999999999999999999", "\"high\"", "true", "[1]"] {
        expect(&wall(&format!("height_m = {bad}")), "E-WORLD-VALUE", bad, "a number from 0.001 to 1000 (metres)");
    }
    expect(&wall("closed = 1"), "E-WORLD-VALUE", "1", "true or false");
    expect(&format!("{START}[light]\ntowards = [0, 0, 0]\n"), "E-WORLD-VALUE", "[0, 0, 0]", "direction");
    expect("[[start]]\nposition_m = [0]\n", "E-WORLD-VALUE", "[0]", "2 numbers");
    let text = format!("{START}[[wall]]\npoints_m = [[1, 1], [1, 1.0]]\n");
    expect(&text, "E-WORLD-VALUE", "[1, 1.0]", "the same point as the one before");
    expect(&text, "E-WORLD-VALUE", "[1, 1.0]", "two points of 'points_m' are the same");
    let slab = format!("{START}[[platform]]\ncentre_m = [2, 2]\nsize_m = [4, 4]\n");
    expect(&slab, "E-WORLD-VALUE", "[4, 4]", "a solid needs [length, width, height]");
    let text = format!("{START}[[wall]]\npoints_m = [[1, 1]]\n");
    expect(&text, "E-WORLD-VALUE", "[[1, 1]]", "found 1 point");
    let texture = "[[material]]\nname = \"a\"\ncolour = [0, 0, 0]\ntexture = { kind = \"chequer\" }\n";
    expect(&format!("{START}{texture}"), "E-WORLD-VALUE", "\"chequer\"", "did you mean \"checker\"?");
}

#[test]
fn names_must_exist_and_be_used_once() {
    expect(&wall("material = \"plian\""), "E-WORLD-NAME", "\"plian\"", "did you mean \"plain\"?");
    let material = "[[material]]\nname = \"a\"\ncolour = [0, 0, 0]\n";
    expect(&format!("{START}{material}{material}"), "E-WORLD-NAME", "\"a\"", "two materials with the name 'a'");
    let mover = "[[mover]]\nname = \"a\"\nroute = \"b\"\nspeed_m_per_s = 1\nboxes = []\n";
    expect(&format!("{START}{mover}"), "E-WORLD-NAME", "\"b\"", "no route named 'b'");
}

#[test]
fn a_lap_is_closed_and_a_radius_fits() {
    let route = |rest: &str| format!("{START}[[route]]\nname = \"lap\"\npoints_m = [[0, 0], [4, 0], [4, 4]]\n{rest}\n");
    expect(&route("closed = false"), "E-WORLD-VALUE", "false", "must be closed");
    let found = mistake(&route("closed = true\ncorner_radius_m = 3"));
    assert!(found.0 == "E-WORLD-VALUE" && found.3.contains("there is room for"), "{found:?}");
}

#[test]
fn a_start_must_be_free_and_on_the_ground() {
    expect(
        &wall("").replace("[[1, 1], [2, 1]]", "[[0.2, -1], [0.2, 1]]"),
        "E-WORLD-START",
        "[0, 0]",
        "[[wall]] of line 3",
    );
    let edge = "[[platform]]\ncentre_m = [0, 0]\nsize_m = [0.6, 0.4, 0.5]\n";
    expect(&format!("{edge}{START}"), "E-WORLD-START", "[0, 0]", "no ground");
    let round = BodyShape { footprint: crate::settings::Footprint::Round { radius_m: 0.22 }, ..PIONEER };
    let help = |text: String| Layout::parse(SourceText::new("test.toml", text), &round).unwrap_err().help.unwrap();
    let wall = wall("").replace("[[1, 1], [2, 1]]", "[[0.2, -1], [0.2, 1]]");
    assert_eq!(help(wall), "the robot needs 0.22 m on all sides of this place");
    assert_eq!(help(format!("{edge}{START}")), "move it at least 0.22 m away from every edge");
    assert_eq!(mistake("description = \"empty\"\n").0, "E-WORLD-START");
    assert_eq!(mistake("").0, "E-WORLD-START");
}

#[test]
fn hostile_text_is_refused_without_harm() {
    let codes = [
        (mistake("x = = 1").0, "E-WORLD-SYNTAX"),
        (mistake(&"[".repeat(20_000)).0, "E-WORLD-SYNTAX"),
        (mistake(&format!("x = {}", "[".repeat(200_000))).0, "E-WORLD-SYNTAX"),
        (mistake(&format!("{}b = 1", "a.".repeat(200_000))).0, "E-WORLD-SYNTAX"),
        (mistake(&format!("{START}[light]\ngain = 1\ngain = 2\n")).0, "E-WORLD-SYNTAX"),
        (mistake("\"\\u001b[31m\" = 1\n").0, "E-WORLD-KEY"),
    ];
    for (found, expected) in codes {
        assert_eq!(found, expected);
    }
    let many = format!("{START}[[wall]]\npoints_m = [{}]\n", "[1, 1], [2, 1], ".repeat(4_900));
    assert!(parse(&many).is_ok());
    assert_eq!(mistake(&format!("{START}{}", many[START.len()..].repeat(3))).0, "E-WORLD-VALUE");
}

/// Line and code of each mistake.
fn mistakes(text: &str) -> Vec<(usize, &'static str)> {
    let error = parse(text).unwrap_err();
    let line = |one: &Diagnostic| one.place.as_ref().map_or(0, |place| place.source.position(place.span.start).0);
    error.all().map(|one| (line(one), one.code)).collect()
}

#[test]
fn every_wrong_part_is_told_in_the_order_of_the_lines() {
    let text = format!(
        "[light]\ngain = 9\n{START}[[wall]]\npoints_m = [[1, 1], [2, 1]]\nheigth_m = 1\nmaterial = 3\n\
         [[box]]\ncentre_m = [5, 5]\nsize_m = [1, 1, 1]\nmaterial = \"glass\"\n[[cylinder]]\nradius_m = 1\n"
    );
    let told =
        [(2, "E-WORLD-VALUE"), (7, "E-WORLD-KEY"), (8, "E-WORLD-VALUE"), (12, "E-WORLD-NAME"), (13, "E-WORLD-KEY")];
    assert_eq!(mistakes(&text), told);
    let error = parse(&text).unwrap_err();
    assert_eq!(error.summary().unwrap(), "5 mistakes in 'worlds/test.toml'");
    assert!(error.others[3].help.as_ref().unwrap().ends_with("; it needs 'height_m' too"));
    let starts = "[[start]]\nposition_m = [1.5, 1]\n[[start]]\nposition_m = [1, 1.2]\n";
    assert_eq!(mistakes(&wall(starts)), [(6, "E-WORLD-START"), (8, "E-WORLD-START")]);
    let twice = format!("{START}[light]\ngain = 1\ngain = 2\nambient = 0.1\nambient = 0.2\n");
    assert_eq!(mistakes(&twice), [(5, "E-WORLD-SYNTAX"), (7, "E-WORLD-SYNTAX")]);
}

#[test]
fn what_follows_from_a_mistake_is_not_told() {
    let glass = "material = \"glass\"\n";
    let material = |key: &str, colour: &str| format!("[[material]]\n{key} = \"glass\"\ncolour = {colour}\n");
    // The material is there, or may be: only its own mistake is told.
    for text in [material("name", "[1]"), material("nmae", "[1, 2, 3]"), material("name", "7")] {
        assert_eq!(mistakes(&format!("{}{text}", wall(glass))).len(), 1, "{text}");
    }
    assert_eq!(mistakes(&format!("{}[[matrial]]\nname = \"glass\"\n", wall(glass))).len(), 1);
    let mover = "[[mover]]\nname = \"a\"\nroute = \"b\"\nspeed_m_per_s = 1\nboxes = []\n";
    let route = "[[route]]\nname = \"b\"\npoints_m = [[0, 0]]\n";
    assert_eq!(mistakes(&format!("{START}{mover}{route}")).len(), 1);
    assert_eq!(mistakes("[[start]]\nposition = [0, 0]\n"), [(2, "E-WORLD-KEY")]);
}

#[test]
fn twenty_mistakes_of_a_world_are_shown_and_the_others_counted() {
    let error = parse(&format!("{START}{}", "[[box]]\n".repeat(25))).unwrap_err();
    assert_eq!((error.others.len(), error.left_out), (19, 5));
    // As many as fit into a file: bounded in time and in memory.
    let error = parse(&format!("{START}{}", "[[box]]\nx=1\n".repeat(19_000))).unwrap_err();
    assert_eq!((error.others.len(), error.left_out), (19, 18_980));
}

#[test]
fn a_file_that_cannot_be_read_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("w.toml");
    let message = || Layout::load(&path, &PIONEER).map(|_| ()).unwrap_err();
    assert!(message().code == "E-WORLD-FILE" && message().message.contains("no such file"));
    std::fs::write(&path, [0xff, 0xfe, 0x00]).unwrap();
    assert!(message().message.contains("UTF-8"));
    std::fs::write(&path, " ".repeat((1 << 20) + 1)).unwrap();
    assert!(message().message.contains("1 MiB"));
    assert!(Layout::load(folder.path(), &PIONEER).unwrap_err().message.contains("folder"));
}

#[test]
fn the_manual_names_every_key() {
    fn names(keys: &'static [FileKey], found: &mut Vec<&'static str>) {
        for key in keys {
            found.push(key.name);
            if let KeyForm::Table(keys) | KeyForm::Tables(keys, _) = key.form {
                names(keys, found);
            }
        }
    }
    let mut keys = Vec::new();
    names(FILE, &mut keys);
    let manual = include_str!("../../../../../worlds/README.md");
    let missing: Vec<_> = keys.iter().filter(|key| !manual.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "not in worlds/README.md: {missing:?}");
    let example = manual.split("```toml").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert!(parse(example).is_ok(), "{:?}", parse(example).err());
}

#[test]
fn platforms_ramps_and_what_is_a_step_from_them_are_driven_on_and_walls_are_not() {
    let text = "[[start]]\nposition_m = [0, 0]\n\
        [[platform]]\ncentre_m = [0, 0]\nsize_m = [4, 4, 0.5]\n\
        [[box]]\ncentre_m = [1, 0]\nsize_m = [0.4, 2, 0.04]\nbottom_m = 0.5\n\
        [[box]]\ncentre_m = [-1, 1]\nsize_m = [0.4, 0.4, 0.4]\nbottom_m = 0.5\n\
        [[box]]\ncentre_m = [2.5, 0]\nsize_m = [1, 1, 0.5]\n\
        [[box]]\ncentre_m = [9, 9]\nsize_m = [1, 1, 0.5]\n\
        [[box]]\ncentre_m = [9, 0]\nsize_m = [1, 1, 0.05]\n";
    let layout = parse(text).unwrap();
    // The boxes come first.
    assert_eq!(layout.driven_on(&PIONEER), [true, false, true, false, true, true]);
}
