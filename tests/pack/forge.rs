use pack::Digest;

use crate::support::{SCRIPT, WORLD};

/// One entry of a tar, with every field open to lies.
#[derive(Clone)]
pub(crate) struct Forged {
    pub(crate) name: Vec<u8>,
    pub(crate) data: Vec<u8>,
    pub(crate) kind: u8,
    pub(crate) mode: Vec<u8>,
    pub(crate) uid: Vec<u8>,
    pub(crate) gid: Vec<u8>,
    pub(crate) mtime: Vec<u8>,
    pub(crate) size: Option<Vec<u8>>,
    pub(crate) link: Vec<u8>,
    pub(crate) magic: Vec<u8>,
    pub(crate) owner: Vec<u8>,
    pub(crate) device: Vec<u8>,
    pub(crate) prefix: Vec<u8>,
    pub(crate) padding: u8,
    pub(crate) checksum_error: u32,
}

impl Forged {
    pub(crate) fn new(name: &str, data: &[u8]) -> Self {
        Self {
            name: name.as_bytes().to_vec(),
            data: data.to_vec(),
            kind: b'0',
            mode: b"0000644\0".to_vec(),
            uid: b"0000000\0".to_vec(),
            gid: b"0000000\0".to_vec(),
            mtime: b"00000000000\0".to_vec(),
            size: None,
            link: Vec::new(),
            magic: b"ustar\x0000".to_vec(),
            owner: Vec::new(),
            device: Vec::new(),
            prefix: Vec::new(),
            padding: 0,
            checksum_error: 0,
        }
    }

    fn write(&self, out: &mut Vec<u8>) {
        let mut block = [0_u8; 512];
        let mut put = |offset: usize, room: usize, bytes: &[u8]| {
            let length = bytes.len().min(room);
            block[offset..offset + length].copy_from_slice(&bytes[..length]);
        };
        put(0, 100, &self.name);
        put(100, 8, &self.mode);
        put(108, 8, &self.uid);
        put(116, 8, &self.gid);
        let size = format!("{:011o}\0", self.data.len());
        put(124, 12, self.size.as_deref().unwrap_or(size.as_bytes()));
        put(136, 12, &self.mtime);
        put(148, 8, b"        ");
        put(156, 1, &[self.kind]);
        put(157, 100, &self.link);
        put(257, 8, &self.magic);
        put(265, 32, &self.owner);
        put(329, 8, &self.device);
        put(345, 155, &self.prefix);
        let sum: u32 = block.iter().map(|byte| u32::from(*byte)).sum::<u32>() + self.checksum_error;
        block[148..156].copy_from_slice(format!("{sum:07o}\0").as_bytes());
        out.extend_from_slice(&block);
        out.extend_from_slice(&self.data);
        out.resize(out.len().next_multiple_of(512), self.padding);
    }
}

/// The entries as a tar, with its end.
pub(crate) fn tar(entries: &[Forged]) -> Vec<u8> {
    let mut out = Vec::new();
    entries.iter().for_each(|entry| entry.write(&mut out));
    out.resize(out.len() + 1024, 0);
    out
}

/// The head of a manifest; `[[file]]` lines follow.
pub(crate) const HEAD: &str = r#"format = 1
name = "eve/small"
version = "1.0.0"
engine = ">=0.1"
license = "MIT"
description = "a small pack"

[entry]
script = "scripts/short.rhai"
"#;

/// A manifest that lists these files.
pub(crate) fn manifest(head: &str, files: &[(&str, &[u8])]) -> String {
    let mut text = head.to_owned();
    for (path, bytes) in files {
        text += &format!("\n[[file]]\npath = \"{path}\"\nsize = {}\nsha256 = \"{}\"\n", bytes.len(), Digest::of(bytes));
    }
    text
}

/// An honest pack of these files.
pub(crate) fn pack_of(head: &str, files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut entries = vec![Forged::new("manifest.toml", manifest(head, files).as_bytes())];
    entries.extend(files.iter().map(|(path, bytes)| Forged::new(path, bytes)));
    tar(&entries)
}

/// The files of the small pack.
pub(crate) fn small_files() -> Vec<(&'static str, &'static [u8])> {
    vec![
        ("readme.md", b"# small\n"),
        ("scripts/short.rhai", SCRIPT.as_bytes()),
        ("worlds/small.toml", WORLD.as_bytes()),
    ]
}

/// An honest small pack: it reads, and it runs.
pub(crate) fn small() -> Vec<u8> {
    pack_of(HEAD, &small_files())
}

/// Its entries, to be forged.
pub(crate) fn small_entries() -> Vec<Forged> {
    let files = small_files();
    let mut entries = vec![Forged::new("manifest.toml", manifest(HEAD, &files).as_bytes())];
    entries.extend(files.iter().map(|(path, bytes)| Forged::new(path, bytes)));
    entries
}
