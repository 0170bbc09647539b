use engine::random::{Random, Stream};

use crate::support::mutate::mutate;

/// The readers, shared with the fuzzers.
#[path = "fuzz/targets.rs"]
mod targets;

/// Words that texts of ours are made of: a changed byte alone seldom comes past the first check.
const WORDS: [&str; 16] = [
    "\u{9b}",
    "\u{202e}",
    "\0",
    "[[",
    "]]",
    "\"",
    "= ",
    "#{",
    "fn reward(facts) { ",
    "when ",
    "=> -1",
    "1e308",
    "-1",
    "nan",
    "99999999999999999999",
    "\n",
];

/// Feeds a reader its corpus and so many mutants, the same ones each time.
fn feed(name: &str, mutants: u32) {
    let (_, target) = targets::TARGETS.iter().find(|(known, _)| *known == name).unwrap();
    let corpus = targets::corpus(name);
    assert!(!corpus.is_empty(), "{name}");
    corpus.iter().for_each(|bytes| target(bytes));
    let long = if std::env::var_os("ENGINE_LONG").is_some() { 100 } else { 1 };
    let mut random = Random::new(17, Stream::Test);
    for _ in 0..mutants * long {
        let mut bytes = corpus[random.below(corpus.len() as u32) as usize].clone();
        if bytes.is_empty() {
            continue;
        }
        mutate(&mut random, &mut bytes);
        if random.below(3) == 0 {
            let at = random.below(bytes.len() as u32) as usize;
            bytes.splice(at..at, WORDS[random.below(WORDS.len() as u32) as usize].bytes());
        }
        target(&bytes);
    }
}

#[test]
fn no_script_brings_its_reader_down() {
    feed("script", 300);
}

#[test]
fn no_world_brings_its_reader_down() {
    feed("world", 600);
}

#[test]
fn no_run_file_brings_its_reader_down() {
    feed("run", 300);
}

#[test]
fn no_policy_brings_its_reader_down() {
    feed("policy", 300);
}

#[test]
fn no_log_brings_its_reader_down() {
    feed("log", 5_000);
}

#[test]
fn no_pack_brings_its_reader_down() {
    feed("pack", 2_000);
}

#[test]
fn no_answer_of_a_worker_brings_its_host_down() {
    feed("wire", 50_000);
}

#[test]
fn no_image_brings_its_reader_down() {
    feed("image", 3_000);
}

#[test]
fn no_checkpoint_brings_its_reader_down() {
    feed("checkpoint", 1_000);
}
