//! Pictures of made-up runs: sizes, labels, places, sameness, and odd inputs.

use filter_api::Format;
use image::GenericImageView;

use super::*;
use engine::diagnostic::SourceText;
use engine::experiment::SeenView;
use engine::experiment::Trail;
use engine::geometry::{Point3, Twist, Vector3};
use engine::random::Random;
use engine::sensors::observation::Image;
use engine::settings::BodyShape;
use engine::world::Layout;
use engine::world::scene::{Light, Material, SceneParts, Shape, Solid, Texture};

fn solid(shape: Shape, x: f64, y: f64, yaw_rad: f64) -> Solid {
    let z = shape.half_extents().z;
    Solid { shape, centre: Point3::new(x, y, z), yaw_rad, material: 0, collides: true }
}

/// What the robot of these tests drives on.
const SLAB: Shape = Shape::Box { half_m: Vector3::new(3.0, 3.0, 0.2) };

fn wall(from: [f64; 2], to: [f64; 2]) -> Solid {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let half_m = Vector3::new((dx * dx + dy * dy).sqrt() / 2.0 + 0.05, 0.05, 0.25);
    solid(Shape::Box { half_m }, (from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0, libm::atan2(dy, dx))
}

fn world(solids: Vec<Solid>) -> SceneParts {
    let material = Material { name: "wall".into(), colour: [200, 40, 30], texture: Texture::Plain, laser: true };
    let light = Light::from_direction(Vector3::z(), 0.5, 1.0);
    SceneParts { solids, materials: vec![material], floor: 0, light }
}

fn square() -> SceneParts {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    world((0..4).map(|side| wall(corners[side], corners[(side + 1) % 4])).collect())
}

fn circle(points: usize) -> Vec<[f32; 2]> {
    let angle = |part: usize| part as f64 / points as f64 * std::f64::consts::TAU;
    (0..points).map(|part| [(2.0 + libm::cos(angle(part))) as f32, (2.0 + libm::sin(angle(part))) as f32]).collect()
}

fn both(parts: &SceneParts, path: &Trail) -> Picture {
    let world = WorldPlan {
        driven_on: parts.solids.iter().map(|solid| solid.shape == SLAB).collect(),
        ..WorldPlan::standing(parts)
    };
    trajectories(&TrajectoryData { title: "lap", world: &world, panels: &[("early", path), ("late", path)] }).unwrap()
}

fn rising(runs: usize) -> Vec<Vec<f64>> {
    let mut random = Random::new(1, engine::random::Stream::Learner);
    (0..runs).map(|_| (1..=40).map(|window| -20.0 / f64::from(window) - random.unit()).collect()).collect()
}

fn curve(curves: &[Vec<f64>], learned_at: Option<u64>) -> Picture {
    learning_curve(&CurveData { title: "curve <&>", window_steps: 500, curves, learned_at }).unwrap()
}

fn pixels(picture: &Picture) -> image::DynamicImage {
    image::load_from_memory(&picture.png).unwrap()
}

/// Every element of a document is closed in order, and there is one root.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, text) = tag.split_once('>').unwrap();
        assert!(!text.contains('&') || text.contains(';'), "{text}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap());
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
    }
    let shows = svg.split_once("<desc>").and_then(|(_, rest)| rest.split_once("</desc>"));
    assert!(shows.is_some_and(|(words, _)| words.len() > 20), "it does not say what it shows");
    assert!(open.is_empty() && svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    assert!(!svg.contains("NaN") && !svg.contains("\"inf") && !svg.contains(",inf"));
}

#[test]
fn a_learning_curve_has_its_size_its_axes_and_its_mark() {
    for curves in [rising(1), rising(30)] {
        let picture = curve(&curves, Some(3500));
        assert_well_formed(&picture.svg);
        assert_eq!(pixels(&picture).dimensions(), (1200, 700));
        for words in
            ["curve &lt;&amp;&gt;", ">step<", ">reinforcement per 500 steps<", "step 3500", ">20\u{2009}000<", ">−5<"]
        {
            assert!(picture.svg.contains(words), "{words}");
        }
        assert_eq!(picture.svg.contains("median of 30 runs"), curves.len() == 30);
    }
}

#[test]
fn text_is_painted_with_the_built_in_font() {
    let picture = pixels(&curve(&[], None));
    let dark = (20..300).filter(|&x| (28..50).any(|y| picture.get_pixel(x, y)[0] < 60)).count();
    assert!(dark > 40, "{dark} columns of the title have ink");
}

#[test]
fn odd_curves_are_drawn() {
    let nan = f64::NAN;
    let odd: [&[Vec<f64>]; 7] = [
        &[],
        &[vec![]],
        &[vec![-3.0]],
        &[vec![2.0; 50]],
        &[vec![0.0; 3], vec![]],
        &[vec![nan, 1.0, nan, f64::INFINITY, 2.0, 3.0]],
        &[vec![1e308, -1e308], vec![-1e308, 1e308]],
    ];
    for curves in odd {
        assert_well_formed(&curve(curves, Some(u64::MAX)).svg);
        assert_well_formed(&curve(curves, None).svg);
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    assert_eq!(curve(&rising(5), Some(900)), curve(&rising(5), Some(900)));
    let path = Trail { legs: vec![circle(500)], failures: vec![[1.0, 1.0]], ..Trail::default() };
    assert_eq!(both(&square(), &path), both(&square(), &path));
}

#[test]
fn a_wall_has_its_colour_where_it_stands_and_the_floor_is_light() {
    let picture = both(&square(), &Trail::default());
    let image = pixels(&picture);
    // The plot ends 28 px before the right border and is (1400 - 56 - 24) / 2 - 66 = 594 px wide and high; the world with
    // its border is 4.1 m * 1.06 = 4.346 m wide. A metre is 136.68 px, and x = 0 lies 0.173 m after the plot's left end.
    let at = |x_m: f64, y_m: f64| {
        let place = |metres: f64| (metres + 0.173) * 594.0 / 4.346;
        let pixel = image.get_pixel((1372.0 - 594.0 + place(x_m)) as u32, (98.0 + 594.0 - place(y_m)) as u32);
        [pixel[0], pixel[1], pixel[2]]
    };
    let floor = plan::WorldPlan::standing(&square()).floor().rgb;
    for (x_m, y_m) in [(0.0, 2.0), (4.0, 1.0), (3.0, 4.0), (1.0, 0.0)] {
        assert_eq!(at(x_m, y_m), [200, 40, 30], "{x_m} {y_m}");
    }
    assert_eq!(at(0.13, 2.1), floor);
    assert_eq!(at(3.4, 3.4), floor);
    for words in [">x (m)<", ">y (m)<", ">early<", ">late<", ">failure<"] {
        assert!(picture.svg.contains(words), "{words}");
    }
}

#[test]
fn what_the_robot_drives_on_is_light_and_all_else_has_its_own_colour() {
    let mut stripe = solid(Shape::Box { half_m: Vector3::new(0.2, 3.0, 0.001) }, 5.0, 0.0, 0.0);
    stripe.collides = false;
    let platform = solid(SLAB, 0.0, 0.0, 0.3);
    let (own, light) = ("fill=\"#c8281e\"", "fill=\"#f1c9c7\"");
    let drawn = both(&world(vec![stripe, platform]), &Trail::default()).svg;
    assert_eq!((drawn.matches(own).count(), drawn.matches(light).count()), (2, 4), "{drawn}");
}

#[test]
fn a_mover_stands_where_it_is_at_the_end_of_the_shown_time_and_its_way_is_drawn() {
    let text = "[[material]]\nname = \"green\"\ncolour = [1, 200, 3]\n[[start]]\nposition_m = [0, 0]\n\
        [[route]]\nname = \"patrol\"\npoints_m = [[-4, 2], [4, 2]]\n\
        [[mover]]\nname = \"guard\"\nroute = \"patrol\"\nspeed_m_per_s = 0.1\noffset_m = 0\n\
        boxes = [{ centre_m = [0, 0, 0.2], size_m = [0.4, 0.4, 0.4], material = \"green\" }]\n";
    let layout = Layout::parse(SourceText::new("guard.toml", text), &BodyShape::pioneer2at()).unwrap();
    let (routes, movers) = (layout.routes.as_slice(), layout.movers.as_slice());
    let world = WorldPlan { routes, movers, ..WorldPlan::standing(layout.scene.parts()) };
    let trail = |steps: usize| Trail {
        legs: vec![vec![[0.0, 0.0]; steps + 1]],
        failures: vec![],
        movers: vec![movers[0].pose_at(routes, 0.5 * steps as f64)],
        ..Trail::default()
    };
    let panels: [(&str, &Trail); 2] = [("early", &trail(20)), ("late", &trail(80))];
    let svg = trajectories(&TrajectoryData { title: "guard", world: &world, panels: &panels }).unwrap().svg;
    let corners: Vec<f64> = (svg.lines().filter(|line| line.contains("fill=\"#01c803\"")))
        .map(|line| line.split(['"', ',']).nth(1).unwrap().parse().unwrap())
        .collect();
    let [early, late] = corners[..] else { panic!("{svg}") };
    // In the second panel it is 3 m farther on; a panel begins 684 px after the other, and is 594 px and 8.48 m wide.
    assert!((late - early - 684.0 - 3.0 * 594.0 / 8.48).abs() < 1.0, "{early} {late}");
    for words in ["mover at the end", "way of a mover", "path of the robot over 80 steps", "mover: guard"] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn odd_worlds_and_paths_are_drawn() {
    let far = |x: f64| solid(Shape::Cylinder { radius_m: 1.0, half_height_m: 1.0 }, x, 0.0, 0.0);
    let worlds = [vec![], vec![far(0.0)], vec![far(-1e7), far(1e7)], vec![wall([0.0, 0.0], [0.0, 3000.0])]];
    let paths = [
        Trail::default(),
        Trail { legs: vec![vec![]], failures: vec![], ..Trail::default() },
        Trail { legs: vec![vec![[1.0, 1.0]]], failures: vec![[1.0, 1.0]], ..Trail::default() },
        Trail { legs: vec![vec![[2.0, 2.0]; 300]], failures: vec![], ..Trail::default() },
        Trail {
            legs: vec![vec![[f32::NAN, 0.0], [f32::INFINITY, 1.0], [0.0, 1.0]]],
            failures: vec![[f32::NAN; 2]],
            ..Trail::default()
        },
        Trail { legs: vec![vec![[0.0, 0.0], [1e30, -1e30]]], failures: vec![], ..Trail::default() },
    ];
    for solids in worlds {
        for path in &paths {
            let picture = both(&world(solids.clone()), path);
            assert_well_formed(&picture.svg);
            let (width, height) = pixels(&picture).dimensions();
            assert!(width == 1400 && height <= 1000, "{width} x {height}");
        }
    }
}

fn shown(image: &Image, filtered: &[u8], flags: &[bool; 9]) -> engine::diagnostic::Result<Picture> {
    frame(&FrameData {
        title: "step",
        width_px: image.width_px,
        height_px: image.height_px,
        panels: &[FramePanel::image("camera", image), FramePanel::mask("filtered", filtered)],
        views: &[SeenView {
            name: None,
            mask: Vec::new(),
            grid: (3, 3),
            shares: vec![0.0, 0.5, 1.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.125],
            occupied: flags.to_vec(),
            filled: flags.to_vec(),
            number: 21,
        }],
        state: 21,
    })
}

#[test]
fn a_frame_shows_its_pixels_enlarged_and_its_state() {
    let mut image = Image::new(80, 60);
    image.pixels[..3].copy_from_slice(&[250, 10, 20]);
    let filtered = vec![255; 4800];
    let flags = [true, true, true, false, false, false, false, false, false];
    let picture = shown(&image, &filtered, &flags).unwrap();
    assert_well_formed(&picture.svg);
    for words in ["state 21", "in each column: 1 1 1", "50.0 %", "100.0 % foreground", "data:image/png;base64,"] {
        assert!(picture.svg.contains(words), "{words}");
    }
    // Each pixel is a square of 5; the first panel begins at (28, 98) with a border of one pixel.
    let png = pixels(&picture);
    assert_eq!(png.get_pixel(32, 102).0[..3], [250, 10, 20]);
    assert_eq!(png.get_pixel(33, 102).0[..3], [0, 0, 0]);
}

#[test]
fn a_frame_shows_every_stage_between_the_image_and_the_grid() {
    let (grey, image) = (vec![100; 4800], Image::new(80, 60));
    let (width_px, height_px, flags) = (80, 60, vec![false]);
    let blurred = FramePanel { name: "blur", format: Format::Grey, pixels: &grey };
    let panels = &[FramePanel::image("photograph", &image), blurred, FramePanel::mask("filtered", &grey)];
    let (name, mask, shares, occupied, filled) = (None, Vec::new(), vec![0.0], flags.clone(), flags);
    let views = &[SeenView { name, mask, grid: (1, 1), shares, occupied, filled, number: 0 }];
    let data = FrameData { title: "", width_px, height_px, panels, views, state: 0 };
    let picture = frame(&data).unwrap();
    assert!(picture.svg.contains("blur") && picture.svg.contains("grey levels"));
    // Four panels of 400 pixels, 428 apart; the second begins at 456.
    assert_eq!(pixels(&picture).width(), 2 * 28 + 4 * 428 - 28);
    assert_eq!(pixels(&picture).get_pixel(470, 150).0[..3], [100; 3]);
    assert_eq!(frame(&FrameData { panels: &[], ..data }).unwrap_err().code, "E-PICTURE");
}

#[test]
fn a_frame_of_any_size_is_drawn_and_one_that_does_not_fit_is_refused() {
    let flags = [false; 9];
    for (width, height) in [(1, 1), (1280, 960), (7, 900), (900, 7)] {
        let image = Image::new(width, height);
        let picture = shown(&image, &vec![128; width * height], &flags).unwrap();
        let (wide, high) = pixels(&picture).dimensions();
        assert!((1000..=2100).contains(&wide) && high <= 900, "{wide} x {high}");
    }
    assert_eq!(shown(&Image::new(8, 6), &[0; 47], &flags).unwrap_err().code, "E-PICTURE");
    assert_eq!(shown(&Image::new(0, 0), &[], &flags).unwrap_err().code, "E-PICTURE");
}

fn state(state: usize, visits: u64, best: (f64, f64)) -> PolicyState {
    let best = Twist { linear_m_per_s: best.0, angular_rad_per_s: best.1 };
    PolicyState { state, cells: vec![true, false, true, false], visits, best, value: -1.0 }
}

#[test]
fn a_policy_shows_the_most_visited_states_in_order() {
    let motions = [(0.2, 0.0), (0.0, 0.5), (0.0, 0.0), (-0.1, -3.0), (f64::NAN, f64::NAN)];
    let states: Vec<PolicyState> =
        (0..200).map(|s| state(s, if s < 100 { s as u64 } else { 0 }, motions[s % 5])).collect();
    let picture = policy(&PolicyData { title: "policy", rows: 2, columns: 2, states: &states }).unwrap();
    assert_well_formed(&picture.svg);
    assert!(picture.svg.contains(">99<") && picture.svg.contains(">36<") && !picture.svg.contains(">35<"));
    for states in [vec![], vec![state(5, 0, (0.0, 0.0))]] {
        assert_well_formed(&policy(&PolicyData { title: "", rows: 2, columns: 2, states: &states }).unwrap().svg);
    }
}

#[test]
fn a_state_that_was_hardly_met_looks_unsure() {
    let drawn = |visits| {
        let states = [state(1, visits, (0.2, 0.0)), state(2, 50, (0.2, 0.0))];
        policy(&PolicyData { title: "policy", rows: 2, columns: 2, states: &states }).unwrap().svg
    };
    let strokes = |svg: &str| svg.matches("stroke=\"#8c959f\" stroke-opacity").count();
    assert!(strokes(&drawn(9)) > strokes(&drawn(10)) + 5);
    assert!(drawn(10).contains("met fewer than 10 times, unsure"));
}

#[test]
fn the_paths_of_many_seeds_have_one_that_is_strong() {
    let trails: Vec<Trail> = (0..3)
        .map(|seed| Trail { legs: vec![circle(50)], failures: vec![[1.0, 1.0]; seed], ..Trail::default() })
        .collect();
    let (parts, all) = (square(), trails.iter().collect::<Vec<_>>());
    let data = PathsData { title: "all", world: &WorldPlan::standing(&parts), paths: &all, strong: (1, 7) };
    let picture = paths(&data).unwrap();
    assert_well_formed(&picture.svg);
    assert!(picture.svg.contains("seed 7, with the median failures"));
    assert!(picture.svg.contains("Paths of 3 seeds in their tests, failures: 3; seed 7 is drawn strong"));
    // The other two have one line each.
    assert_eq!(picture.svg.matches("stroke=\"#57606a\" stroke-opacity=\"0.55\"").count(), 2);
    assert!(paths(&PathsData { paths: &[], ..data }).is_ok());
}

#[test]
fn the_first_row_of_a_certainty_grid_is_at_the_bottom() {
    let path = Trail { legs: vec![vec![[0.5, 0.5], [1.5, 0.5]]], failures: vec![], ..Trail::default() };
    let picture = certainty_grid("map", &[0, 0, 255, 255], 2, 1.0, [0.0, 0.0], &path).unwrap();
    assert_well_formed(&picture.svg);
    let image = pixels(&picture);
    // 720 px for 2 m, centred in the room right of the labels, from y = 68 on.
    assert_eq!(image.get_pixel(640, 68 + 180)[0], 255);
    assert_eq!(image.get_pixel(640, 68 + 700)[0], 0);
    for (cells, width, cell_m) in [(vec![0; 3], 2, 1.0), (vec![], 1, 1.0), (vec![0], 0, 1.0), (vec![0], 1, f64::NAN)] {
        assert!(certainty_grid("map", &cells, width, cell_m, [0.0, 0.0], &path).is_err());
    }
    assert!(certainty_grid("map", &[9; 5000], 5000, 1e-3, [-1e3, 1e3], &path).is_ok());
}

#[test]
fn a_picture_is_written_in_both_forms_or_the_failure_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let picture = Picture { svg: "<svg/>".to_owned(), png: vec![1, 2, 3] };
    picture.write(folder.path(), "curve").unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("curve.svg")).unwrap(), "<svg/>");
    assert_eq!(std::fs::read(folder.path().join("curve.png")).unwrap(), [1, 2, 3]);
    assert_eq!(picture.write(&folder.path().join("none"), "curve").unwrap_err().code, "E-IO");
}
