// The world from above: what stands on one canvas, what moves on another.

const TRAIL_STEPS = 400;
const MANY_MARKS = 200;

class WorldMap {
  constructor(box) {
    [this.base, this.over] = box.querySelectorAll('canvas');
    this.view = null;
    this.world = 0;
  }

  /** Whether a step was done in the world that is shown. */
  shows(track, index) {
    return !track.world || track.world[index] === this.world;
  }

  ground(doc) {
    return worldsOf(doc)[this.world] ?? doc.world;
  }

  /** What stands, and where each rule fired. */
  drawBase(doc, track, litRule) {
    const ground = this.ground(doc);
    const [x0, y0, x1, y1] = ground.bounds_m;
    this.base.parentElement.style.setProperty('--shape', `${(x1 - x0).toFixed(2)} / ${(y1 - y0).toFixed(2)}`);
    const sheet = fit(this.base);
    if (!sheet) return;
    const { pen, width, height } = sheet;
    const [left, below, above, right] = [34, 24, 8, 16];
    const scale = Math.min((width - left - right) / (x1 - x0), (height - above - below) / (y1 - y0));
    const [spanX, spanY] = [(x1 - x0) * scale, (y1 - y0) * scale];
    const fromX = left + (width - left - right - spanX) / 2;
    const fromY = above + (height - above - below - spanY) / 2;
    this.view = { floor: [fromX - 1, fromY - 1, spanX + 2, spanY + 2], scale, x: (m) => fromX + (m - x0) * scale, y: (m) => fromY + (y1 - m) * scale };
    pen.fillStyle = floorInk(ground.floor);
    pen.fillRect(fromX, fromY, spanX, spanY);
    pen.save();
    pen.beginPath();
    pen.rect(...this.view.floor);
    pen.clip();
    for (const solid of ground.solids) this.solid(pen, solid);
    const places = (way) => way.map(([x, y]) => [this.view.x(x), this.view.y(y)]);
    for (const { way_m: way } of ground.movers) if (way) line(pen, places(way), ink.quiet, 1, [2, 3]);
    for (const gate of ground.gates_m ?? []) line(pen, places(gate), ink.quiet, 1, [2, 3]);
    for (const circle of ground.places_m ?? []) line(pen, places(ring(circle)), ink.quiet, 1, [2, 3]);
    if (ground.route_m) line(pen, places(ground.route_m), ink.route, 1, [5, 4]);
    if (track) this.marks(pen, doc, track, litRule);
    pen.restore();
    for (const at of ticks(x0, x1, spanX / 70)) if (this.view.x(at) < fromX + spanX - 8) label(pen, short(at), this.view.x(at), fromY + spanY + 14, 'center');
    for (const at of ticks(y0, y1, spanY / 60)) label(pen, short(at), fromX - 6, this.view.y(at), 'right', 'middle');
    label(pen, 'm', fromX + spanX + 5, fromY + spanY + 14);
  }

  outline(pen, solid) {
    pen.beginPath();
    if (solid.circle_m) {
      const [x, y, radius] = solid.circle_m;
      pen.arc(this.view.x(x), this.view.y(y), radius * this.view.scale, 0, 2 * Math.PI);
      return;
    }
    solid.corners_m.forEach(([x, y], index) => {
      if (index === 0) pen.moveTo(this.view.x(x), this.view.y(y));
      else pen.lineTo(this.view.x(x), this.view.y(y));
    });
    pen.closePath();
  }

  solid(pen, solid) {
    this.outline(pen, solid);
    const colour = `rgb(${solid.colour.join(' ')})`;
    if (solid.kind === 'paint') {
      pen.fillStyle = colour;
      pen.fill();
      return;
    }
    pen.lineWidth = 1;
    pen.strokeStyle = solid.kind === 'ground' ? ink.route : ink.wall;
    pen.fillStyle = solid.kind === 'ground' ? floorInk(solid.colour) : colour;
    if (solid.kind === 'glass') pen.globalAlpha = 0.35;
    pen.fill();
    pen.globalAlpha = 1;
    pen.stroke();
  }

  marks(pen, doc, track, litRule) {
    const shown = doc.rules.map((_, rule) => rule).filter((rule) => (litRule === null ? !covers(track, rule) : litRule === rule));
    for (const rule of shown) {
      const count = track.firings(rule);
      // What fires at every turn is a shade; what fires seldom is an event.
      const crowd = count > MANY_MARKS;
      const strength = litRule === rule ? 0.95 : 0.75;
      pen.fillStyle = ruleInk(rule);
      pen.globalAlpha = crowd ? Math.max(0.12, strength * Math.sqrt(MANY_MARKS / count)) : strength;
      for (let index = 0; index < track.count; index += 1) {
        if (!track.fired(index, rule) || !this.shows(track, index)) continue;
        const [x, y] = [this.view.x(track.x[index] * doc.unit_m), this.view.y(track.y[index] * doc.unit_m)];
        ruleMark(pen, rule, x, y, crowd ? 2 : litRule === rule ? 4.5 : 3.5);
      }
    }
    pen.globalAlpha = 1;
  }

  /** What moves: the trail, the laser's fan, the robot, and what drives by itself. */
  drawOver(doc, track, step, share) {
    const sheet = fit(this.over);
    if (!sheet || !this.view || !track) return;
    const { pen } = sheet;
    const index = track.index(step);
    if (index < 0 || !this.shows(track, index)) return;
    const pose = between(track, index, share, doc.unit_m);
    pen.beginPath();
    pen.rect(...this.view.floor);
    pen.clip();
    this.trail(pen, doc, track, index, pose);
    this.ground(doc).movers.forEach((mover, number) => this.mover(pen, mover, moverPose(track, number, index, share, doc.unit_m)));
    this.fan(pen, doc, track, index, pose);
    this.robot(pen, doc, pose, track.flags[index]);
  }

  trail(pen, doc, track, index, pose) {
    const from = Math.max(0, index - TRAIL_STEPS);
    pen.lineWidth = 1.5;
    pen.strokeStyle = ink.trail;
    // Four pieces of rising strength: where it was lately counts more.
    for (let piece = 0; piece < 4; piece += 1) {
      const start = from + Math.floor(((index - from) * piece) / 4);
      const end = from + Math.floor(((index - from) * (piece + 1)) / 4);
      pen.globalAlpha = 0.15 + 0.22 * piece;
      pen.beginPath();
      let lifted = true;
      for (let at = start; at <= end; at += 1) {
        if (!this.shows(track, at)) { lifted = true; continue; }
        const point = at === index ? [pose.x, pose.y] : [track.x[at] * doc.unit_m, track.y[at] * doc.unit_m];
        if (lifted) pen.moveTo(this.view.x(point[0]), this.view.y(point[1]));
        else pen.lineTo(this.view.x(point[0]), this.view.y(point[1]));
        lifted = (track.flags[at] & MOVES) !== 0 || !this.shows(track, at + 1) || (at + 1 < track.count && track.step(at + 1) !== track.step(at) + 1);
      }
      pen.stroke();
    }
    pen.globalAlpha = 1;
  }

  fan(pen, doc, track, index, pose) {
    const { kept, every, first_rad: first, apart_rad: apart, whole, max_range_m: most, forward_m: forward, tilt_rad: tilt } = doc.scan;
    const from = [pose.x + forward * Math.cos(pose.yaw), pose.y + forward * Math.sin(pose.yaw)];
    const end = (beam, range) => {
      const angle = pose.yaw + first + beam * apart;
      const reach = range * Math.cos(tilt);
      return [this.view.x(from[0] + reach * Math.cos(angle)), this.view.y(from[1] + reach * Math.sin(angle))];
    };
    if ((index + 1) * kept <= track.scan.length) {
      pen.beginPath();
      // A whole circle has no corner where the laser stands.
      if (!whole) pen.moveTo(this.view.x(from[0]), this.view.y(from[1]));
      for (let beam = 0; beam < kept; beam += 1) pen.lineTo(...end(beam * every, (track.scan[index * kept + beam] / 255) * most));
      pen.closePath();
      pen.globalAlpha = 0.13;
      pen.fillStyle = ink.accent;
      pen.fill();
      pen.globalAlpha = 1;
    }
    const nearest = track.nearest[index] / 1000;
    const start = [this.view.x(from[0]), this.view.y(from[1])];
    line(pen, [start, end(track.nearestBeam[index], nearest)], ink.accent, 1);
    if (track.beam[index] !== NO_BEAM) {
      const rule = doc.rules.findLastIndex((_, at) => track.fired(index, at));
      const range = track.beam[index] === track.nearestBeam[index] ? nearest
        : track.scan.length ? (track.scan[index * kept + Math.round(track.beam[index] / every)] / 255) * most : nearest;
      line(pen, [start, end(track.beam[index], range || nearest)], ruleInk(Math.max(rule, 0)), 2.5);
    }
  }

  robot(pen, doc, pose, flags) {
    const [half, side] = doc.robot_half_m.map((metres) => metres * this.view.scale);
    pen.save();
    pen.translate(this.view.x(pose.x), this.view.y(pose.y));
    pen.rotate(-pose.yaw);
    const grow = Math.max(1, 6 / half);
    pen.scale(grow, grow);
    pen.fillStyle = flags & (CONTACT | FALLEN) ? ink.bad : ink.text;
    const outline = doc.robot_outline_m.map((at) => at.map((metres) => metres * this.view.scale));
    pen.beginPath();
    for (const [x, y] of outline) pen.lineTo(x, -y);
    pen.fill();
    pen.translate(Math.max(...outline.map(([x]) => x)) - half, 0);
    pen.fillStyle = ink.paper;
    pen.beginPath();
    pen.moveTo(half * 0.75, 0);
    pen.lineTo(-half * 0.15, side * 0.6);
    pen.lineTo(-half * 0.15, -side * 0.6);
    pen.fill();
    pen.restore();
  }

  mover(pen, mover, pose) {
    pen.save();
    pen.translate(this.view.x(pose.x), this.view.y(pose.y));
    pen.rotate(-pose.yaw);
    for (const solid of mover.solids) {
      pen.fillStyle = `rgb(${solid.colour.join(' ')})`;
      pen.strokeStyle = ink.text;
      pen.lineWidth = 1;
      pen.beginPath();
      const scale = this.view.scale;
      if (solid.circle_m) pen.arc(solid.circle_m[0] * scale, -solid.circle_m[1] * scale, solid.circle_m[2] * scale, 0, 7);
      else solid.corners_m.forEach(([x, y], at) => (at ? pen.lineTo(x * scale, -y * scale) : pen.moveTo(x * scale, -y * scale)));
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
    pen.restore();
  }
}

/** All worlds of a run, the home world first. */
const worldsOf = (doc) => [doc.world, ...(doc.further_worlds ?? [])];

/** A rule that fires at most steps would cover the plan; it is drawn only when it is pointed at. */
const covers = (track, rule) => track.firings(rule) > 0 && track.firings(rule) >= track.count / 2;

/** What is drawn, in words. */
function mapNote(doc, track, phase) {
  if (!track) return 'these steps are not in this file';
  const left = doc.rules.filter((_, rule) => covers(track, rule)).map((rule) => rule.name);
  return `${phase}: the last ${TRAIL_STEPS} steps, and where rules fired${left.length ? `, but ${left.join(', ')}, which fired at most steps` : ''}; metres`;
}

/** The robot's pose a share of the way from the step before, where no recovery lies between. */
function between(track, index, share, unit) {
  const apart = index > 0 && (track.flags[index - 1] & MOVES);
  return mixed(track, track, index, apart ? 1 : share, unit);
}

/** Points round a circle. */
function ring([x, y, radius]) {
  const turns = Array.from({ length: 49 }, (_, part) => (part * Math.PI) / 24);
  return turns.map((turn) => [x + radius * Math.cos(turn), y + radius * Math.sin(turn)]);
}

/** Where something that drives by itself was between two steps; recovery may have put it back to where it begins. */
function moverPose(track, number, index, share, unit) {
  const apart = index > 0 && (track.flags[index - 1] & MOVES);
  return mixed(track, track.movers[number], index, apart ? 1 : share, unit);
}

function mixed(track, poses, index, share, unit) {
  const apart = index === 0 || track.step(index) !== track.step(index - 1) + 1;
  const [from, part] = apart ? [index, 1] : [index - 1, share];
  let turn = poses.yaw[index] - poses.yaw[from];
  if (turn > 3142) turn -= 6283;
  if (turn < -3142) turn += 6283;
  return {
    x: (poses.x[from] + (poses.x[index] - poses.x[from]) * part) * unit,
    y: (poses.y[from] + (poses.y[index] - poses.y[from]) * part) * unit,
    yaw: (poses.yaw[from] + turn * part) / 1000,
  };
}
