// Why: the step in words, the causes of its window, the script with the lines that spoke, settings.

/** The step as it was recorded. */
function showStep(doc, track, index, step) {
  const flags = track.flags[index];
  const events = [
    flags & CONTACT ? 'contact' : '', flags & FALLEN ? 'fallen' : '', flags & RECOVER ? 'recovery follows' : '',
    flags & HOP ? 'stayed long enough: it goes on elsewhere' : '',
    flags & EXPLORED ? 'explored: not the best known action' : '',
  ].filter(Boolean).join(', ');
  const rows = [
    ['step', `${whole(step)}, ends at ${((step + 1) * doc.period_s).toFixed(1)} s`],
    ['state', `${track.state[index]} → ${track.nextState[index]}`],
    ['action', motion(doc.actions[track.action[index]] ?? [0, 0])],
    ...(doc.uses ? [['chosen by', doc.uses[track.driver[index] - 1]?.name ?? 'the script']] : []),
    ['reward', signed(track.reward[index])],
    ['nearest', `${(track.nearest[index] / 1000).toFixed(2)} m, ${beamWords(track.nearestBeam[index], doc.scan)}`],
    ['events', events || 'none'],
    ...(track.world ? [['world', worldsOf(doc)[track.world[index]]?.name ?? '']] : []),
  ];
  const box = $('step');
  if (box.children.length !== 2 * rows.length) box.replaceChildren(...rows.flatMap(([name]) => [el('dt', { text: name }), el('dd')]));
  rows.forEach(([, words], row) => {
    const cell = box.children[2 * row + 1];
    const shown = visible(words);
    if (cell.textContent !== shown) cell.textContent = shown;
  });
}

function factWords(fact, doc) {
  const value = fact.unit === 'metres' ? `${short(fact.value)} m`
    : fact.unit === '' ? (fact.value ? 'true' : 'false')
      : fact.unit === 'share' ? `${short(100 * fact.value)} %` : `${short(fact.value)} ${fact.unit}`;
  return `${fact.name} = ${value}${fact.beam === null ? '' : ` (${beamWords(fact.beam, doc.scan)})`}`;
}

/** What a rule added in a step: its value, or what the others leave of the reward; null where two such rules fired. */
function addedBy(doc, track, index, rule) {
  if (doc.rules[rule].value !== null) return doc.rules[rule].value;
  let left = track.reward[index];
  for (const [at, { value }] of doc.rules.entries()) {
    if (at === rule || !track.fired(index, at)) continue;
    if (value === null) return null;
    left -= value;
  }
  return left;
}

/** Why an action is worth what it is: what spoke, from what stands behind all else to its own tries, and these steps. */
function valueChain({ value, unit, links, own_tries: count, tries }, jump, title = 'why this action was worth') {
  const rows = links.map((link) => el('tr', {}, el('td', { text: link.name }), el('td', { text: link.tries.toFixed(1) }),
    el('td', { text: link.mean === null ? '' : short(link.mean) }), el('td', { text: short(link.value) })));
  const head = el('tr', { class: 'quiet' }, ...['', 'tries', 'mean', 'so far'].map((text) => el('th', { text })));
  const own = tries.map(({ step, gain, earlier }) => {
    const words = `${whole(step)}${earlier ? ' of the run before' : ''} (${short(gain)})`;
    return earlier || !jump ? el('span', { text: words }) : el('button', { type: 'button', class: 'link', text: words, onclick: () => jump(step) });
  });
  const more = count > tries.length ? ` and ${whole(count - tries.length)} more` : '';
  return el('div', {}, el('div', {}, el('b', { text: `${title} ${short(value)}` }), ` (a spread of ${short(unit)} is usual)`),
    el('table', {}, el('tbody', {}, head, ...rows)),
    ...(own.length ? [el('div', { class: 'fact' }, 'its own tries, as steps of learning (and what followed): ',
      ...own.flatMap((one, at) => (at ? [', ', one] : [one])), more)] : []));
}

/** What each rule said: with its facts where the moment brought them, else only which fired; and why the action had its value. */
function showReasons(doc, track, index, reasons, jump) {
  // Before a swap of the reward, another script judged: its rules are known by their names.
  const why = new Map(reasons?.rules.map((rule) => [rule.name, rule]));
  const rules = doc.rules.map((rule, at) => ({ rule, at, fired: track.fired(index, at), why: why.get(rule.name) }));
  const gone = [...why.values()].filter((rule) => rule.added !== null && !doc.rules.some(({ name }) => name === rule.name));
  const shown = rules.filter(({ fired, why }) => fired || why);
  const drawn = (reasons?.drawn ?? []).map(([key, value]) => el('li', { class: 'quiet', text: `drawn: ${key} = ${value}` }));
  $('reasons').replaceChildren(el('ul', {}, ...drawn, ...shown.map(({ rule, at, fired, why }) => {
    const held = why && why.needed > 1 ? `; held ${why.held} of ${why.needed} steps` : '';
    const words = fired ? `${signed(why ? why.added : addedBy(doc, track, index, at))}${held}`
      : why && !why.asked ? 'not asked: an earlier rule ended the step' : `silent${held}`;
    const facts = why ? why.parts.flatMap((part) => part.facts.map((fact) => factWords(fact, doc))) : [];
    return el('li', {}, chip(at), fired ? el('b', { text: rule.name }) : el('span', { class: 'quiet', text: rule.name }), ` ${words}`,
      ...[...new Set(facts)].map((fact) => el('div', { class: 'fact', text: fact })));
  }), ...(reasons?.used ? [el('li', {}, el('b', { text: `use "${reasons.used.name}"` }), ` in its state ${reasons.used.text}`,
    ...reasons.used.parts.flatMap((part) => part.facts.map((fact) => el('div', { class: 'fact', text: factWords(fact, doc) }))))] : []), ...(reasons?.guards ?? []).map((guard) => el('li', { class: 'quiet',
    text: `${guard.name} forbade ${guard.actions.length} of ${doc.actions.length} actions` })), ...gone.map((rule) => el('li', { class: 'quiet', text: `${rule.name} ${signed(rule.added)}, in the script before the swap` }))), ...(reasons?.value ? [valueChain(reasons.value, jump)] : []));
}

/** The causes of one window of the curve: which rules, through which beams, when first. */
function showCauses(doc, seed, track, phase, window_, jump, light_) {
  const [from, to] = [window_ * doc.window_steps, (window_ + 1) * doc.window_steps];
  const causes = doc.rules.map((rule, at) => ({ rule, at, count: 0, total: 0, first: null, beams: new Map() }));
  let sum = 0;
  for (let step = from; track && step < Math.min(to, track.end); step += 1) {
    const index = track.index(step);
    if (index < 0) continue;
    sum += track.reward[index];
    for (const cause of causes) {
      if (!track.fired(index, cause.at)) continue;
      cause.count += 1;
      const added = addedBy(doc, track, index, cause.at);
      cause.total = added === null || cause.total === null ? null : cause.total + added;
      cause.first ??= step;
      const beam = track.beam[index];
      if (beam !== NO_BEAM && cause.rule.value !== null) cause.beams.set(beam, (cause.beams.get(beam) ?? 0) + 1);
    }
  }
  const byRule = phase === 'learning' ? seed.by_rule[window_] : null;
  if (byRule) for (const cause of causes) cause.total = byRule[cause.at];
  const spoke = causes.filter((cause) => cause.count > 0);
  $('window-note').textContent = `steps ${whole(from)} to ${whole(to - 1)}: ${signed(sum)}`;
  if (!spoke.length) {
    $('causes').replaceChildren(el('p', { class: 'quiet', text: 'no rule fired' }));
    return;
  }
  $('causes').replaceChildren(el('ul', {}, ...spoke.map((cause) => {
    const beams = [...cause.beams].sort((a, b) => b[1] - a[1]).slice(0, 3)
      .map(([beam, count]) => `${beamWords(beam, doc.scan)}${count > 1 ? ` (${count} ×)` : ''}`).join('; ');
    return el('li', { onpointerenter: () => light_(cause.at), onpointerleave: () => light_(null) },
      chip(cause.at), el('b', { text: cause.rule.name }),
      ` ${whole(cause.count)} ×, ${cause.total === null ? 'sum not kept' : signed(cause.total)}, first at `,
      el('button', { type: 'button', class: 'link', text: `step ${whole(cause.first)}`, onclick: () => jump(cause.first) }),
      ...(beams ? [el('div', { class: 'fact', text: beams })] : []));
  })));
}

/** The script, each rule's lines with its colour. */
class Script {
  constructor(box, onRule) {
    Object.assign(this, { box, onRule, lines: [], lit: null });
  }

  draw(doc) {
    $('script-path').textContent = visible(doc.script_path);
    const owner = (number) => doc.rules.findIndex((rule) => number >= rule.line && number < rule.line + rule.lines);
    const texts = doc.script.replace(/\n$/, '').split('\n');
    this.lines = texts.map((text, index) => {
      const rule = owner(index + 1);
      const line_ = el('div', {}, el('i', {}, ...(rule >= 0 && doc.rules[rule].line === index + 1 ? [chip(rule)] : []), `${index + 1}`), el('code', { text: text || ' ' }));
      if (rule >= 0) {
        line_.style.borderLeftColor = ruleInk(rule);
        line_.addEventListener('pointerenter', () => this.onRule(rule));
        line_.addEventListener('pointerleave', () => this.onRule(null));
      }
      return { line: line_, rule };
    });
    this.box.replaceChildren(...this.lines.map((entry) => entry.line));
  }

  /** Lights one rule's lines, and those of the rules that fired. */
  light(litRule, fired) {
    for (const { line: line_, rule } of this.lines) {
      line_.classList.toggle('lit', rule >= 0 && rule === litRule);
      line_.classList.toggle('fired', rule >= 0 && fired(rule));
    }
  }

  /** Marks the lines that a check found something in. */
  note(findings) {
    for (const { line: line_ } of this.lines) {
      line_.classList.remove('noted');
      line_.firstChild.removeAttribute('title');
    }
    for (const finding of findings) {
      const line_ = this.lines[(finding.line ?? 0) - 1]?.line;
      if (!line_) continue;
      line_.classList.add('noted');
      line_.firstChild.title = `${finding.code}: ${finding.message}`;
    }
  }

  /** Shows one line, for a moment in another colour. */
  reveal(number) {
    const line_ = this.lines[number - 1]?.line;
    if (!line_) return;
    line_.scrollIntoView({ block: 'center' });
    line_.classList.add('lit');
    setTimeout(() => line_.classList.remove('lit'), 1500);
  }

  /** Marks the lines with mistakes, by their numbers from 1. */
  wrong(numbers) {
    this.lines.forEach(({ line: line_ }, index) => line_.classList.toggle('wrong', numbers.includes(index + 1)));
  }
}

/** A slider for a parameter; `set` is told its new value when it is let go. */
function slider({ name, value, low, high, whole }, set) {
  const step = whole ? 1 : (high - low) / 200;
  const shown = el('output', { text: String(value) });
  const input = el('input', { type: 'range', min: low, max: high, step, 'aria-label': name,
    oninput: () => { shown.textContent = String(round(input.value)); },
    onchange: () => set(name, round(input.value)) });
  const round = (text) => (whole ? Number(text) : Math.min(high, Math.max(low, Number(Number(text).toPrecision(4)))));
  input.value = value;
  return el('label', { class: 'param' }, name, input, shown);
}

/** Sliders for the parameters of the script, if there is somebody to learn with them. */
function showParams(doc, set) {
  const box = $('params');
  const params = (set && doc.params) || [];
  box.hidden = !params.length;
  // A document comes every second: a slider that is being moved stays.
  const shown = JSON.stringify(params);
  if (box.dataset.shown === shown) return;
  box.dataset.shown = shown;
  box.replaceChildren(...params.map((param) => slider(param, set)));
}

function showSettings(doc) {
  $('settings').replaceChildren(el('tbody', {}, ...doc.settings.map((setting) => el('tr', setting.changed ? { class: 'changed' } : {},
    el('td', { text: setting.name }),
    el('td', { text: `${setting.value}${setting.unit ? ` ${setting.unit}` : ''}` })))));
}
