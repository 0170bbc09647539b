//! Each stage of a step, and the whole step, under Criterion: `cargo bench --bench stages`.

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot start fails by panicking")]

#[allow(unreachable_pub, reason = "the file belongs to the program")]
#[path = "../src/commands/bench/stages.rs"]
mod stages;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use engine::experiment::{Overrides, Plan, learn};
use engine::script::Behaviour;
use stages::{SAMPLES, STAGES, Stages};

/// Steps of learning that are timed together; their set-up is timed with them.
const STEPS: u64 = 2_000;

fn plan(set: &[&str]) -> Plan {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/wall.rhai");
    let behaviour = Arc::new(Behaviour::load(&script).unwrap());
    let set = set.iter().map(|pair| (*pair).to_owned()).collect();
    Plan::new(behaviour, &Overrides { set, steps: Some(STEPS), ..Overrides::default() }).unwrap()
}

fn stages(criterion: &mut Criterion) {
    for (name, set) in [
        ("160x120", &[][..]),
        ("320x240", &["camera.width_px=320", "camera.height_px=240"]),
        ("fisheye", &["camera.lens=fisheye"]),
    ] {
        let mut group = criterion.benchmark_group(name);
        let mut stages = Stages::new(&plan(set)).unwrap();
        for (name, call) in STAGES {
            let mut index = 0;
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    call(&mut stages, index % SAMPLES);
                    index += 1;
                });
            });
        }
        stages.finish().unwrap();
    }
}

fn whole_step(criterion: &mut Criterion) {
    let (plan, stop) = (plan(&[]), AtomicBool::new(false));
    let mut group = criterion.benchmark_group("whole step");
    group.throughput(Throughput::Elements(STEPS)).sample_size(10);
    group.bench_function("learning", |bencher| bencher.iter(|| learn(&plan, 1, &stop, &|_| ()).unwrap()));
}

criterion_group!(benches, stages, whole_step);
criterion_main!(benches);
