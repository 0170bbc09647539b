//! Damaged files, the same ones in every run.

use engine::random::Random;

/// Changes a few bytes: half of the time in place only, so that many keep their form, or else also removed, put in or
/// repeated from elsewhere. Nothing comes of nothing.
pub(crate) fn mutate(random: &mut Random, bytes: &mut Vec<u8>) {
    let ways = if random.below(2) == 0 { 2 } else { 5 };
    for _ in 0..1 + random.below(ways) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len() as u32) as usize;
        match random.below(ways) {
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..(at + 1 + random.below(8) as usize).min(bytes.len()))),
            3 => bytes.insert(at, random.below(256) as u8),
            _ => {
                let end = (at + 1 + random.below(16) as usize).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len() as u32) as usize;
                bytes.splice(to..to, piece);
            }
        }
    }
}
