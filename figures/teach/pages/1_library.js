// SPDX-License-Identifier: GPL-3.0-or-later
// What the pages share: the compiled library, and pieces that every bench is made of.
'use strict';

/** The compiled library. Its functions leave numbers in two lists, one of reals and one of ints. */
class Library {
  constructor(module) {
    this.module = module;
  }

  /** Calls a function of lab.cpp. Throws its sentence where it refuses. */
  call(name, ...numbers) {
    const answer = this.module['_' + name](...numbers);
    const sentence = this.module.UTF8ToString(this.module._lagrain_error());
    if (sentence) throw new Error(sentence);
    return answer;
  }
  /** The same with a list of numbers that the function reads. */
  callWith(list, name, ...numbers) {
    const start = this.module._lagrain_input(list.length) >> 3;
    this.module.HEAPF64.set(list, start);
    return this.call(name, ...numbers);
  }
  /** Copies: the memory of the module may move at the next call. */
  reals() {
    const start = this.module._lagrain_reals() >> 3;
    return this.module.HEAPF64.slice(start, start + this.module._lagrain_real_count());
  }
  ints() {
    const start = this.module._lagrain_ints() >> 2;
    return this.module.HEAP32.slice(start, start + this.module._lagrain_int_count());
  }
  /** What a call left behind, in groups: pairs, triples, ... */
  groups(size) {
    const list = this.ints(), groups = [];
    for (let k = 0; k + size <= list.length; k += size) groups.push([...list.slice(k, k + size)]);
    return groups;
  }
}

/** A new element with attributes and children. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value !== false) element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children);
  return element;
}

/** The colours of the style sheet, which knows light, dark and print. */
function colours() {
  const style = getComputedStyle(document.documentElement);
  return new Proxy({}, { get: (_, name) => style.getPropertyValue('--' + name).trim() });
}

/** Numbers with as many digits as matter. */
function shown(value, digits = 3) {
  if (!Number.isFinite(value)) return String(value);
  if (Number.isInteger(value)) return String(value).replace('-', '−');
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    const [digitsOf, power] = value.toExponential(digits - 1).split('e');
    const high = [...String(+power)].map(c => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('');
    return `${digitsOf.replace('-', '−')}·10${high}`;
  }
  return String(+value.toPrecision(digits)).replace('-', '−');
}

/** Numbers from a seed, the same on every machine: benches start alike for everybody. */
function randomFrom(seed) {
  let state = seed >>> 0 || 1;
  return () => {
    state ^= state << 13;
    state >>>= 0;
    state ^= state >>> 17;
    state ^= state << 5;
    state >>>= 0;
    return state / 4294967296;
  };
}

/** A drawing area in units of the world, y up, that keeps its sharpness on every screen. */
class Stage {
  /** @param box  [x0, y0, x1, y1] of the world */
  constructor(canvas, box) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d');
    this.show(box);
  }
  show(box) {
    this.box = box;
    this.canvas.style.aspectRatio = `${box[2] - box[0]} / ${box[3] - box[1]}`;
  }
  /** Clears it, and fits its pixels to those of the screen. */
  begin() {
    const ratio = Math.max(2, window.devicePixelRatio || 1);
    const width = Math.round((this.canvas.clientWidth || 600) * ratio);
    const height = Math.round(width * (this.box[3] - this.box[1]) / (this.box[2] - this.box[0]));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    this.scale = width / (this.box[2] - this.box[0]);
    this.pixel = ratio;
    this.pen.clearRect(0, 0, width, height);
  }
  x(x) {
    return (x - this.box[0]) * this.scale;
  }
  y(y) {
    return this.canvas.height - (y - this.box[1]) * this.scale;
  }
  /** Where a pointer is in the world. */
  place(event) {
    const area = this.canvas.getBoundingClientRect();
    const scale = (this.box[2] - this.box[0]) / area.width;
    return [this.box[0] + (event.clientX - area.left) * scale,
            this.box[1] + (area.bottom - event.clientY) * scale];
  }
  /** @param look  { stroke, width, dash, fill, alpha }, lengths in pixels of the page */
  ink(look) {
    const pen = this.pen;
    pen.globalAlpha = look.alpha ?? 1;
    if (look.fill) {
      pen.fillStyle = look.fill;
      pen.fill();
    }
    pen.globalAlpha = 1;
    if (!look.stroke) return;
    pen.strokeStyle = look.stroke;
    pen.lineWidth = (look.width ?? 1) * this.pixel;
    pen.setLineDash((look.dash ?? []).map(length => length * this.pixel));
    pen.lineCap = 'round';
    pen.lineJoin = 'round';
    pen.stroke();
    pen.setLineDash([]);
  }
  disc(x, y, r, look) {
    this.pen.beginPath();
    this.pen.arc(this.x(x), this.y(y), Math.max(0, r * this.scale), 0, 2 * Math.PI);
    this.ink(look);
  }
  line(points, look) {
    this.pen.beginPath();
    for (const [x, y] of points) this.pen.lineTo(this.x(x), this.y(y));
    if (look.closed) this.pen.closePath();
    this.ink(look);
  }
  text(x, y, words, colour, align = 'center') {
    this.pen.fillStyle = colour;
    this.pen.font = `${13 * this.pixel}px ${getComputedStyle(this.canvas).fontFamily}`;
    this.pen.textAlign = align;
    this.pen.textBaseline = 'middle';
    this.pen.fillText(words, this.x(x), this.y(y));
  }
}

/** What all benches have: a stage, controls beside it, sentences below, numbers. */
class Bench {
  constructor(place, start, library) {
    this.place = place;
    this.start = start;
    this.library = library;
    this.colours = colours();
    this.canvas = make('canvas', { tabindex: 0, role: 'application' });
    this.said = make('p', { class: 'said', 'aria-live': 'polite' });
    this.why = make('p', { class: 'why', 'aria-live': 'polite' });
    this.trouble = make('p', { class: 'trouble', role: 'alert', hidden: true });
    this.numbers = make('table', { class: 'numbers' });
    this.controls = make('div', { class: 'controls' });
    this.legend = make('p', { class: 'legend' });
    place.replaceChildren(
        make('div', { class: 'stage' }, this.canvas, this.legend, this.trouble),
        make('div', { class: 'side' }, this.controls, this.said, this.why, this.numbers));
    window.addEventListener('resize', () => this.draw());
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
    window.addEventListener('beforeprint', () => this.draw());
    window.addEventListener('afterprint', () => this.draw());
  }

  /** Does something that the library may refuse: its sentence is shown, and the page goes on. */
  attempt(work) {
    try {
      work();
      this.trouble.hidden = true;
      return true;
    } catch (error) {
      this.trouble.textContent = error.message;
      this.trouble.hidden = false;
      return false;
    }
  }
  say(words) {
    this.said.textContent = words;
  }
  table(rows) {
    this.numbers.replaceChildren(
        ...rows.map(([name, value]) => make('tr', {}, make('th', { scope: 'row' }, name),
                                            make('td', {}, String(value)))));
  }
  /** Samples of lines, each with its meaning. */
  explain(entries) {
    this.legend.replaceChildren(...entries.map(([kind, words]) =>
        make('span', { class: 'key ' + kind }, words)));
  }
  button(words, act) {
    const button = make('button', { type: 'button', onclick: act }, words);
    this.controls.append(button);
    return button;
  }
  tick(words, on, act) {
    const box = make('input', { type: 'checkbox', onchange: () => act(box.checked) });
    box.checked = on;
    this.controls.append(make('label', {}, box, ' ' + words));
    return box;
  }
  choice(words, options, chosen, act) {
    const list = make('select', { onchange: () => act(list.value) });
    for (const [value, name] of options) list.append(make('option', { value }, name));
    list.value = chosen;
    this.controls.append(make('label', {}, words + ' ', list));
    return list;
  }
  slider(words, { least, most, step, value, show = shown }, act) {
    const shownValue = make('output', {}, show(value));
    const bar = make('input', { type: 'range', min: least, max: most, step, value });
    bar.addEventListener('input', () => {
      shownValue.textContent = show(+bar.value);
      act(+bar.value);
    });
    this.controls.append(make('label', {}, words + ' ', bar, ' ', shownValue));
    return bar;
  }
  draw() {}
  /** Tells the exercises of the page that something has changed. */
  changed() {
    document.dispatchEvent(new CustomEvent('bench', { detail: this }));
  }
}
