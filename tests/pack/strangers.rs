use std::path::Path;

use pack::Pack;

use super::{archives, mutants, needs, trust};

/// Where a kind of attack is refused.
enum Shown {
    /// By archives of `archives.rs`, by their names there, each with this code; any code of packs if it is empty.
    Archives(&'static [&'static str], &'static str),
    /// By a test of its own, which runs beside this one: naming it here only keeps it from being lost.
    Test(#[expect(dead_code, reason = "it runs by itself")] fn()),
    /// Nowhere, since packs have no place for it; the nearest that there is stands in the next line.
    NoPlace,
}

use Shown::{Archives, NoPlace, Test};

/// The forty attacks of a stranger who gives away a pack, by number. A number may take several lines.
const ATTACKS: &[(&str, &str, Shown)] = &[
    ("P01", "a name that climbs out", Archives(&["name ../evil.txt", "name a/../../evil.txt"], "E-PACK-ENTRY")),
    ("P02", "an absolute name", Archives(&["name /etc/evil.txt", "name //evil.txt"], "E-PACK-ENTRY")),
    ("P03", "a symbolic link", Archives(&["kind 2"], "E-PACK-ENTRY")),
    ("P04", "a link, then a file through it", Archives(&["a link, then a file through it"], "E-PACK-ENTRY")),
    ("P05", "a hard link", Archives(&["kind 1"], "E-PACK-ENTRY")),
    ("P06", "devices and a pipe", Archives(&["kind 3", "kind 4", "kind 6"], "E-PACK-ENTRY")),
    ("P07", "permission to run as another", Archives(&["setuid"], "E-PACK-ENTRY")),
    ("P08", "two manifests", Archives(&["two manifests", "a second manifest last"], "E-PACK-ENTRY")),
    ("P09", "names that differ in case", Archives(&["name A.txt"], "E-PACK-ENTRY")),
    (
        "P10",
        "names that Windows takes for something else",
        Archives(&["name con.txt", "name a.", "name x:y.txt", "name ..\\\\evil.txt"], "E-PACK-ENTRY"),
    ),
    ("P11", "names that a terminal obeys", Archives(&["name a\\x1b[2J.txt", "name a\\n.txt"], "E-PACK-ENTRY")),
    ("P12", "240 folders deep: a name has 100 bytes: 45 folders are the deepest that can be tried", NoPlace),
    ("P12", "45 folders deep", Archives(&[DEEP], "E-PACK-ENTRY")),
    ("P13", "a name that is a folder itself", Archives(&["name .", "name .."], "E-PACK-ENTRY")),
    ("P14", "a small file that unpacks to a large one: packs are not compressed, so nothing grows", NoPlace),
    ("P14", "compressed all the same", Archives(&["gzip", "zstd", "zip"], "E-PACK-FORM")),
    ("P14", "large without compression", Archives(&["a bomb"], "E-PACK-LIMIT")),
    ("P15", "a pack in a pack", Archives(&["name inner.pack"], "E-PACK-ENTRY")),
    ("P15", "a pack after a pack", Archives(&["two packs"], "E-PACK-FORM")),
    ("P16", "very many empty files", Archives(&["too many files"], "E-PACK-LIMIT")),
    (
        "P17",
        "sizes that lie, both ways",
        Archives(&["the size 00000000007\\x00", "the size 00000002000\\x00", "the size 77777777777\\x00"], ""),
    ),
    ("P18", "an extension header with another size", Archives(&["kind x", "kind g"], "E-PACK-ENTRY")),
    ("P18", "a size in two forms", Archives(&["a size in binary", "a size of 2^63"], "E-PACK-FORM")),
    ("P19", "bytes after the end", Archives(&["bytes after the end", "a block after the end"], "E-PACK-FORM")),
    ("P20", "cut off anywhere", Test(mutants::every_truncation_is_refused)),
    ("P21", "a file that the manifest does not list", Archives(&["a file that is not listed"], "E-PACK-LIST")),
    ("P22", "no manifest", Archives(&["no manifest"], "E-PACK-FORM")),
    ("P22", "no manifest, nor anything else", Archives(&["an empty tar"], "E-PACK-MANIFEST")),
    ("P22", "a listed file that is not there", Archives(&["a listed file that is missing"], "E-PACK-LIST")),
    ("P23", "a wrong digest", Archives(&["a digest of something else", "a file that was changed"], "E-TRUST-DIGEST")),
    ("P24", "no signature", Test(trust::an_unsigned_pack_is_refused_unless_that_is_said)),
    ("P25", "a signature by an unknown key", Test(trust::unknown_foreign_changed_and_revoked_keys_are_refused)),
    ("P26", "a good signature of another pack", Test(trust::the_signature_of_another_pack_does_not_fit)),
    ("P27", "an expired key: keys of minisign do not expire; they are revoked", NoPlace),
    ("P27", "a revoked key", Test(trust::unknown_foreign_changed_and_revoked_keys_are_refused)),
    ("P28", "the algorithm 'none' in the manifest", Archives(&["an algorithm of its own"], "E-PACK-MANIFEST")),
    ("P28", "the algorithm 'none' in the signature", Test(trust::the_signature_of_another_pack_does_not_fit)),
    (
        "P29",
        "digests in another form",
        Archives(&["a digest in capitals", "a short digest", "no digest"], "E-PACK-MANIFEST"),
    ),
    ("P30", "another digest than the locked one", Test(trust::what_is_installed_is_checked_again_before_it_runs)),
    ("P31", "a newer format", Archives(&["a newer format"], "E-PACK-FORMAT")),
    ("P32", "a newer engine is needed", Test(trust::a_pack_for_another_engine_is_refused_before_it_is_installed)),
    (
        "P33",
        "code that is not asked for",
        Archives(
            &[
                "WebAssembly that is not asked for",
                "a native filter that is not asked for",
                "a program under another name",
            ],
            "E-PACK-CAPABILITY",
        ),
    ),
    (
        "P34",
        "something new that is asked for",
        Test(trust::something_new_that_is_asked_for_is_granted_by_name_or_refused),
    ),
    ("P35", "an older version", Test(trust::a_changed_key_an_older_version_and_another_build_are_hard_stops)),
    ("P36", "a name that looks like another", Test(trust::a_name_that_looks_like_another_is_warned_of)),
    ("P36", "a name in letters that look like others", Archives(&["a name in Cyrillic"], "E-PACK-MANIFEST")),
    ("P37", "packs that build on one another", Test(needs::circles_and_missing_versions_are_errors)),
    ("P37", "a pack that builds on itself", Archives(&["itself as a dependency"], "E-PACK-MANIFEST")),
    ("P38", "a policy of another shape", Test(trust::a_policy_of_another_shape_is_the_authors_mistake)),
    ("P39", "a model file with a header of 2^63 bytes: policies are text; no model file is ever read", NoPlace),
    ("P39", "any model file", Archives(&["name model.safetensors"], "E-PACK-ENTRY")),
    ("P40", "another form under a model file's name: policies are text; no model file is ever read", NoPlace),
    (
        "P40",
        "another form as the policy",
        Archives(&["a policy of another form", "a policy that is a page"], "E-PACK-MANIFEST"),
    ),
];

/// A name of 95 bytes with 45 folders.
const DEEP: &str =
    "name d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/d/x.txt";

#[test]
fn each_of_the_forty_attacks_is_refused_or_has_no_place() {
    let cases = archives::all();
    for (number, what, shown) in ATTACKS {
        let Archives(names, code) = shown else { continue };
        assert!(!names.is_empty(), "{number}");
        for name in *names {
            let mut found = cases.iter().filter(|(own, ..)| own == name);
            let (_, bytes, _) = found.next().unwrap_or_else(|| panic!("{number} {what}: there is no archive '{name}'"));
            let error = Pack::parse(Path::new("hostile.pack"), bytes.clone()).expect_err(name);
            let fits = if code.is_empty() { error.code.starts_with("E-PACK-") } else { error.code == *code };
            assert!(fits, "{number} {what}: {}", error.render(false));
        }
    }
}

#[test]
fn no_attack_is_forgotten() {
    let mut numbers: Vec<&str> = ATTACKS.iter().map(|(number, ..)| *number).collect();
    assert!(numbers.is_sorted());
    numbers.dedup();
    assert_eq!(numbers, (1..=40).map(|number| format!("P{number:02}")).collect::<Vec<_>>());
    for number in numbers {
        let own: Vec<_> = ATTACKS.iter().filter(|(own, ..)| *own == number).collect();
        let refused = own.iter().filter(|(_, _, shown)| !matches!(shown, NoPlace)).count();
        assert!(refused > 0, "{number} is only said to have no place");
    }
}
