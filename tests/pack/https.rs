use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use super::flow::signed_pack;
use crate::support::{Bench, root, told};

/// A real TLS server on a free port of this machine, over a folder of its own; it ends with the test.
struct Server {
    process: Child,
    address: String,
    files: Bench,
}

impl Drop for Server {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

/// A certificate authority, and a certificate by it for 127.0.0.1: good for two days.
const CERTIFICATES: [&str; 2] = [
    "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -keyout ca.key -out ca.pem -subj /CN=authority",
    "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -keyout server.key -out server.pem \
     -subj /CN=localhost -CA ca.pem -CAkey ca.key -addext basicConstraints=critical,CA:FALSE \
     -addext subjectAltName=IP:127.0.0.1,DNS:localhost",
];

fn start() -> Option<Server> {
    let works = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).output().is_ok_and(|output| output.status.success())
    };
    if !works("python3", &["-c", "import ssl"]) || !works("openssl", &["version"]) {
        println!("skipped: python3 or openssl is not installed");
        return None;
    }
    let files = Bench::new();
    for arguments in CERTIFICATES {
        let output = Command::new("openssl").args(arguments.split_whitespace()).current_dir(files.path()).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", told(&output));
    }
    let script = root().join("tests/fixtures/https_server.py").canonicalize().unwrap();
    let mut command = Command::new("python3");
    command.arg(script).current_dir(files.path()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut process = command.spawn().unwrap();
    let mut port = String::new();
    BufReader::new(process.stdout.take().unwrap()).read_line(&mut port).unwrap();
    let address = format!("https://127.0.0.1:{}", port.trim());
    Some(Server { process, address, files })
}

impl Server {
    /// The engine on a bench, which trusts the authority of the server or nobody's; exit status and standard error.
    fn engine(&self, bench: &Bench, arguments: &[&str], authority: &str) -> String {
        let mut command = bench.command(arguments);
        command.env("SSL_CERT_FILE", self.files.path().join(authority)).env_remove("SSL_CERT_DIR");
        for proxy in ["https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"] {
            command.env_remove(proxy);
        }
        told(&command.output().unwrap())
    }

    fn pull(&self, bench: &Bench, path: &str) -> String {
        self.engine(bench, &["pack", "pull", &format!("{}/{path}", self.address), "--out", "got"], "ca.pem")
    }
}

#[test]
fn a_pack_comes_over_https_with_its_signature() {
    let Some(server) = start() else { return };
    let file = signed_pack(&server.files, "ada/short");
    let bench = Bench::new();
    bench.write("ada.pub", server.files.read("ada.pub"));
    bench.ok(&["pack", "trust", "ada", "--key", "ada.pub"]);
    let text = server.pull(&bench, &file);
    assert!(text.starts_with("exit status 0"), "{text}");
    let pulled = format!("got/{file}");
    let bytes = |bench: &Bench, name: &str| std::fs::read(bench.path().join(name)).unwrap();
    assert!(bytes(&bench, &pulled) == bytes(&server.files, &file));
    assert!(bench.ok(&["pack", "verify", &pulled, "--replay"]).contains("reproduced bit for bit"));
    let address = format!("{}/{file}", server.address);
    let text = server.engine(&bench, &["pack", "install", &address], "ca.pem");
    assert!(text.starts_with("exit status 0"), "{text}");
    // Without a signature beside it, it comes, and is not trusted.
    server.files.write("small.pack", super::forge::small());
    assert!(server.pull(&bench, "small.pack").starts_with("exit status 0"));
    assert!(bench.failure(&["pack", "verify", "got/eve-small-1.0.0.pack"]).contains("E-TRUST-UNSIGNED"));
}

#[test]
fn a_server_that_nobody_vouches_for_is_not_asked_for_anything() {
    let Some(server) = start() else { return };
    let bench = Bench::new();
    server.files.write("small.pack", super::forge::small());
    // Another authority than the server's.
    let other = start().unwrap();
    std::fs::copy(other.files.path().join("ca.pem"), server.files.path().join("other.pem")).unwrap();
    let address = format!("{}/small.pack", server.address);
    let text = server.engine(&bench, &["pack", "pull", &address, "--out", "got"], "other.pem");
    assert!(text.starts_with("exit status 6\nerror[E-PACK-NETWORK]"), "{text}");
    assert!(text.contains("certificate") && text.contains("SSL_CERT_FILE"), "{text}");
    // A certificate for 127.0.0.1 and localhost is none for another name of this machine.
    let elsewhere = address.replace("127.0.0.1", "127.0.0.2");
    let text = server.engine(&bench, &["pack", "pull", &elsewhere, "--out", "got"], "ca.pem");
    assert!(text.starts_with("exit status 6\nerror[E-PACK-NETWORK]"), "{text}");
    // Without encryption nothing is fetched at all.
    let plain = address.replace("https:", "http:");
    let text = server.engine(&bench, &["pack", "pull", &plain, "--out", "got"], "ca.pem");
    assert!(text.starts_with("exit status 2\nerror[E-PACK-ADDRESS]"), "{text}");
    assert!(!bench.path().join("got").exists());
}

#[test]
fn what_a_server_does_wrong_is_told_and_leaves_nothing() {
    let Some(server) = start() else { return };
    let bench = Bench::new();
    for (path, words) in [
        ("missing.pack", "there is no such file"),
        ("endless.pack", "it has more than 67108864 bytes"),
        ("away.pack", "redirect"),
        ("broken.pack", "500"),
        ("short.pack", "body"),
    ] {
        let text = server.pull(&bench, path);
        assert!(text.starts_with("exit status 6\nerror[E-PACK-NETWORK]") && text.contains(words), "{path}: {text}");
        assert!(!bench.path().join("got").exists(), "{path}");
    }
    // Stopped at the limit, not after it: what was sent beyond stood in buffers.
    let sent = (0..100).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        std::fs::read_to_string(server.files.path().join("sent.txt")).ok()?.parse::<u64>().ok()
    });
    assert!(sent.unwrap() < 80 << 20, "{sent:?}");
    server.files.write("page.pack", "<html>no pack</html>");
    let text = server.pull(&bench, "page.pack");
    assert!(text.starts_with("exit status 3\nerror[E-PACK-FORM]"), "{text}");
}
