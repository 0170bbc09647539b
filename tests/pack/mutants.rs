use std::path::Path;

use engine::random::{Random, Stream};
use pack::{Pack, Password, Signature, TrustStore, key_line, new_keys, sign};

use super::forge::{small, small_entries, tar};

fn read(bytes: Vec<u8>) -> Result<Pack, &'static str> {
    Pack::parse(Path::new("small.pack"), bytes).map_err(|error| error.code)
}

/// A small signed pack, and who trusts its key.
fn signed() -> (Pack, Signature, TrustStore) {
    let pack = read(small()).unwrap();
    let [secret, public] = new_keys(Password::None).unwrap();
    let signature = sign(&pack, &secret, Password::None).unwrap();
    let mut trust = TrustStore::default();
    trust.trust("eve", &key_line(&public).unwrap(), false).unwrap();
    trust.judge(&pack, Some(&signature), false).unwrap();
    (pack, signature, trust)
}

#[test]
fn every_flipped_byte_is_refused() {
    let honest = small();
    let (_, signature, trust) = signed();
    for index in 0..honest.len() {
        for mask in [0x01, 0x20, 0x80] {
            let mut bytes = honest.clone();
            bytes[index] ^= mask;
            // A manifest that still reads is another manifest: the signature refuses it.
            let refused = match read(bytes) {
                Err(code) => code,
                Ok(pack) => trust.judge(&pack, Some(&signature), false).unwrap_err().code,
            };
            assert!(refused.starts_with("E-PACK-") || refused.starts_with("E-TRUST-"), "byte {index}: {refused}");
        }
    }
}

#[test]
fn every_flipped_byte_of_a_signature_is_refused() {
    let (pack, signature, trust) = signed();
    let text = signature.text();
    // The first line is the one comment that nobody signs, in minisign too.
    let start = text.find('\n').unwrap();
    for index in start..text.len() - 1 {
        let mut bytes = text.as_bytes().to_vec();
        bytes[index] ^= 0x01;
        let Ok(text) = String::from_utf8(bytes) else { continue };
        let judged = Signature::parse(&text).and_then(|signature| trust.judge(&pack, Some(&signature), false));
        assert!(judged.is_err(), "byte {index}: {text}");
    }
}

#[test]
fn every_deleted_file_is_refused() {
    for index in 0..small_entries().len() {
        let mut entries = small_entries();
        entries.remove(index);
        assert!(matches!(read(tar(&entries)).unwrap_err(), "E-PACK-FORM" | "E-PACK-LIST"), "file {index}");
    }
}

#[test]
pub(super) fn every_truncation_is_refused() {
    let honest = small();
    for length in 0..honest.len() {
        let code = read(honest[..length].to_vec()).unwrap_err();
        assert!(matches!(code, "E-PACK-FORM"), "{length}: {code}");
    }
}

/// Changes a pack in one to four places: bytes, blocks, numbers, pieces moved or repeated.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut below = |bound: usize| random.below(bound as u32) as usize;
    for _ in 0..=below(4) {
        if bytes.is_empty() {
            return;
        }
        let index = below(bytes.len());
        match below(6) {
            0 => bytes[index] = below(256) as u8,
            1 => bytes[index] ^= 1 << below(8),
            2 => bytes.truncate(index.max(1)),
            3 => {
                let from = below(bytes.len() / 512 + 1) * 512;
                let piece: Vec<u8> = bytes.iter().skip(from).take(512).copied().collect();
                let to = below(bytes.len() / 512 + 1) * 512;
                bytes.splice(to.min(bytes.len())..to.min(bytes.len()), piece);
            }
            4 => {
                let from = below(bytes.len() / 512 + 1) * 512;
                bytes.drain(from.min(bytes.len())..(from + 512).min(bytes.len()));
                bytes.push(0);
            }
            _ => bytes[index] = b"0123456789/.\0\"[]="[below(17)],
        }
    }
}

#[test]
fn no_mutant_is_accepted_as_the_pack_that_was_signed() {
    let (honest, signature, trust) = signed();
    let mut random = Random::new(1, Stream::Test);
    for round in 0..20_000 {
        let mut bytes = honest.bytes().to_vec();
        mutate(&mut bytes, &mut random);
        let same = bytes == honest.bytes();
        if let Ok(pack) = read(bytes) {
            assert_eq!(trust.judge(&pack, Some(&signature), false).is_ok(), same, "round {round}");
        }
    }
}
