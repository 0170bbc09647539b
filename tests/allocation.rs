#![allow(unsafe_code, reason = "a global allocator cannot be written without it; it only counts and passes on")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::SourceText;
use engine::experiment::{Ledger, Overrides, Plan, learn_into};
use engine::script::Behaviour;

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
    // The policy at the end has a row for each state that was seen; the loop itself has none.
    ALLOCATIONS.get() - before - learned.policy.rows().iter().flatten().count() as u64
}

#[test]
fn more_steps_allocate_nothing_more() {
    for script in ["wall", "corridor", "platform", "object"] {
        let behaviour = Behaviour::load(&root().join(format!("scripts/{script}.rhai"))).unwrap();
        let plan = Plan::new(Arc::new(behaviour), &Overrides::default()).unwrap();
        assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000), "{script}");
    }
}

#[test]
fn more_steps_through_scharr_allocate_nothing_more() {
    let path = root().join("scripts/wall.rhai");
    let text = std::fs::read_to_string(&path).unwrap().replace("\"sobel\"", "\"scharr\"");
    let behaviour = Behaviour::parse("wall", SourceText::new(path, text)).unwrap();
    let plan = Plan::new(Arc::new(behaviour), &Overrides::default()).unwrap();
    assert_eq!(plan.settings.filters[0].name, "scharr");
    assert_eq!(allocations(&plan, 5_000), allocations(&plan, 1_000));
}
