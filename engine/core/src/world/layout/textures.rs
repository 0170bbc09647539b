//! The textures of a world file.

use super::build::{Builder, error};
use super::reader::FileRow;
use crate::world::scene::{Texture, Tiling};

impl Builder<'_> {
    /// What a table `texture` says.
    pub(super) fn texture(&mut self, row: &FileRow) -> Texture {
        let own = Tiling::default();
        let number = |key: &str, default: f64| row.number(key).unwrap_or(default);
        let tiling = Tiling {
            amplitude: number("amplitude", own.amplitude),
            scale_m: number("scale_m", own.scale_m),
            joint_m: number("joint_m", own.joint_m),
            joint: number("joint", own.joint),
        };
        let kind = row.text("kind").unwrap_or("plain");
        if !matches!(kind, "tiles" | "bricks")
            && let Some(key) = ["joint_m", "joint"].into_iter().find(|key| row.has(key))
        {
            let wrong = error("E-WORLD-KEY", format!("a texture of the kind \"{kind}\" has no joints"))
                .at(self.source, row.span_of(key), "not of this kind")
                .help(format!("take '{key}' out, or write kind = \"tiles\" or \"bricks\""));
            self.mistakes.add(wrong);
        }
        Texture::of_kind(kind, tiling)
    }
}
