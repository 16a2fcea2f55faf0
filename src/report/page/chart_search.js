// SPDX-License-Identifier: GPL-3.0-or-later
// How the answer was found: starts and what they ended at, evaluations by what they were for.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const C = F.colour;

  const ROW = 26;

  // Horizontal bars { name, value } with their numbers behind them.
  function bars(g, w, list, title, tint) {
    const left = Math.min(Math.max(...list.map((b) => T.width(b.name))) + 14, w * 0.5);
    const numbers = Math.max(...list.map((b) => T.width(T.short(b.value, 6)))) + 14;
    const right = w - numbers;
    const most = Math.max(1, ...list.map((b) => b.value));
    const x = d3.scaleLinear([0, most], [left, right]);
    const bottom = list.length * ROW;
    const whole = x.ticks(Math.max(2, Math.round((right - left) / 90)))
      .filter(Number.isInteger);
    F.axisBelow(g, x, [left, right], title, { top: 0, bottom, ticks: whole });
    list.forEach((b, i) => {
      const y = i * ROW;
      F.text(g, left - 8, y + 17, T.fit(b.name, left - 10), { anchor: 'end' });
      F.rect(g, left, y + 5, Math.max(1, x(b.value) - left), ROW - 10, tint);
      F.text(g, x(b.value) + 6, y + 17, T.short(b.value, 6), { halo: true });
    });
    return bottom + 42;
  }

  const run = () => mt.result().run;

  function starts() {
    const r = run();
    const list = [{ name: 'local searches', value: r.starts },
      { name: 'distinct designs', value: r.distinct_designs },
      { name: 'found by one start only', value: r.found_once }];
    return list.filter((b) => T.isNumber(b.value));
  }

  function leadStarts() {
    const r = run();
    const n = T.isNumber(r.distinct_designs) ? `${r.starts} local searches ended at ` +
      `${r.distinct_designs} distinct design${r.distinct_designs === 1 ? '' : 's'}` +
      (r.found_once > 0 ? `, ${r.found_once} of them found once` : '') + '.' : '';
    const missing = T.isNumber(r.estimated_missing)
      ? ` At least ${T.short(r.estimated_missing, 2)} more are to be expected.` : '';
    return n + missing;
  }

  mt.chartStarts = {
    id: 'starts', title: 'The search', lead: leadStarts,
    draw: (g, w) => bars(g, w, starts(), 'number', C.after),
    table: () => ({ columns: ['what', 'number'],
      rows: starts().map((b) => [b.name, b.value]) }),
    has: () => starts().length > 1,
  };

  function spent() {
    const names = { search: 'search', positions: 'positions of drives',
      descriptions: 'descriptions', spread: 'other weights', relaxations: 'relaxations',
      trade: 'trade study' };
    return Object.entries(names).map(([key, name]) => ({ name, value: run().spent[key] }))
      .filter((b) => b.value > 0);
  }

  mt.chartSpent = {
    id: 'spent', title: 'What it took',
    lead: () => `${run().evaluations} evaluations of the model` +
      (run().modal_solutions >= 0 ? `, ${run().modal_solutions} modal solutions` : '') +
      (run().spent.multiplications > 0 ? ', and ' + T.short(run().spent.multiplications, 2) +
        ' multiplications of proofs.' : '.'),
    draw: (g, w) => bars(g, w, spent(), 'evaluations', C.other),
    table: () => ({ columns: ['what', 'evaluations'],
      rows: spent().map((b) => [b.name, b.value]) }),
    has: () => Boolean(run().spent) && spent().length > 1,
  };
})();
