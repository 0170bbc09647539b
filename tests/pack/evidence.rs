use std::sync::atomic::AtomicBool;

use engine::experiment::Overrides;
use engine::filter::Sources;
use pack::{MAX_EVIDENCE_STEPS, MAX_SEED_STEPS, Pack, measure};

use super::flow::small_folder;
use super::forge::{HEAD, pack_of, small_files};
use crate::support::Bench;

/// A pack that claims these seeds for a script of so many steps of learning and of its test.
fn claiming(seeds: u64, steps: u64, test_steps: u64) -> Vec<u8> {
    let script = format!(
        "world(\"small\");\nrun(#{{ steps: {steps}, test_steps: {test_steps} }});\nrule \"contact\" when robot.contact => -1 then recover;\n"
    );
    let mut head = format!(
        "{HEAD}\n[evidence]\nengine = \"0.1.0\"\nbehaves = \"{}\"\nsteps = 400\ntest_steps = 100\n",
        "0".repeat(64)
    );
    for seed in 1..=seeds {
        head += &format!(
            "\n[[evidence.seed]]\nseed = {seed}\nstate_hash = \"x\"\ntest_hash = \"y\"\nstates_seen = 1\nfailures_per_1000 = 0.0\ncontacts = 0\nmean_speed = 0.1\nspinning = 0.0\nreinforcement_per_400 = []\n"
        );
    }
    let files = small_files();
    pack_of(&head, &[files[0], (files[1].0, script.as_bytes()), files[2]])
}

#[test]
fn a_claim_that_would_hold_the_machine_for_days_is_not_replayed() {
    let bench = Bench::new();
    for (seeds, steps, test_steps, limit) in [
        (1, MAX_SEED_STEPS, 1, "takes 1000001 steps for each seed; the limit is 1000000 steps for each seed"),
        (1, 1, MAX_SEED_STEPS, "takes 1000001 steps for each seed"),
        (1, 1_000_000_000, 1_000_000_000, "takes 2000000000 steps for each seed"),
        (100, MAX_EVIDENCE_STEPS / 100, 1, "takes 10000100 steps for 100 seeds; the limit is 10000000 steps in all"),
        (101, 400, 100, "the evidence has more than 100 seeds"),
    ] {
        bench.write("a.pack", claiming(seeds, steps, test_steps));
        let text = bench.failure(&["pack", "verify", "a.pack", "--allow-unsigned", "--replay"]);
        assert!(text.starts_with("exit status 3\nerror[E-PACK-LIMIT]") && text.contains(limit), "{text}");
    }
}

#[test]
fn an_author_cannot_build_what_nobody_could_replay() {
    let bench = Bench::new();
    small_folder(&bench, "short", "ada/short");
    let script = bench.read("short/scripts/short.rhai").replace("steps: 800", "steps: 3000000");
    bench.write("short/scripts/short.rhai", script);
    for command in ["check", "build"] {
        let text = bench.failure(&["pack", command, "short"]);
        assert!(text.starts_with("exit status 3\nerror[E-PACK-LIMIT]"), "{text}");
        assert!(text.contains("fewer steps in the script's run()"), "{text}");
    }
}

#[test]
fn a_certificate_is_built_into_a_pack_and_drawn_again_by_whoever_doubts_it() {
    let bench = Bench::new();
    small_folder(&bench, "short", "ada/short");
    let author = bench.read("short/pack.toml");
    let certify = |worlds: &str| format!("{author}\n[certify]\nworlds = [\"{worlds}\"]\ndraws = 4\nsteps = 40\n");
    bench.write("short/pack.toml", certify("rooms"));
    bench.ok(&["pack", "build", "short", "--out", "a.pack"]);
    let pack = Pack::load(&bench.path().join("a.pack")).unwrap();
    let manifest = pack.manifest();
    let certificate = manifest.evidence.as_ref().unwrap().certificate.as_ref().unwrap();
    assert_eq!((manifest.format, certificate.draws, certificate.failures.steps), (2, 4, 160));
    let verified = bench.ok(&["pack", "verify", "a.pack", "--allow-unsigned", "--replay"]);
    assert!(verified.contains("reproduced bit for bit"), "{verified}");
    let others = bench.engine(&["certify", "a.pack", "--allow-unsigned", "--again", "--seed", "5"]);
    let others = String::from_utf8_lossy(&others.stdout).into_owned();
    assert!(others.contains("before:") && others.contains("the intervals of the failures"), "{others}");
    // A stranger's certificate must not read the files of who verifies it.
    let text = pack.text("manifest.toml").unwrap().text.to_string();
    let files: Vec<_> = pack.files().filter(|(path, _)| *path != "manifest.toml").collect();
    let forged = |from: &str, to: &str| {
        assert!(text.contains(from), "{text}");
        let lied = text.replacen(from, to, 1);
        let mut bytes = Vec::new();
        let all = [("manifest.toml", lied.as_bytes())].into_iter().chain(files.iter().copied());
        pack::archive::write(all, &mut bytes).unwrap();
        bench.write("lied.pack", bytes);
        let output = bench.engine(&["pack", "verify", "lied.pack", "--allow-unsigned", "--replay"]);
        String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()
    };
    let lied = forged("\"rooms\"", "\"secret.toml\"");
    assert!(lied.contains("made by rule, not in 'secret.toml'"), "{lied}");
    let lied = forged(&format!("seed = {}\n", certificate.seed), "seed = 3\n");
    assert!(lied.contains("of its author's choice"), "{lied}");
    let lied = forged("learned_in = 0", "learned_in = 1");
    assert!(lied.contains("the certificate does not come out as it is claimed"), "{lied}");
    bench.write("short/pack.toml", certify("worlds/small.toml"));
    assert!(bench.failure(&["pack", "build", "short"]).contains("made by rule"));
}

#[test]
fn a_replay_finds_other_steps_and_a_policy_that_no_seed_is_said_to_learn() {
    let bench = Bench::new();
    small_folder(&bench, "short", "ada/short");
    bench.ok(&["pack", "build", "short", "--out", "a.pack"]);
    let pack = Pack::load(&bench.path().join("a.pack")).unwrap();
    let text = pack.text("manifest.toml").unwrap().text.to_string();
    let files: Vec<_> = pack.files().filter(|(path, _)| *path != "manifest.toml").collect();
    for (from, to, told) in [
        (
            "steps = 800\n",
            "steps = 80000\n",
            "80000 steps of learning and 400 of the test are claimed, the script has 800",
        ),
        ("policy_seed = ", "# policy_seed = ", "no seed is claimed to learn 'policy.toml'"),
    ] {
        assert_eq!(text.matches(from).count(), 1, "{text}");
        let lied = text.replace(from, to);
        let mut bytes = Vec::new();
        let all = [("manifest.toml", lied.as_bytes())].into_iter().chain(files.iter().copied());
        pack::archive::write(all, &mut bytes).unwrap();
        bench.write("lied.pack", bytes);
        let output = bench.engine(&["pack", "verify", "lied.pack", "--allow-unsigned", "--replay"]);
        let out = String::from_utf8(output.stdout.clone()).unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", crate::support::told(&output));
        assert!(out.contains(told), "{out}");
    }
}

#[test]
fn measuring_has_the_same_limits_for_the_library() {
    let pack = Pack::parse("a.pack".as_ref(), super::forge::small()).unwrap();
    let runnable = pack.plan(&[], &Overrides::default(), Sources::default()).unwrap();
    let seeds: Vec<u64> = (0..101).collect();
    let error = measure(&runnable, &seeds, 1, &AtomicBool::new(false), &|_| ()).err().unwrap();
    assert_eq!(error.code, "E-PACK-LIMIT");
    assert!(error.message.contains("has 101 seeds; the limit is 100 seeds"), "{}", error.message);
}
