use crate::support::{Bench, SCRIPT};
use sha2::{Digest, Sha256};

fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let rest = text.split_once(from).unwrap().1;
    rest.split_once(to).unwrap().0
}

fn document(html: &str) -> serde_json::Value {
    serde_json::from_str(between(html, "id=\"data\">", "</script>")).unwrap()
}

fn bytes(base64: &serde_json::Value) -> Vec<u8> {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let value = |letter: u8| letters.iter().position(|known| *known == letter).unwrap() as u32;
    let text = base64.as_str().unwrap().trim_end_matches('=');
    let mut out = Vec::new();
    for four in text.as_bytes().chunks(4) {
        let bits = four.iter().fold(0, |bits, letter| bits << 6 | value(*letter)) << (6 * (4 - four.len()));
        out.extend_from_slice(&bits.to_be_bytes()[1..four.len()]);
    }
    out
}

fn shorts(base64: &serde_json::Value) -> Vec<i16> {
    bytes(base64).chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect()
}

#[test]
fn the_page_of_a_run_holds_what_the_run_recorded() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let page = document(&bench.read("runs/short/1/report.html"));
    let summary: serde_json::Value = serde_json::from_str(&bench.read("runs/short/1/summary.json")).unwrap();
    let seed = &page["seeds"][0];
    assert_eq!(seed["curve"], summary["reinforcement_per_400"]);
    assert_eq!(seed["test"], summary["test"]);
    assert_eq!(page["script"].as_str().unwrap(), SCRIPT);
    assert_eq!(page["rules"][0]["line"], 3);
    let listed = bench.success(&["replay", "runs/short/1", "--from", "0", "--to", "799", "--json"]);
    let steps: serde_json::Value = serde_json::from_str(&listed).unwrap();
    let track = &seed["learning"];
    let (x, yaw, action) = (shorts(&track["x"]), shorts(&track["yaw"]), bytes(&track["action"]));
    let fired = bytes(&track["fired"]);
    assert_eq!((x.len(), action.len(), fired.len()), (800, 800, 800));
    for (index, step) in steps["listed"].as_array().unwrap().iter().enumerate() {
        let metres = f64::from(x[index]) * page["unit_m"].as_f64().unwrap();
        assert!((metres - step["pose"][0].as_f64().unwrap()).abs() < 0.001);
        assert!((f64::from(yaw[index]) / 1000.0 - step["pose"][2].as_f64().unwrap()).abs() < 0.001);
        assert_eq!(u64::from(action[index]), step["action"].as_u64().unwrap());
        assert_eq!(fired[index].count_ones() as usize, step["rules"].as_array().unwrap().len());
    }
    let kept = page["scan"]["kept"].as_u64().unwrap() as usize;
    assert_eq!(bytes(&track["scan"]).len(), 800 * kept);
}

#[test]
fn measures_and_stages_of_every_step_stand_on_the_page() {
    let bench = Bench::new();
    let script = SCRIPT.to_owned()
        + "stages([\"near\", \"far\"]);\nmeasure turn = action.angular;\n\
           rule \"away\" in \"near\" when laser.front > 2.0 => 0 then stage \"far\";\n";
    bench.write("staged.rhai", script);
    bench.engine(&["run", "staged.rhai"]);
    let page = document(&bench.read("runs/staged/1/report.html"));
    assert_eq!(page["measures"], serde_json::json!(["turn"]));
    assert_eq!(page["stages"], serde_json::json!({ "names": ["near", "far"], "states": 64 }));
    let track = &page["seeds"][0]["learning"];
    let turns = bytes(&track["measures"][0]);
    let turns: Vec<f32> = turns.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    let actions = bytes(&track["action"]);
    assert_eq!((turns.len(), actions.len()), (800, 800));
    for (turn, action) in turns.iter().zip(actions) {
        assert_eq!(f64::from(*turn), f64::from(page["actions"][usize::from(action)][1].as_f64().unwrap() as f32));
    }
}

#[test]
fn the_pictures_of_a_moment_come_with_its_reasons() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let page = document(&bench.read("runs/short/1/report.html"));
    let shots = page["shots"].as_array().unwrap();
    assert!(shots.len() > 60 && shots.len() <= 120, "{}", shots.len());
    let shot = &shots[0];
    let told = bench.success(&["explain", "runs/short/1", "--step", &shot["step"].to_string(), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!(shot["reasons"]["next_state"], told["next_state"]);
    assert_eq!(shot["state"], shot["reasons"]["next_state"]["index"]);
    for stage in shot["stages"].as_array().unwrap() {
        assert!(stage["picture"].as_str().unwrap().starts_with("data:image/"));
    }
}

#[test]
fn a_full_run_stays_under_three_mebibytes() {
    let bench = Bench::new();
    let script = SCRIPT.replace("steps: 800, test_steps: 400", "steps: 5200, test_steps: 5000");
    bench.write("long.rhai", script);
    bench.engine(&["run", "long.rhai"]);
    let length = bench.read("runs/long/1/report.html").len();
    assert!(length < 3 << 20, "{length} bytes");
}

#[test]
fn a_run_that_is_checked_too_shows_what_its_reward_can_be_had_for() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    assert!(document(&bench.read("runs/short/1/report.html"))["checked"].is_null());
    let output = bench.engine(&["run", "short.rhai", "--check"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("checked:   0 errors, "), "{text}");
    let page = document(&bench.read("runs/short/1/report.html"));
    let report: serde_json::Value =
        serde_json::from_slice(&bench.engine(&["check", "short.rhai", "--json"]).stdout).unwrap();
    assert_eq!(page["checked"]["exploits"], report["exploits"]);
    assert!(text.contains(report["exploits"]["sentence"].as_str().unwrap()), "{text}");
    assert_eq!(page["findings"].as_array().unwrap().len(), report["findings"].as_array().unwrap().len());
}

#[test]
fn many_seeds_share_a_page_that_begins_with_the_median() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--seeds", "3"]);
    let html = bench.read("runs/short/1-3/report.html");
    let page = document(&html);
    let seeds = page["seeds"].as_array().unwrap();
    let failures = |seed: &serde_json::Value| seed["test"]["failures_per_1000"].as_f64().unwrap();
    let mut all: Vec<f64> = seeds.iter().map(failures).collect();
    all.sort_by(f64::total_cmp);
    let first: Vec<_> = seeds.iter().filter(|seed| seed["shown_first"] == true).collect();
    assert_eq!((seeds.len(), first.len()), (3, 1));
    assert_eq!(failures(first[0]), all[1]);
    assert!(html.len() < 3 << 20);
}

#[test]
fn a_script_cannot_become_part_of_the_page() {
    let bench = Bench::new();
    let evil = "</script><script>document.title='caught'</script><img src=x onerror=alert(1)>";
    let script = format!("// {evil}\n{}", SCRIPT.replace("too close", evil));
    bench.write("evil.rhai", script);
    bench.engine(&["run", "evil.rhai"]);
    let html = bench.read("runs/evil/1/report.html");
    assert!(!html.contains(evil) && !html.contains("<img src=x"));
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(document(&html)["rules"][0]["name"], evil);
}

#[test]
fn the_policy_of_the_page_lets_only_its_own_code_run() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let html = bench.read("runs/short/1/report.html");
    let policy = between(&html, "Content-Security-Policy\" content=\"", "\">");
    for (kind, from, to) in [("script", "<script type=\"module\">", "</script>"), ("style", "<style>", "</style>")] {
        let digest = Sha256::digest(between(&html, from, to).as_bytes());
        let named = between(policy, &format!("{kind}-src 'sha256-"), "'");
        assert_eq!(bytes(&serde_json::json!(named)), digest.as_slice());
    }
    assert!(policy.contains("default-src 'none'") && policy.contains("connect-src 'none'"));
    for outside in ["http://", "https://", "src=\"", "href="] {
        assert!(
            !html.replace("http://www.w3.org/2000/svg", "").replace("http://${own}", "").contains(outside),
            "{outside}"
        );
    }
}
