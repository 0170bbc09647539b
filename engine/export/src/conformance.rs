//! Frames of the run's own test with what the engine made of them, for a port to be held against.

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Phase, Plan, Playback};

use crate::model::Model;

/// Frames in the kit.
const FRAMES: usize = 50;
const MAGIC: &[u8; 8] = b"BEHAVE1\n";

/// The bytes of `conformance.bin`, and how many frames it has: of the test, evenly spread; one after the other from its
/// beginning if a view remembers its columns.
///
/// # Errors
/// If the test cannot be played again.
pub(crate) fn conformance(model: &Model, plan: &Plan, seed: u64, test: &Ledger) -> Result<(Vec<u8>, usize)> {
    let frames = FRAMES.min(test.len());
    if frames == 0 {
        let error = Diagnostic::new("E-EXPORT", "the run has no recorded steps of a test to check a port with");
        return error.help("run the behaviour again").fail();
    }
    let remembers = model.views.iter().any(|view| view.remembered_steps > 0);
    let step = |frame: usize| if remembers { frame } else { frame * test.len() / frames };
    let mut bytes = MAGIC.to_vec();
    let cells = model.views.iter().map(|view| view.least.len()).sum::<usize>();
    let digits = model.told().count();
    let head =
        [frames, model.size_px.0, model.size_px.1, model.channels, model.views.len().max(1), cells.max(1), digits];
    head.iter().for_each(|number| put(&mut bytes, *number));
    let mut playback = Playback::new(plan, seed, Phase::Test, test)?;
    let mut anew = true;
    for frame in 0..frames {
        playback.seek(step(frame))?;
        let holds = |guard: &usize| playback.cycle().guard_holds(*guard);
        let guards = (0..model.guards.len()).filter(holds).fold(0, |guards, guard| guards | 1_u32 << guard);
        put(&mut bytes, usize::from(anew));
        put(&mut bytes, guards as usize);
        one(model, &playback, guards, &mut bytes);
        // Only what is remembered goes on from frame to frame.
        anew = !remembers || playback.advance()?.is_some_and(|step| step.moves());
    }
    Ok((bytes, frames))
}

/// Image, digits, masks, counts, state, action.
fn one(model: &Model, playback: &Playback<'_>, guards: u32, bytes: &mut Vec<u8>) {
    let cycle = playback.cycle();
    let (pixels, state) = (model.size_px.0 * model.size_px.1, cycle.state());
    let image = &cycle.observation().image.pixels;
    bytes.extend(image.iter().copied().chain(std::iter::repeat(0)).take(pixels * model.channels));
    bytes.extend(model.digits_of(state));
    let seen: Vec<_> = cycle.views().collect();
    let own = model
        .views
        .iter()
        .map(|view| seen.iter().find(|seen| seen.name.as_deref() == Some(&view.name)).or(seen.first()));
    let own: Vec<_> = own.flatten().collect();
    match own.is_empty() {
        true => bytes.extend(std::iter::repeat_n(0, pixels)),
        false => own.iter().for_each(|view| bytes.extend(&view.mask)),
    }
    for (seen, view) in own.iter().zip(&model.views) {
        let areas = view.row_edges.windows(2).flat_map(|row| {
            view.column_edges.windows(2).map(move |column| (row[1] - row[0]) * (column[1] - column[0]))
        });
        for (share, area) in seen.shares.iter().zip(areas) {
            put(bytes, (f64::from(*share) * area as f64).round() as usize);
        }
    }
    if own.is_empty() {
        put(bytes, 0);
    }
    put(bytes, state);
    put(bytes, model.action(state, guards));
}

fn put(bytes: &mut Vec<u8>, number: usize) {
    bytes.extend((number as u32).to_le_bytes());
}
