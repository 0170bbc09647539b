/// Debian's Chromium, driven through its pipe.
mod chromium;

use std::path::PathBuf;

use chromium::Chromium;

use crate::support::{Bench, SCRIPT, WORLD, root};

const DESK: (u32, u32, bool) = (1280, 720, false);
const DESK_DARK: (u32, u32, bool) = (1280, 720, true);
const PHONE: (u32, u32, bool) = (390, 844, false);
const SHOWN: &str = "document.querySelector('main') !== null && !document.querySelector('main').hidden";

fn pictures() -> PathBuf {
    let folder = root().join("target/browser");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A page that is open, or nothing where there is no Chromium; a clear line says so.
fn open(url: &str) -> Option<Chromium> {
    let mut page = Chromium::start()?;
    page.size(DESK);
    page.go(url);
    page.wait_for(SHOWN);
    Some(page)
}

#[test]
fn the_page_of_a_run_plays_scrubs_and_explains() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai"]);
    let path = bench.path().join("runs/short/1/report.html");
    let Some(mut page) = open(&format!("file://{}", path.display())) else { return };
    let step = "Number((document.querySelector('#moment b')?.textContent ?? '-1').replace(',', ''))";
    // It opens on the test, playing, with the verdict above.
    page.wait_for(&format!("{step} > 0 && document.getElementById('play').textContent === 'Pause'"));
    assert_eq!(page.value("document.querySelector('[data-phase=test]').ariaPressed"), "true");
    assert_eq!(page.value("document.querySelectorAll('#verdict li').length > 0"), true);
    page.key(" ", 0);
    page.click_on("document.querySelector('[data-phase=learning]')");
    page.wait_for(&format!("{step} === 0"));
    page.key("ArrowRight", 0);
    page.wait_for(&format!("{step} === 1"));
    page.key("ArrowRight", 8);
    page.wait_for(&format!("{step} === 101"));
    let said = |page: &mut Chromium, id: &str| {
        page.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
        let label = page.value(&format!("document.querySelector('#{id} canvas').ariaLabel"));
        label.as_str().unwrap().to_owned()
    };
    let plan = said(&mut page, "map");
    assert!(
        plan.starts_with("plan of the world small, learning: path of the robot over 102 steps up to step 101"),
        "{plan}"
    );
    assert!(said(&mut page, "curve").starts_with("learning curve of seed 1: reward per 400 steps"));
    assert!(said(&mut page, "timeline").starts_with("timeline of learning, 800 steps, at step 101: too close fired"));
    page.key("9", 0);
    page.key(" ", 0);
    page.wait_for(&format!("{step} === 799 && document.getElementById('play').textContent === 'Play'"));
    page.click("timeline", 0.5);
    page.wait_for(&format!("{step} > 200 && {step} < 600"));
    // The first window is the worst: a click there goes to a step that was punished, and lists its causes.
    page.click("curve", 0.2);
    page.wait_for(&format!("{step} < 400 && document.querySelector('#moment').textContent.includes('reward −1')"));
    assert_eq!(page.value("document.querySelectorAll('#causes li').length > 0"), true);
    assert_eq!(page.value("document.querySelectorAll('#script .fired').length"), 1);
    page.click_on("document.querySelector('[data-phase=test]')");
    page.wait_for("document.querySelector('[data-phase=test]').ariaPressed === 'true'");
    assert_eq!(page.value("document.querySelectorAll('#frames img').length"), 2);
    for (name, size) in [("report", DESK), ("report-dark", DESK_DARK), ("report-phone", PHONE)] {
        page.size(size);
        page.picture(&pictures().join(format!("{name}.png")));
        assert_eq!(page.value("document.documentElement.scrollWidth <= innerWidth"), true, "{name} is too wide");
    }
    assert_eq!(page.complaints(), [] as [String; 0]);
}

#[test]
fn all_that_drives_by_itself_is_drawn() {
    let bench = Bench::new();
    let mut world = WORLD.to_owned();
    for (name, colour, offset_m) in [("pink", "[250, 20, 200]", 3.0), ("green", "[20, 230, 40]", 9.0)] {
        world += &format!(
            "[[material]]\nname = \"{name}\"\ncolour = {colour}\n[[mover]]\nname = \"{name}\"\nroute = \"lap\"\n\
             speed_m_per_s = 0.1\noffset_m = {offset_m}\n\
             boxes = [{{ centre_m = [0, 0, 0.2], size_m = [0.4, 0.4, 0.4], material = \"{name}\" }}]\n"
        );
    }
    bench.write("worlds/small.toml", world);
    bench.engine(&["run", "short.rhai"]);
    let path = bench.path().join("runs/short/1/report.html");
    let Some(mut page) = open(&format!("file://{}", path.display())) else { return };
    page.key(" ", 0);
    page.click_on("document.querySelector('[data-phase=learning]')");
    // Where the pixels of a colour are on the canvas of what moves: their mean column.
    let column = |page: &mut Chromium, colour: &str| {
        page.value(&format!(
            "(() => {{ const canvas = document.querySelectorAll('#map canvas')[1]; \
             const {{ width, height }} = canvas; \
             const pen = Object.assign(document.createElement('canvas'), {{ width, height }}).getContext('2d'); \
             pen.drawImage(canvas, 0, 0); \
             const {{ data }} = pen.getImageData(0, 0, width, height); \
             let [sum, count] = [0, 0]; \
             for (let at = 0; at < data.length; at += 4) {{ \
             if ([{colour}].every((part, index) => data[at + index] === part)) {{ sum += (at / 4) % width; count += 1; }} }} \
             return count > 20 ? sum / count : null; }})()"
        ))
    };
    let step = "Number((document.querySelector('#moment b')?.textContent ?? '-1').replace(',', ''))";
    page.wait_for(&format!("{step} === 0"));
    let (pink, green) = ("250, 20, 200", "20, 230, 40");
    let before = [pink, green].map(|colour| column(&mut page, colour).as_f64().expect(colour));
    page.key("ArrowRight", 8);
    page.wait_for(&format!("{step} === 100 || {step} === 101"));
    page.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    let after = [pink, green].map(|colour| column(&mut page, colour).as_f64().expect(colour));
    assert!(after[0] > before[0] && after[1] != before[1], "{before:?} {after:?}");
    page.picture(&pictures().join("two-movers.png"));
    assert_eq!(page.complaints(), [] as [String; 0]);
}

#[test]
fn a_computed_reward_has_its_rows_and_its_trace_and_seeds_have_a_list() {
    let bench = Bench::new();
    bench.write("computed.rhai", format!("{SCRIPT}fn reward(facts) {{ 0.1 * facts.action.linear }}\n"));
    for name in ["short", "computed"] {
        bench.engine(&["run", &format!("{name}.rhai"), "--seeds", "3"]);
    }
    let url = |name: &str| format!("file://{}", bench.path().join(format!("runs/{name}/1-3/report.html")).display());
    let Some(mut page) = open(&url("short")) else { return };
    let height = "document.getElementById('timeline').clientHeight";
    page.wait_for(&format!("{height} > 0 && document.querySelector('#timeline canvas').ariaLabel.includes('fired')"));
    let without = page.value(height).as_i64().unwrap();
    assert_eq!(page.value("document.querySelectorAll('#seeds tbody tr').length"), 3);
    page.click_on("document.querySelector('#seeds tr:not(.now) button')");
    page.wait_for(
        "document.querySelector('#seeds .now th').textContent === document.querySelector('#seed option:checked').text",
    );
    page.go(&url("computed"));
    page.wait_for("document.querySelector('#timeline canvas')?.ariaLabel.includes('; reward fired ')");
    // A row for the function, and the trace.
    assert!(page.value(height).as_i64().unwrap() >= without + 13 + 30);
    page.wait_for("document.querySelectorAll('#script .fired .chip').length > 0");
    page.picture(&pictures().join("computed.png"));
    assert_eq!(page.complaints(), [] as [String; 0]);
}

#[test]
fn a_hostile_script_is_only_text() {
    let bench = Bench::new();
    let evil = "</script><script>document.title='caught'</script><img src=x onerror=\\\"document.title='caught'\\\">";
    bench.write("evil.rhai", SCRIPT.replace("too close", evil));
    bench.engine(&["run", "evil.rhai"]);
    let path = bench.path().join("runs/evil/1/report.html");
    let Some(mut page) = open(&format!("file://{}", path.display())) else { return };
    page.key("ArrowRight", 8);
    assert_eq!(page.value("document.title"), "evil in small");
    assert_eq!(page.value("document.querySelectorAll('#frames ~ img, h1 img, #script img, #causes img').length"), 0);
    assert_eq!(page.complaints(), [] as [String; 0]);
}

#[cfg(feature = "serve")]
#[test]
fn a_save_redraws_the_live_page_and_a_bad_one_shows_its_error() {
    let served = crate::watch::served::Served::new(&[]);
    let Some(mut page) = open(&served.address()) else { return };
    let tested = "document.getElementById('status').textContent";
    page.wait_for(&format!("{tested}.startsWith('save 1') && {tested}.includes('tested')"));
    page.picture(&pictures().join("live.png"));
    let drawn = "document.querySelector('#curve canvas').toDataURL()";
    let before = page.value(drawn);
    served.bench.write("short.rhai", SCRIPT.replace("<= 0.25", "<= 0.4"));
    page.wait_for(&format!("{tested}.startsWith('save 2') && {tested}.includes('tested')"));
    page.wait_for("document.getElementById('script').textContent.includes('<= 0.4')");
    assert_ne!(page.value(drawn), before);
    assert_eq!(page.value("document.getElementById('states-note').textContent.includes('since the last save')"), true);
    page.wait_for("document.querySelectorAll('#frames img').length === 2");
    page.picture(&pictures().join("live-saved.png"));
    let wrong = SCRIPT.replace("laser.nearest", "laser.nearst").replace("robot.contact", "robot.contract");
    served.bench.write("short.rhai", wrong);
    page.wait_for("!document.getElementById('error').hidden");
    assert_eq!(page.value("document.querySelectorAll('#error-text pre').length"), 2);
    let count = page.value("document.getElementById('error-count').textContent");
    assert!(count.as_str().unwrap().starts_with("2 mistakes in"), "{count}");
    let text = page.value("document.getElementById('error-text').textContent");
    assert!(text.as_str().unwrap().contains("did you mean 'nearest'?"), "{text}");
    assert_eq!(page.value("document.querySelector('#script .wrong i').textContent"), "3");
    page.picture(&pictures().join("live-error.png"));
    served.bench.write("short.rhai", SCRIPT);
    page.wait_for("document.getElementById('error').hidden");
    page.wait_for(&format!("{tested}.includes('tested')"));
    page.choose("seed", "1");
    page.wait_for("document.getElementById('map-note').textContent.startsWith('learning')");
    assert_eq!(page.complaints(), [] as [String; 0]);
}

#[cfg(feature = "serve")]
#[test]
fn a_reward_swapped_under_running_robots_goes_on_with_their_curve() {
    let served = crate::watch::served::Served::new(&["--port", "0", "--keep", "--out", "kept"]);
    let Some(mut page) = open(&served.address()) else { return };
    page.click_on("document.querySelector('[data-phase=learning]')");
    page.wait_for("document.getElementById('moment').textContent.includes('of 800')");
    served.bench.write(
        "short.rhai",
        SCRIPT.replace("\"contact\" when robot.contact => -1", "\"touch\" when robot.contact => -2"),
    );
    page.wait_for(
        "document.getElementById('status').textContent.includes('reward swapped before step 800, table: keep')",
    );
    page.wait_for("document.getElementById('moment').textContent.includes('of 1,600')");
    assert_eq!(page.value("document.getElementById('script').textContent.includes('touch')"), true);
    page.wait_for("!document.getElementById('status').classList.contains('busy')");
    page.size(DESK);
    page.picture(&pictures().join("live-kept.png"));
}

#[cfg(feature = "serve")]
#[test]
fn what_the_reward_can_be_had_for_appears_after_a_save() {
    let served = crate::watch::served::Served::new(&[]);
    let Some(mut page) = open(&served.address()) else { return };
    let panel = "document.querySelector('.cheats')";
    page.wait_for(&format!("!{panel}.hidden && {panel}.querySelectorAll('tbody tr').length >= 4"));
    assert_eq!(page.value("document.querySelectorAll('#cheats .verdict.warning').length"), 0);
    served.bench.write("short.rhai", format!("{SCRIPT}rule \"slow\" when action.linear < 0.1 => 1;\n"));
    page.wait_for("document.querySelectorAll('#cheats .verdict.warning').length === 1");
    let words = page.value("document.querySelector('#cheats .verdict').textContent");
    assert!(words.as_str().unwrap().contains("can be had without getting anywhere"), "{words}");
    // Whoever hardly moves is paid in every one of 400 steps.
    assert_eq!(page.value("document.querySelector('#cheats tr.had td').textContent"), "+400");
    assert_eq!(page.value("document.querySelector('#findings').textContent.includes('W-EXPLOIT')"), true);
    assert_eq!(page.value("document.querySelectorAll('#script .noted').length > 0"), true);
    for (name, size) in [("live-checked", DESK), ("live-checked-dark", DESK_DARK), ("live-checked-phone", PHONE)] {
        page.size(size);
        page.value("document.querySelector('.findings').scrollIntoView()");
        page.picture(&pictures().join(format!("{name}.png")));
        assert_eq!(page.value("document.documentElement.scrollWidth <= innerWidth"), true, "{name} is too wide");
    }
    assert_eq!(page.complaints(), [] as [String; 0]);
}
