// SPDX-License-Identifier: GPL-3.0-or-later
// Exercises that the page checks, and the start of everything.
'use strict';

/** What a bench can be asked to be. Each gives the value that the exercise compares. */
const kAsked = {
  missed: bench => bench.missed,
  hidden: bench => bench.hidden?.size,
  contacts: bench => bench.contacts?.length,
  moves: bench => bench.moves,
  flips: bench => bench.flips,
  bad: bench => bench.badLeft,
  uncertain: bench => bench.uncertain,
  wrong: bench => bench.wrong,
  time: bench => bench.time,
  audited: bench => bench.audited,
  /** Whether an edge is there: edge(2,3) */
  edge: (bench, i, j) => Number((bench.edges ?? []).some(([a, b]) => a === i && b === j)),
  /** Whether the centre of a disc lies in the cell of another. */
  outside: (bench, i) => {
    const power = disc => (disc[0] - bench.discs[i][0]) ** 2 + (disc[1] - bench.discs[i][1]) ** 2 -
                          disc[2] ** 2;
    return Number(bench.discs.some((disc, k) => k !== i && power(disc) < power(bench.discs[i])));
  },
  rule: bench => bench.rule,
  still: bench => Number(bench.still),
  which: bench => bench.which,
  error: bench => bench.error,
  steps: bench => bench.steps,
};

/** Whether "missed>=2 still=1 edge(0,1)=0" holds for a bench. */
function holds(wish, bench) {
  return wish.split(/\s+/).filter(Boolean).every(part => {
    const [, name, , list, relation, number] =
        part.match(/^(\w+)(\(([\d,]*)\))?(>=|<=|=)(-?[\d.]+)$/) ?? [];
    if (!kAsked[name]) throw new Error(`an exercise asks for "${part}", which no bench knows`);
    const value = kAsked[name](bench, ...(list ? list.split(',').map(Number) : []));
    if (relation === '>=') return value >= +number;
    if (relation === '<=') return value <= +number;
    return value === +number;
  });
}

/** An exercise to compute: a field for a number, with its unit. */
function addNumberExercise(place) {
  const answer = Number(place.dataset.answer), tolerance = Number(place.dataset.tolerance ?? 0.01);
  const field = make('input', { type: 'text', inputmode: 'decimal', size: 10 });
  const verdict = make('output', { class: 'verdict', 'aria-live': 'polite' });
  const check = () => {
    const value = Number(field.value.trim().replace(',', '.').replace('−', '-'));
    if (field.value.trim() === '' || Number.isNaN(value)) {
      verdict.textContent = 'Please give a number.';
      return;
    }
    const right = Math.abs(value - answer) <= tolerance * Math.abs(answer);
    place.classList.toggle('done', right);
    verdict.textContent = right ? '✓ Right.' : '✗ Not yet.';
  };
  field.addEventListener('keydown', event => { if (event.key === 'Enter') check(); });
  place.append(make('p', { class: 'answer' },
                    make('label', {}, 'Your answer: ', field, ` ${place.dataset.unit ?? ''} `),
                    make('button', { type: 'button', onclick: check }, 'check'), ' ', verdict));
}

/** An exercise to build: it is done once a bench of the page is as it shall be. */
function addBuildExercise(place) {
  const verdict = make('p', { class: 'verdict', 'aria-live': 'polite' }, '○ Not done yet.');
  place.append(verdict);
  document.addEventListener('bench', event => {
    if (place.classList.contains('done') || !event.detail.ready) return;
    // Of several benches of a kind all but the first have names of their own.
    const bench = event.detail.start.name ?? event.detail.place.dataset.bench;
    if (place.dataset.of && bench !== place.dataset.of) return;
    if (!holds(place.dataset.build, event.detail)) return;
    place.classList.add('done');
    verdict.textContent = '✓ Done.';
  });
}

/** An exercise to program: a function in a text field, compared with the right one at some points.
 *  The page runs what its reader has written, and nothing else. */
function addCodeExercise(place) {
  const names = place.dataset.arguments.split(','), right = new Function(...names,
      'return ' + place.dataset.code);
  const text = make('textarea', { rows: 6, spellcheck: false, 'aria-label': 'your function' });
  text.value = place.dataset.begin ?? 'return 0;';
  const verdict = make('output', { class: 'verdict', 'aria-live': 'polite' });
  const check = () => {
    verdict.textContent = '';
    try {
      const own = new Function(...names, text.value), random = randomFrom(3);
      for (let k = 0; k < 200; ++k) {
        const at = names.map(() => Math.round(200 * random() - 80) / 100);
        const wanted = right(...at), got = own(...at);
        if (Math.abs(got - wanted) <= 1e-9 * Math.max(1, Math.abs(wanted))) continue;
        verdict.textContent = `✗ At ${names.map((n, d) => `${n} = ${shown(at[d])}`).join(', ')} ` +
            `your function gives ${shown(Number(got))}, and ${shown(wanted)} is right.`;
        return;
      }
      place.classList.add('done');
      verdict.textContent = '✓ Right at 200 points.';
    } catch (error) {
      verdict.textContent = `✗ ${error.message}`;
    }
  };
  place.append(make('pre', {}, `function force(${names.join(', ')}) {`), text, make('pre', {}, '}'),
               make('p', {}, make('button', { type: 'button', onclick: check }, 'check'), ' ',
                    verdict));
}

const kBenches = { discs: DiscsBench, grains: GrainsBench, signs: SignBench, work: WorkBench,
                   lifting: LiftingBench, flips: FlipsBench, space: SpaceBench };

/** Starts all benches of the page. One that cannot start leaves its still picture and says why. */
function startPage(module) {
  const library = new Library(module), benches = [];
  for (const place of document.querySelectorAll('[data-bench]')) {
    const still = [...place.childNodes];
    try {
      const bench = new kBenches[place.dataset.bench](place, JSON.parse(place.dataset.start || '{}'),
                                                       library);
      bench.ready = true;
      place.classList.add('live');
      benches.push(bench);
    } catch (error) {
      place.replaceChildren(...still, make('p', { class: 'trouble', role: 'alert' },
                                           `This bench could not start: ${error.message}`));
    }
  }
  for (const place of document.querySelectorAll('[data-answer]')) addNumberExercise(place);
  for (const place of document.querySelectorAll('[data-build]')) addBuildExercise(place);
  for (const place of document.querySelectorAll('[data-code]')) addCodeExercise(place);
  window.lagrain = { library, benches };
  document.documentElement.dataset.started = 'yes';
}

if (typeof Lagrain === 'function') {
  Lagrain().then(startPage).catch(error => {
    document.querySelector('main').prepend(make('p', { class: 'trouble', role: 'alert' },
        `What moves on this page could not start (${error.message}); text and pictures stay.`));
  });
}
