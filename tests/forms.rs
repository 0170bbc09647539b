use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use engine::experiment::{Overrides, Plan, learn};
use engine::filter::{Catalogue, Chain};
use engine::random::{Random, Stream};
use engine::script::Behaviour;
use engine::sensors::observation::Image;
use engine::settings::FilterSettings;
use filter_api::{Format, Frame, FrameMut};

use crate::support::filters::{c_native, c_wasm, catalogue, digest, forms};
use crate::support::{Bench, root};

const SIZES: [(usize, usize); 8] = [(1, 1), (1, 9), (9, 1), (7, 5), (16, 12), (33, 17), (64, 48), (160, 120)];
const THRESHOLDS: [f64; 5] = [1.0, 17.5, 60.0, 200.0, 1443.0];

fn chain(catalogue: &Catalogue, (width, height): (usize, usize), threshold: f64) -> Chain {
    let parameters = vec![("threshold".to_owned(), threshold)];
    let sobel = FilterSettings { parameters, ..FilterSettings::new("sobel") };
    Chain::new(&[sobel], width, height, catalogue).map_err(|error| error.error).unwrap()
}

/// A frame of noise, the range of which is another one each time.
fn noise(random: &mut Random, (width, height): (usize, usize)) -> Image {
    let mut image = Image::new(width, height);
    let range = 1 + random.below(256);
    image.pixels.fill_with(|| random.below(range) as u8);
    image
}

#[test]
fn a_thousand_random_frames_give_the_same_bytes_in_every_form() {
    let linked_in = Catalogue::linked_in();
    for (form, catalogue) in forms() {
        let mut random = Random::new(4, Stream::Camera);
        for (size, threshold) in SIZES.iter().flat_map(|size| THRESHOLDS.map(|threshold| (*size, threshold))) {
            let mut own = chain(&linked_in, size, threshold);
            let mut other = chain(&catalogue, size, threshold);
            for frame in 0..25 {
                let image = noise(&mut random, size);
                let same = own.apply(&image).unwrap() == other.apply(&image).unwrap();
                assert!(same, "{form}: frame {frame} of {size:?} at {threshold}");
            }
        }
    }
}

/// A short run by edges, whatever the world is for; it has no laser rule, since not every world has walls.
const SCRIPT: &str = r#"world("room");
filter("sobel", #{ threshold: 60 });
run(#{ steps: 200 });
recovery("start");
rule "contact" when robot.contact => -1 then recover;
"#;

fn state_hash(world: &Path, catalogue: &Arc<Catalogue>) -> String {
    let bench = Bench::new();
    bench.write("worlds/room.toml", std::fs::read(world).unwrap());
    bench.write("edges.rhai", SCRIPT);
    let behaviour = Arc::new(Behaviour::load(&bench.path().join("edges.rhai")).unwrap());
    let plan = Plan::with_filters(behaviour, &Overrides::default(), Arc::clone(catalogue));
    let plan = plan.unwrap_or_else(|error| panic!("{}: {}", world.display(), error.render(false)));
    learn(&plan, 1, &AtomicBool::new(false), &|_| ()).unwrap().state_hash
}

#[test]
fn a_run_in_every_world_is_the_same_in_every_form() {
    let linked_in = Arc::new(Catalogue::linked_in());
    let (forms, mut worlds) = (forms(), 0);
    for entry in std::fs::read_dir(root().join("worlds")).unwrap() {
        let world = entry.unwrap().path();
        if world.extension().is_some_and(|ending| ending == "toml") {
            worlds += 1;
            let wanted = state_hash(&world, &linked_in);
            for (form, catalogue) in &forms {
                assert_eq!(state_hash(&world, catalogue), wanted, "{form} in {}", world.display());
            }
        }
    }
    assert!(worlds > 10);
}

/// The example in C, in the forms that can be built here.
fn contrast(bench: &Bench) -> Vec<&'static str> {
    let source = root().join("plugins/examples/contrast.c");
    std::fs::create_dir_all(bench.path().join("native")).unwrap();
    std::fs::create_dir_all(bench.path().join("wasm")).unwrap();
    let native = c_native(&source, &[], &bench.path().join("native/contrast.so")).then_some("native");
    let wasm = cfg!(feature = "wasm") && c_wasm(&source, &[], &bench.path().join("wasm/contrast.wasm"));
    native.into_iter().chain(wasm.then_some("wasm")).collect()
}

#[test]
fn the_example_in_c_stretches_brightness_from_black_to_white() {
    let bench = Bench::new();
    for form in contrast(&bench) {
        let catalogue = catalogue(&bench.path().join(form), false);
        let entry = catalogue.find("contrast").unwrap();
        let stretched = |greys: [u8; 4], least_range: f64| {
            let mut out = [7; 4];
            let input = Frame::new(4, 1, Format::Grey, &greys).unwrap();
            let output = FrameMut::new(4, 1, Format::Grey, &mut out).unwrap();
            entry.start(&[least_range]).unwrap().process(input, output).unwrap();
            out
        };
        // 40 levels from 100 to 140: (grey - 100) * 255 / 40, rounded down.
        assert_eq!(stretched([100, 110, 120, 140], 32.0), [0, 63, 127, 255], "{form}");
        assert_eq!(stretched([100, 110, 120, 140], 41.0), [100, 110, 120, 140], "{form}");
        assert_eq!(stretched([9, 9, 9, 9], 1.0), [9, 9, 9, 9], "{form}");
    }
}

#[test]
fn a_script_uses_the_example_in_c_in_both_forms_with_one_result() {
    let bench = Bench::new();
    bench.write(
        "stretched.rhai",
        "world(\"small\");\nrun(#{ steps: 400, test_steps: 200 });\nfilter(\"contrast\", #{ least_range: 20 });\n\
         filter(\"sobel\");\nrule \"contact\" when robot.contact => -1 then recover;\n",
    );
    let hashes = contrast(&bench).into_iter().map(|form| {
        let mut command = bench.command(&["run", "stretched.rhai", "--json", "--filter-dir", form]);
        if form == "native" {
            let allowed = digest(&bench.path().join("native/contrast.so"));
            command.arg("--isolate").arg(format!("--allow-native={allowed}"));
        }
        let told = command.output().unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&told.stdout)
            .unwrap_or_else(|_| panic!("{form}: {}", String::from_utf8_lossy(&told.stderr)));
        summary["state_hash"].as_str().unwrap().to_owned()
    });
    let hashes: Vec<String> = hashes.collect();
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:?}");
}

/// Microseconds of one frame through each chain: the least of many rounds, in which all take turns.
fn cost_us(chains: &mut [Chain], image: &Image) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; chains.len()];
    for _ in 0..100 {
        for (chain, least) in chains.iter_mut().zip(&mut least) {
            let started = Instant::now();
            (0..50).for_each(|_| assert!(!black_box(chain.apply(image).unwrap()).is_empty()));
            *least = least.min(started.elapsed().as_secs_f64() * 1e6 / 50.0);
        }
    }
    least
}

/// Equal masks always; times are printed only where somebody asked for them, with `ENGINE_LONG` in the environment, since they
/// need a quiet machine: `ENGINE_LONG=1 cargo test --release --all-features -- --nocapture every_form_of_sobel`.
#[test]
fn every_form_of_sobel_gives_the_same_mask_and_can_be_timed() {
    let forms: Vec<_> = forms().into_iter().filter(|(form, _)| *form != "native and isolated").collect();
    let size = (160, 120);
    let mut chains = vec![chain(&Catalogue::linked_in(), size, 60.0)];
    chains.extend(forms.iter().map(|(_, catalogue)| chain(catalogue, size, 60.0)));
    let colour = noise(&mut Random::new(4, Stream::Camera), size);
    let mut grey = Image::of(Format::Grey, size.0, size.1);
    colour.frame().unwrap().write_luma(&mut grey.pixels).unwrap();
    for (kind, image) in [("colour", &colour), ("grey", &grey)] {
        let masks: Vec<_> = chains.iter_mut().map(|chain| chain.apply(image).unwrap().to_vec()).collect();
        assert!(masks.windows(2).all(|pair| pair[0] == pair[1]), "{kind}");
        if std::env::var_os("ENGINE_LONG").is_some() {
            let costs = cost_us(&mut chains, image);
            println!("{kind}, linked in: {:.2} us", costs[0]);
            for ((form, _), cost) in forms.iter().zip(&costs[1..]) {
                println!("{kind}, {form}: {cost:.2} us, {:.2} times", cost / costs[0]);
            }
        }
    }
}
