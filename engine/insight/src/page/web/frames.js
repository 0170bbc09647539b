// The camera's image, what each filter made of it, the grid and its state.

class Frames {
  constructor(box, note) {
    this.box = box;
    this.note = note;
    this.parts = null;
    this.shown = null;
  }

  /** Shows a moment; `step` is the one that the player stands at. */
  show(doc, shot, step) {
    if (!shot) {
      if (this.shown !== null) this.box.replaceChildren();
      this.parts = null;
      this.shown = null;
      this.note.textContent = 'no picture of this phase is kept here';
      return;
    }
    const apart = step - shot.step;
    this.note.textContent = apart === 0 ? `at the end of step ${whole(shot.step)}`
      : `of step ${whole(shot.step)}, ${whole(Math.abs(apart))} ${apart > 0 ? 'earlier' : 'later'}: the nearest kept`;
    if (this.shown === shot) return;
    this.shown = shot;
    const names = shot.stages.map((stage) => stage.name).join();
    if (!this.parts || this.parts.names !== names) this.build(doc, shot, names);
    shot.stages.forEach((stage, index) => { this.parts.images[index].src = stage.picture; });
    shot.shares.forEach((share, cell) => {
      const box = this.parts.cells[cell];
      box.textContent = doc.grid[1] <= 3 ? `${(100 * share).toFixed(1)} %` : doc.grid[1] <= 6 ? (100 * share).toFixed(0) : '';
      box.className = shot.occupied[cell] ? 'occupied' : shot.filled[cell] ? 'filled' : '';
    });
    const filled = shot.filled.filter(Boolean).length;
    this.parts.grid.setAttribute('aria-label', `grid in state ${shot.state}: ${filled} of ${shot.filled.length} cells filled`);
    this.parts.state.textContent = `state ${shot.state}`;
  }

  build(doc, shot, names) {
    const [rows, columns] = doc.grid;
    const ratio = `${shot.size_px[0]} / ${shot.size_px[1]}`;
    const images = shot.stages.map((stage) => {
      const image = el('img', { alt: stage.name });
      image.style.aspectRatio = ratio;
      return image;
    });
    const cells = shot.shares.map(() => el('span'));
    const grid = el('div', { class: 'cells', role: 'img', 'aria-label': 'grid' }, ...cells);
    grid.style.gridTemplateColumns = `repeat(${columns}, 1fr)`;
    grid.style.aspectRatio = ratio;
    const state = el('b');
    const captions = shot.stages.map((stage, index) =>
      index === 0 ? `camera, ${shot.size_px[0]} × ${shot.size_px[1]} px` : `filter ${stage.name}`);
    this.parts = { names, images, cells, grid, state };
    this.box.replaceChildren(
      ...images.map((image, index) => el('figure', {}, image, el('figcaption', { text: captions[index] }))),
      el('figure', {}, grid, el('figcaption', {}, `grid ${rows} × ${columns}, `, state)),
    );
  }
}

/** The kept moment nearest to a step. */
function nearestShot(shots, seed, phase, step) {
  let best = null;
  for (const shot of shots) {
    if (shot.seed !== seed || shot.phase !== phase) continue;
    if (!best || Math.abs(shot.step - step) < Math.abs(best.step - step)) best = shot;
  }
  return best;
}
