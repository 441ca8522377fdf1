// SPDX-License-Identifier: GPL-3.0-or-later
// Precision: what doubles say of signs, and what a time step does to an impact.
'use strict';

/** Signs of orientation(p, q, r) for p on a grid of neighbouring doubles: by doubles, exactly.
 *  After Kettner, Mehlhorn, Pion, Schirra, Yap: Classroom examples of robustness problems (2008). */
class SignBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'Two maps of signs, by doubles and exact.');
    this.points = { p: start.p ?? [0.5, 0.5], q: start.q ?? [12, 12], r: start.r ?? [24, 24] };
    this.size = 128;
    for (const name of ['p', 'q', 'r']) this.addPoint(name);
    this.explain([['minus', 'right of the line'], ['zero', 'on it'], ['plus', 'left of it']]);
    this.draw();
  }
  addPoint(name) {
    const fields = this.points[name].map((value, axis) => make('input', {
      type: 'text', inputmode: 'decimal', value: String(value), size: 5,
      'aria-label': `${'xy'[axis]} of ${name}`,
      onchange: event => {
        this.points[name][axis] = Number(event.target.value.replace(',', '.'));
        this.draw();
      } }));
    this.controls.append(make('label', {}, `${name} = ( `, fields[0], ' , ', fields[1], ' )'));
  }
  draw() {
    const n = this.size, { p, q, r } = this.points, hue = this.colours;
    const good = this.attempt(() => {
      this.wrong = this.library.call('sign_map', n, ...p, ...q, ...r);
    });
    if (!good) return;
    const signs = this.library.ints(), gap = 8;
    this.canvas.width = 2 * n + gap;
    this.canvas.height = n;
    this.canvas.style.aspectRatio = `${2 * n + gap} / ${n}`;
    this.canvas.style.imageRendering = 'pixelated';
    const pen = this.canvas.getContext('2d'), colour = [hue.gone, hue.paper, hue.new];
    pen.clearRect(0, 0, 2 * n + gap, n);
    for (let map = 0; map < 2; ++map) {
      for (let j = 0; j < n; ++j) {
        for (let i = 0; i < n; ++i) {
          pen.fillStyle = colour[signs[(map * n + j) * n + i]];
          pen.fillRect(map * (n + gap) + i, n - 1 - j, 1, 1);
        }
      }
    }
    this.table([['signs', grouped(n * n)], ['wrong by doubles', grouped(this.wrong)]]);
    this.say(`Left: doubles. Right: exact. ${grouped(this.wrong)} of ${grouped(n * n)} signs are ` +
             'wrong by doubles.');
    this.changed();
  }
}

function grouped(count) {
  return String(count).replace(/\B(?=(\d{3})+$)/g, ',');
}

/** The error of an impact with a known answer, against what it costs: both on logarithmic axes. */
class WorkBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'Error of an impact against evaluations of the force.');
    this.stage = new Stage(this.canvas, [0, 0, 1.2, 0.9]);
    this.restitution = start.restitution ?? 0.5;
    this.steps = start.steps ?? 25;
    this.names = start.integrators;
    // Below 0.3 impacts last longer than the library's measurement waits.
    this.slider('restitution', { least: 0.3, most: 1, step: 0.05, value: this.restitution },
                value => { this.restitution = value; this.draw(); });
    this.slider('steps in a contact', { least: 10, most: 400, step: 1, value: this.steps },
                value => { this.steps = value; this.draw(); });
    this.draw();
  }
  /** What an impact costs and how wrong it is; null where the integrator cannot have a dashpot. */
  measure(integrator, steps) {
    try {
      this.library.call('impact', integrator, steps, this.restitution);
    } catch {
      return null;
    }
    const [, duration, evaluations] = this.library.reals();
    return { error: duration, evaluations };
  }
  draw() {
    if (!this.names) return;
    const stage = this.stage, hue = this.colours, curves = [];
    this.now = this.names.map((_, k) => this.measure(k, this.steps));
    this.names.forEach((_, k) => {
      const curve = [];
      for (let steps = 10; this.now[k] && steps < 1500; steps *= Math.SQRT2) {
        curve.push(this.measure(k, Math.round(steps)));
      }
      curves.push(curve);
    });
    stage.begin();
    const all = curves.flat().filter(point => point.error > 0);
    const span = key => [Math.floor(Math.log10(Math.min(...all.map(p => p[key])))),
                         Math.ceil(Math.log10(Math.max(...all.map(p => p[key]))))];
    const [x0, x1] = span('evaluations'), [y0, y1] = span('error');
    const place = p => [0.16 + 1.0 * (Math.log10(p.evaluations) - x0) / (x1 - x0),
                        0.14 + 0.72 * (Math.log10(Math.max(p.error, 10 ** y0)) - y0) / (y1 - y0)];
    const power = k => '10' + [...String(k)].map(c => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('');
    for (let k = x0; k <= x1; ++k) {
      const [x] = place({ evaluations: 10 ** k, error: 1 });
      stage.line([[x, 0.14], [x, 0.86]], { stroke: hue.faint, width: 0.5 });
      stage.text(x, 0.09, power(k), hue.ink);
    }
    for (let k = y0; k <= y1; ++k) {
      const [, y] = place({ evaluations: 1, error: 10 ** k });
      stage.line([[0.16, y], [1.16, y]], { stroke: hue.faint, width: 0.5 });
      stage.text(0.14, y, power(k), hue.ink, 'right');
    }
    stage.text(0.66, 0.035, 'evaluations of the force in one contact', hue.ink);
    stage.text(0.02, 0.885, 'relative error of the duration', hue.ink, 'left');
    // As the still picture has them.
    const looks = [{ stroke: hue.new, width: 2 }, { stroke: hue.gone, width: 2, dash: [6, 4] },
                   { stroke: hue.contact, width: 2, dash: [2, 4] }, { stroke: hue.ink, width: 2 }];
    curves.forEach((curve, k) => {
      if (curve.length === 0) return;
      stage.line(curve.map(place), looks[k % looks.length]);
      const [x, y] = place(this.now[k]);
      stage.disc(x, y, 0.012, { fill: looks[k % looks.length].stroke });
      const end = place(curve[curve.length - 1]);
      stage.text(end[0], end[1] + 0.035, this.names[k], looks[k % looks.length].stroke, 'right');
    });
    this.table(this.now.map((point, k) =>
        [this.names[k], point ? `${shown(100 * point.error, 2)} %` : 'has no dashpots']));
    this.error = this.now[1]?.error;
    this.changed();
  }
}

