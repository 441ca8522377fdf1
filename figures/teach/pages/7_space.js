// SPDX-License-Identifier: GPL-3.0-or-later
// Flips in space: a few points that can be turned, and tetrahedra that change places.
'use strict';

class SpaceBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('aria-label',
        'Tetrahedra of a few points. Arrows turn them, Enter flips.');
    this.stage = new Stage(this.canvas, [-1.7, -1.4, 1.7, 1.4]);
    this.turned = [0.5, 0.35];
    this.flips = 0;
    this.choice('flip', start.flips.map((flip, k) => [String(k), flip.name]), '0', value => {
      this.which = +value;
      this.after = false;
      this.draw();
    });
    this.which = 0;
    this.after = false;
    this.button('flip', () => this.flip());
    this.tick('drawn apart', true, on => { this.apart = on; this.draw(); });
    this.apart = true;
    this.radius = 0;
    this.slider('radius of the last site', { least: 0, most: 1.5, step: 0.01, value: 0 }, value => {
      this.radius = value;
      this.draw();
    });
    let held = null;
    this.canvas.addEventListener('pointerdown', event => {
      held = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointermove', event => {
      if (!held) return;
      this.turn((event.clientX - held[0]) / 120, (event.clientY - held[1]) / 120);
      held = [event.clientX, event.clientY];
    });
    for (const end of ['pointerup', 'pointercancel']) {
      this.canvas.addEventListener(end, () => { held = null; });
    }
    this.canvas.addEventListener('keydown', event => {
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1],
                      ArrowDown: [0, 0.1] };
      if (turns[event.key]) this.turn(...turns[event.key]);
      else if (event.key === 'Enter' || event.key === ' ') this.flip();
      else return;
      event.preventDefault();
    });
    this.draw();
  }
  turn(about, over) {
    this.turned[0] += about;
    this.turned[1] = Math.max(-1.5, Math.min(1.5, this.turned[1] + over));
    this.draw();
  }
  flip() {
    this.after = !this.after;
    ++this.flips;
    const flip = this.start.flips[this.which], [from, to] = flip.name.split('-');
    const [before, now] = this.after ? [from, to] : [to, from];
    this.say(`${before} tetrahedra became ${now}.`);
    this.draw();
  }
  /** How many tetrahedra the regular triangulation of the points has, by the library. */
  regular(points) {
    const last = points.length - 1, weight = this.radius ** 2;
    const sites = points.flatMap((point, i) => [...point, i === last ? weight : 0]);
    const good = this.attempt(() => this.library.callWith(sites, 'space_build', points.length));
    return good ? this.library.call('space_tetrahedra') : '–';
  }
  /** Where a point is on the page, and how near it is. */
  seen([x, y, z]) {
    const [a, b] = this.turned;
    const u = x * Math.cos(a) - y * Math.sin(a), v = x * Math.sin(a) + y * Math.cos(a);
    return [u, z * Math.cos(b) - v * Math.sin(b), -(v * Math.cos(b) + z * Math.sin(b))];
  }
  draw() {
    if (!this.turned) return;
    const flip = this.start.flips[this.which], hue = this.colours, stage = this.stage;
    const points = flip.points, tetrahedra = this.after ? flip.after : flip.before;
    const fills = [hue.grain, hue.cell, hue.pale, hue.faint];
    stage.begin();
    const middle = list => [0, 1, 2].map(d => list.reduce((sum, p) => sum + p[d], 0) / list.length);
    const centre = middle(points), faces = [];
    tetrahedra.forEach((corners, k) => {
      const own = middle(corners.map(i => points[i]));
      const shift = own.map((value, d) => this.apart ? 0.35 * (value - centre[d]) : 0);
      const at = i => this.seen(points[i].map((value, d) => value - centre[d] + shift[d]));
      for (let out = 0; out < 4; ++out) {
        const face = corners.filter((_, c) => c !== out).map(at);
        faces.push({ face, fill: fills[k % fills.length],
                     depth: (face[0][2] + face[1][2] + face[2][2]) / 3 });
      }
    });
    faces.sort((f, g) => f.depth - g.depth);
    for (const { face, fill } of faces) {
      stage.line(face, { closed: true, fill, alpha: 0.55, stroke: hue.outline, width: 1.2 });
    }
    points.forEach((point, i) => {
      const [x, y] = this.seen(point.map((value, d) => value - centre[d]));
      if (!this.apart) stage.disc(x, y, 0.035, { fill: hue.ink });
      stage.text(x * 1.28, y * 1.28, String(i), hue.ink);
    });
    this.table([['flip', flip.name], ['tetrahedra drawn', tetrahedra.length],
                ['tetrahedra of T', this.regular(points)]]);
    this.changed();
  }
}
