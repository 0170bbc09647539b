//! Writes the corpus that the fuzzers begin from: `corpus/TARGET/`.

#![allow(dead_code, reason = "it writes what the targets begin from")]

mod targets;

use std::path::Path;

fn main() -> std::io::Result<()> {
    for (name, _) in targets::TARGETS {
        let folder = Path::new("corpus").join(name);
        std::fs::create_dir_all(&folder)?;
        for (number, bytes) in targets::corpus(name).iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number}")), bytes)?;
        }
    }
    Ok(())
}
