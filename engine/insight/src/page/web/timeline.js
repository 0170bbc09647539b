// All steps of a phase in one line: a row of marks for each rule, and the reward of each step where it is more than marks.

const ROW = 13;
const TRACE = 40;
const FOOT = 30;
const TOTAL = 'reward of a step';
const DRIVES = 'who drives';
/** A reward that is not 0 in a greater share of the steps is no rare punishment. */
const RARE = 0.1;

/** Whether the rows of the rules do not already say what the reward of a step was. */
function speaks(doc, track) {
  const often = track.reward.reduce((count, reward) => count + (reward !== 0), 0) > RARE * track.count;
  return often || doc.rules.some((rule, at) => rule.value === null && track.firings(at) > 0);
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
    const traced = Boolean(track?.count) && speaks(doc, track);
    const band = doc.uses ? ROW : 0;
    const foot = doc.rules.length * ROW + band + (traced ? TRACE : 0) + 1;
    this.box.style.height = `${foot + FOOT}px`;
    const sheet = fit(this.base);
    this.frame = null;
    if (!sheet || !track || !track.count) return;
    const { pen, width } = sheet;
    const names = [...doc.rules.map((rule) => rule.name), ...(band ? [DRIVES] : []), ...(traced ? [TOTAL] : [])];
    const left = Math.min(width * 0.3, Math.max(60, ...names.map((name) => pen.measureText(name).width + 24)));
    const wide = width - left - 8;
    const steps = Math.max(track.end, 2);
    this.frame = { left, wide, steps, foot, x: (step) => left + (step / (steps - 1)) * wide };
    doc.rules.forEach((rule, at) => this.row(pen, track, rule, at, litRule));
    if (band) this.drivers(pen, doc, track, doc.rules.length * ROW + 1);
    if (traced) this.trace(pen, track, doc.rules.length * ROW + band + 1);
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

  /** Who drives: a bar over the steps of each use, under its policy's name where there is room. */
  drivers(pen, doc, track, top) {
    const { left, wide, x } = this.frame;
    pen.fillStyle = ink.soft;
    pen.fillRect(left, top, wide, ROW - 3);
    label(pen, DRIVES, 14, top + 5.5, 'left', 'middle', ink.text);
    for (let from = 0, to = 0; from < track.count; from = to) {
      const driver = track.driver[from];
      while (to < track.count && track.driver[to] === driver && track.step(to) - track.step(from) === to - from) to += 1;
      if (driver === 0) continue;
      const [start, broad] = [x(track.step(from)), Math.max(x(track.step(to - 1)) - x(track.step(from)), 1)];
      pen.globalAlpha = 0.35 + 0.4 * ((driver - 1) % 2);
      pen.fillStyle = ink.accent;
      pen.fillRect(start, top, broad, ROW - 3);
      pen.globalAlpha = 1;
      const { name } = doc.uses[driver - 1];
      if (pen.measureText(name).width + 6 < broad) label(pen, name, start + 3, top + 5.5, 'left', 'middle', ink.text);
    }
  }

  /** The reward of each step: in each column of pixels from the least to the greatest, and through their means. */
  trace(pen, track, top) {
    const { left, wide, x } = this.frame;
    let [low, high] = [0, 0];
    for (const reward of track.reward) { low = Math.min(low, reward); high = Math.max(high, reward); }
    if (high === low) high = 1;
    const y = (reward) => top + 4 + ((high - reward) / (high - low)) * (TRACE - 10);
    pen.fillStyle = ink.soft;
    pen.fillRect(left, top, wide, TRACE - 3);
    label(pen, TOTAL, 14, top + 12, 'left', 'middle', ink.text);
    label(pen, `${short(low)} to ${short(high)}`, 14, top + 26, 'left', 'middle');
    line(pen, [[left, y(0)], [left + wide, y(0)]], ink.line, 1);
    const columns = new Map();
    for (let index = 0; index < track.count; index += 1) {
      const at = Math.round(x(track.step(index)));
      const reward = track.reward[index];
      const column = columns.get(at) ?? { least: reward, most: reward, sum: 0, count: 0 };
      column.least = Math.min(column.least, reward);
      column.most = Math.max(column.most, reward);
      column.sum += reward;
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
