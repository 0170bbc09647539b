// The learning curve: the seed, the band of all seeds, and the same of the save before.

class Curve {
  constructor(box, note, onPick) {
    Object.assign(this, { box, note });
    [this.base, this.over] = box.querySelectorAll('canvas');
    this.frame = null;
    const window_ = (event) => {
      if (!this.frame) return null;
      const at = (event.clientX - box.getBoundingClientRect().left - this.frame.left) / this.frame.perWindow;
      return Math.min(Math.max(0, Math.round(at) - 1), this.frame.windows - 1);
    };
    box.addEventListener('click', (event) => this.frame && onPick(window_(event)));
    box.addEventListener('pointermove', (event) => { this.hover = window_(event); this.stale = true; });
    box.addEventListener('pointerleave', () => { this.hover = null; this.stale = true; });
    this.hover = null;
    this.stale = true;
  }

  drawBase(doc, seed, before) {
    const sheet = fit(this.base);
    if (!sheet) return;
    const { pen, width, height } = sheet;
    const all = doc.seeds.map((one) => one.curve).filter((curve) => curve.length);
    const old = before ? before.seeds.map((one) => one.curve).filter((curve) => curve.length) : [];
    const values = [...all, ...old].flat();
    this.frame = null;
    if (!values.length) {
      label(pen, 'nothing was learned: this behaviour combines policies', width / 2, height / 2, 'center');
      return;
    }
    const windows = Math.max(...[...all, ...old].map((curve) => curve.length), Math.ceil(doc.planned_steps / doc.window_steps));
    const [right, above, below] = [22, 8, 34];
    let [low, high] = [Math.min(...values, 0), Math.max(...values, 0)];
    if (high === low) low = -1;
    const room = (high - low) * 0.06;
    [low, high] = [low - room, high + room];
    const rows = ticks(low, high, (height - above - below) / 34);
    // The numbers stand between the axis and its name.
    const left = Math.max(44, 24 + Math.max(...rows.map((at) => pen.measureText(short(at)).width)));
    const perWindow = (width - left - right) / windows;
    const x = (index) => left + (index + 1) * perWindow;
    const y = (value) => above + ((high - value) / (high - low)) * (height - above - below);
    this.frame = { left, perWindow, windows, x, y, width, height, above, bottom: height - below, seed };
    for (const at of rows) {
      line(pen, [[left, y(at)], [width - right, y(at)]], at === 0 ? ink.quiet : ink.soft, 1);
      label(pen, short(at), left - 6, y(at), 'right', 'middle');
    }
    const steps = windows * doc.window_steps;
    for (const at of ticks(0, steps, width / 90)) {
      label(pen, whole(at), left + (at / doc.window_steps) * perWindow, height - below + 14, 'center');
    }
    label(pen, 'steps of learning', (left + width - right) / 2, height - 4, 'center');
    pen.save();
    pen.translate(9, (above + height - below) / 2);
    pen.rotate(-Math.PI / 2);
    label(pen, `reward per ${doc.window_steps} steps`, 0, 0, 'center', 'middle');
    pen.restore();
    for (const [index, { step, table }] of doc.swaps.entries()) {
      const at = left + (step / doc.window_steps) * perWindow;
      line(pen, [[at, above], [at, height - below]], ink.quiet, 1, [1, 3]);
      // The words of many swaps would run into each other.
      if (doc.swaps.length > 3 && index < doc.swaps.length - 1) continue;
      const side = at > width / 2 ? 'right' : 'left';
      label(pen, `reward swap: ${table}`, at + (side === 'left' ? 5 : -5), above + 9, side, 'middle');
    }
    if (all.length > 1) this.band(pen, all);
    if (old.length) this.middle(pen, old, ink.before, [4, 3], 1.5);
    if (all.length > 1) {
      this.middle(pen, all, ink.accent, [2, 2], 1);
    }
    line(pen, seed.curve.map((value, index) => [x(index), y(value)]), ink.accent, 2);
    for (const [index, value] of seed.curve.entries()) {
      pen.beginPath();
      pen.arc(x(index), y(value), 2, 0, 7);
      pen.fillStyle = ink.accent;
      pen.fill();
    }
    this.legend(seed, all.length, old.length);
  }

  sorted(curves, index) {
    return curves.map((curve) => curve[index]).filter((value) => value !== undefined).sort((a, b) => a - b);
  }

  band(pen, curves) {
    const longest = Math.max(...curves.map((curve) => curve.length));
    pen.beginPath();
    for (let index = 0; index < longest; index += 1) pen.lineTo(this.frame.x(index), this.frame.y(quantile(this.sorted(curves, index), 0.9)));
    for (let index = longest - 1; index >= 0; index -= 1) pen.lineTo(this.frame.x(index), this.frame.y(quantile(this.sorted(curves, index), 0.1)));
    pen.closePath();
    pen.fillStyle = ink['accent-soft'];
    pen.fill();
  }

  middle(pen, curves, colour, dash, width) {
    const longest = Math.max(...curves.map((curve) => curve.length));
    const points = Array.from({ length: longest }, (_, index) => [
      this.frame.x(index), this.frame.y(quantile(this.sorted(curves, index), 0.5)),
    ]);
    line(pen, points, colour, width, dash);
  }

  /** What each line means; in words beside the heading, where no line can run through them. */
  legend(seed, seeds, old) {
    const entries = [[`seed ${seed.seed}`, 'seed']];
    if (seeds > 1) entries.push([`median of ${seeds}, band 10–90 %`, 'median']);
    if (old) entries.push(['median before the save', 'before']);
    this.note.replaceChildren(...entries.map(([words, kind]) => el('span', { class: `sign ${kind}` }, el('i'), words)));
  }

  /** The window of the shown step, and the one under the pointer. */
  drawOver(window_) {
    const sheet = fit(this.over);
    this.stale = false;
    if (!sheet || !this.frame) return;
    const { pen } = sheet;
    const { x, y, perWindow, above, bottom, seed } = this.frame;
    if (window_ !== null) {
      pen.fillStyle = ink.text;
      pen.globalAlpha = 0.07;
      pen.fillRect(x(window_) - perWindow, above, perWindow, bottom - above);
      pen.globalAlpha = 1;
    }
    const value = this.hover === null ? undefined : seed.curve[this.hover];
    if (value === undefined) return;
    pen.beginPath();
    pen.arc(x(this.hover), y(value), 4.5, 0, 7);
    pen.strokeStyle = ink.text;
    pen.lineWidth = 1.5;
    pen.stroke();
    const side = this.hover > this.frame.windows / 2 ? 'right' : 'left';
    label(pen, short(value), x(this.hover) + (side === 'left' ? 9 : -9), y(value) - 8, side, 'middle', ink.text);
  }
}
