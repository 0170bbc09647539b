use engine::filter::{Catalogue, Chain};
use engine::random::{Random, Stream};
use engine::sensors::observation::Image;
use engine::settings::FilterSettings;
use filter_api::{Format, Moved};
use serde_json::Value;

use crate::support::filters::forms;
use crate::support::{Bench, SCRIPT, assert_tested_again};

fn floor(catalogue: &Catalogue) -> Chain {
    let filter = FilterSettings { parameters: vec![("memory".to_owned(), 1.0)], ..FilterSettings::new("floor") };
    Chain::new(&[filter], 16, 12, catalogue).map_err(|error| error.error).unwrap()
}

/// A drive over a floor of a few greys: images, and how the robot moved before each.
fn drive() -> Vec<(Image, Moved)> {
    let mut random = Random::new(9, Stream::Camera);
    let one = |index: usize| {
        let mut image = Image::of(Format::Rgb, 16, 12);
        let base = 40 + 30 * random.below(4) as u8;
        image.pixels.fill_with(|| base + random.below(12) as u8);
        let jumped = index.is_multiple_of(17);
        (
            image,
            Moved { driven_m: if jumped { 0.0 } else { 0.01 * f64::from(random.below(12)) }, turned_rad: 0.0, jumped },
        )
    };
    (0..60).map(one).collect()
}

#[test]
fn a_filter_that_keeps_something_keeps_the_same_in_every_form_and_goes_on_from_what_another_kept() {
    let drive = drive();
    for (form, catalogue) in forms() {
        let (mut own, mut other) = (floor(&Catalogue::linked_in()), floor(&catalogue));
        assert_eq!(own.keeps(), other.keeps(), "{form}");
        for (index, (image, moved)) in drive.iter().enumerate() {
            own.moved(moved).unwrap();
            other.moved(moved).unwrap();
            assert_eq!(own.apply(image).unwrap(), other.apply(image).unwrap(), "{form}, frame {index}");
            if index == 30 {
                let kept = own.save().unwrap();
                assert_eq!(kept, other.save().unwrap(), "{form}");
                other = floor(&catalogue);
                other.load(&kept).unwrap();
            }
        }
        assert!(other.load(&[0; 7]).is_err() && other.load(&vec![255; own.keeps()]).is_err(), "{form}");
    }
}

fn json(bench: &Bench, arguments: &[&str]) -> Value {
    let output = bench.engine(&[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A run whose filter remembers the floor.
fn remembered() -> Bench {
    let bench = Bench::new();
    let filter = "filter(\"floor\", #{ memory: true });\ngrid(#{ occupied: 0.2 });\n";
    bench.write("floor.rhai", SCRIPT.replacen('\n', &format!("\n{filter}"), 1));
    bench.engine(&["run", "floor.rhai", "--out", "a"]);
    bench
}

#[test]
fn what_a_filter_kept_is_part_of_the_policy_and_the_test_begins_with_it() {
    let bench = remembered();
    let verified = json(&bench, &["replay", "a", "--verify"]);
    assert_eq!(verified["reproduced"], true);
    let policy = bench.read("a/policy.toml");
    assert!(policy.starts_with("format = 5\n") && policy.contains("\nkept = \""), "{policy}");
    let summary: Value = serde_json::from_str(&bench.read("a/summary.json")).unwrap();
    let tested = bench.engine(&["test", "a", "--json"]);
    assert_tested_again(&summary, &tested.stdout);
}

#[test]
fn a_recorded_step_of_learning_and_of_the_test_is_seen_with_what_the_filter_knew_then() {
    let bench = remembered();
    let words = |arguments: &[&str]| {
        let told = json(&bench, &[&["explain", "a", "--step"], arguments].concat());
        told["kept"][0]["words"].as_str().unwrap().to_owned()
    };
    // The world `small` is plain: one grey of the floor, which begins the first step and the test's.
    assert!(words(&["0"]).starts_with("greys of the floor driven over: "));
    assert!(words(&["0", "--test"]).starts_with("greys of the floor driven over: "));
    json(&bench, &["explain", "a", "--step", "399", "--test"]);
}
