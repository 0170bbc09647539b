//! The textures of a world file.

use super::build::{Builder, error};
use super::reader::FileRow;
use crate::world::scene::{Texture, Tiling};

impl Builder<'_> {
    /// What a table `texture` says.
    pub(super) fn texture(&mut self, row: &FileRow) -> Texture {
        let (amplitude, scale_m) = (row.number("amplitude").unwrap_or(10.0), row.number("scale_m").unwrap_or(0.2));
        let (joint_m, joint) = (row.number("joint_m").unwrap_or(0.012), row.number("joint").unwrap_or(40.0));
        let tiling = Tiling { amplitude, scale_m, joint_m, joint };
        let kind = row.text("kind").unwrap_or("plain");
        if !matches!(kind, "tiles" | "bricks")
            && let Some(key) = ["joint_m", "joint"].into_iter().find(|key| row.has(key))
        {
            let wrong = error("E-WORLD-KEY", format!("a texture of the kind \"{kind}\" has no joints"))
                .at(self.source, row.span_of(key), "not of this kind")
                .help(format!("take '{key}' out, or write kind = \"tiles\" or \"bricks\""));
            self.mistakes.add(wrong);
        }
        match kind {
            "checker" => Texture::Checker { amplitude, scale_m },
            "stripes" => Texture::Stripes { amplitude, scale_m },
            "noise" => Texture::Noise { amplitude, scale_m },
            "tiles" => Texture::Tiles(tiling),
            "bricks" => Texture::Bricks(tiling),
            _ => Texture::Plain,
        }
    }
}
