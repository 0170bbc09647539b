// The page: which run, seed, phase and step are shown; the clock of the player; keys.

const SPEEDS = [1, 2, 5, 10, 25, 50, 100, 250, 1000];

const app = {
  doc: null, before: null, save: 0, seed: 0, phase: 'test', step: 0, share: 1, speed: 3, playing: false,
  litRule: null, live: null, shot: null, tracks: new Map(), picked: false, world: null, explained: null,
};
const stale = { base: true, moment: true, motion: true, lit: true };
const map = new WorldMap($('map'));
const curve = new Curve($('curve'), $('curve-note'), pickWindow);
const timeline = new Timeline($('timeline'), (step) => { pause(); go(step); });
const frames = new Frames($('frames'), $('frames-note'));
const states = new States($('states'), $('states-note'), pickState);
const seeds = new Seeds($('seeds'), $('seeds-note'), pickSeed);
const script = new Script($('script'), light);

const seedView = () => app.doc.seeds[app.seed];

/** The steps that are shown, decoded once. */
function track() {
  const seed = seedView();
  const key = `${seed.seed} ${app.phase}`;
  const raw = app.phase === 'learning' ? seed.learning : seed.tested;
  if (!app.tracks.has(key) && raw) app.tracks.set(key, new Track(raw, app.doc.rules.length, app.doc.scan.kept));
  return app.tracks.get(key) ?? null;
}

function showDocument(doc, before) {
  const [wasSeed, wasPhase, wasStep] = app.doc ? [seedView()?.seed, app.phase, app.step] : [null, 'test', 0];
  Object.assign(app, { doc, before, shot: null });
  app.tracks.clear();
  app.litRule = null;
  chooseRuleInks(doc.rules);
  document.querySelector('main').hidden = false;
  const more = worldsOf(doc).length - 1;
  document.title = visible(`${doc.behaviour} in ${doc.world.name}${more ? ` and ${more} more` : ''}`);
  $('title').textContent = document.title;
  $('from').hidden = !doc.from;
  $('from').textContent = doc.from ? visible(`Goes on from ${doc.from}.`) : '';
  const kept = app.picked ? doc.seeds.findIndex((seed) => seed.seed === wasSeed) : -1;
  app.seed = Math.max(0, kept >= 0 ? kept : doc.seeds.findIndex((seed) => seed.shown_first));
  $('seed').replaceChildren(...doc.seeds.map((seed, index) => el('option', {
    value: index, text: seed.seed, disabled: !app.live && !seed.learning && !seed.tested,
  })));
  $('seed').value = app.seed;
  seeds.draw(doc, app.live !== null);
  script.draw(doc);
  checkedNow();
  showWorlds(doc);
  showSettings(doc);
  showParams(doc, app.live ? (name, value) => app.live.set(app.save, name, value) : null);
  setPhase(wasPhase);
  go(wasStep);
  complete();
  app.picked ||= app.live !== null;
}

/** A choice of world, where there are several: that of the robot, or one that stays. */
function showWorlds(doc) {
  const worlds = worldsOf(doc);
  app.world = null;
  $('world').parentElement.hidden = worlds.length < 2;
  $('world').replaceChildren(el('option', { value: '', text: "the robot's" }), ...worlds.map((world, index) => el('option', { value: index, text: world.name })));
}

/** Shows the world in which the robot is, unless one was chosen. */
function turnToWorld(steps, index) {
  const world = app.world ?? (index >= 0 && steps.world ? steps.world[index] : 0);
  if (map.world === world) return;
  map.world = world;
  stale.base = true;
}

function checkedNow() {
  showChecked(app.doc, app.live !== null, (line_) => script.reveal(line_));
  script.note(app.doc.findings);
}

function chooseSeed(index) {
  app.seed = index;
  app.shot = null;
  setPhase(app.phase);
  go(app.step);
  complete();
}

function pickSeed(index) {
  app.picked = true;
  $('seed').value = index;
  chooseSeed(index);
}

/** Asks for the steps of a seed that the document left out. */
function complete() {
  const seed = seedView();
  if (!app.live || seed.learning || seed.tested || seed.asked) return;
  seed.asked = true;
  const doc = app.doc;
  app.live.tracks(app.save, seed.seed).then((found) => {
    if (!found || app.doc !== doc) return;
    Object.assign(seed, { learning: found.learning, tested: found.tested });
    if (seedView() === seed) { setPhase(app.phase); go(app.step); }
  });
}

function setPhase(phase) {
  const seed = seedView();
  app.phase = phase === 'test' && !seed.tested ? 'learning' : phase;
  if (app.phase === 'learning' && !seed.learning && seed.tested) app.phase = 'test';
  for (const button of $('phase').children) {
    const own = button.dataset.phase;
    button.setAttribute('aria-pressed', String(own === app.phase));
    button.disabled = own === 'learning' ? !seed.learning : !seed.tested;
  }
  const { test, verdict } = seed;
  const success = { true: 'success', false: 'no success', null: 'success cannot be told' };
  const all = Seeds.words(app.doc);
  $('verdict').hidden = !verdict;
  $('verdict').replaceChildren(...(verdict ? [
    ...(all ? [el('p', { class: 'all' }, el('b', { text: all }))] : []),
    el('p', {}, ...(all ? [`shown is seed ${seed.seed}: `] : []), el('b', { text: success[verdict.success] }), ...(verdict.success ? [] : [`: ${verdict.text.replace(/^(no: |cannot be told:? )/, '')}`])),
    el('ul', {}, ...verdict.conditions.map((one) => el('li', { class: one.holds ? 'holds' : 'fails', title: one.condition },
      el('b', { text: `${one.holds ? '✓' : '✗'} ${one.name}` }), ` ${one.figures}`))),
  ] : []));
  $('facts').replaceChildren(
    ...(seed.curve.length ? ['learned ', el('b', { text: seed.learned_at === null ? (seed.tells_learning ? 'not yet' : 'cannot be told') : `at step ${whole(seed.learned_at)}` })] : ['policies combined']),
    ...(test ? [' · test: ', el('b', { text: `${short(test.failures_per_1000)} failures` }), ' in 1,000 steps, ',
      el('b', { text: `${short(test.mean_speed)} m/s` }), ...(test.forbidden_per_1000 === undefined ? [] : [', guards in ', el('b', { text: short(test.forbidden_per_1000) }), ' of 1,000 steps']), ...(test.laps === null ? [] : [', ', el('b', { text: `${short(test.laps)} laps` })])] : []),
  );
  app.shot = null;
  seeds.now(app.seed);
  if (app.explained !== seed) $('state-why').replaceChildren();
  states.draw(app.doc, seed, app.before?.seeds.find((old) => old.seed === seed.seed) ?? null);
  Object.assign(stale, { base: true, moment: true, motion: true });
}

function go(step, share = 1) {
  const steps = track();
  app.step = steps ? steps.nearestStep(step) : 0;
  app.share = share;
  Object.assign(stale, { moment: true, motion: true });
}

function pause() {
  app.playing = false;
  $('play').textContent = 'Play';
  stale.moment = true;
}

function toggle() {
  const steps = track();
  if (!steps) return;
  if (!app.playing && app.step >= steps.end - 1) go(0);
  app.playing = !app.playing;
  $('play').textContent = app.playing ? 'Pause' : 'Play';
  stale.moment = true;
}

function light(rule) {
  app.litRule = rule;
  stale.base = true;
  stale.lit = true;
}

/** Goes to the worst step of a window. */
function pickWindow(window_) {
  pause();
  if (seedView().learning) setPhase('learning');
  const steps = track();
  if (!steps) return;
  let worst = window_ * app.doc.window_steps;
  let least = 0;
  for (let step = worst; step < Math.min((window_ + 1) * app.doc.window_steps, steps.end); step += 1) {
    const index = steps.index(step);
    if (index >= 0 && steps.reward[index] < least) { least = steps.reward[index]; worst = step; }
  }
  go(worst);
}

/** Goes to the next step that ends in a state, and tells why its best action is worth what it is. */
function pickState(row) {
  const title = `state ${row.state}: why ${motion(app.doc.actions[row.best])} is worth, after the last step of learning,`;
  const jump = (step) => { pause(); setPhase('learning'); go(step); };
  app.explained = seedView();
  $('state-why').replaceChildren(...(row.why ? [valueChain(row.why, jump, title)] : []));
  nextWithState(row.state);
}

function nextWithState(state) {
  const steps = track();
  if (!steps || !steps.count) return;
  const from = Math.max(0, steps.index(app.step));
  for (let index = 1; index <= steps.count; index += 1) {
    const at = (from + index) % steps.count;
    if (steps.nextState[at] === state) { pause(); go(steps.step(at)); return; }
  }
}

function drawMoment(steps, index) {
  const { doc } = app;
  const window_ = Math.floor(app.step / doc.window_steps);
  const nearest = nearestShot(doc.shots, seedView().seed, app.phase, app.step);
  const exact = [app.shot, nearest].find((shot) => shot && shot.step === app.step);
  frames.show(doc, exact ?? (app.live && app.shot) ?? nearest, app.step);
  if (app.live && !exact) {
    const shown = app.doc;
    app.live.frame(app.save, seedView().seed, app.phase, app.step, (shot) => {
      if (app.doc !== shown || shot.seed !== seedView().seed || shot.phase !== app.phase) return;
      app.shot = shot;
      stale.moment = true;
    });
  }
  showStep(doc, steps, index, app.step);
  if (!app.playing || steps.reward[index] !== 0) showReasons(doc, steps, index, exact?.reasons, app.phase === 'learning' ? go : null);
  states.mark(steps.nextState[index]);
  if (drawMoment.window !== window_ || !app.playing) showCauses(doc, seedView(), steps, app.phase, window_, (step) => { pause(); go(step); }, light);
  if (drawMoment.window !== window_ || drawMoment.phase !== app.phase) curve.stale = true;
  Object.assign(drawMoment, { window: window_, phase: app.phase });
  $('moment').replaceChildren('step ', el('b', { text: whole(app.step) }), ` of ${whole(steps.steps)} · `,
    `${((app.step + 1) * doc.period_s).toFixed(1)} s · reward `, el('b', { text: signed(steps.reward[index]) }));
}

function advance(elapsed) {
  const steps = track();
  if (!app.playing || !steps) return;
  const at = app.step + app.share + (elapsed / 1000 / app.doc.period_s) * SPEEDS[app.speed - 1];
  const step = Math.floor(at);
  if (steps.index(step) < 0 && step < steps.end) go(steps.nearestStep(step + (steps.end - step)));
  else if (step >= steps.end) { go(steps.end - 1); pause(); }
  else if (step === app.step) { app.share = at - step; stale.motion = true; }
  else go(step, at - step);
}

function drawFrame(now) {
  requestAnimationFrame(drawFrame);
  const elapsed = Math.min(now - (drawFrame.last ?? now), 100);
  drawFrame.last = now;
  if (!app.doc) return;
  advance(elapsed);
  const steps = track();
  turnToWorld(steps, steps ? steps.index(app.step) : -1);
  if (stale.base) {
    map.drawBase(app.doc, steps, app.litRule);
    $('map-note').textContent = visible(`${worldsOf(app.doc).length > 1 ? `${map.ground(app.doc).name}, ` : ''}${mapNote(app.doc, steps, app.phase)}`);
    curve.drawBase(app.doc, seedView(), app.before);
    timeline.drawBase(app.doc, steps, app.litRule, app.phase === 'learning' ? app.doc.swaps : []);
    curve.stale = true;
  }
  const index = steps ? steps.index(app.step) : -1;
  if (index >= 0 && stale.moment) drawMoment(steps, index);
  if (index >= 0 && (stale.moment || stale.lit)) script.light(app.litRule, (rule) => steps.fired(index, rule) === 1);
  if (stale.motion || stale.base) {
    map.drawOver(app.doc, steps, app.step, app.share);
    timeline.drawOver(app.step + app.share - 1);
  }
  // While it plays, once a second is enough for whoever listens.
  if (stale.base || (stale.moment && (!app.playing || now - drawFrame.said > 1000))) {
    say(app, seedView(), steps, index, map.ground(app.doc));
    drawFrame.said = now;
  }
  if (curve.stale) curve.drawOver(app.phase === 'learning' ? Math.floor(app.step / app.doc.window_steps) : null);
  Object.assign(stale, { base: false, moment: false, motion: false, lit: false });
}

function setSpeed(number) {
  app.speed = number;
  $('speed').value = number;
}

function key(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || !app.doc) return;
  const typing = event.target instanceof HTMLSelectElement;
  if (event.key === ' ' && !typing) toggle();
  else if (event.key === 'ArrowLeft' && !typing) { pause(); go(app.step - (event.shiftKey ? 100 : 1)); }
  else if (event.key === 'ArrowRight' && !typing) { pause(); go(app.step + (event.shiftKey ? 100 : 1)); }
  else if (event.key >= '1' && event.key <= '9' && !typing) setSpeed(Number(event.key));
  else return;
  event.preventDefault();
}

function message(said) {
  if (said.kind === 'working') {
    $('status').className = 'busy';
    $('status').textContent = visible(said.text);
  } else if (said.kind === 'failed') {
    $('status').className = '';
    $('status').textContent = app.doc ? 'the last good run stays on screen' : '';
    $('error').hidden = false;
    $('error-text').replaceChildren(...said.blocks.map((text) => el('pre', { text })));
    $('error-count').textContent = visible(said.summary ?? '');
    const here = [said.error, ...said.error.others].filter((one) => app.doc && one.file === app.doc.script_path);
    script.wrong(here.map((one) => one.line));
  } else if (said.kind === 'run') {
    $('error').hidden = true;
    $('status').className = said.done ? '' : 'busy';
    $('status').textContent = visible(said.text);
    app.save = said.save;
    showDocument(said.document, said.before);
  } else if (app.doc && said.save === app.save) {
    if (said.kind === 'checked') Object.assign(app.doc, { findings: said.findings, checked: said.checked });
    else Object.assign(app.doc, { checked: { steps: 0, left_out: 0, exploits: null }, unchecked: said.text });
    checkedNow();
  }
}

function start() {
  readInk();
  $('speed').replaceChildren(...SPEEDS.map((speed, index) => el('option', { value: index + 1, text: `${whole(speed)} ×` })));
  setSpeed(app.speed);
  $('play').addEventListener('click', toggle);
  $('back').addEventListener('click', () => { pause(); go(app.step - 1); });
  $('forth').addEventListener('click', () => { pause(); go(app.step + 1); });
  $('speed').addEventListener('change', (event) => { setSpeed(Number(event.target.value)); event.target.blur(); });
  $('world').addEventListener('change', (event) => {
    app.world = event.target.value === '' ? null : Number(event.target.value);
    stale.base = true;
    event.target.blur();
  });
  $('seed').addEventListener('change', (event) => { pickSeed(Number(event.target.value)); event.target.blur(); });
  for (const button of $('phase').children) button.addEventListener('click', () => { setPhase(button.dataset.phase); go(0); });
  document.addEventListener('keydown', key);
  const again = () => { readInk(); if (app.doc) { script.draw(app.doc); script.note(app.doc.findings); stale.base = true; stale.moment = true; } };
  const sizes = new ResizeObserver(() => { stale.base = true; });
  for (const box of ['map', 'curve', 'timeline']) sizes.observe($(box));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  const document_ = JSON.parse($('data').textContent);
  if (document_) {
    showDocument(document_, null);
    if (!matchMedia('(prefers-reduced-motion: reduce)').matches) toggle();
  }
  else {
    $('status').textContent = 'connecting';
    $('again').hidden = false;
    $('again').addEventListener('click', () => app.live.again());
    app.live = new Live({
      message,
      connected: (on) => { if (!on) { $('status').className = 'busy'; $('status').textContent = 'the engine is not running any more'; } },
    });
  }
  requestAnimationFrame(drawFrame);
}

start();
