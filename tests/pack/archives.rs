use std::path::Path;

use pack::{Digest, Pack};

use super::forge::{Forged, HEAD, manifest, pack_of, small, small_entries, small_files, tar};
use crate::support::{Bench, told};

/// A hostile archive: what it is, its bytes, the code that it is refused with.
pub(super) type Case = (String, Vec<u8>, &'static str);

/// The small pack with its second entry changed.
fn with(change: impl Fn(&mut Forged)) -> Vec<u8> {
    let mut entries = small_entries();
    change(&mut entries[1]);
    tar(&entries)
}

fn names() -> Vec<Case> {
    let deep = format!("{}x.txt", "d/".repeat(45));
    let names: [&[u8]; 30] = [
        b"../evil.txt",
        b"a/../../evil.txt",
        b"/etc/evil.txt",
        b"//evil.txt",
        b"a//b.txt",
        b"./a.txt",
        b".",
        b"..",
        b"A.txt",
        b"con.txt",
        b"nul",
        b"aux.md",
        b"com1.txt",
        b"lpt9.toml",
        b"a.txt.",
        b"a.",
        b"x:y.txt",
        b"c:\\evil.txt",
        b"..\\evil.txt",
        b"a\x1b[2J.txt",
        b"a\n.txt",
        b"a\xff.txt",
        b".hidden.txt",
        b"-rf.txt",
        b"a b.txt",
        "\u{430}.txt".as_bytes(),
        "a\u{202e}txt.md".as_bytes(),
        b"inner.pack",
        b"model.safetensors",
        b"run.sh",
    ];
    let case = |name: &[u8]| {
        let shown = format!("name {}", name.escape_ascii());
        (shown, with(|entry| entry.name = name.to_vec()), "E-PACK-ENTRY")
    };
    let mut cases: Vec<Case> = names.into_iter().map(case).collect();
    cases.push(case(deep.as_bytes()));
    cases.push(("a name in the prefix field".to_owned(), with(|entry| entry.prefix = b"..".to_vec()), "E-PACK-ENTRY"));
    cases.push(("an empty name".to_owned(), with(|entry| entry.name.clear()), "E-PACK-ENTRY"));
    cases
}

fn kinds() -> Vec<Case> {
    let kinds = [
        (b'1', "E-PACK-ENTRY"),
        (b'2', "E-PACK-ENTRY"),
        (b'3', "E-PACK-ENTRY"),
        (b'4', "E-PACK-ENTRY"),
        (b'5', "E-PACK-ENTRY"),
        (b'6', "E-PACK-ENTRY"),
        (b'7', "E-PACK-ENTRY"),
        (b'L', "E-PACK-ENTRY"),
        (b'K', "E-PACK-ENTRY"),
        (b'S', "E-PACK-ENTRY"),
        (b'x', "E-PACK-ENTRY"),
        (b'g', "E-PACK-ENTRY"),
        (b'D', "E-PACK-ENTRY"),
        (b'V', "E-PACK-ENTRY"),
        (b'\0', "E-PACK-FORM"),
    ];
    let case = |(kind, code): (u8, &'static str)| {
        let link = |entry: &mut Forged| {
            entry.kind = kind;
            entry.link = b"/etc/passwd".to_vec();
        };
        (format!("kind {}", kind.escape_ascii()), with(link), code)
    };
    let mut cases: Vec<Case> = kinds.into_iter().map(case).collect();
    let mut through = small_entries();
    through[1].kind = b'2';
    through[1].name = b"scripts".to_vec();
    through[1].link = b"/tmp".to_vec();
    cases.push(("a link, then a file through it".to_owned(), tar(&through), "E-PACK-ENTRY"));
    cases
}

fn fields() -> Vec<Case> {
    type Change = fn(&mut Forged);
    let changes: [(&str, Change, &'static str); 17] = [
        ("setuid", |entry| entry.mode = b"0004755\0".to_vec(), "E-PACK-ENTRY"),
        ("executable", |entry| entry.mode = b"0000755\0".to_vec(), "E-PACK-ENTRY"),
        ("a mode that is no number", |entry| entry.mode = b"zzzzzzz\0".to_vec(), "E-PACK-ENTRY"),
        ("a mode in other digits", |entry| entry.mode = b"000644 \0".to_vec(), "E-PACK-FORM"),
        ("an owner's number", |entry| entry.uid = b"0001750\0".to_vec(), "E-PACK-FORM"),
        ("a group's number", |entry| entry.gid = b"0001750\0".to_vec(), "E-PACK-FORM"),
        ("a time", |entry| entry.mtime = b"14000000000\0".to_vec(), "E-PACK-FORM"),
        ("an owner's name", |entry| entry.owner = b"root".to_vec(), "E-PACK-FORM"),
        ("a device number", |entry| entry.device = b"0000010\0".to_vec(), "E-PACK-FORM"),
        ("a link's target", |entry| entry.link = b"/etc/passwd".to_vec(), "E-PACK-FORM"),
        ("a wrong checksum", |entry| entry.checksum_error = 1, "E-PACK-FORM"),
        ("the magic of GNU tar", |entry| entry.magic = b"ustar  \0".to_vec(), "E-PACK-FORM"),
        ("no magic", |entry| entry.magic = vec![0; 8], "E-PACK-FORM"),
        ("padding that is not zero", |entry| entry.padding = 7, "E-PACK-FORM"),
        ("a size in binary", |entry| entry.size = Some(b"\x80\0\0\0\0\0\0\0\0\0\0\x08".to_vec()), "E-PACK-FORM"),
        ("a size of 2^63", |entry| entry.size = Some(b"\x80\0\0\0\x80\0\0\0\0\0\0\0".to_vec()), "E-PACK-FORM"),
        ("a size that is no number", |entry| entry.size = Some(b"xxxxxxxxxxx\0".to_vec()), "E-PACK-ENTRY"),
    ];
    let case = |(what, change, code): (&str, Change, &'static str)| (what.to_owned(), with(change), code);
    let mut cases: Vec<Case> = changes.into_iter().map(case).collect();
    // A size that lies leads into the middle of other bytes.
    for size in [
        &b"00000000000\0"[..],
        b"00000000007\0",
        b"00000002000\0",
        b"77777777777\0",
        b"\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff",
    ] {
        cases.push((format!("the size {}", size.escape_ascii()), with(|entry| entry.size = Some(size.to_vec())), ""));
    }
    cases
}

fn wholes() -> Vec<Case> {
    let files = small_files();
    let (honest, entries) = (small(), small_entries());
    let order = |indices: &[usize]| tar(&indices.iter().map(|index| entries[*index].clone()).collect::<Vec<_>>());
    let mut cases: Vec<Case> = [
        ("nothing", Vec::new(), "E-PACK-FORM"),
        ("an empty tar", vec![0; 1024], "E-PACK-MANIFEST"),
        ("zeros", vec![0; 100 * 512], "E-PACK-FORM"),
        ("noise", (0..5000_u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8).collect(), "E-PACK-FORM"),
        ("gzip", [b"\x1f\x8b\x08\0", &honest[..]].concat(), "E-PACK-FORM"),
        ("zstd", [b"\x28\xb5\x2f\xfd", &honest[..]].concat(), "E-PACK-FORM"),
        ("zip", b"PK\x03\x04 and so on".to_vec(), "E-PACK-FORM"),
        ("two packs", [&honest[..], &honest[..]].concat(), "E-PACK-FORM"),
        ("bytes after the end", [&honest[..], b"evil"].concat(), "E-PACK-FORM"),
        ("a block after the end", [&honest[..], &[0; 512]].concat(), "E-PACK-FORM"),
        ("one end block", honest[..honest.len() - 512].to_vec(), "E-PACK-FORM"),
        ("no end", honest[..honest.len() - 1024].to_vec(), "E-PACK-FORM"),
        ("two manifests", order(&[0, 0, 1, 2, 3]), "E-PACK-ENTRY"),
        ("a second manifest last", order(&[0, 1, 2, 3, 0]), "E-PACK-ENTRY"),
        ("a file twice", order(&[0, 1, 1, 2, 3]), "E-PACK-ENTRY"),
        ("out of order", order(&[0, 2, 1, 3]), "E-PACK-FORM"),
        ("the manifest last", order(&[1, 2, 3, 0]), "E-PACK-FORM"),
        ("no manifest", order(&[1, 2, 3]), "E-PACK-FORM"),
        ("a file that is not listed", pack_with_extra(), "E-PACK-LIST"),
        ("a listed file that is missing", order(&[0, 1, 2]), "E-PACK-LIST"),
        ("only the manifest", order(&[0]), "E-PACK-LIST"),
        (
            "a program under another name",
            pack_of(HEAD, &[("readme.md", b"\x7fELF"), files[1], files[2]]),
            "E-PACK-CAPABILITY",
        ),
        (
            "WebAssembly under another name",
            pack_of(HEAD, &[("readme.md", b"\0asm"), files[1], files[2]]),
            "E-PACK-CAPABILITY",
        ),
        (
            "WebAssembly that is not asked for",
            pack_of(HEAD, &[("a.wasm", b"\0asm"), files[1], files[2]]),
            "E-PACK-CAPABILITY",
        ),
        (
            "a native filter that is not asked for",
            pack_of(HEAD, &[("a.so", b"\x7fELF"), files[1], files[2]]),
            "E-PACK-CAPABILITY",
        ),
        ("too many files", tar(&many(2000)), "E-PACK-LIMIT"),
        ("a bomb", vec![0; (64 << 20) + 512], "E-PACK-LIMIT"),
    ]
    .into_iter()
    .map(|(what, bytes, code)| (what.to_owned(), bytes, code))
    .collect();
    let mut other = entries.clone();
    other[1].data = b"# smaLl\n".to_vec();
    cases.push(("a file that was changed".to_owned(), tar(&other), "E-TRUST-DIGEST"));
    let big = manifest(&format!("{HEAD}# {}", "x".repeat(600 << 10)), &files);
    let big = [&[Forged::new("manifest.toml", big.as_bytes())], &entries[1..]].concat();
    cases.push(("a manifest that is too large".to_owned(), tar(&big), "E-PACK-LIMIT"));
    cases
}

fn pack_with_extra() -> Vec<u8> {
    let mut entries = small_entries();
    entries.insert(1, Forged::new("extra.txt", b"here I am"));
    tar(&entries)
}

fn many(count: usize) -> Vec<Forged> {
    let files = (0..count).map(|index| Forged::new(&format!("f{index:06}.txt"), b""));
    [Forged::new("manifest.toml", manifest(HEAD, &small_files()).as_bytes())].into_iter().chain(files).collect()
}

/// Manifests that lie or ask for too much, in archives that are in order.
fn manifests() -> Vec<Case> {
    let long = Digest::of(b"").to_string();
    let change = |from: &str, to: &str| HEAD.replace(from, to);
    let heads = [
        ("no name", change("name = \"eve/small\"", ""), "E-PACK-MANIFEST"),
        ("a name without an owner", change("eve/small", "small"), "E-PACK-MANIFEST"),
        ("a name in Cyrillic", change("eve/small", "eve/sm\u{430}ll"), "E-PACK-MANIFEST"),
        ("a name with an escape", change("eve/small", "eve/\\u001b[2J"), "E-PACK-MANIFEST"),
        ("a version that is none", change("1.0.0", "1.0"), "E-PACK-MANIFEST"),
        ("a version with an escape", change("1.0.0", "1.0.0\\u001b"), "E-PACK-MANIFEST"),
        ("a newer format", change("format = 1", "format = 3"), "E-PACK-FORMAT"),
        ("a misspelt key", change("license", "licence"), "E-PACK-MANIFEST"),
        ("an unknown capability", format!("{HEAD}\n[capabilities]\nnetwork = true\n"), "E-PACK-MANIFEST"),
        (
            "a capability for nothing",
            format!("{HEAD}\n[capabilities]\nfilters_wasm = [\"a.wasm\"]\n"),
            "E-PACK-CAPABILITY",
        ),
        ("a hook", format!("{HEAD}\n[install]\nrun = \"evil\"\n"), "E-PACK-MANIFEST"),
        ("an algorithm of its own", format!("signature = \"none\"\n{HEAD}"), "E-PACK-MANIFEST"),
        ("a script outside", change("scripts/short.rhai", "../x.rhai"), "E-PACK-MANIFEST"),
        ("a script that is not there", change("scripts/short.rhai", "scripts/long.rhai"), "E-PACK-LIST"),
        ("a script that is none", change("scripts/short.rhai", "readme.md"), "E-PACK-MANIFEST"),
        ("a policy of another form", format!("{HEAD}policy = \"policy.safetensors\"\n"), "E-PACK-MANIFEST"),
        ("a policy that is a page", format!("{HEAD}policy = \"readme.md\"\n"), "E-PACK-MANIFEST"),
        (
            "itself as a dependency",
            format!("{HEAD}\n[[depends]]\nname = \"eve/small\"\nversion = \"1\"\n"),
            "E-PACK-MANIFEST",
        ),
        (
            "the manifest in its list",
            format!("{HEAD}\n[[file]]\npath = \"manifest.toml\"\nsize = 0\nsha256 = \"{long}\"\n"),
            "E-PACK-MANIFEST",
        ),
        ("no text", "\u{feff}\0".to_owned(), "E-PACK-MANIFEST"),
        ("deep brackets", format!("x = {}", "[".repeat(20_000)), "E-PACK-MANIFEST"),
        ("a description of many lines", change("a small pack", "a\\nb"), "E-PACK-MANIFEST"),
        ("a description that hides", change("a small pack", "a \u{202e}pack"), "E-PACK-MANIFEST"),
    ];
    let mut cases: Vec<Case> =
        heads.into_iter().map(|(what, head, code)| (what.to_owned(), pack_of(&head, &small_files()), code)).collect();
    let honest = manifest(HEAD, &small_files());
    let digest = Digest::of(b"# small\n").to_string();
    for (what, text) in [
        ("a digest in capitals", honest.replace(&digest, &digest.to_uppercase())),
        ("a short digest", honest.replace(&digest, &digest[..12])),
        ("no digest", honest.replace(&digest, "none")),
    ] {
        let mut entries = small_entries();
        entries[0].data = text.into_bytes();
        cases.push((what.to_owned(), tar(&entries), "E-PACK-MANIFEST"));
    }
    let mut entries = small_entries();
    entries[0].data = honest.replace(&digest, &Digest::of(b"other").to_string()).into_bytes();
    cases.push(("a digest of something else".to_owned(), tar(&entries), "E-TRUST-DIGEST"));
    cases
}

pub(super) fn all() -> Vec<Case> {
    [names(), kinds(), fields(), wholes(), manifests()].concat()
}

#[test]
fn the_small_pack_that_is_forged_is_honest() {
    assert_eq!(Pack::parse(Path::new("small.pack"), small()).unwrap().title(), "eve/small 1.0.0");
}

#[test]
fn every_hostile_archive_is_refused_with_its_error() {
    let cases = all();
    assert!(cases.len() >= 120, "{}", cases.len());
    for (what, bytes, code) in cases {
        let error = Pack::parse(Path::new("hostile.pack"), bytes).expect_err(&what);
        assert!(code.is_empty() || error.code == code, "{what}: {} instead of {code}", error.render(false));
        let shown = error.render(false);
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{what}: {}", shown.escape_debug());
    }
}

/// Every file below a folder with its digest.
fn census(folder: &Path) -> Vec<String> {
    let mut lines = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            lines.push(path.display().to_string());
            lines.extend(census(&path));
        } else {
            lines.push(format!("{} {}", path.display(), Digest::of(&std::fs::read(&path).unwrap())));
        }
    }
    lines.sort();
    lines
}

#[test]
fn no_command_writes_anything_for_a_hostile_archive() {
    let bench = Bench::new();
    bench.write("canary/secret.txt", "do not touch");
    for (index, (what, bytes, _)) in all().into_iter().enumerate() {
        let name = format!("hostile-{index}.pack");
        bench.write(&name, &bytes);
        let before = census(bench.path());
        for command in [&["install", "--allow-unsigned"][..], &["inspect"], &["verify", "--allow-unsigned"]] {
            let output = bench.engine(&[&["pack"], command, &[&name]].concat());
            let text = told(&output);
            assert!(matches!(output.status.code(), Some(3 | 5)), "{what}: {text}");
        }
        assert_eq!(census(bench.path()), before, "{what}");
        std::fs::remove_file(bench.path().join(name)).unwrap();
    }
}
