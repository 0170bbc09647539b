//! Integration tests, in one program. The table of contents:

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "a test says why it was skipped")]

/// Runs the engine in a scratch folder.
mod support;

/// The step loop allocates nothing.
mod allocation;
/// Imports between rooms, file sizes, forbidden words: the laws of ARCHITECTURE.md.
mod architecture;
/// Every mistake that a user can make gets one clear error; the texts stand in `snapshots/`.
mod bad_input;
/// What a bench measures and what it refuses.
mod bench;
/// The page in a real browser, from a file and live; pictures of it in `target/browser`.
mod browser;
/// A bound in worlds that nobody has seen: the same bytes, drawn again, its worst draws.
mod certify;
/// Learned policies combined: files, figures, disagreements, mistakes.
mod combine;
/// Runs beside one another, listed, tagged and pruned; many seeds in their order.
mod compare;
/// The C header says what the Rust side of the filter contract says, on 64 and on 32 bits.
mod contract;
/// Licences and sources of all dependencies are those that deny.toml allows.
mod dependencies;
/// Same seed, same bytes: twice, with one thread or two, stored and tested again.
mod determinism;
/// The pages for people: links, lengths, commands, the example that is worked by hand.
mod docs;
/// Editions of the language: upgraded, stored; the language as data.
mod editions;
/// Exported policies: their kit, in C and in Python, for this processor and another.
mod export;
/// Every operation of the disk fails in turn.
mod faults;
/// Every filter that ships keeps the contract, in every form.
mod filters;
/// Scripts that were once called a success and are none.
mod fooled;
/// One filter gives the same bytes linked in, in a native library and in WebAssembly.
mod forms;
/// Every reader of strangers' bytes, over a corpus and mutants of it.
mod fuzzed;
/// Every shipped behaviour leaves the bytes that were recorded.
mod golden;
/// Scripts that ask for too much: refused, or within their limits.
mod hostile;
/// Filters that keep something, in every form, in policies and in recorded runs.
mod keepers;
/// Folders of runs and tests: nothing written over, tagged away or forged without a word.
mod kept;
/// Runs that go on from what others have learned, and one rule for what is carried on.
mod learning_on;
/// Every step kept, and brought back by its actions.
mod ledger;
/// Seeded mistakes and what is found in them; scripts that ship; ways to cheat.
mod lint;
/// Runs longer than a ledger has room for: segments of their logs.
mod long_runs;
/// The learner that remembers its steps, from a script to its files and what is told of it.
mod memory;
/// All mistakes of a script and of its world at once, in order, each once.
mod mistakes;
/// WebAssembly filters that loop, grow, trap, lie or are damaged.
#[cfg(feature = "wasm")]
mod modules;
/// Native filters that are no filters, crash, exit, loop or lie.
mod native;
/// A filter from the template: built, listed, checked, learned with.
mod new_filter;
/// Filters by a condition, parameters of scripts and guards, through the program.
mod own_words;
/// Behaviour packs: made, signed, refused, installed, shared.
mod pack;
/// The page of a run as a file: its data, its size, its policy.
mod page;
/// Filters listed and photographs seen through them; what cannot be seen.
mod photos;
/// Where attempts begin: places that scripts name, starts that join, marks that tests count.
mod places;
/// Recordings for viewers, read back by another reader.
mod recording;
/// Frames that another renderer drew are what this one sees.
mod rendered;
/// Recorded runs through the program: replayed, explained, rescored, damaged.
mod replay;
/// The paper's claims through the program, quickly; the map that a test leaves.
mod reproduce;
/// Every kind of run that learns goes on from its checkpoints.
mod resumed;
/// What a run leaves, and that it is well-formed.
mod robots;
mod run_folder;
/// Every script and world that ships can be used, and the reference pages are current.
mod shipped;
/// What people stumbled over: told where it stands, with what to type next.
mod stumbles;
/// Runs that are killed, stopped, doubled or refused by the disk: nothing is lost, and nothing lies.
mod survival;
/// The live view in the terminal: its screen, its keys, and itself in a pseudo terminal.
#[cfg(feature = "tui")]
mod terminal;
/// Learned policies that a script uses: who drives, what is learned, what does not fit.
mod used;
/// What is called a success: no cheat, no chance, no reward alone; failures, goals and restarts told apart.
mod verdict;
/// The live page by raw connections: what is refused, what is told.
#[cfg(feature = "serve")]
mod watch;
/// Several worlds in one run, and what is drawn for each attempt.
mod worlds;
