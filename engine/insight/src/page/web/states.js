// The table of states: its cells, the best action as an arrow, how often it was met, what the last save changed.

const MOST_STATES = 96;
/** Fewer visits than these leave a state unsure. */
const FEW_VISITS = 10;

/** An arrow from the bottom of the icon: longer is faster, to the left is a left turn. */
function arrow([linear, angular], fastest, kind) {
  const length = 9 + 13 * (fastest ? Math.max(0, linear) / fastest : 0);
  const turn = Math.max(-1.25, Math.min(1.25, angular * 1.2));
  const [x0, y0] = [17, 29];
  const [x, y] = [x0 - length * Math.sin(turn), y0 - length * Math.cos(turn)];
  const path = svg('path', { class: `icon-${kind}`, d: `M${x0} ${y0}Q${x0} ${y0 - length * 0.5} ${x.toFixed(1)} ${y.toFixed(1)}` });
  if (kind !== 'best') return [path];
  const way = Math.atan2(x - x0, y0 - length * 0.5 - y);
  const point = (back, side) => [
    (x + 4 * (back * Math.sin(way) + side * Math.cos(way))).toFixed(1),
    (y - 4 * (back * Math.cos(way) - side * Math.sin(way))).toFixed(1),
  ].join(' ');
  return [path, svg('path', { class: 'icon-head', d: `M${point(1, 0)}L${point(-0.4, 0.8)}L${point(-0.4, -0.8)}Z` })];
}

function stateIcon(doc, row, old) {
  const [rows, columns] = doc.grid;
  const [wide, high] = [34 / columns, 34 / rows];
  const fastest = Math.max(...doc.actions.map(([linear]) => linear));
  const cells = [...row.cells].map((cell, index) => svg('rect', {
    class: cell === '1' ? 'icon-cell on' : 'icon-cell',
    x: (index % columns) * wide, y: Math.floor(index / columns) * high, width: wide, height: high,
  }));
  const before = old && old.best !== row.best ? arrow(doc.actions[old.best], fastest, 'before') : [];
  return svg('svg', { viewBox: '0 0 34 34', 'aria-hidden': 'true' }, ...cells, ...before,
    ...arrow(doc.actions[row.best], fastest, 'best'));
}

class States {
  constructor(box, note, onPick) {
    Object.assign(this, { box, note, onPick, buttons: new Map(), now: null });
  }

  draw(doc, seed, before) {
    const old = new Map((before ? before.states : []).map((row) => [row.state, row]));
    const rows = seed.states.length > MOST_STATES
      ? [...seed.states].sort((a, b) => b.visits - a.visits).slice(0, MOST_STATES) : seed.states;
    let changed = 0;
    this.buttons.clear();
    this.box.replaceChildren(...rows.map((row) => {
      const last = old.get(row.state);
      const differs = Boolean(last) && last.best !== row.best;
      changed += differs;
      const action = doc.actions[row.best];
      const next = [...row.values.keys()].filter((at) => at !== row.best).sort((a, b) => row.values[b] - row.values[a]).slice(0, 2)
        .map((at) => `\nnext best: ${motion(doc.actions[at])}, value ${short(row.values[at])}`).join('');
      const title = `state ${row.state}${row.text ? ` (${row.text})` : ''}: ${motion(action)}, value ${short(row.value)}, met ${whole(row.visits)} times${row.visits < FEW_VISITS ? ', too seldom to be sure' : ''}${next}`
        + (differs ? `\nbefore the save: ${motion(doc.actions[last.best])}` : '');
      const button = el('button', {
        type: 'button', title, class: `state${differs ? ' changed' : ''}${row.visits < FEW_VISITS ? ' rare' : ''}`,
        onclick: () => this.onPick(row),
      }, stateIcon(doc, row, last),
      el('span', { class: 'number', text: `no. ${row.state}` }),
      // What else the state holds.
      ...words(row.text).map((text) => el('span', { class: 'stage', text })),
      el('span', { text: row.value.toFixed(2).replace('-', '−') }),
      el('span', { text: `${whole(row.visits)} ×` }));
      this.buttons.set(row.state, button);
      return button;
    }));
    const met = `${whole(seed.states_met)} met`
      + (rows.length < seed.states_met ? `, the ${rows.length} most met are shown` : '');
    const diff = before ? `; ${changed} change${changed === 1 ? 's' : ''} the best action since the last save (dashed: before)` : '';
    this.note.textContent = seed.states.length
      ? `${met}: number and value of the best action, which the arrow shows; how often met${rows.some((row) => row.visits < FEW_VISITS) ? `; hatched: fewer than ${FEW_VISITS} times, unsure` : ''}${diff}` : 'nothing was learned';
    this.now = null;
  }

  mark(state) {
    if (state === this.now) return;
    this.buttons.get(this.now)?.classList.remove('now');
    this.buttons.get(state)?.classList.add('now');
    this.now = state;
  }
}

/** What a state of several parts holds besides the cells that are drawn, briefly: `0.6 to 1.2`, `search`, `white 0 2 1`. */
function words(text) {
  if (!text) return [];
  const parts = text.split(' | ');
  const others = !parts[0].includes('columns ') ? parts : parts.slice(1);
  const brief = (part) => part.match(/(below \S+|\S+ to \S+|from \S+|no|yes)$/)?.[0] ?? part.replace('columns ', '');
  return others.map((part) => (part.startsWith('stage ') ? part.slice(6).replaceAll('"', '') : brief(part)));
}
