use super::flow::signed_pack;
use crate::support::Bench;

#[test]
fn a_folder_is_a_place_to_push_to_and_pull_from() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    bench.write("small.pack", super::forge::small());
    assert!(bench.failure(&["pack", "push", "small.pack", "shelf"]).contains("E-TRUST-UNSIGNED"));
    bench.ok(&["pack", "push", &file, "shelf"]);
    bench.ok(&["pack", "push", "small.pack", "shelf", "--allow-unsigned"]);
    let text = bench.failure(&["pack", "pull", "shelf", "--out", "got"]);
    assert!(text.contains("holds more than one pack") && text.contains("ada/short@0.1.0, eve/small@1.0.0"), "{text}");
    assert!(bench.failure(&["pack", "pull", "shelf", "--name", "ada/long"]).contains("no such pack"));
    bench.ok(&["pack", "pull", "shelf", "--name", "ada/short", "--out", "got"]);
    bench.ok(&["pack", "verify", "got/ada-short-0.1.0.pack"]);
    bench.ok(&["pack", "install", "shelf", "--name", "ada/short@0.1.0"]);
    let wrong = format!("sha256:{}", "0".repeat(64));
    let text = bench.failure(&["pack", "pull", &file, "--digest", &wrong, "--out", "no"]);
    assert!(text.starts_with("exit status 5\nerror[E-TRUST-DIGEST]"), "{text}");
    assert!(!bench.path().join("no").exists());
}

#[cfg(not(feature = "share"))]
#[test]
fn without_the_network_an_address_says_how_to_get_it() {
    let bench = Bench::new();
    bench.write("small.pack", super::forge::small());
    for address in ["oci://localhost:5000/ada/short:0.1.0", "https://example.org/a.pack"] {
        let text = bench.failure(&["pack", "pull", address]);
        assert!(
            text.starts_with("exit status 2\nerror[E-PACK-ADDRESS]") && text.contains("--features share"),
            "{text}"
        );
    }
    assert!(
        bench.failure(&["pack", "push", "small.pack", "oci://x/y", "--allow-unsigned"]).contains("--features share")
    );
}

#[cfg(feature = "share")]
mod registry {
    use std::net::{TcpListener, TcpStream};
    use std::process::{Child, Command, Stdio};

    use super::super::flow::signed_pack;
    use crate::support::{Bench, told};

    /// Debian's docker-registry on a free port of this machine; it ends with the test.
    struct Registry {
        server: Child,
        host: String,
    }

    impl Drop for Registry {
        fn drop(&mut self) {
            self.server.kill().unwrap();
            self.server.wait().unwrap();
        }
    }

    fn start(bench: &Bench) -> Option<Registry> {
        if Command::new("docker-registry").arg("--version").output().is_err() {
            println!("skipped: docker-registry is not installed (apt-get install docker-registry)");
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let host = format!("127.0.0.1:{port}");
        let folder = bench.path().join("registry").display().to_string();
        bench.write(
            "registry.yml",
            format!("version: 0.1\nlog:\n  level: error\nstorage:\n  filesystem:\n    rootdirectory: {folder}\nhttp:\n  addr: {host}\n"),
        );
        let server = Command::new("docker-registry")
            .arg("serve")
            .arg(bench.path().join("registry.yml"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        for _ in 0..200 {
            if TcpStream::connect(&host).is_ok() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        Some(Registry { server, host })
    }

    #[test]
    fn a_pack_goes_through_a_registry_and_is_reproduced_on_another_home() {
        let bench = Bench::new();
        let Some(registry) = start(&bench) else { return };
        let file = signed_pack(&bench, "ada/short");
        let address = format!("oci://{}/ada/short", registry.host);
        let pushed = bench.ok(&["pack", "push", &file, &address]);
        let by_digest = pushed.split_whitespace().last().unwrap().to_owned();
        assert!(by_digest.contains("@sha256:"), "{pushed}");
        let other = Bench::new();
        other.write("ada.pub", bench.read("ada.pub"));
        other.ok(&["pack", "trust", "ada", "--key", "ada.pub"]);
        for (from, out) in [(format!("{address}:0.1.0"), "tag"), (by_digest, "digest")] {
            other.ok(&["pack", "pull", &from, "--out", out]);
            let pulled = format!("{out}/ada-short-0.1.0.pack");
            assert!(
                std::fs::read(other.path().join(&pulled)).unwrap() == std::fs::read(bench.path().join(&file)).unwrap()
            );
            assert!(other.ok(&["pack", "verify", "--replay", &pulled]).contains("reproduced bit for bit"));
        }
        other.ok(&["pack", "install", &format!("{address}:0.1.0")]);
        let text = other.failure(&["pack", "pull", &format!("{address}:9.9.9")]);
        assert!(text.starts_with("exit status 3\nerror[E-PACK-VERSION]"), "{text}");
        assert!(text.contains("there are: 0.1.0\n"), "{text}");
        let wrong = format!("oci://{}/ada/short@sha256:{}", registry.host, "0".repeat(64));
        assert!(other.failure(&["pack", "pull", &wrong]).contains("E-PACK-VERSION"));
        let nobody = format!("oci://{}/nobody/nothing:1.0.0", registry.host);
        assert!(other.failure(&["pack", "pull", &nobody]).contains("E-PACK-NETWORK"));
    }

    #[test]
    fn bytes_that_were_changed_in_the_registry_are_refused() {
        let bench = Bench::new();
        let Some(registry) = start(&bench) else { return };
        let file = signed_pack(&bench, "ada/short");
        let address = format!("oci://{}/ada/short", registry.host);
        bench.ok(&["pack", "push", &file, &address]);
        let blob = pack::Pack::load(&bench.path().join(&file)).unwrap().blob().to_string();
        let kept = format!("registry/docker/registry/v2/blobs/sha256/{}/{blob}/data", &blob[..2]);
        let mut bytes = std::fs::read(bench.path().join(&kept)).unwrap();
        *bytes.last_mut().unwrap() ^= 1;
        bench.write(&kept, bytes);
        let text = bench.failure(&["pack", "pull", &format!("{address}:0.1.0"), "--out", "got"]);
        assert!(text.starts_with("exit status 5\nerror[E-PACK-BYTES]"), "{text}");
        assert!(!bench.path().join("got").exists());
    }

    #[test]
    fn another_client_reads_what_was_pushed_and_we_read_what_it_copied() {
        if Command::new("skopeo").arg("--version").output().is_err() {
            println!("skipped: skopeo is not installed (apt-get install skopeo)");
            return;
        }
        let bench = Bench::new();
        let Some(registry) = start(&bench) else { return };
        let file = signed_pack(&bench, "ada/short");
        bench.ok(&["pack", "push", &file, &format!("oci://{}/ada/short", registry.host)]);
        let skopeo = |arguments: &[&str]| {
            let output = Command::new("skopeo").args(arguments).current_dir(bench.path()).output().unwrap();
            assert!(output.status.success(), "{}", told(&output));
            String::from_utf8(output.stdout).unwrap()
        };
        let from = format!("docker://{}/ada/short:0.1.0", registry.host);
        let raw = skopeo(&["inspect", "--raw", "--tls-verify=false", &from]);
        assert!(raw.contains("application/vnd.engine.pack.v1.tar"), "{raw}");
        // The file's name stands on the layer too, where other clients look for it.
        assert_eq!(raw.matches("ada-short-0.1.0.pack").count(), 2, "{raw}");
        skopeo(&["copy", "--src-tls-verify=false", &from, "dir:copied"]);
        let blob = pack::Pack::load(&bench.path().join(&file)).unwrap().blob().to_string();
        assert!(
            std::fs::read(bench.path().join("copied").join(blob)).unwrap()
                == std::fs::read(bench.path().join(&file)).unwrap()
        );
        let to = format!("docker://{}/copy/short:0.1.0", registry.host);
        skopeo(&["copy", "--src-tls-verify=false", "--dest-tls-verify=false", &from, &to]);
        bench.ok(&["pack", "pull", &format!("oci://{}/copy/short:0.1.0", registry.host), "--out", "got"]);
        let text = bench.failure(&["pack", "verify", "got/ada-short-0.1.0.pack"]);
        assert!(text.contains("E-TRUST-UNSIGNED"), "a copy without its referrers has no signature: {text}");
    }
}
