// SPDX-License-Identifier: GPL-3.0-or-later
// Lifting: sites on a line become points above it, and their triangulation a lower hull.
'use strict';

/** Balls of the line: x and radius. A site is lifted to the height x^2 - r^2. */
class LiftingBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('aria-label',
        'Sites on a line and their lifted points. Brackets choose one, left and right move it, ' +
        'plus and minus change its radius.');
    this.chosen = start.chosen ?? 0;
    this.stage = new Stage(this.canvas, start.box ?? [-2.6, -2.4, 2.6, 5.2]);
    this.button('start again', () => this.restart());
    this.addHands();
    this.explain([['new', 'lower hull'], ['border', 'paraboloid'], ['contact', 'border of cells']]);
    this.restart();
  }
  restart() {
    this.sites = (this.start.sites ?? [[-2, 0.5], [-0.8, 0.4], [0.5, 0.7], [1.7, 0.5]])
                     .map(site => [...site]);
    this.draw();
  }
  height([x, r]) {
    return x * x - r * r;
  }
  /** The lower hull of the lifted points, from left to right, and the sites that are not on it. */
  hull() {
    const order = this.sites.map((_, i) => i).sort((a, b) =>
        this.sites[a][0] - this.sites[b][0] || this.height(this.sites[a]) - this.height(this.sites[b]));
    const hull = [];
    for (const i of order) {
      if (hull.length > 0 && this.sites[hull.at(-1)][0] === this.sites[i][0]) continue;
      const lifted = k => [this.sites[k][0], this.height(this.sites[k])];
      // The sign is that of the power test in one dimension; the library's is exact.
      while (hull.length > 1 && this.library.call('sign_orientation', ...lifted(hull.at(-2)),
                                                  ...lifted(hull.at(-1)), ...lifted(i)) <= 0) {
        hull.pop();
      }
      hull.push(i);
    }
    return hull;
  }
  draw() {
    if (!this.sites) return;
    const stage = this.stage, hue = this.colours, [x0, , x1] = stage.box;
    const good = this.attempt(() => { this.onHull = this.hull(); });
    if (!good) return;
    stage.begin();
    stage.line([[x0, 0], [x1, 0]], { stroke: hue.ink });
    const curve = [];
    for (let k = 0; k <= 100; ++k) {
      const x = x0 + (x1 - x0) * k / 100;
      curve.push([x, x * x]);
    }
    stage.line(curve, { stroke: hue.border });
    const hull = this.onHull.map(i => [this.sites[i][0], this.height(this.sites[i])]);
    stage.line(hull, { stroke: hue.new, width: 3 });
    this.borders = [];
    for (let k = 0; k + 1 < hull.length; ++k) {
      // Where two powers agree: half the slope of the hull's edge.
      const x = (hull[k + 1][1] - hull[k][1]) / (hull[k + 1][0] - hull[k][0]) / 2;
      this.borders.push(x);
      stage.line([[x, -0.5], [x, 0.5]], { stroke: hue.contact, width: 2 });
    }
    this.hidden = new Set(this.sites.map((_, i) => i).filter(i => !this.onHull.includes(i)));
    this.sites.forEach((site, i) => {
      const [x, r] = site, y = this.height(site), hidden = this.hidden.has(i);
      stage.line([[x, 0], [x, y]], { stroke: hue.faint, dash: [3, 3] });
      stage.line([[x - r, 0], [x + r, 0]], { stroke: hue.outline, width: i === this.chosen ? 6 : 4,
                                             alpha: 0.5 });
      stage.disc(x, y, 0.07, { fill: hidden ? hue.paper : hue.new, stroke: hue.ink,
                               width: i === this.chosen ? 3 : 1, dash: hidden ? [2, 2] : [] });
      stage.text(x, -0.75, String(i), hue.ink);
    });
    const [x, r] = this.sites[this.chosen];
    this.table([['site', this.chosen], ['x', shown(x)], ['radius', shown(r)],
                ['height x² − r²', shown(this.height([x, r]))],
                ['on the lower hull', this.hidden.has(this.chosen) ? 'no: hidden' : 'yes']]);
    this.changed();
  }
  move(i, x, r) {
    this.sites[i] = [x, Math.max(0, r)];
    this.draw();
    this.say(this.hidden.has(i) ? `Site ${i} is above the hull: hidden.` : '');
  }
  addHands() {
    let held = null;
    this.canvas.addEventListener('pointerdown', event => {
      const [x, y] = this.stage.place(event);
      const away = this.sites.map(site => Math.min(Math.hypot(site[0] - x, this.height(site) - y),
                                                   Math.hypot(site[0] - x, y)));
      this.chosen = away.indexOf(Math.min(...away));
      held = Math.hypot(this.sites[this.chosen][0] - x, y) <= away[this.chosen] ? 'site' : 'point';
      this.canvas.setPointerCapture(event.pointerId);
      this.draw();
    });
    this.canvas.addEventListener('pointermove', event => {
      if (!held) return;
      const [x, y] = this.stage.place(event), [, r] = this.sites[this.chosen];
      if (held === 'site') this.move(this.chosen, x, r);
      else this.move(this.chosen, x, Math.sqrt(Math.max(0, x * x - y)));
    });
    for (const end of ['pointerup', 'pointercancel']) {
      this.canvas.addEventListener(end, () => { held = null; });
    }
    this.canvas.addEventListener('keydown', event => {
      const [x, r] = this.sites[this.chosen], step = event.shiftKey ? 0.005 : 0.05;
      const count = this.sites.length;
      if (event.key === 'ArrowLeft') this.move(this.chosen, x - step, r);
      else if (event.key === 'ArrowRight') this.move(this.chosen, x + step, r);
      else if (event.key === '+' || event.key === '=') this.move(this.chosen, x, r + step);
      else if (event.key === '-') this.move(this.chosen, x, r - step);
      else if (event.key === ']' || event.key === '[') {
        this.chosen = (this.chosen + (event.key === ']' ? 1 : count - 1)) % count;
        this.draw();
        this.say(`Site ${this.chosen} is chosen.`);
      } else return;
      event.preventDefault();
    });
  }
}
