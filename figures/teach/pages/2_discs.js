// SPDX-License-Identifier: GPL-3.0-or-later
// Discs by hand: their regular triangulation T follows, and says what happens to it.
'use strict';

const kRules = [['0', 'r²'], ['1', '√r (the misprint)'], ['2', 'r'], ['3', '0 (Delaunay)']];
/** Where the certificate ends: deeper overlaps, of the smaller radius, may hide a contact. */
const kDeepest = 2 - Math.SQRT2;
const kLeastRadius = 1e-3;

class DiscsBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('aria-label',
        'Discs. Brackets choose one, arrows move it, with Shift finely, plus and minus change ' +
        'its radius, N adds one, Delete removes it.');
    this.show = new Set(start.show ?? ['cells', 'edges']);
    this.rule = start.rule ?? 0;
    this.still = start.still ?? false;
    this.unit = start.unit ?? 1;
    this.skin = start.skin ?? 0;
    this.chosen = start.chosen ?? 0;
    this.events = [];
    this.moves = 0;
    this.stage = new Stage(this.canvas, [0, 0, 1, 0.7]);
    this.addControls();
    this.addHands();
    this.restart();
  }

  // ---- What there is ----------------------------------------------------------------------------

  firstDiscs() {
    const start = this.start;
    if (start.discs) return start.discs.map(disc => [...disc]);
    const random = randomFrom(start.seed ?? 1), discs = [];
    const [least, most] = start.radii ?? [0.035, 0.1];
    for (let tries = 0; discs.length < (start.random ?? 24) && tries < 50000; ++tries) {
      const r = least + (most - least) * random();
      const x = r + (1 - 2 * r) * random(), y = r + (0.7 - 2 * r) * random();
      if (discs.every(d => Math.hypot(d[0] - x, d[1] - y) > 0.93 * (d[2] + r))) {
        discs.push([x, y, r]);
      }
    }
    return discs;
  }
  restart() {
    this.discs = this.firstDiscs();
    this.stage.show(this.start.box ?? this.boxAround());
    this.moves = 0;
    this.build();
  }
  boxAround() {
    const low = axis => Math.min(...this.discs.map(d => d[axis] - d[2]));
    const high = axis => Math.max(...this.discs.map(d => d[axis] + d[2]));
    const margin = 0.12 * Math.max(high(0) - low(0), high(1) - low(1));
    return [low(0) - margin, low(1) - margin, high(0) + margin, high(1) + margin];
  }
  /** Radii as T has them: with skins, where these are shown. */
  reach(disc) {
    return disc[2] * (1 + this.skin);
  }
  inUnits(disc) {
    return [disc[0] * this.unit, disc[1] * this.unit, this.reach(disc) * this.unit];
  }
  /** Builds T anew. If the library refuses, the discs stay what they were. */
  build(discs = this.discs) {
    const done = this.attempt(() => this.library.callWith(
        discs.flatMap(disc => this.inUnits(disc)), 'discs_build', discs.length, this.rule));
    if (!done) return;
    this.discs = discs;
    this.events = [];
    this.chosen = Math.min(this.chosen, discs.length - 1);
    this.library.call('discs_stand_still', this.still ? 1 : 0);
    this.draw();
  }
  /** The library holds the discs of one bench at a time: a page may have several. */
  take() {
    if (DiscsBench.current === this) return;
    DiscsBench.current = this;
    this.build();
  }
  add() {
    const [x0, y0, x1, y1] = this.stage.box, size = Math.min(x1 - x0, y1 - y0);
    this.chosen = this.discs.length;
    this.build([...this.discs, [(x0 + x1) / 2, (y0 + y1) / 2, 0.08 * size]]);
    this.say(`Disc ${this.chosen} was added in the middle.`);
  }
  remove() {
    if (this.discs.length < 2) return;
    const gone = this.chosen;
    this.build(this.discs.filter((_, i) => i !== gone));
    this.say(`Disc ${gone} was removed.`);
  }

  /** Moves a disc along a straight line, and notes every event on the way in its order. */
  move(i, x, y, r) {
    const disc = [x, y, Math.max(r, kLeastRadius * (this.stage.box[2] - this.stage.box[0]))];
    this.take();
    const [px, py, pr] = this.inUnits(disc);
    const moved = this.attempt(() => {
      if (this.still) this.library.call('discs_move', i, px, py, pr);
      else this.library.call('discs_events', i, px, py, pr);
    });
    if (!moved) return;
    this.discs[i] = disc;
    ++this.moves;
    if (!this.still) this.note(i);
    this.draw();
  }
  note(i) {
    const times = this.library.reals(), list = [...this.library.ints()], events = [];
    const pairs = count => Array.from({ length: count }, () => list.splice(0, 2));
    for (const time of times) {
      const [gone, made] = list.splice(0, 2);
      events.push({ time, gone: pairs(gone), made: pairs(made) });
    }
    if (events.length === 0) return;
    this.events = events;
    this.say(`Disc ${i}: ${events.slice(-3).map(inWords).join('; ')}.`);
  }

  // ---- What it looks like -----------------------------------------------------------------------

  draw() {
    if (!this.discs) return;
    if (DiscsBench.current !== this) return this.take();
    this.stage.begin();
    const library = this.library, hue = this.colours, stage = this.stage;
    library.call('discs_hidden');
    this.hidden = new Set(library.ints());
    if (this.show.has('cells')) this.drawCells();
    this.discs.forEach((disc, i) => {
      stage.disc(...disc, { fill: this.hidden.has(i) ? null : hue.grain, alpha: 0.75,
                            stroke: hue.outline, width: i === this.chosen ? 3 : 1.2,
                            dash: this.hidden.has(i) ? [5, 4] : [] });
      if (this.skin > 0) {
        stage.disc(disc[0], disc[1], this.reach(disc), { stroke: hue.new, dash: [3, 3] });
      }
    });
    library.call('discs_edges');
    this.edges = library.groups(2);
    this.drawEdges();
    this.drawContacts();
    for (const event of this.events.slice(-4)) {
      for (const [i, j] of event.gone) this.join(i, j, { stroke: hue.gone, width: 2, dash: [6, 5] });
      for (const [i, j] of event.made) this.join(i, j, { stroke: hue.new, width: 3 });
    }
    if (this.discs.length <= 60) {
      this.discs.forEach(([x, y], i) => stage.text(x, y, String(i), hue.ink));
    }
    if (this.show.has('circle')) this.drawCircle();
    if (this.show.has('tangent')) this.drawTangent();
    this.count();
    this.changed();
  }
  join(i, j, look) {
    const a = this.discs[i], b = this.discs[j];
    if (a && b) this.stage.line([a, b], look);
  }
  drawCells() {
    const [x0, y0, x1, y1] = this.stage.box.map(value => value * this.unit);
    if (!this.attempt(() => this.library.call('discs_cells', x0, y0, x1, y1))) return;
    const counts = this.library.ints(), places = this.library.reals();
    let at = 0;
    for (const count of counts) {
      const corners = [];
      for (let k = 0; k < count; ++k, at += 2) {
        corners.push([places[at] / this.unit, places[at + 1] / this.unit]);
      }
      if (count > 0) {
        this.stage.line(corners, { closed: true, fill: this.colours.cell,
                                   stroke: this.colours.border, width: 1 });
      }
    }
  }
  drawEdges() {
    this.uncertain = 0;
    if (!this.show.has('edges')) return;
    for (const [i, j] of this.edges) {
      const passes = this.skin === 0 || this.passes(i, j);
      if (!passes) ++this.uncertain;
      this.join(i, j, passes ? { stroke: this.still ? this.colours.stale : this.colours.edge }
                             : { stroke: this.colours.gone, width: 3, dash: [2, 5] });
    }
  }
  /** The certificate (skins.hpp): the balls of radius r + skin meet at less than a right angle. */
  passes(i, j) {
    const a = this.discs[i], b = this.discs[j];
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 > this.reach(a) ** 2 + this.reach(b) ** 2;
  }
  drawContacts() {
    this.contacts = this.touching();
    this.missed = 0;
    for (const [i, j, found] of this.contacts) {
      if (found) {
        this.join(i, j, { stroke: this.colours.contact, width: 3 });
      } else {
        ++this.missed;
        this.join(i, j, { stroke: this.colours.ink, width: 7 });
        this.join(i, j, { stroke: this.colours.missed, width: 4 });
      }
    }
  }
  /** Pairs that touch, by trying all, and whether T has the edge. (Without skins, which the
   *  library's own search would count in.) */
  touching() {
    const known = new Set(this.edges.map(([i, j]) => i * 65536 + j)), pairs = [];
    this.discs.forEach((a, i) => this.discs.forEach((b, j) => {
      if (i >= j || Math.hypot(a[0] - b[0], a[1] - b[1]) > a[2] + b[2]) return;
      pairs.push([i, j, known.has(i * 65536 + j)]);
    }));
    return pairs;
  }
  /** The circle that meets three discs at right angles; T has no disc nearer to its centre. */
  drawCircle() {
    if (!this.pointer) return;
    this.library.call('discs_triangles');
    const [px, py] = this.pointer;
    const left = (p, q) => (q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0]) >= 0;
    const under = this.library.groups(3).find(([a, b, c]) =>
        [[a, b], [b, c], [c, a]].every(([i, j]) => left(this.discs[i], this.discs[j])));
    if (!under || !this.attempt(() => this.library.call('discs_circle', ...under))) return;
    const [x, y, square] = this.library.reals();
    this.stage.disc(x / this.unit, y / this.unit, Math.sqrt(Math.abs(square)) / this.unit,
                    { stroke: this.colours.new, width: 2, dash: square < 0 ? [2, 4] : [] });
  }
  /** The power of the pointer to the chosen disc: the square of a tangent's length. */
  drawTangent() {
    const disc = this.discs[this.chosen], [x, y] = this.pointer ?? this.start.from ?? [0, 0];
    const dx = x - disc[0], dy = y - disc[1], square = dx * dx + dy * dy;
    const power = square - disc[2] ** 2, hue = this.colours;
    this.stage.disc(x, y, 4 / this.stage.scale * this.stage.pixel, { fill: hue.contact });
    if (power > 0) {
      const along = disc[2] ** 2 / square, across = disc[2] * Math.sqrt(power) / square;
      const touch = [disc[0] + along * dx - across * dy, disc[1] + along * dy + across * dx];
      this.stage.line([disc, touch], { stroke: hue.ink, dash: [2, 3] });
      this.stage.line([touch, [x, y]], { stroke: hue.contact, width: 3 });
    }
    this.why.textContent = `The power of the point to disc ${this.chosen} is ${shown(power)}` +
        (power > 0 ? `: a tangent of length ${shown(Math.sqrt(power))}, squared.`
                   : ', negative: the point lies inside.');
  }

  count() {
    const rows = [['discs', this.discs.length], ['edges', this.edges.length],
                  ['hidden', this.hidden.size], ['contacts', this.contacts.length],
                  ['missed', this.missed]];
    if (this.skin > 0) rows.push(['edges that fail the certificate', this.uncertain]);
    this.table(rows);
    if (!this.show.has('tangent')) this.why.textContent = this.reason();
  }
  /** Why contacts are missed; and if none is, that. */
  reason() {
    if (this.missed === 0) return 'No contact is missed.';
    const count = this.missed === 1 ? 'One contact is missed: ' : `${this.missed} are missed: `;
    if (this.still) return count + 'T stands still and does not know where the discs are now.';
    if (this.rule !== 0) return count + 'the weight is not r², so the theorem does not hold.';
    const deepest = Math.max(...this.contacts.map(([i, j]) => this.overlap(i, j)));
    if (deepest > kDeepest) {
      return count + `an overlap is ${shown(deepest)} of the smaller radius, beyond 2 − √2 = ` +
             `${shown(kDeepest, 4)}, where the theorem promises nothing.`;
    }
    return count + 'this must not happen; please tell us.';
  }
  /** Of the smaller radius. */
  overlap(i, j) {
    const a = this.discs[i], b = this.discs[j];
    return (a[2] + b[2] - Math.hypot(a[0] - b[0], a[1] - b[1])) / Math.min(a[2], b[2]);
  }

  // ---- Hands ------------------------------------------------------------------------------------

  addControls() {
    const switches = new Set(this.start.switches ?? ['cells', 'edges', 'circle', 'rule', 'still']);
    const showing = (name, words) => this.tick(words, this.show.has(name), on => {
      this.show[on ? 'add' : 'delete'](name);
      this.draw();
    });
    if (switches.has('cells')) showing('cells', 'Laguerre cells');
    if (switches.has('edges')) showing('edges', 'edges of T');
    if (switches.has('circle')) showing('circle', 'orthogonal circle under the pointer');
    if (switches.has('rule')) {
      this.choice('weight', kRules, String(this.rule), value => {
        this.rule = +value;
        this.build();
      });
    }
    if (switches.has('unit')) {
      this.slider('unit of length', { least: -2, most: 2, step: 0.01, value: 0,
                                      show: power => shown(10 ** power) }, power => {
        this.unit = 1 / 10 ** power;
        this.build();
      });
    }
    if (switches.has('skin')) {
      this.slider('skin, of the radius', { least: 0, most: 0.6, step: 0.002, value: this.skin },
                  value => {
        this.skin = value;
        this.build();
      });
    }
    if (switches.has('radius')) {
      const disc = this.start.chosen ?? 0, first = this.firstDiscs()[disc];
      this.slider(`radius of disc ${disc}`, { least: 0.01 * first[2], most: 4 * first[2],
                                              step: first[2] / 500, value: first[2] }, r => {
        this.move(disc, this.discs[disc][0], this.discs[disc][1], r);
      });
    }
    if (switches.has('still')) {
      this.tick('let T stand still', this.still, on => {
        this.still = on;
        this.build();
      });
    }
    this.button('start again', () => this.restart());
    const lines = [['edge', 'edge of T'], ['contact', 'contact found'],
                   ['missed', 'contact missed']];
    if (switches.has('cells')) lines.push(['border', 'cell']);
    if (!this.start.still) lines.push(['new', 'edge made'], ['gone', 'edge gone']);
    this.explain(lines);
  }

  addHands() {
    let held = null;
    this.canvas.addEventListener('pointerdown', event => {
      this.take();
      const [x, y] = this.stage.place(event);
      const i = this.under(x, y);
      if (i < 0) return;
      this.chosen = i;
      const disc = this.discs[i], away = Math.hypot(disc[0] - x, disc[1] - y);
      const hold = 12 * this.stage.pixel / this.stage.scale;
      held = { i, dx: disc[0] - x, dy: disc[1] - y, rim: Math.abs(away - disc[2]) < hold &&
               away > 0.6 * disc[2] };
      this.canvas.setPointerCapture(event.pointerId);
      this.draw();
    });
    this.canvas.addEventListener('pointermove', event => {
      const [x, y] = this.pointer = this.stage.place(event);
      if (!held) {
        if (this.show.has('circle') || this.show.has('tangent')) this.draw();
        return;
      }
      const disc = this.discs[held.i];
      if (held.rim) this.move(held.i, disc[0], disc[1], Math.hypot(disc[0] - x, disc[1] - y));
      else this.move(held.i, x + held.dx, y + held.dy, disc[2]);
    });
    for (const end of ['pointerup', 'pointercancel']) {
      this.canvas.addEventListener(end, () => { held = null; });
    }
    this.canvas.addEventListener('keydown', event => this.key(event));
  }
  /** The smallest disc under a place, so that a hidden one can be taken hold of as well; else one
   *  whose rim is near. -1: none */
  under(x, y) {
    const hold = 14 * this.stage.pixel / this.stage.scale;
    let best = -1, least = Infinity;
    this.discs.forEach((disc, i) => {
      const away = Math.hypot(disc[0] - x, disc[1] - y) - disc[2];
      if (away < hold && disc[2] < least) {
        best = i;
        least = disc[2];
      }
    });
    return best;
  }
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const i = this.chosen, [x, y, r] = this.discs[i];
    const step = (this.stage.box[2] - this.stage.box[0]) * (event.shiftKey ? 0.001 : 0.01);
    const moves = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0],
                    ArrowDown: [0, -1, 0], '+': [0, 0, 0.5], '=': [0, 0, 0.5], '-': [0, 0, -0.5] };
    const go = moves[event.key];
    if (go) {
      this.move(i, x + go[0] * step, y + go[1] * step, r + go[2] * step);
    } else if (event.key === '[' || event.key === ']') {
      const count = this.discs.length;
      this.chosen = (i + (event.key === ']' ? 1 : count - 1)) % count;
      const disc = this.discs[this.chosen];
      this.draw();
      this.say(`Disc ${this.chosen} of ${count} is chosen: centre ${shown(disc[0])}, ` +
               `${shown(disc[1])}, radius ${shown(disc[2])}` +
               (this.hidden.has(this.chosen) ? ', hidden.' : '.'));
    } else if (event.key === 'n' || event.key === 'N') {
      this.add();
    } else if (event.key === 'Delete' || event.key === 'Backspace') {
      this.remove();
    } else {
      return;
    }
    event.preventDefault();
  }
}

/** An event of T as a part of a sentence. */
function inWords(event) {
  const list = pairs => pairs.map(([i, j]) => `${i}–${j}`).join(', ');
  const { gone, made } = event;
  if (gone.length === 1 && made.length === 1) return `edge ${list(gone)} becomes ${list(made)}`;
  if (made.length === 0) return `edges ${list(gone)} go`;
  if (gone.length === 0) return `edges ${list(made)} come`;
  const kind = gone.length > made.length ? 'a site is hidden or leaves the rim'
                                         : 'a site appears or joins the rim';
  return `${kind}: ${list(gone)} go, ${list(made)} come`;
}
