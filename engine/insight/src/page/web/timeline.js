// All steps of a phase in one line, with a row of marks for each rule.

const ROW = 13;

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
    const rules = doc.rules.map((_, rule) => rule).filter((rule) => marked(doc, rule));
    this.box.style.height = `${rules.length * ROW + 26}px`;
    const sheet = fit(this.base);
    this.frame = null;
    if (!sheet || !track || !track.count) return;
    const { pen, width, height } = sheet;
    const names = rules.map((rule) => doc.rules[rule].name);
    const left = Math.min(width * 0.3, Math.max(40, ...names.map((name) => pen.measureText(name).width + 24)));
    const wide = width - left - 8;
    this.frame = { left, wide, steps: Math.max(track.end, 2), height };
    const x = (step) => left + (step / (this.frame.steps - 1)) * wide;
    rules.forEach((rule, row) => {
      const y = row * ROW + 1;
      pen.globalAlpha = litRule === null || litRule === rule ? 1 : 0.3;
      pen.fillStyle = ink.soft;
      pen.fillRect(left, y, wide, ROW - 3);
      pen.fillStyle = ruleInk(rule);
      pen.fillRect(0, y + 1, 8, 8);
      pen.save();
      pen.beginPath();
      pen.rect(0, y, left - 8, ROW);
      pen.clip();
      label(pen, doc.rules[rule].name, 14, y + 5.5, 'left', 'middle', ink.text);
      pen.restore();
      pen.fillStyle = ruleInk(rule);
      for (let index = 0; index < track.count; index += 1) {
        if (track.fired(index, rule)) pen.fillRect(Math.round(x(track.step(index))) - 0.75, y, 1.5, ROW - 3);
      }
      pen.globalAlpha = 1;
    });
    const foot = rules.length * ROW + 1;
    for (const { step } of swaps) line(pen, [[x(step), 0], [x(step), foot]], ink.text, 1, [1, 3]);
    for (const gap of track.spans.slice(1)) {
      label(pen, '…', x(gap[0]), foot + 10, 'center');
    }
    for (const at of ticks(0, this.frame.steps, wide / 90)) {
      if (at >= this.frame.steps) continue;
      line(pen, [[x(at), foot], [x(at), foot + 4]], ink.route, 1);
      label(pen, whole(at), x(at), foot + 15, 'center');
    }
    label(pen, 'step', 14, foot + 15, 'left');
  }

  drawOver(step) {
    const sheet = fit(this.over);
    if (!sheet || !this.frame) return;
    const { pen, height } = sheet;
    const { left, wide, steps } = this.frame;
    const x = left + (step / (steps - 1)) * wide;
    line(pen, [[x, 0], [x, height - 20]], ink.text, 1.5);
    pen.beginPath();
    pen.arc(x, height - 20, 4, 0, 7);
    pen.fillStyle = ink.text;
    pen.fill();
  }
}
