// The document as numbers: typed arrays by step, and the small words that every panel uses.

const $ = (id) => document.getElementById(id);

/** Names of strangers: what turns a line around or is not seen is written out. */
function visible(text) {
  return String(text).replace(/[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/g,
    (c) => `\\u{${c.codePointAt(0).toString(16)}}`);
}

/** An element; text is only ever set as text. */
function el(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === 'text') made.textContent = visible(value ?? '');
    else if (name === 'class') made.className = value;
    else if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (value !== undefined && value !== false) made.setAttribute(name, value === true ? '' : value);
  }
  made.append(...children);
  return made;
}

const SVG = 'http://www.w3.org/2000/svg';
function svg(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

function bytes(text) {
  const plain = atob(text);
  const out = new Uint8Array(plain.length);
  for (let index = 0; index < plain.length; index += 1) out[index] = plain.charCodeAt(index);
  return out.buffer;
}

/** The steps of one phase. */
class Track {
  constructor(raw, rules, kept) {
    this.steps = raw.steps;
    this.spans = raw.spans;
    this.rules = rules;
    this.kept = kept;
    this.x = new Int16Array(bytes(raw.x));
    this.y = new Int16Array(bytes(raw.y));
    this.yaw = new Int16Array(bytes(raw.yaw));
    this.state = new Uint32Array(bytes(raw.state));
    this.nextState = new Uint32Array(bytes(raw.next_state));
    this.action = new Uint8Array(bytes(raw.action));
    this.driver = new Uint8Array(bytes(raw.driver ?? ''));
    this.flags = new Uint8Array(bytes(raw.flags));
    this.reward = new Float32Array(bytes(raw.reward));
    this.bits = new Uint8Array(bytes(raw.fired));
    this.words = Math.ceil(rules / 8);
    // Which world, of several.
    this.world = raw.world ? new Uint16Array(bytes(raw.world)) : null;
    this.beam = new Uint16Array(bytes(raw.beam));
    this.nearestBeam = new Uint16Array(bytes(raw.nearest_beam));
    this.nearest = new Uint16Array(bytes(raw.nearest));
    this.movers = raw.movers.map((mover) => ({
      x: new Int16Array(bytes(mover.x)), y: new Int16Array(bytes(mover.y)), yaw: new Int16Array(bytes(mover.yaw)),
    }));
    this.measures = (raw.measures ?? []).map((measure) => new Float32Array(bytes(measure)));
    this.scan = new Uint8Array(bytes(raw.scan));
    this.count = this.x.length;
    const last = this.spans[this.spans.length - 1];
    this.end = last ? last[1] : 0;
  }

  /** Where a step stands in the arrays; -1 if it is left out. */
  index(step) {
    let before = 0;
    for (const [from, to] of this.spans) {
      if (step >= from && step < to) return before + step - from;
      before += to - from;
    }
    return -1;
  }

  step(index) {
    let left = index;
    for (const [from, to] of this.spans) {
      if (left < to - from) return from + left;
      left -= to - from;
    }
    return this.end - 1;
  }

  /** The nearest step that is kept. */
  nearestStep(step) {
    let best = 0;
    let far = Infinity;
    for (const [from, to] of this.spans) {
      const at = Math.min(Math.max(step, from), to - 1);
      if (Math.abs(at - step) < far) { far = Math.abs(at - step); best = at; }
    }
    return Math.max(0, best);
  }

  /** In how many of the steps a rule fired. */
  firings(rule) {
    this.counts ??= [];
    if (this.counts[rule] === undefined) {
      let count = 0;
      for (let index = 0; index < this.count; index += 1) count += this.fired(index, rule);
      this.counts[rule] = count;
    }
    return this.counts[rule];
  }

  fired(index, rule) {
    return (this.bits[index * this.words + (rule >> 3)] >> (rule & 7)) & 1;
  }
}

const RECOVER = 1;
const CONTACT = 2;
const FALLEN = 4;
const EXPLORED = 8;
const HOP = 16;
/** The robot was put elsewhere after the step. */
const MOVES = RECOVER | HOP;
const NO_BEAM = 65535;

const whole = (number) => Math.round(number).toLocaleString('en-US');
function short(number) {
  if (number === null || number === undefined) return '–';
  const text = Math.abs(number) >= 100 ? Number(number).toFixed(0) : Number(number).toFixed(2).replace(/\.?0+$/, '');
  return (text === '-0' ? '0' : text).replace('-', '−');
}
const signed = (number) => (number > 0 ? '+' : '') + short(number);

function motion([linear, angular]) {
  const turn = angular === 0 ? 'straight' : `${short(Math.abs(angular))} rad/s ${angular > 0 ? 'left' : 'right'}`;
  return `${short(linear)} m/s, ${turn}`;
}

function beamWords(beam, scan) {
  const angle = ((scan.first_rad + beam * scan.apart_rad) * 180) / Math.PI;
  const side = Math.abs(angle) < 0.5 ? 'straight ahead' : `${Math.abs(angle).toFixed(0)}° ${angle > 0 ? 'left' : 'right'}`;
  return `beam ${beam}, ${side}`;
}

function quantile(sorted, share) {
  const at = (sorted.length - 1) * share;
  const low = Math.floor(at);
  const high = Math.min(low + 1, sorted.length - 1);
  return sorted[low] + (sorted[high] - sorted[low]) * (at - low);
}
