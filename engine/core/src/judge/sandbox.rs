//! The engine that scripts run in: what it can do, and where it stops.
//!
//! A script is a stranger's program. It starts from an engine that knows nothing, gets arithmetic, arrays and maps, and
//! nothing that reads a file, a clock or the environment, waits, prints or writes code. Limits are counted, never timed:
//! a script that is stopped is stopped at the same operation on every machine, and a run stays repeatable.

use rhai::module_resolvers::DummyModuleResolver;
use rhai::packages::{
    ArithmeticPackage, BasicArrayPackage, BasicIteratorPackage, BasicMapPackage, BasicMathPackage, LogicPackage,
    Package,
};
use rhai::{Engine, OptimizationLevel};

/// Operations of one step, as `budget` counts them; of the top level and of `fn calibrate` as many.
pub(crate) const MAX_OPERATIONS: u64 = 100_000;
/// Functions that wait for one another.
pub(crate) const MAX_CALL_LEVELS: usize = 16;
/// Brackets and operators within one another.
pub(crate) const MAX_NESTING: usize = 48;
/// Bytes of one text.
pub(crate) const MAX_TEXT_BYTES: usize = 4096;
/// Values in one array: more than any laser has beams.
pub(crate) const MAX_ARRAY: usize = 2048;
/// Keys in one map.
pub(crate) const MAX_MAP: usize = 64;
/// Variables at one time.
pub(crate) const MAX_VARIABLES: usize = 64;
/// Functions in one script.
pub(crate) const MAX_FUNCTIONS: usize = 64;

/// Words of the language that a reward has no use for.
const NOT_HERE: &[&str] = &[
    "eval",
    "import",
    "export",
    "curry",
    "Fn",
    "call",
    "sleep",
    "timestamp",
    "print",
    "debug",
    "type_of",
    "**",
    "**=",
];

/// An engine with these limits, arithmetic, arrays, maps, functions and facts.
pub(crate) fn engine() -> Engine {
    let mut engine = Engine::new_raw();
    ArithmeticPackage::new().register_into_engine(&mut engine);
    LogicPackage::new().register_into_engine(&mut engine);
    BasicMathPackage::new().register_into_engine(&mut engine);
    BasicArrayPackage::new().register_into_engine(&mut engine);
    BasicIteratorPackage::new().register_into_engine(&mut engine);
    BasicMapPackage::new().register_into_engine(&mut engine);
    engine
        .set_max_operations(MAX_OPERATIONS)
        .set_max_call_levels(MAX_CALL_LEVELS)
        .set_max_expr_depths(MAX_NESTING, MAX_NESTING)
        .set_max_string_size(MAX_TEXT_BYTES)
        .set_max_array_size(MAX_ARRAY)
        .set_max_map_size(MAX_MAP)
        .set_max_variables(MAX_VARIABLES)
        .set_max_functions(MAX_FUNCTIONS)
        .set_max_modules(0)
        .set_module_resolver(DummyModuleResolver::new())
        // Folding would remove the very expressions that are checked and compiled.
        .set_optimization_level(OptimizationLevel::None)
        .set_strict_variables(true)
        .set_allow_shadowing(false)
        .set_allow_anonymous_fn(false)
        .set_fail_on_invalid_map_property(true);
    for word in NOT_HERE {
        engine.disable_symbol(*word);
    }
    super::budget::register(&mut engine);
    super::equality::register(&mut engine);
    super::functions::register(&mut engine);
    super::views::register(&mut engine);
    engine
}

/// Whether a word is one of the language's that scripts here go without.
pub(crate) fn is_refused(word: &str) -> bool {
    NOT_HERE.contains(&word)
}
