// All steps of a phase in one line: a row of marks for each rule, a band for the stages and for who drives, a trace for the reward,
// where it is more than marks, and for each measure.

const ROW = 13;
const TRACE = 40;
const FOOT = 30;
const TOTAL = 'reward of a step';
const DRIVES = 'who drives';
const STAGE = 'stage';
/** A reward that is not 0 in a greater share of the steps is no rare punishment. */
const RARE = 0.1;

/** Whether the rows of the rules do not already say what the reward of a step was. */
function speaks(doc, track) {
  const often = track.reward.reduce((count, reward) => count + (reward !== 0), 0) > RARE * track.count;
  return often || doc.rules.some((rule, at) => rule.value === null && track.firings(at) > 0);
}

/** Who drives, and what the robot is about. */
function bands(doc, track) {
  const found = [];
  if (doc.uses) {
    const of = (index) => (track.driver[index] ? track.driver[index] - 1 : null);
    found.push({ title: DRIVES, height: ROW, of, name: (use) => doc.uses[use].name });
  }
  if (doc.stages) {
    const of = (index) => Math.floor(track.state[index] / doc.stages.states);
    found.push({ title: STAGE, height: ROW, of, name: (stage) => doc.stages.names[stage] });
  }
  return found;
}

/** The reward, where the rules do not say it already, and each measure. */
function traces(doc, track) {
  const measures = track.measures.map((values, at) => ({ title: doc.measures[at], height: TRACE, values, zero: false }));
  return [...(speaks(doc, track) ? [{ title: TOTAL, height: TRACE, values: track.reward, zero: true }] : []), ...measures];
}

class Timeline {
  constructor(box, onScrub) {
    this.box = box;
    [this.base, this.over] = box.querySelectorAll('canvas');
    this.frame = null;
    let held = false;
    const step = (event) => {
      const at = event.clientX - box.getBoundingClientRect().left - this.frame.left;
      return Math.round((at / this.frame.wide) * (this.frame.steps - 1));
    };
    this.over.addEventListener('pointerdown', (event) => {
      if (!this.frame) return;
      held = true;
      this.over.setPointerCapture(event.pointerId);
      onScrub(step(event));
    });
    this.over.addEventListener('pointermove', (event) => held && this.frame && onScrub(step(event)));
    for (const end of ['pointerup', 'pointercancel']) this.over.addEventListener(end, () => { held = false; });
  }

  drawBase(doc, track, litRule, swaps) {
    const below = track?.count ? [...bands(doc, track), ...traces(doc, track)] : [];
    const foot = doc.rules.length * ROW + below.reduce((sum, one) => sum + one.height, 0) + 1;
    this.box.style.height = `${foot + FOOT}px`;
    const sheet = fit(this.base);
    this.frame = null;
    if (!sheet || !track || !track.count) return;
    const { pen, width } = sheet;
    const names = [...doc.rules.map((rule) => rule.name), ...below.map((one) => one.title)];
    const left = Math.min(width * 0.3, Math.max(60, ...names.map((name) => pen.measureText(name).width + 24)));
    const wide = width - left - 8;
    const steps = Math.max(track.end, 2);
    this.frame = { left, wide, steps, foot, x: (step) => left + (step / (steps - 1)) * wide };
    doc.rules.forEach((rule, at) => this.row(pen, track, rule, at, litRule));
    let top = doc.rules.length * ROW + 1;
    for (const one of below) {
      one.values ? this.trace(pen, track, top, one) : this.band(pen, track, top, one);
      top += one.height;
    }
    this.axis(pen, track, swaps);
  }

  /** Where one rule fired: its mark while they are few, else a stroke for each step. */
  row(pen, track, rule, at, litRule) {
    const { left, wide, x } = this.frame;
    const y = at * ROW + 1;
    const middle = y + (ROW - 3) / 2;
    pen.globalAlpha = litRule === null || litRule === at ? 1 : 0.3;
    pen.fillStyle = ink.soft;
    pen.fillRect(left, y, wide, ROW - 3);
    pen.fillStyle = ruleInk(at);
    ruleMark(pen, at, 5, middle, 4);
    pen.save();
    pen.beginPath();
    pen.rect(0, y, left - 8, ROW);
    pen.clip();
    label(pen, rule.name, 14, y + 5.5, 'left', 'middle', ink.text);
    pen.restore();
    pen.fillStyle = ruleInk(at);
    const few = track.firings(at) <= MANY_MARKS;
    for (let index = 0; index < track.count; index += 1) {
      if (!track.fired(index, at)) continue;
      if (few) ruleMark(pen, at, x(track.step(index)), middle, 4);
      else pen.fillRect(Math.round(x(track.step(index))) - 0.75, y, 1.5, ROW - 3);
    }
    pen.globalAlpha = 1;
  }

  /** A bar over the steps of each spell, under its name where there is room. */
  band(pen, track, top, { title, of, name }) {
    const { left, wide, x } = this.frame;
    pen.fillStyle = ink.soft;
    pen.fillRect(left, top, wide, ROW - 3);
    this.title(pen, title, top + 5.5);
    for (let from = 0, to = 0; from < track.count; from = to) {
      const what = of(from);
      while (to < track.count && of(to) === what && track.step(to) - track.step(from) === to - from) to += 1;
      if (what === null) continue;
      const [start, broad] = [x(track.step(from)), Math.max(x(track.step(to - 1)) - x(track.step(from)), 1)];
      pen.globalAlpha = 0.25 + 0.2 * (what % 3);
      pen.fillStyle = ink.accent;
      pen.fillRect(start, top, broad, ROW - 3);
      pen.globalAlpha = 1;
      if (pen.measureText(name(what)).width + 6 < broad) label(pen, name(what), start + 3, top + 5.5, 'left', 'middle', ink.text);
    }
  }

  title(pen, text, y) {
    pen.save();
    pen.beginPath();
    pen.rect(0, y - 7, this.frame.left - 8, 14);
    pen.clip();
    label(pen, text, 14, y, 'left', 'middle', ink.text);
    pen.restore();
  }

  /** A number of each step: in each column of pixels from the least to the greatest, and through their means. */
  trace(pen, track, top, { title, values, zero }) {
    const { left, wide, x } = this.frame;
    let [low, high] = zero ? [0, 0] : [Infinity, -Infinity];
    for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
    if (high === low) high = low + 1;
    const y = (value) => top + 4 + ((high - value) / (high - low)) * (TRACE - 10);
    pen.fillStyle = ink.soft;
    pen.fillRect(left, top, wide, TRACE - 3);
    this.title(pen, title, top + 12);
    this.title(pen, `${short(low)} to ${short(high)}`, top + 26);
    if (low <= 0 && high >= 0) line(pen, [[left, y(0)], [left + wide, y(0)]], ink.line, 1);
    const columns = new Map();
    for (let index = 0; index < Math.min(track.count, values.length); index += 1) {
      const at = Math.round(x(track.step(index)));
      const value = values[index];
      const column = columns.get(at) ?? { least: value, most: value, sum: 0, count: 0 };
      column.least = Math.min(column.least, value);
      column.most = Math.max(column.most, value);
      column.sum += value;
      column.count += 1;
      columns.set(at, column);
    }
    pen.fillStyle = ink.accent;
    pen.globalAlpha = 0.35;
    for (const [at, { least, most }] of columns) pen.fillRect(at - 0.5, y(most), 1, Math.max(y(least) - y(most), 1));
    pen.globalAlpha = 1;
    line(pen, [...columns].map(([at, { sum, count }]) => [at, y(sum / count)]), ink.accent, 1);
  }

  axis(pen, track, swaps) {
    const { steps, foot, wide, x } = this.frame;
    for (const { step } of swaps) line(pen, [[x(step), 0], [x(step), foot]], ink.text, 1, [1, 3]);
    for (const gap of track.spans.slice(1)) label(pen, '…', x(gap[0]), foot + 10, 'center');
    for (const at of ticks(0, steps, wide / 90)) {
      if (at >= steps) continue;
      line(pen, [[x(at), foot], [x(at), foot + 4]], ink.route, 1);
      label(pen, whole(at), x(at), foot + 23, 'center');
    }
    label(pen, 'step', 14, foot + 23, 'left');
  }

  drawOver(step) {
    const sheet = fit(this.over);
    if (!sheet || !this.frame) return;
    const { pen } = sheet;
    const { left, wide, steps, foot } = this.frame;
    const x = left + (step / (steps - 1)) * wide;
    line(pen, [[x, 0], [x, foot + 6]], ink.text, 1.5);
    pen.beginPath();
    pen.arc(x, foot + 6, 4, 0, 7);
    pen.fillStyle = ink.text;
    pen.fill();
  }
}
