//! The tar of a pack, in the one form that `write` gives it.
//!
//! [`read`] names the known tricks (links, devices, twins, `..`) with an error of their own. What is left is caught by
//! one rule: the entries, written again, must give the same bytes. No reader can then see something else than another.

use std::io::{self, Write};
use std::ops::Range;

use tar::{Builder, EntryType, Header};

use super::entry_path::EntryPath;
use super::{MAX_FILES, MAX_PACK_BYTES, malformed};
use engine::diagnostic::{Diagnostic, Result, printable};

/// The unit of a tar, bytes.
const BLOCK: usize = 512;
/// The permission bits of every file.
const MODE: u32 = 0o644;
/// Beginnings of files that are not a tar, and what they are.
const OTHER_FORMS: [(&[u8], &str); 6] = [
    (b"\x1f\x8b", "compressed with gzip"),
    (b"\x28\xb5\x2f\xfd", "compressed with zstd"),
    (b"BZh", "compressed with bzip2"),
    (b"\xfd7zXZ", "compressed with xz"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x7fELF", "a program"),
];

/// One file of a pack: its name, and where its bytes stand in the tar.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArchiveEntry {
    /// The name.
    pub path: EntryPath,
    /// Its bytes' place in the tar.
    pub range: Range<usize>,
}

/// Writes files as a tar in the one form: regular files, mode 644, no owner, no time.
///
/// # Errors
/// If `out` fails, or a name is longer than 100 bytes.
pub fn write<'a>(files: impl IntoIterator<Item = (&'a str, &'a [u8])>, out: impl Write) -> io::Result<()> {
    let mut builder = Builder::new(out);
    for (path, bytes) in files {
        let mut header = Header::new_ustar();
        header.set_path(path)?;
        header.set_entry_type(EntryType::Regular);
        header.set_mode(MODE);
        header.set_uid(0);
        header.set_gid(0);
        header.set_mtime(0);
        header.set_size(bytes.len() as u64);
        header.set_cksum();
        builder.append(&header, bytes)?;
    }
    builder.finish()
}

/// Reads the entries of a tar in the one form; nothing is copied.
///
/// # Errors
/// `E-PACK-LIMIT`, `E-PACK-FORM` or `E-PACK-ENTRY`; nothing is ever skipped.
pub fn read(bytes: &[u8]) -> Result<Vec<ArchiveEntry>> {
    if bytes.len() > MAX_PACK_BYTES {
        let message = format!("the pack has {} bytes, more than the limit of {MAX_PACK_BYTES}", bytes.len());
        return malformed("E-PACK-LIMIT", message).fail();
    }
    if let Some((_, form)) = OTHER_FORMS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return form_error(format!("the file is {form}; a pack is a plain tar")).fail();
    }
    let mut entries: Vec<ArchiveEntry> = Vec::new();
    let mut offset = 0;
    loop {
        let Some(block) = bytes.get(offset..offset + BLOCK) else {
            return form_error(format!("the pack is cut off after {} bytes", bytes.len())).fail();
        };
        offset += BLOCK;
        if block.iter().all(|byte| *byte == 0) {
            break;
        }
        if entries.len() == MAX_FILES {
            let message = format!("the pack has more than {MAX_FILES} files");
            return malformed("E-PACK-LIMIT", message).fail();
        }
        let entry = entry(bytes, offset, Header::from_byte_slice(block))?;
        check_order(entries.last(), &entry.path)?;
        offset = entry.range.end.next_multiple_of(BLOCK);
        entries.push(entry);
    }
    check_end(bytes, offset)?;
    check_form(bytes, &entries)?;
    Ok(entries)
}

fn entry(bytes: &[u8], offset: usize, header: &Header) -> Result<ArchiveEntry> {
    if header.as_ustar().is_none() {
        return form_error("the file is not a tar of the form that 'engine pack build' writes").fail();
    }
    let name = header.path_bytes();
    let name = String::from_utf8_lossy(&name);
    let wrong = |what: &str| {
        let message = format!("the pack holds '{}', which {what}", printable(&name));
        malformed("E-PACK-ENTRY", message).help("do not use this pack; tell its author if you know them")
    };
    if let Some(what) = forbidden(header.entry_type()) {
        return wrong(what).fail();
    }
    let path = EntryPath::new(&name).map_err(|what| Box::new(wrong(&what)))?;
    let mode = header.mode().map_err(|_| Box::new(wrong("has unreadable permission bits")))?;
    if mode != MODE {
        return wrong(&format!("has the permission bits {mode:o}; every file of a pack has 644")).fail();
    }
    let size = header.entry_size().map_err(|_| Box::new(wrong("has an unreadable size")))?;
    let range = usize::try_from(size).ok().and_then(|size| Some(offset..offset.checked_add(size)?));
    match range {
        Some(range) if range.end <= bytes.len() => Ok(ArchiveEntry { path, range }),
        _ => form_error(format!("the pack is cut off in '{path}', which should have {size} bytes")).fail(),
    }
}

/// What is wrong with anything but a regular file.
fn forbidden(kind: EntryType) -> Option<&'static str> {
    Some(match kind {
        EntryType::Regular => return None,
        EntryType::Link => "is a hard link",
        EntryType::Symlink => "is a symbolic link",
        EntryType::Char | EntryType::Block => "is a device",
        EntryType::Fifo => "is a pipe",
        EntryType::Directory => "is a folder; a pack lists files only",
        EntryType::GNULongName | EntryType::GNULongLink | EntryType::GNUSparse => "is an extension of GNU tar",
        EntryType::XHeader | EntryType::XGlobalHeader => "is an extension header (PAX)",
        _ => "is no regular file",
    })
}

/// The manifest stands first, the others follow in the order of their names, each once.
fn check_order(last: Option<&ArchiveEntry>, path: &EntryPath) -> Result<()> {
    let is_manifest = path.as_str() == super::manifest::FILE;
    match last {
        None if is_manifest => Ok(()),
        None => form_error(format!("the pack starts with '{path}' instead of '{}'", super::manifest::FILE)).fail(),
        Some(last) if last.path == *path || is_manifest => {
            malformed("E-PACK-ENTRY", format!("the pack holds '{path}' twice")).fail()
        }
        Some(last) if last.path.as_str() != super::manifest::FILE && last.path > *path => {
            form_error(format!("'{path}' stands after '{}': out of order", last.path)).fail()
        }
        Some(_) => Ok(()),
    }
}

/// After the first empty block comes a second one, and nothing else.
fn check_end(bytes: &[u8], offset: usize) -> Result<()> {
    let rest = &bytes[offset..];
    if rest.len() < BLOCK {
        return form_error(format!("the pack is cut off after {} bytes", bytes.len())).fail();
    }
    if rest.len() > BLOCK {
        return form_error(format!("the pack has {} bytes after its end", rest.len() - BLOCK)).fail();
    }
    Ok(())
}

/// The rule that holds for every byte: written again, the entries give this tar.
fn check_form(bytes: &[u8], entries: &[ArchiveEntry]) -> Result<()> {
    let mut comparing = Comparing { bytes, offset: 0 };
    let files = entries.iter().map(|entry| (entry.path.as_str(), &bytes[entry.range.clone()]));
    let same = write(files, &mut comparing);
    if same.is_ok() && comparing.offset == bytes.len() {
        return Ok(());
    }
    form_error(format!("the pack is not in the one form of packs: byte {} differs", comparing.offset)).fail()
}

/// Takes the bytes that are expected, and stops at the first that is not.
struct Comparing<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl Write for Comparing<'_> {
    fn write(&mut self, part: &[u8]) -> io::Result<usize> {
        let rest = &self.bytes[self.offset..];
        let same =
            if rest.starts_with(part) { part.len() } else { rest.iter().zip(part).take_while(|(a, b)| a == b).count() };
        self.offset += same;
        if same < part.len() { Err(io::ErrorKind::InvalidData.into()) } else { Ok(same) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn form_error(message: impl Into<String>) -> Diagnostic {
    malformed("E-PACK-FORM", message).help("get the pack again; a pack is made with: engine pack build FOLDER")
}
