// SPDX-License-Identifier: GPL-3.0-or-later
// Grains: a simulation by the library, in real time as far as the machine can.
'use strict';

const kKinds = { pour: 0, bed: 1, bounce: 2, cloud: 3 };
/** A picture takes as many steps as fit into this [ms]: it stays fluent, and time slows down. */
const kPatience = 12;
const kFrame = 1 / 60;  // [s]
const kGravity = 9.81;  // [m/s^2]

class GrainsBench extends Bench {
  constructor(place, start, library) {
    super(place, start, library);
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', 'Grains that fall, touch and come to rest.');
    this.show = new Set(start.show ?? ['forces']);
    this.settings = { count: start.count ?? 200, friction: start.friction ?? 0.4,
                      restitution: start.restitution ?? 0.5, follow: start.follow ?? true,
                      skin: start.skin ?? 1.3, certify: start.certify ?? true,
                      leap: start.leap ?? true };
    this.tilt = 0;
    this.slowness = 1;
    this.stage = new Stage(this.canvas, start.box ?? [-0.05, -0.05, 1.05, 1.05]);
    this.addControls();
    new IntersectionObserver(seen => {
      this.seen = seen[0].isIntersecting;
      this.wake();
    }).observe(this.canvas);
    document.addEventListener('visibilitychange', () => this.wake());
    this.restart();
    if (!matchMedia('(prefers-reduced-motion: reduce)').matches) this.run(true);
  }

  /** The library holds the grains of one bench at a time. */
  restart() {
    const { count, friction, restitution, follow, skin, certify, leap } = this.settings;
    GrainsBench.current?.run(false);
    GrainsBench.current = this;
    this.attempt(() => {
      this.library.call('grains_follow', follow ? 1 : 0);
      this.library.call('grains_skin', skin);
      this.library.call('grains_certify', certify ? 1 : 0);
      this.library.call('grains_leap', leap ? 1 : 0);
      this.library.call('grains_start', kKinds[this.start.kind ?? 'pour'], count,
                        this.start.seed ?? 1, friction, restitution);
      this.turn();
    });
    this.draw();
  }
  turn() {
    if (this.start.kind === 'cloud') return;
    const angle = this.tilt * Math.PI / 180;
    this.library.call('grains_gravity', kGravity * Math.sin(angle), -kGravity * Math.cos(angle));
  }

  // ---- Time -------------------------------------------------------------------------------------

  run(on) {
    if (on && GrainsBench.current !== this) this.restart();
    this.running = on;
    this.starter.textContent = on ? 'stop' : 'run';
    this.wake();
  }
  wake() {
    if (this.awake || !this.running || this.seen === false || document.hidden) return;
    this.awake = true;
    requestAnimationFrame(() => this.frame());
  }
  frame() {
    this.awake = false;
    if (!this.running || this.seen === false || document.hidden) return;
    const began = performance.now(), step = this.library.call('grains_time_step');
    const wanted = Math.max(1, Math.round(kFrame / step / (this.start.slowed ?? 1)));
    let done = 0;
    const good = this.attempt(() => {
      while (done < wanted && performance.now() - began < kPatience) {
        const steps = Math.min(16, wanted - done);
        this.library.call('grains_step', steps);
        done += steps;
      }
    });
    if (!good) this.run(false);
    // A mean over half a second or so: the words must not flicker.
    this.slowness += 0.04 * (wanted / Math.max(done, 1) - this.slowness);
    this.draw();
    this.wake();
  }

  // ---- What it looks like -----------------------------------------------------------------------

  draw() {
    if (GrainsBench.current !== this) return;
    const library = this.library, hue = this.colours, stage = this.stage;
    stage.begin();
    library.call('grains_places');
    const places = library.reals(), forces = this.show.has('forces');
    for (let k = 0; k < places.length; k += 4) {
      const [x, y, r, angle] = places.subarray(k, k + 4);
      stage.disc(x, y, r, { fill: forces ? hue.pale : hue.grain, stroke: hue.outline, width: 0.8 });
      if (this.show.has('spin')) {
        stage.line([[x, y], [x + r * Math.cos(angle), y + r * Math.sin(angle)]],
                   { stroke: hue.outline, width: 0.8 });
      }
    }
    if (this.show.has('skins')) this.drawTriangulation();
    if (forces) this.drawForces();
    library.call('grains_walls');
    const walls = library.reals();
    for (let k = 0; k < walls.length; k += 4) {
      stage.line([[walls[k], walls[k + 1]], [walls[k + 2], walls[k + 3]]],
                 { stroke: hue.ink, width: 3 });
    }
    this.report();
    this.changed();
  }
  drawTriangulation() {
    this.library.call('grains_triangulation');
    const edges = this.library.groups(2), list = this.library.reals(), hue = this.colours;
    for (const [i, j] of edges) {
      this.stage.line([[list[4 * i], list[4 * i + 1]], [list[4 * j], list[4 * j + 1]]],
                      { stroke: hue.edge, width: 0.6 });
    }
    for (let k = 0; k < list.length; k += 4) {
      this.stage.disc(list[k], list[k + 1], list[k + 2] + list[k + 3],
                      { stroke: hue.new, width: 0.8, dash: [3, 3] });
    }
  }
  /** Normal forces as lines whose width grows with them: force chains. */
  drawForces() {
    this.library.call('grains_contacts');
    const list = this.library.reals(), count = list.length / 5;
    let sum = 0;
    for (let k = 0; k < count; ++k) sum += list[5 * k + 4];
    const mean = sum / Math.max(count, 1) || 1;
    for (let k = 0; k < count; ++k) {
      const [x0, y0, x1, y1, force] = list.subarray(5 * k, 5 * k + 5);
      const width = Math.min(9, 1.6 * force / mean);
      if (width < 0.2) continue;
      this.stage.line([[x0, y0], [x1, y1]], { stroke: this.colours.contact, width });
    }
  }

  report() {
    this.library.call('grains_report');
    const [kinetic, gravity, elastic, dashpot, friction, walls, turned, residual, contacts, mean,
           flips, moved, updates, leaps, audited, missed] = this.library.reals();
    this.missed = missed;
    this.audited = audited;
    this.time = this.library.call('grains_time');
    this.table([['time', `${shown(this.time)} s`], ['contacts', contacts],
                ['contacts per grain', shown(mean)],
                ['references moved', moved], ['flips of T', flips],
                ['contacts audited', audited], ['of these missed', missed]]);
    this.ledger = { kinetic, gravity, elastic, dashpot, friction, walls, turned, residual };
    if (this.show.has('ledger')) this.drawLedger();
    this.why.textContent = (missed > 0
        ? 'Contacts were missed: ' + (this.settings.follow
            ? 'the certificate is off, so nothing promises that there are none.'
            : 'T stands still while the grains move.')
        : audited > 0 ? 'No contact was missed.' : '') +
        (this.running && this.slowness > 1.15
            ? ` Time runs ${shown(this.slowness, 2)} times slower than real.` : '');
  }
  /** Where the energy is, as bars, with numbers beside them. */
  drawLedger() {
    const { kinetic, gravity, elastic, dashpot, friction, residual } = this.ledger;
    const rows = [['moving', kinetic], ['height', gravity], ['springs', elastic],
                  ['lost in dashpots', dashpot], ['lost in friction', friction],
                  ['residual', residual]];
    const most = Math.max(...rows.map(([, value]) => Math.abs(value)), 1e-30);
    if (!this.bars) {
      this.bars = make('table', { class: 'ledger' });
      this.numbers.before(this.bars);
    }
    this.bars.replaceChildren(make('caption', {}, 'energy ledger [J]'), ...rows.map(
        ([name, value]) => make('tr', {}, make('th', { scope: 'row' }, name),
            make('td', {}, make('span', { class: value < 0 ? 'bar minus' : 'bar',
                                          style: `width:${60 * Math.abs(value) / most}%` }),
                 ' ' + shown(value, 2)))));
  }

  addControls() {
    const switches = new Set(this.start.switches ?? ['tilt', 'count', 'forces', 'skins']);
    this.starter = this.button('run', () => this.run(!this.running));
    this.button('start again', () => this.restart());
    const setting = name => value => {
      this.settings[name] = value;
      const running = this.running;
      this.restart();
      this.run(running);
    };
    if (switches.has('tilt')) {
      this.slider('tilt', { least: -45, most: 45, step: 1, value: 0, show: v => `${shown(v)}°` },
                  value => {
        this.tilt = value;
        this.attempt(() => this.turn());
      });
    }
    if (switches.has('count')) {
      this.slider('grains', { least: 50, most: 400, step: 50, value: this.settings.count },
                  setting('count'));
    }
    if (switches.has('friction')) {
      this.slider('friction', { least: 0, most: 1, step: 0.05, value: this.settings.friction },
                  setting('friction'));
    }
    if (switches.has('restitution')) {
      this.slider('restitution', { least: 0.1, most: 1, step: 0.05,
                                   value: this.settings.restitution }, setting('restitution'));
    }
    if (switches.has('skin')) {
      this.slider('skin, of what the certificate allows', { least: 0.1, most: 3, step: 0.1,
                                                            value: this.settings.skin },
                  setting('skin'));
    }
    if (switches.has('follow')) this.tick('T follows', this.settings.follow, setting('follow'));
    if (switches.has('certify')) {
      this.tick('certificate', this.settings.certify, setting('certify'));
    }
    const names = { forces: 'force chains', skins: 'T, references and skins', spin: 'spin',
                    ledger: 'energy ledger' };
    for (const [name, words] of Object.entries(names)) {
      if (!switches.has(name)) continue;
      this.tick(words, this.show.has(name), on => {
        this.show[on ? 'add' : 'delete'](name);
        if (this.bars) this.bars.hidden = !this.show.has('ledger');
        this.draw();
      });
    }
    const lines = [];
    if (switches.has('forces')) lines.push(['contact', 'force at a contact']);
    if (switches.has('skins')) lines.push(['edge', 'edge of T'], ['skin', 'reference with skin']);
    this.explain(lines);
  }
}
