// All seeds of a run, the worst first: which are a success, and why the others are not.

class Seeds {
  constructor(box, note, onPick) {
    Object.assign(this, { box, note, onPick, rows: new Map() });
  }

  draw(doc, live) {
    const tested = doc.seeds.map((seed, index) => ({ seed, index })).filter(({ seed }) => seed.test);
    document.querySelector('.panel.seeds').hidden = tested.length < 2;
    const rank = ({ seed: { verdict, test } }) => [verdict?.success ? 1 : 0, -test.failures_per_1000];
    tested.sort((a, b) => {
      const [[wonA, failsA], [wonB, failsB]] = [rank(a), rank(b)];
      return wonA - wonB || failsA - failsB || a.seed.seed - b.seed.seed;
    });
    const won = tested.filter(({ seed }) => seed.verdict?.success).length;
    this.note.textContent = `${won} of ${tested.length} are a success; the worst first`;
    const [route, goals] = [tested.some(({ seed }) => seed.test.net_route_m !== null), tested.some(({ seed }) => seed.test.goals > 0)];
    const head = ['seed', 'success', 'failures in 1,000', ...(route ? ['net metres'] : []), ...(goals ? ['goals'] : []), 'why not'];
    const words = { true: 'yes', false: 'no', null: '–' };
    const cells = ({ test, verdict }) => [
      words[verdict?.success ?? null], short(test.failures_per_1000),
      ...(route ? [short(test.net_route_m)] : []), ...(goals ? [whole(test.goals)] : []),
      verdict && !verdict.success ? verdict.text.replace(/^(no: |cannot be told:? )/, '') : '',
    ];
    this.rows.clear();
    const rows = tested.map(({ seed, index }) => {
      // The steps of the others are not in the file.
      const shown = live || seed.learning || seed.tested;
      const name = shown ? el('button', { type: 'button', class: 'link', text: seed.seed, onclick: () => this.onPick(index) }) : `${seed.seed}`;
      const row = el('tr', {}, el('th', { scope: 'row' }, name), ...cells(seed).map((text) => el('td', { text })));
      this.rows.set(index, row);
      return row;
    });
    this.box.replaceChildren(
      el('thead', {}, el('tr', {}, ...head.map((text) => el('th', { scope: 'col', text })))), el('tbody', {}, ...rows),
    );
  }

  /** What all seeds came to, in words; nothing of one alone. */
  static words(doc) {
    const tested = doc.seeds.filter((seed) => seed.test);
    if (tested.length < 2) return '';
    const won = tested.filter((seed) => seed.verdict?.success).length;
    const fails = [...tested].sort((a, b) => a.test.failures_per_1000 - b.test.failures_per_1000);
    const [median, worst] = [fails[fails.length >> 1], fails.at(-1)];
    return `${won} of ${tested.length} seeds are a success; failures in 1,000 steps: median ${short(median.test.failures_per_1000)}, worst ${short(worst.test.failures_per_1000)} (seed ${worst.seed})`;
  }

  /** Marks the seed that is shown. */
  now(index) {
    for (const [at, row] of this.rows) row.classList.toggle('now', at === index);
  }
}
