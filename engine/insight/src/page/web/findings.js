// What a check found in the script, and what its reward can be had for.

const MARKS = { error: '!', warning: '!', note: 'i' };

/** A small round mark; its colour says how bad it is. */
const mark = (kind, title) => el('span', { class: `mark ${kind}`, title, role: 'img', 'aria-label': title, text: MARKS[kind] });

const countOf = (count, one) => `${whole(count)} ${one}${count === 1 ? '' : 's'}`;

/** How far the check is: only read, being tried out, or tried out. */
function showChecked(doc, live, goLine) {
  const { checked } = doc;
  const tried = checked && checked.steps > 0;
  const waits = live && !checked;
  $('findings-note').textContent = tried ? `from the script and ${countOf(checked.steps, 'step')} of trying it out`
    : waits ? 'from reading the script; checking …' : 'from reading the script';
  $('findings-note').classList.toggle('busy', Boolean(waits));
  showFindings(doc, waits, goLine);
  const exploits = checked ? checked.exploits : null;
  document.querySelector('.cheats').hidden = !exploits && !waits;
  document.querySelector('main').classList.toggle('unchecked', !exploits && !waits);
  // The table of the save before stays, pale, until the new one comes: nothing jumps.
  const old = waits && $('cheats').querySelector('table') !== null;
  $('cheats').classList.toggle('old', old);
  $('cheats-note').textContent = old ? 'of the save before; checking …' : 'driven in the simulator';
  $('cheats-note').classList.toggle('busy', old);
  if (exploits) showCheats(exploits);
  else if (!waits) $('cheats').replaceChildren();
  else if (!old) {
    $('cheats').replaceChildren(el('p', { class: 'quiet', text: 'The best behaviour for this reward and the usual cheats are tried out after the test.' }));
  }
}

function showFindings(doc, waits, goLine) {
  const rows = doc.findings.map((finding) => el('li', {},
    mark(finding.severity, finding.severity),
    el('div', {},
      el('b', { text: finding.message }), ' ',
      ...(finding.line === null ? [] : [el('button', {
        type: 'button', class: 'link', text: `line ${finding.line}`, onclick: () => goLine(finding.line),
      }), ' ']),
      el('span', { class: 'quiet code', text: finding.code }),
      ...(finding.label ? [el('div', { text: finding.label })] : []),
      ...(finding.help ? [el('div', { class: 'quiet', text: finding.help })] : []))));
  const { checked } = doc;
  if (doc.unchecked) rows.push(el('li', {}, mark('warning', 'warning'), el('div', { text: `trying it out ended early: ${doc.unchecked}` })));
  const foot = rows.length ? `${checked && checked.left_out ? `and ${checked.left_out} more. ` : ''}engine explain CODE says more about a code.`
    : checked ? 'None.' : waits ? 'None so far.' : 'None. With engine run --check the behaviour is tried out too.';
  $('findings').replaceChildren(...(rows.length ? [el('ul', {}, ...rows)] : []), el('p', { class: 'quiet', text: foot }));
}

/** Every behaviour that was driven, with its figures. */
function showCheats(exploits) {
  const { behaviours, coverage, cheapest, verdict } = exploits;
  const bad = verdict === 'pays' || verdict === 'easier' ? 'warning' : verdict === 'equal' ? 'note' : null;
  const head = [
    ['behaviour', ''], ['reward', 'per 400 steps'], ['failures', 'per 1,000'], ['speed', 'm/s'], ['net', 'm/s'], ['spinning', '%'],
  ];
  const titles = [
    '', 'the sum of all rewards in 400 steps', 'how often the script asks for recovery in 1,000 steps', 'path length over time',
    'progress along the route over time; – in a world without a route', 'share of 20 s spells in which it turns on the spot',
  ];
  const place = (value) => (value === null ? '–' : (Math.abs(value) < 0.005 ? 0 : value).toFixed(2).replace('-', '−'));
  const rows = behaviours.map((one, index) => el('tr', { class: index === cheapest && bad ? `had ${bad}` : '' },
    el('th', { scope: 'row' }, one.behaviour.replace(/(\d) s$/, '$1\u00a0s'),
      ...(one.nowhere ? [el('small', {}, ...(index === cheapest && bad ? [mark(bad, 'earns as much as driving on')] : []), 'gets nowhere')] : [])),
    el('td', { text: signed(one.reward_per_400) }),
    el('td', { text: short(one.failures_per_1000) }),
    el('td', { text: place(one.speed_m_per_s) }),
    el('td', { text: place(one.net_m_per_s) }),
    el('td', { text: whole(100 * one.spinning) })));
  $('cheats').replaceChildren(
    el('p', { class: `verdict ${bad ?? 'fine'}` }, ...(bad ? [mark(bad, bad)] : []), el('span', { text: exploits.sentence.replace(/ -(?=\d)/g, ' −') })),
    el('table', {},
      el('thead', {}, el('tr', {}, ...head.map(([name, unit], at) => el('th', { scope: 'col', title: titles[at] || undefined },
        name, ...(unit ? [el('small', { text: unit })] : []))))),
      el('tbody', {}, ...rows),
      el('tfoot', {}, el('tr', {}, el('th', { scope: 'row', text: 'driving on, no failure' }), el('td', { text: signed(exploits.honest_per_400) }),
        ...[0, 1, 2, 3].map(() => el('td', {}))))),
    el('p', { class: 'quiet', text: `The model that chose the best behaviour has seen ${coverage.states_seen} of ${coverage.states} states, `
      + `${coverage.states_hardly_seen} of them in fewer than 20 steps; ${coverage.pairs_untried} of ${coverage.pairs} pairs of state and action were never tried.` }),
  );
}
