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
    shot.grids.forEach((grid, index) => this.fill(shot, grid, this.parts.grids[index]));
  }

  fill(shot, grid, { box, cells, number }) {
    const columns = grid.size[1];
    grid.shares.forEach((share, cell) => {
      cells[cell].textContent = columns <= 3 ? `${(100 * share).toFixed(1)} %` : columns <= 6 ? (100 * share).toFixed(0) : '';
      cells[cell].className = grid.occupied[cell] ? 'occupied' : grid.filled[cell] ? 'filled' : '';
    });
    const filled = grid.filled.filter(Boolean).length;
    const named = grid.view === null ? `state ${shot.state}` : `number ${grid.number}`;
    box.setAttribute('aria-label', `grid${grid.view === null ? '' : ` of ${grid.view}`} in ${named}: ${filled} of ${grid.filled.length} cells filled`);
    number.textContent = named;
  }

  build(doc, shot, names) {
    const ratio = `${shot.size_px[0]} / ${shot.size_px[1]}`;
    const images = shot.stages.map((stage) => {
      const image = el('img', { alt: stage.name });
      image.style.aspectRatio = ratio;
      return image;
    });
    const grids = shot.grids.map((grid) => {
      const cells = grid.shares.map(() => el('span'));
      const box = el('div', { class: 'cells', role: 'img', 'aria-label': 'grid' }, ...cells);
      box.style.gridTemplateColumns = `repeat(${grid.size[1]}, 1fr)`;
      box.style.aspectRatio = ratio;
      return { box, cells, number: el('b'), caption: `${grid.view ?? 'grid'} ${grid.size[0]} × ${grid.size[1]}, ` };
    });
    const captions = shot.stages.map((stage, index) =>
      index === 0 ? `camera, ${shot.size_px[0]} × ${shot.size_px[1]} px` : `filter ${stage.name}`);
    this.parts = { names, images, grids };
    this.box.replaceChildren(
      ...images.map((image, index) => el('figure', {}, image, el('figcaption', { text: captions[index] }))),
      ...grids.map(({ box, number, caption }) => el('figure', {}, box, el('figcaption', {}, caption, number))),
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
