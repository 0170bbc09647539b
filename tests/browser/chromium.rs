use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// What Chromium is told, besides where its profile is: no display, no network of its own.
const FLAGS: &str = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                     --disable-component-update --disable-sync --force-color-profile=srgb --remote-debugging-pipe";
/// How long a page may take to become what a test waits for; only a broken page takes so long.
const PATIENCE: Duration = Duration::from_secs(120);

/// A browser with one page, spoken to in its own protocol: JSON objects, each ended by a zero byte.
pub(super) struct Chromium {
    child: Child,
    commands: File,
    answers: BufReader<File>,
    asked: u64,
    session: Option<String>,
    complaints: Vec<String>,
    _folder: tempfile::TempDir,
}

impl Drop for Chromium {
    fn drop(&mut self) {
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl Chromium {
    /// Nothing where Chromium is not installed.
    pub(super) fn start() -> Option<Self> {
        let known = Command::new("chromium").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !known.is_ok_and(|status| status.success()) {
            println!("skipped: chromium is not installed (apt-get install chromium)");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let (input, output) = (folder.path().join("in"), folder.path().join("out"));
        assert!(Command::new("mkfifo").args([&input, &output]).status().unwrap().success());
        // The browser reads commands from file 3 and answers to file 4; a shell opens them.
        let line = format!("exec chromium {FLAGS} --user-data-dir=\"$0/profile\" about:blank 3<\"$0/in\" 4>\"$0/out\"");
        let child = Command::new("sh").arg("-c").arg(line).arg(folder.path()).stderr(Stdio::null()).spawn().unwrap();
        let commands = File::options().write(true).open(&input).unwrap();
        let answers = BufReader::new(File::open(&output).unwrap());
        let mut browser =
            Self { child, commands, answers, asked: 0, session: None, complaints: Vec::new(), _folder: folder };
        let targets = browser.call("Target.getTargets", json!({}));
        let mut targets = targets["targetInfos"].as_array().unwrap().iter();
        let target = targets.find(|target| target["type"] == "page").unwrap()["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        browser.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        Some(browser)
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let mut command = json!({ "id": self.asked, "method": method, "params": params });
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        self.commands.write_all(format!("{command}\0").as_bytes()).unwrap();
        loop {
            let mut text = Vec::new();
            self.answers.read_until(0, &mut text).unwrap();
            assert!(text.pop().is_some(), "chromium ended");
            let mut said: Value = serde_json::from_slice(&text).unwrap();
            let complains = ["Runtime.exceptionThrown", "Log.entryAdded"].iter().any(|name| said["method"] == *name);
            if complains {
                self.complaints.push(said["params"].to_string());
            }
            if said["id"] == self.asked {
                assert!(said["error"].is_null(), "{method}: {}", said["error"]);
                return said["result"].take();
            }
        }
    }

    /// Errors that the page threw, and what the browser refused.
    pub(super) fn complaints(&self) -> &[String] {
        &self.complaints
    }

    /// Width and height of the window, pixels, and whether it is dark.
    pub(super) fn size(&mut self, (width, height, dark): (u32, u32, bool)) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
        let scheme = json!({ "name": "prefers-color-scheme", "value": if dark { "dark" } else { "light" } });
        self.call("Emulation.setEmulatedMedia", json!({ "features": [scheme] }));
    }

    pub(super) fn go(&mut self, url: &str) {
        self.call("Page.navigate", json!({ "url": url }));
    }

    /// The value of an expression in the page.
    pub(super) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut found = self.call("Runtime.evaluate", asked);
        assert!(found["exceptionDetails"].is_null(), "{expression}: {}", found["exceptionDetails"]);
        found["result"]["value"].take()
    }

    /// Returns once an expression is true.
    pub(super) fn wait_for(&mut self, expression: &str) {
        let started = Instant::now();
        while self.value(expression) != true {
            assert!(started.elapsed() < PATIENCE, "it never came true: {expression}; {:?}", self.complaints);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Presses a key; 8 is the shift key held.
    pub(super) fn key(&mut self, key: &str, modifiers: u32) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": kind, "key": key, "modifiers": modifiers }));
        }
    }

    /// Clicks in the middle of an element's height, at a share of its width.
    pub(super) fn click(&mut self, id: &str, share: f64) {
        let place = self.value(&format!(
            "(() => {{ const box = document.getElementById('{id}').getBoundingClientRect(); \
             return [box.x + {share} * box.width, box.y + 0.5 * box.height]; }})()"
        ));
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        }
    }

    /// Clicks on what an expression names.
    pub(super) fn click_on(&mut self, expression: &str) {
        self.value(&format!("{expression}.click()"));
    }

    /// Chooses an entry of a list.
    #[cfg(feature = "serve")]
    pub(super) fn choose(&mut self, id: &str, entry: &str) {
        self.value(&format!(
            "(() => {{ const list = document.getElementById('{id}'); list.value = '{entry}'; \
             list.dispatchEvent(new Event('change')); }})()"
        ));
    }

    /// Writes what the window shows as PNG, once it has drawn twice since it was asked.
    pub(super) fn picture(&mut self, path: &Path) {
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
        let shot = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let text = shot["data"].as_str().unwrap().trim_end_matches('=');
        let mut decoded = Vec::with_capacity(text.len());
        for four in text.as_bytes().chunks(4) {
            let bits = four.iter().fold(0, |bits, letter| bits << 6 | six(*letter)) << (6 * (4 - four.len()));
            decoded.extend_from_slice(&u32::to_be_bytes(bits)[1..four.len()]);
        }
        std::fs::write(path, decoded).unwrap();
    }
}

fn six(letter: u8) -> u32 {
    u32::from(match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        _ => 63,
    })
}
