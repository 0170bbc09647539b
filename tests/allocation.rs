#![allow(unsafe_code, reason = "a global allocator cannot be written without it; it only counts and passes on")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Ledger, Overrides, Plan, UsedPolicy, learn, learn_into};
use engine::geometry::{Pose, Twist};
use engine::script::Behaviour;
use engine::settings::Settings;
use engine::world::World;

use crate::support::root;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller keeps the contract.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(plan: &Plan, steps: u64) -> u64 {
    let mut plan = plan.clone();
    plan.settings.run.steps = steps;
    let before = ALLOCATIONS.get();
    let mut ledger = Ledger::new(&plan, steps);
    let learned = learn_into(&plan, 7, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
    let all = ALLOCATIONS.get() - before;
    // The policy is made at the end, in as many pieces as a copy of it; the loop itself allocates none.
    let before = ALLOCATIONS.get();
    std::hint::black_box(learned.policy.clone());
    all - (ALLOCATIONS.get() - before)
}

#[test]
fn a_world_with_several_bodies_that_run_into_one_another_allocates_nothing() {
    let settings = Settings::default();
    let layout = engine::world::Layout::load(&root().join("worlds/object.toml"), &settings.robot.body).unwrap();
    let mut world = World::new(Arc::new(layout), &[settings.robot; 4], settings.run.period_s, 1);
    for index in 0..4 {
        world.place(index, Pose::new(1.0 + 0.8 * index as f64, 0.0, 0.0));
    }
    let commands = [0.4, 0.3, 0.2, 0.1].map(|linear| Twist::new(linear, 0.0));
    world.advance(&commands);
    let before = ALLOCATIONS.get();
    let touching = (0..100).filter(|_| world.advance(&commands)[..3].iter().all(|motion| motion.contact)).count();
    assert_eq!(ALLOCATIONS.get(), before);
    assert!(touching > 0);
}

/// Another learner than the one that makes a row for each new state.
fn by_table() -> Overrides {
    Overrides { set: vec!["learner.kind=ttd".to_owned()], ..Overrides::default() }
}

#[test]
fn what_is_remembered_is_allocated_before_the_first_step_and_with_each_new_state() {
    let behaviour = Behaviour::load(&root().join("scripts/wall.rhai")).unwrap();
    let plan = Plan::new(Arc::new(behaviour), &Overrides::default()).unwrap();
    let [few, many] = [1_000, 5_000].map(|steps| allocations(&plan, steps));
    // Of the later states each needs room in some 20 lists, which grow by doubling.
    assert!(many.saturating_sub(few) < 200, "{few} and {many}");
}

#[test]
fn more_steps_allocate_nothing_more_with_a_table() {
    for script in ["wall", "corridor", "platform", "object"] {
        let behaviour = Behaviour::load(&root().join(format!("scripts/{script}.rhai"))).unwrap();
        let plan = Plan::new(Arc::new(behaviour), &by_table()).unwrap();
        assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000), "{script}");
    }
}

#[test]
fn the_shadow_of_a_mover_allocates_nothing_more() {
    let behaviour = Behaviour::load(&root().join("scripts/object.rhai")).unwrap();
    let set = ["light.shadows=true", "camera.own_body=true", "camera.exposure_drift=0.1"].map(str::to_owned);
    let overrides = Overrides { set: set.to_vec(), ..Overrides::default() };
    let plan = Plan::new(Arc::new(behaviour), &overrides).unwrap();
    assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000));
}

#[test]
fn more_steps_through_scharr_allocate_nothing_more() {
    let path = root().join("scripts/wall.rhai");
    let text = std::fs::read_to_string(&path).unwrap().replace("\"sobel\"", "\"scharr\"");
    let behaviour = Behaviour::parse("wall", SourceText::new(path, text)).unwrap();
    let plan = Plan::new(Arc::new(behaviour), &by_table()).unwrap();
    assert_eq!(plan.settings.view.filters[0].name, "scharr");
    assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000));
}

#[test]
fn more_steps_with_a_used_policy_allocate_nothing_more() {
    let path = root().join("scripts/wall.rhai");
    let text = std::fs::read_to_string(&path).unwrap();
    let plan = |text: &str| {
        let behaviour = Behaviour::parse("wall", SourceText::new(path.clone(), text)).unwrap();
        Plan::new(Arc::new(behaviour), &Overrides { steps: Some(400), ..by_table() }).unwrap()
    };
    let source = SourceText::new("policy.toml", "");
    let own = plan(&text);
    let policy = learn(&own, 1, &AtomicBool::new(false), &|_| ()).unwrap().policy;
    let used = UsedPolicy { name: "wall".to_owned(), plan: own, policy, texts: [source.clone(), source] };
    let uses = "policy(\"wall\", \"runs/wall/1\"); use \"wall\" when laser.front < 1.5;";
    let plan = plan(&format!("{uses}\n{text}")).with_used(vec![Arc::new(used)]);
    assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000));
}

#[test]
fn going_from_world_to_world_allocates_nothing() {
    let path = root().join("scripts/wall.rhai");
    let worlds = "worlds([\"room\", \"corridors:1-2\"]); run(#{ stay_steps: 20, period_s: 0.5 });";
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("world(\"room\");", worlds).replace("run(#{ period_s: 0.5 });\n", "\n");
    let behaviour = Behaviour::parse("wall", SourceText::new(path, text)).unwrap();
    let plan = Plan::new(Arc::new(behaviour), &by_table()).unwrap();
    assert_eq!(plan.worlds.layouts().len(), 3);
    assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000));
}
