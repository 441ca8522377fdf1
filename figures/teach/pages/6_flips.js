// SPDX-License-Identifier: GPL-3.0-or-later
// Flips by hand: a triangulation that is none of T's, edge by edge to T.
'use strict';

/** The reader flips. Edges that are bad (not regular) and can be flipped, bad ones that cannot,
 *  and good ones look different; signs are the library's, and exact. */
class FlipsBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('aria-label',
        'A triangulation. Brackets choose an inner edge, Enter flips it.');
    this.stage = new Stage(this.canvas, [0, 0, 1, 0.7]);
    this.button('flip the chosen edge', () => this.flip(this.chosen));
    this.button('start again', () => this.restart());
    this.explain([['edge', 'regular edge'], ['gone', 'bad edge, can be flipped'],
                  ['missed', 'bad edge, cannot'], ['new', 'chosen']]);
    this.canvas.addEventListener('pointerdown', event => this.point(this.stage.place(event)));
    this.canvas.addEventListener('keydown', event => this.key(event));
    this.restart();
  }
  restart() {
    this.sites = this.start.sites;
    this.triangles = this.start.triangles.map(triangle => [...triangle]);
    this.flips = 0;
    this.chosen = 0;
    const low = axis => Math.min(...this.sites.map(site => site[axis] - site[2]));
    const high = axis => Math.max(...this.sites.map(site => site[axis] + site[2]));
    const margin = 0.08 * (high(0) - low(0));
    this.stage.show([low(0) - margin, low(1) - margin, high(0) + margin, high(1) + margin]);
    this.say('');
    this.draw();
  }

  left(a, b, c) {
    const place = i => this.sites[i].slice(0, 2);
    return this.library.call('sign_orientation', ...place(a), ...place(b), ...place(c));
  }
  /** Whether d is nearer in power to the orthogonal centre of a, b, c (counter-clockwise) than
   *  they are. */
  conflicts(a, b, c, d) {
    const list = [a, b, c, d].flatMap(i => {
      const [x, y, r] = this.sites[i];
      return [x, y, r * r];
    });
    return this.library.callWith(list, 'sign_power') > 0;
  }
  /** Inner edges, each with the corners that it sees: [a, b, left, right]. */
  innerEdges() {
    const seen = new Map(), inner = [];
    this.triangles.forEach(triangle => {
      for (let k = 0; k < 3; ++k) {
        seen.set(`${triangle[k]},${triangle[(k + 1) % 3]}`, triangle[(k + 2) % 3]);
      }
    });
    for (const [edge, opposite] of seen) {
      const [a, b] = edge.split(',').map(Number), other = seen.get(`${b},${a}`);
      if (a < b && other !== undefined) inner.push([a, b, opposite, other]);
    }
    return inner.sort((e, f) => e[0] - f[0] || e[1] - f[1]);
  }
  isBad([a, b, c, d]) {
    return this.conflicts(a, b, c, d);
  }
  /** The number of sites around a of which only three triangles are left, if one may go. */
  degree(site) {
    return this.triangles.filter(triangle => triangle.includes(site)).length;
  }
  /** What would happen: 'flip' (2-2), 'drop' (3-1: a site loses its place), or '' */
  possible([a, b, c, d]) {
    if (this.left(c, d, b) > 0 && this.left(d, c, a) > 0) return 'flip';
    for (const site of [a, b]) {
      if (this.degree(site) === 3 && !this.onRim(site)) return 'drop';
    }
    return '';
  }
  onRim(site) {
    const around = this.triangles.filter(triangle => triangle.includes(site)).flat();
    return around.some(other => other !== site &&
        this.triangles.filter(t => t.includes(site) && t.includes(other)).length === 1);
  }
  flip(which) {
    const edge = this.inner[which];
    if (!edge) return;
    const [a, b, c, d] = edge, kind = this.possible(edge);
    if (!kind) {
      this.say(`Edge ${a}–${b} cannot be flipped: the two triangles form no convex quadrilateral.`);
      return;
    }
    if (kind === 'flip') {
      this.triangles = this.triangles.filter(t => !(t.includes(a) && t.includes(b)));
      this.triangles.push([c, d, b], [d, c, a]);
      this.say(`Edge ${a}–${b} became ${Math.min(c, d)}–${Math.max(c, d)}.`);
    } else {
      const site = this.degree(a) === 3 && !this.onRim(a) ? a : b;
      const ring = this.triangles.filter(t => t.includes(site));
      const corners = [...new Set(ring.flat())].filter(i => i !== site);
      const [p, q, r] = corners;
      this.triangles = this.triangles.filter(t => !t.includes(site));
      this.triangles.push(this.left(p, q, r) > 0 ? [p, q, r] : [p, r, q]);
      this.say(`Three triangles became one: site ${site} is hidden.`);
    }
    ++this.flips;
    this.draw();
  }
  draw() {
    if (!this.triangles) return;
    const stage = this.stage, hue = this.colours;
    this.attempt(() => {
      this.inner = this.innerEdges();
      this.chosen = Math.min(this.chosen, Math.max(0, this.inner.length - 1));
      this.bad = this.inner.map(edge => this.isBad(edge));
    });
    stage.begin();
    this.sites.forEach(([x, y, r]) => {
      stage.disc(x, y, r, { fill: hue.grain, alpha: 0.6, stroke: hue.outline, width: 0.8 });
    });
    const join = (i, j, look) => stage.line([this.sites[i], this.sites[j]], look);
    for (const [a, b, c] of this.triangles) {
      for (const [i, j] of [[a, b], [b, c], [c, a]]) join(i, j, { stroke: hue.edge, width: 1.2 });
    }
    this.inner.forEach((edge, k) => {
      const [a, b] = edge;
      if (k === this.chosen) join(a, b, { stroke: hue.new, width: 8, alpha: 0.4 });
      if (!this.bad[k]) return;
      if (this.possible(edge)) join(a, b, { stroke: hue.gone, width: 3, dash: [7, 5] });
      else join(a, b, { stroke: hue.ink, width: 3, dash: [1, 6] });
    });
    this.sites.forEach(([x, y], i) => stage.text(x, y, String(i), hue.ink));
    this.badLeft = this.bad.filter(Boolean).length;
    this.stuck = this.badLeft > 0 && !this.inner.some((e, k) => this.bad[k] && this.possible(e));
    this.table([['flips', this.flips], ['bad edges', this.badLeft],
                ['least that can do', this.start.least ?? '–']]);
    this.why.textContent = this.badLeft === 0
        ? `No edge is bad: this is the regular triangulation, after ${this.flips} flips.`
        : this.stuck ? 'No bad edge can be flipped: flips are stuck.' : '';
    this.changed();
  }
  point([x, y]) {
    let least = Infinity;
    this.inner.forEach(([a, b], k) => {
      const [ax, ay] = this.sites[a], [bx, by] = this.sites[b];
      const along = Math.max(0, Math.min(1, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) /
                                            ((bx - ax) ** 2 + (by - ay) ** 2)));
      const away = Math.hypot(ax + along * (bx - ax) - x, ay + along * (by - ay) - y);
      if (away < least) {
        least = away;
        this.chosen = k;
      }
    });
    this.flip(this.chosen);
  }
  key(event) {
    const count = this.inner.length;
    if (event.key === ']' || event.key === '[') {
      this.chosen = (this.chosen + (event.key === ']' ? 1 : count - 1)) % count;
      const [a, b] = this.inner[this.chosen];
      this.draw();
      this.say(`Edge ${a}–${b} is chosen; it is ${this.bad[this.chosen] ? 'bad' : 'regular'}.`);
    } else if (event.key === 'Enter' || event.key === ' ') {
      this.flip(this.chosen);
    } else {
      return;
    }
    event.preventDefault();
  }
}
