//! What makes two engines the same for evidence: not their version, but what they do.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::Digest;
use engine::diagnostic::{Result, SourceText};
use engine::experiment::{Plan, learn, test};
use engine::filter::Catalogue;
use engine::script::Behaviour;
use engine::world::Layout;

/// A short run that touches every part: walls, texture, lag and noise, laser, filter, rules, recovery and learner.
const SCRIPT: &str = r#"
filter("sobel", #{ threshold: 60 });
run(#{ steps: 400, test_steps: 200 });
camera(#{ noise: 3 });
laser(#{ noise_m: 0.01 });
rule "near" when laser.nearest <= 0.25 => -1 then recover;
rule "contact" when robot.contact => -1 then recover;
rule "lost" when laser.right > 1.0 for 5 seconds => -1;
"#;
const WORLD: &str = include_str!("../../../worlds/room-textured.toml");

/// The digest of what this engine does in a short run that is part of it. Two engines with the same fingerprint learn the
/// same from the same pack, as far as a probe can tell; another fingerprint explains why a replay differs.
///
/// # Errors
/// Never in practice: only if the built-in run fails.
pub fn fingerprint() -> Result<Digest> {
    let behaviour = Arc::new(Behaviour::parse("probe", SourceText::new("probe.rhai", SCRIPT))?);
    let settings = behaviour.settings().clone();
    let layout = Arc::new(Layout::parse(SourceText::new("probe.toml", WORLD), &settings.robot.body)?);
    let plan = Plan::with_layout(behaviour, settings, layout, Arc::new(Catalogue::linked_in()))?;
    let never = AtomicBool::new(false);
    let learned = learn(&plan, 1, &never, &|_| ())?;
    let tested = test(&plan, &learned.policy, 1, &never)?;
    Ok(Digest::of(format!("{} {}", learned.state_hash, tested.state_hash).as_bytes()))
}
