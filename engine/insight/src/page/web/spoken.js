// What the canvases show, in words, for whoever does not see them.

const counted = (count, one) => `${whole(count)} ${count === 1 ? one : `${one}s`}`;

/** Says anew what each canvas shows now. */
function say(app, seed, track, index, ground) {
  const { doc, phase, step } = app;
  const set = (id, words) => $(id).querySelector('canvas').setAttribute('aria-label', words);
  set('curve', seed.curve.length
    ? `learning curve of seed ${seed.seed}: reward per ${doc.window_steps} steps, ${short(seed.curve[0])} in the first of ${counted(seed.curve.length, 'window')}, ${short(seed.curve.at(-1))} in the last`
    : 'no learning curve: nothing was learned');
  if (!track || index < 0) {
    set('map', `plan of the world ${ground.name}: no path, these steps are not here`);
    set('timeline', 'timeline: these steps are not here');
    return;
  }
  const from = Math.max(0, index - TRAIL_STEPS);
  let ended = 0;
  for (let at = from; at <= index; at += 1) ended += (track.flags[at] & RECOVER) !== 0;
  const movers = ground.movers.length ? `; ${ground.movers.map((mover) => mover.name).join(', ')} driving by itself` : '';
  set('map', `plan of the world ${ground.name}, ${phase}: path of the robot over ${counted(index - from + 1, 'step')} up to step ${whole(step)}, ${counted(ended, 'end')} of an attempt${movers}`);
  const fired = doc.rules.map((rule, at) => `${rule.name} fired ${counted(track.firings(at), 'time')}`).join('; ');
  set('timeline', `timeline of ${phase === 'test' ? 'the test' : 'learning'}, ${counted(track.steps, 'step')}, at step ${whole(step)}: ${fired || 'no rules'}`);
}
