// Canvases that fit their boxes, colours of the theme, axes with rounded steps.

const ink = {};
function readInk() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ['text', 'quiet', 'line', 'soft', 'paper', 'accent', 'accent-soft', 'wall', 'route', 'trail',
    'before', 'bad']) {
    ink[name] = style.getPropertyValue(`--${name}`).trim();
  }
  ink.rules = [0, 1, 2, 3, 4, 5].map((rule) => style.getPropertyValue(`--rule-${rule}`).trim());
}

/** Greens for rules that reward, the other colours for those that punish. */
let ruleInks = [];
function chooseRuleInks(rules) {
  const [good, bad] = [[3, 5], [0, 1, 2, 4]];
  let [goods, bads] = [0, 0];
  ruleInks = rules.map((rule) => (rule.value > 0 ? good[goods++ % good.length] : bad[bads++ % bad.length]));
}
const ruleInk = (rule) => ink.rules[ruleInks[rule]];

/** A shape for each rule beside its colour, from -1 to 1: square, disc, triangle, diamond, plus, triangle on its tip, ring. */
const SHAPES = [
  'M-.9-.9H.9V.9H-.9Z', 'M-1 0A1 1 0 1 0 1 0A1 1 0 1 0-1 0Z', 'M0-1.1L1.1.9H-1.1Z', 'M0-1.2L1.2 0L0 1.2L-1.2 0Z',
  'M-.4-1.1H.4V-.4H1.1V.4H.4V1.1H-.4V.4H-1.1V-.4H-.4Z', 'M0 1.1L1.1-.9H-1.1Z',
  'M-1.1 0A1.1 1.1 0 1 0 1.1 0A1.1 1.1 0 1 0-1.1 0ZM-.5 0A.5.5 0 1 1 .5 0A.5.5 0 1 1-.5 0Z',
];
const PATHS = SHAPES.map((shape) => new Path2D(shape));
const shapeOf = (rule) => rule % SHAPES.length;

/** The mark of a rule in the colour of the pen. */
function ruleMark(pen, rule, x, y, size) {
  pen.save();
  pen.translate(x, y);
  pen.scale(size, size);
  pen.fill(PATHS[shapeOf(rule)]);
  pen.restore();
}

/** A shape beside a colour, to stand among words. */
function chip(rule) {
  const path = svg('path', { d: SHAPES[shapeOf(rule)] });
  path.style.fill = ruleInk(rule);
  return svg('svg', { class: 'chip', viewBox: '-1.25 -1.25 2.5 2.5', 'aria-hidden': 'true' }, path);
}

/** The colour of what is driven on: three quarters of the way to the page's paper, so that a path can be read on it. */
function floorInk(colour) {
  const paper = ink.paper.match(/[0-9a-f]{2}/gi).map((part) => parseInt(part, 16));
  return `rgb(${colour.map((part, at) => Math.round(part + 0.75 * (paper[at] - part))).join(' ')})`;
}

/** A canvas in pixels of the screen; false while it has no size. */
function fit(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas.parentElement;
  if (width === 0 || height === 0) return null;
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== columns || canvas.height !== rows) {
    [canvas.width, canvas.height] = [columns, rows];
    // A box of a fraction of a pixel would blur every line.
    [canvas.style.width, canvas.style.height] = [`${columns / ratio}px`, `${rows / ratio}px`];
  }
  const pen = canvas.getContext('2d');
  pen.restore();
  pen.save();
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = '11px system-ui, "DejaVu Sans", sans-serif';
  pen.lineJoin = 'round';
  return { pen, width, height };
}

/** Round numbers from low to high, about `count` of them. */
function ticks(low, high, count) {
  const raw = Math.max((high - low) / Math.max(count, 1), 1e-9);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((by) => by * power).find((size) => size >= raw * 0.999);
  const out = [];
  for (let at = Math.ceil(low / step - 1e-9) * step; at <= high + step * 1e-6; at += step) out.push(Math.abs(at) < step * 1e-6 ? 0 : at);
  return out;
}

function label(pen, text, x, y, align = 'left', baseline = 'alphabetic', colour = ink.quiet) {
  pen.fillStyle = colour;
  pen.textAlign = align;
  pen.textBaseline = baseline;
  pen.fillText(text, x, y);
}

function line(pen, points, colour, width, dash = []) {
  if (points.length < 2) return;
  pen.beginPath();
  pen.moveTo(points[0][0], points[0][1]);
  for (const [x, y] of points.slice(1)) pen.lineTo(x, y);
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}
