use std::io::Cursor;

use image::{ImageFormat, Rgb, RgbImage};
use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Bench, root};

/// A grey photograph of 160 x 120 pixels with white bars well inside these cells of the 3x3 grid, row and column.
fn photograph(cells: &[(u32, u32)]) -> RgbImage {
    let mut image = RgbImage::from_pixel(160, 120, Rgb([60; 3]));
    for (row, column) in cells {
        for (x, y) in (12..40).filter(|x| x % 8 < 4).flat_map(|x| (10..30).map(move |y| (x, y))) {
            image.put_pixel(column * 53 + x, row * 40 + y, Rgb([250; 3]));
        }
    }
    image
}

/// Cells that make up a state: the lowest of each column.
fn cells(state: u32) -> Vec<(u32, u32)> {
    (0..3)
        .map(|column| (state / 4_u32.pow(column) % 4, column))
        .filter(|(height, _)| *height > 0)
        .map(|(height, column)| (height - 1, column))
        .collect()
}

fn encoded(image: &RgbImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png(cells: &[(u32, u32)]) -> Vec<u8> {
    encoded(&photograph(cells), ImageFormat::Png)
}

/// A photograph whose colour depends on the column of pixels.
fn painted(colour: impl Fn(u32) -> [u8; 3]) -> Vec<u8> {
    encoded(&RgbImage::from_fn(160, 120, |x, _| Rgb(colour(x))), ImageFormat::Png)
}

/// The header of a PNG says another size, with a checksum that fits.
fn pretend_size(mut png: Vec<u8>, size: u32) -> Vec<u8> {
    png[16..20].copy_from_slice(&size.to_be_bytes());
    png[20..24].copy_from_slice(&size.to_be_bytes());
    let bit = |crc: u32, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    let crc = png[12..29].iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), bit));
    png[29..33].copy_from_slice(&(!crc).to_be_bytes());
    png
}

fn seen(bench: &Bench, arguments: &[&str]) -> Vec<Value> {
    let output = bench.engine(&[&["filter", "short.rhai", "--json"], arguments].concat());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn told(bench: &Bench, arguments: &[&str]) -> (i32, String) {
    let output = bench.engine(arguments);
    let text = String::from_utf8(output.stdout).unwrap();
    (output.status.code().unwrap(), text + std::str::from_utf8(&output.stderr).unwrap())
}

fn refused(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let bench = Bench::new();
    bench.write(name, bytes);
    bench.failure(&["filter", "short.rhai", name])
}

// What filters say of themselves

#[test]
fn every_filter_is_listed_and_has_a_manual_whose_line_works_in_a_script() {
    let bench = Bench::new();
    let list: Vec<Value> = serde_json::from_slice(&bench.engine(&["plugins", "--json"]).stdout).unwrap();
    let (status, text) = told(&bench, &["plugins"]);
    assert_eq!((status, text.lines().count()), (0, list.len() + 1));
    for filter in &list {
        let name = filter["name"].as_str().unwrap();
        assert!(text.contains(name) && filter["form"] == "linked in", "{name}");
        let output = bench.engine(&["plugins", "show", name, "--json"]);
        let manual: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(manual["licence"].is_string() && manual["parameters"].is_array(), "{name}");
        let line = manual["script"].as_str().unwrap();
        assert!(told(&bench, &["plugins", "show", name]).1.contains(line), "{name}");
        if manual["writes"] == "mask" && manual["reads"][0] == "colour" {
            bench.write("mine.rhai", format!("world(\"small\");\n{line}\nrule \"x\" when robot.contact => -1;\n"));
            bench.write("a.png", png(&[]));
            // Some filters are refused in this grey room, but never for the line itself.
            let said = told(&bench, &["filter", "mine.rhai", "a.png"]).1;
            assert!(!said.contains("E-SCRIPT") && !said.contains("E-FILTER-SETTING"), "{said}");
        }
    }
}

#[test]
fn the_manual_of_a_filter() {
    assert_snapshot!(told(&Bench::new(), &["plugins", "show", "sobel"]).1);
}

#[test]
fn the_manual_of_a_filter_that_is_not_there() {
    assert_snapshot!(Bench::new().failure(&["plugins", "show", "sobell"]));
}

#[test]
fn filters_and_a_grid_are_a_script_enough_to_look_at_photographs_but_not_to_learn() {
    let bench = Bench::new();
    bench.write("look.rhai", "filter(\"sobel\", #{ threshold: 60 });\ngrid(#{ rows: 2, columns: 4 });\n");
    bench.write("a.png", png(&[]));
    let (_, said) = told(&bench, &["filter", "look.rhai", "a.png", "--set", "grid.rows=3", "--json"]);
    let seen: Value = serde_json::from_str(said.lines().next().map_or("", |_| &said))
        .unwrap_or_else(|error| panic!("{error}: {said}"));
    assert_eq!(seen[0]["cells"].as_array().unwrap().len(), 12);
    for command in ["run", "check"] {
        assert!(bench.failure(&[command, "look.rhai"]).contains("E-SCRIPT-EMPTY"), "{command}");
    }
}

// What a photograph becomes

#[test]
fn a_photograph_has_the_state_that_its_cells_say() {
    let bench = Bench::new();
    // Left column down to the middle row: 2; right column only the top row: 1 * 16.
    bench.write("a.png", png(&[(1, 0), (0, 2)]));
    bench.write("b.jpg", encoded(&photograph(&[(2, 1)]), ImageFormat::Jpeg));
    let all = seen(&bench, &["b.jpg", "a.png"]);
    assert_eq!((&all[1]["state"], &all[1]["columns"]), (&18.into(), &serde_json::json!([2, 0, 1])));
    assert_eq!((&all[0]["state"], &all[0]["columns"]), (&12.into(), &serde_json::json!([0, 3, 0])));
    assert!(all[0].get("new").is_none());
    let text = told(&bench, &["filter", "short.rhai", "a.png"]).1;
    assert_eq!(text, "a.png: state 18, columns 2 0 1\npictures: runs/short/filter\n");
    let picture = bench.read("runs/short/filter/a.svg");
    assert!(picture.contains("photograph") && picture.contains("sobel") && picture.contains("state 18"));
    assert!(bench.path().join("runs/short/filter/b.png").exists());
}

#[test]
fn a_photograph_is_cut_around_its_middle_and_scaled() {
    let bench = Bench::new();
    let small = photograph(&[(2, 1)]);
    // Eight times as large, with stripes on the left and the right that are cut away.
    let stripe = |x: u32| if x.is_multiple_of(2) { Rgb([255; 3]) } else { Rgb([0; 3]) };
    let inside = |x: u32| (640..1920).contains(&x);
    let wide =
        RgbImage::from_fn(
            2560,
            960,
            |x, y| if inside(x) { *small.get_pixel((x - 640) / 8, y / 8) } else { stripe(x / 64) },
        );
    bench.write("wide.png", encoded(&wide, ImageFormat::Png));
    let tall =
        RgbImage::from_fn(
            160,
            400,
            |x, y| {
                if (140..260).contains(&y) { *small.get_pixel(x, y - 140) } else { stripe(y / 8) }
            },
        );
    bench.write("tall.png", encoded(&tall, ImageFormat::Png));
    let states: Vec<Value> = seen(&bench, &["wide.png", "tall.png"]).iter().map(|seen| seen["state"].clone()).collect();
    assert_eq!(states, [12, 12]);
}

#[test]
fn a_photograph_from_a_camera_held_upright_is_turned() {
    let bench = Bench::new();
    let lying = encoded(&image::imageops::rotate270(&photograph(&[(2, 1), (0, 2)])), ImageFormat::Jpeg);
    // EXIF with one entry: orientation 6, to be turned clockwise.
    let exif = b"\xff\xe1\0\x22Exif\0\0II\x2a\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    bench.write("a.jpg", [&lying[..2], exif, &lying[2..]].concat());
    assert_eq!(seen(&bench, &["a.jpg"])[0]["columns"], serde_json::json!([0, 3, 1]));
}

#[test]
fn a_folder_stands_for_its_photographs_in_the_order_of_their_names() {
    let bench = Bench::new();
    for name in ["photos/b.png", "photos/a.PNG", "photos/c/d.png", "other/b.png"] {
        bench.write(name, png(&[]));
    }
    bench.write("photos/notes.txt", "none");
    let all = seen(&bench, &["photos", "other"]);
    let files: Vec<&str> = all.iter().map(|seen| seen["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["photos/a.PNG", "photos/b.png", "other/b.png"]);
    // Two photographs of one name have a picture each.
    assert_eq!(all[2]["picture"], "runs/short/filter/b-2.png");
}

// What training met

#[test]
fn states_that_training_met_are_told_from_new_ones() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "learned"]);
    let policy: toml::Table = bench.read("learned/policy.toml").parse().unwrap();
    let rows = policy["state"].as_array().unwrap();
    let rows: Vec<&toml::Value> = rows.iter().filter(|row| row["visits"].as_integer() > Some(0)).collect();
    let met: Vec<u32> = rows.iter().map(|row| row["index"].as_integer().unwrap() as u32).collect();
    let unmet: Vec<u32> = (0..64).filter(|state| !met.contains(state)).collect();
    for (name, state) in [("a.png", met[0]), ("b.png", unmet[0]), ("c.png", unmet[1])] {
        bench.write(&format!("photos/{name}"), png(&cells(state)));
    }
    let output = bench.engine(&["filter", "short.rhai", "photos", "--run", "learned", "--json"]);
    let all: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!([&all[0]["state"], &all[1]["state"]], [met[0], unmet[0]]);
    assert_eq!([&all[0]["new"], &all[1]["new"], &all[2]["new"]], [false, true, true]);
    assert_eq!(all[0]["visits"], rows[0]["visits"].as_integer().unwrap());
    assert_eq!((&all[1]["visits"], output.status.code()), (&0.into(), Some(1)));
    let (status, text) = told(&bench, &["filter", "short.rhai", "photos", "--run", "learned"]);
    assert!(status == 1 && text.contains("warning:  more than 20 %"), "{text}");
    assert!(text.contains("new:      67 % of 3 images show a state never met"), "{text}");
    let fine = ["filter", "short.rhai", "photos", "--run", "learned", "--new-share", "1"];
    assert_eq!(told(&bench, &fine).0, 0);
}

#[test]
fn a_run_that_sees_with_other_filters() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "learned"]);
    bench.write("a.png", png(&[]));
    let script = bench.read("short.rhai");
    // The default written out is the same eye; another threshold is not.
    bench.write("same.rhai", format!("filter(\"sobel\", #{{ threshold: 60 }});\n{script}"));
    assert_ne!(told(&bench, &["filter", "same.rhai", "a.png", "--run", "learned"]).0, 7);
    bench.write("other.rhai", format!("filter(\"sobel\", #{{ threshold: 90 }});\n{script}"));
    assert_snapshot!(bench.failure(&["filter", "other.rhai", "a.png", "--run", "learned"]));
    let set = ["filter", "other.rhai", "a.png", "--run", "learned", "--set", "filter.sobel.threshold=60"];
    assert_ne!(told(&bench, &set).0, 7);
}

// What cannot be seen

#[test]
fn a_photograph_that_is_not_there() {
    let bench = Bench::new();
    bench.write("photo.png", png(&[]));
    assert_snapshot!(bench.failure(&["filter", "short.rhai", "phoot.png"]));
}

#[test]
fn a_folder_without_photographs() {
    assert_snapshot!(Bench::new().failure(&["filter", "short.rhai", "worlds"]));
}

#[test]
fn a_text_that_is_called_png() {
    assert_snapshot!(refused("notes.png", "no picture\n"));
}

#[test]
fn an_image_of_another_format() {
    assert_snapshot!(refused("moving.png", b"GIF89a\x01\0\x01\0\0\0\0;"));
}

#[test]
fn an_image_of_too_many_pixels() {
    assert_snapshot!(refused("bomb.png", pretend_size(png(&[]), 65_000)));
}

#[test]
fn a_file_of_too_many_bytes() {
    let bench = Bench::new();
    let file = std::fs::File::create(bench.path().join("large.png")).unwrap();
    file.set_len((64 << 20) + 1).unwrap();
    assert_snapshot!(bench.failure(&["filter", "short.rhai", "large.png"]));
}

#[test]
fn a_truncated_image() {
    let whole = png(&[(1, 1)]);
    assert_snapshot!(refused("cut.png", &whole[..whole.len() / 2]));
    let whole = encoded(&photograph(&[(1, 1)]), ImageFormat::Jpeg);
    assert_snapshot!(refused("cut.jpg", &whole[..whole.len() / 2]));
}

#[test]
fn pictures_that_would_overwrite_photographs() {
    let bench = Bench::new();
    bench.write("photos/a.png", png(&[]));
    assert_snapshot!(bench.failure(&["filter", "short.rhai", "photos", "--out", "photos"]));
    assert_eq!(std::fs::read(bench.path().join("photos/a.png")).unwrap(), png(&[]));
}

#[test]
fn damage_anywhere_is_an_error_or_a_picture_and_never_a_panic() {
    let bench = Bench::new();
    let small = image::imageops::resize(&photograph(&[(1, 1)]), 24, 18, image::imageops::FilterType::Triangle);
    let path = bench.path().join("damaged");
    for format in [ImageFormat::Png, ImageFormat::Jpeg] {
        let whole = encoded(&small, format);
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x55;
            for bytes in [&damaged[..], &whole[..at]] {
                std::fs::write(&path, bytes).unwrap();
                match engine::sensors::load_photograph(&path, 16, 12) {
                    Ok(image) => assert_eq!(image.pixels.len(), 16 * 12 * 3),
                    Err(error) => assert!(error.code.starts_with("E-IMAGE-"), "{error}"),
                }
            }
        }
    }
}

#[test]
fn a_photograph_of_a_shipped_behaviour_is_seen_through_all_its_filters() {
    let bench = Bench::new();
    bench.write("a.png", png(&[(2, 2)]));
    let script = root().join("scripts/wall.rhai");
    let (status, text) = told(&bench, &["filter", script.to_str().unwrap(), "a.png", "--out", "x"]);
    assert_eq!((status, text.as_str()), (0, "a.png: state 48, columns 0 0 3\npictures: x\n"));
}

#[test]
fn photographs_need_no_world_that_shows_what_the_filters_look_for() {
    let bench = Bench::new();
    bench.write(
        "yellow.rhai",
        "world(\"nowhere\"); filter(\"colour\", #{ hue_deg: 50 });\nrule \"seen\" when camera.seen => 1;",
    );
    bench.write("a.png", painted(|x| if x < 80 { [230, 200, 20] } else { [90, 90, 90] }));
    let output = bench.engine(&["filter", "yellow.rhai", "a.png", "--json"]);
    let all: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    // The left half is yellow: of the three columns the first wholly, the second half.
    assert_eq!(all[0]["coverage"], 0.5);
    let cells: Vec<f64> = all[0]["cells"].as_array().unwrap().iter().map(|share| share.as_f64().unwrap()).collect();
    assert!(cells.len() == 9 && cells[0] == 1.0 && (cells[1] - 0.5).abs() < 0.02 && cells[2] == 0.0, "{cells:?}");
    let mask = image::open(bench.path().join(all[0]["mask"].as_str().unwrap())).unwrap().into_luma8();
    assert_eq!((mask.width(), mask.height()), (160, 120));
    assert_eq!(mask.pixels().filter(|pixel| pixel.0[0] == 255).count(), 160 * 120 / 2);
}

#[test]
fn images_that_all_have_one_state_are_told() {
    let bench = Bench::new();
    for index in 0..6 {
        bench.write(&format!("photos/{index}.png"), painted(|_| [10 * index, 50, 50]));
    }
    let output = bench.engine(&["filter", "short.rhai", "photos"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("one state (0) for 6 of 6 images, with every cell empty: lower the filter's threshold"),
        "{text}"
    );
    assert_eq!(output.status.code(), Some(1));
}

// Several views

#[test]
fn a_view_of_several_is_seen_by_its_name() {
    let bench = Bench::new();
    let views = "view(\"red\", filter(\"colour\")); view(\"edges\", filter(\"sobel\", #{ threshold: 60 }));";
    let script = bench.read("short.rhai");
    bench.write("short.rhai", format!("{script}{views}"));
    // Red on the left half, and nothing else that is coloured.
    bench.write("half.png", painted(|x| if x < 80 { [220, 20, 20] } else { [120, 120, 120] }));
    let red = &seen(&bench, &["half.png", "--view", "red"])[0];
    assert_eq!((&red["state"], &red["coverage"], &red["size"]), (&(3 + 4 * 3).into(), &0.5.into(), &0.5.into()));
    // The middle of the left half is half of tan 40 degrees aside: 22.8 degrees, more on the floor below.
    assert!((22.0..45.0).contains(&red["bearing_deg"].as_f64().unwrap()), "{red}");
    let edges = &seen(&bench, &["half.png", "--view", "edges"])[0];
    assert!(edges["coverage"].as_f64().unwrap() < 0.1, "{edges}");
    assert_snapshot!(bench.failure(&["filter", "short.rhai", "half.png", "--view", "rde"]));
}
