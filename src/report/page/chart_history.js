// SPDX-License-Identifier: GPL-3.0-or-later
// How the search came to its answer: objective and violation of the best design so far, over
// evaluations. One figure for each objective.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const LEAST = 1e-3; // of a tolerance: what is missed by less is drawn there
  const NEAR = 0.01; // of the objective's last value
  const PANEL = { value: 190, violation: 120, gap: 22 };

  const steps = (k) => D.clean(mt.result().run.history).filter((s) => s.objective === k &&
    (T.isNumber(s.value) || T.isNumber(s.violation)));
  const met = (list) => list.filter((s) => s.feasible && T.isNumber(s.value));
  const misses = (list) => list.some((s) => s.violation > LEAST);

  const decades = (low, high) => d3.range(Math.ceil(Math.log10(low) - 1e-9),
    Math.floor(Math.log10(high) + 1e-9) + 1);

  // Powers of ten, so many that there is room for them.
  function tens(low, high, most) {
    const all = decades(low, high);
    const each = Math.ceil(all.length / Math.max(2, most));
    return all.filter((e, i) => i % each === 0).map((e) => 10 ** e);
  }

  const tenth = (v) => T.short(v, 2);

  // Steps from left to right, each round a line of its own.
  function stairs(g, list, x, y, value, right) {
    for (const round of new Set(list.map((s) => s.round))) {
      const own = list.filter((s) => s.round === round);
      const next = list.find((s) => s.round > round);
      const points = own.map((s) => [x(s.evaluations), y(value(s))]);
      points.push([next ? x(next.evaluations) : right, points[points.length - 1][1]]);
      g.append('path').attr('fill', 'none').attr('stroke', C.after).attr('stroke-width', 2)
        .attr('stroke-opacity', 0.55).attr('d', d3.line().curve(d3.curveStepAfter)(points));
    }
    for (const s of list) {
      F.mark(g, 'circle', x(s.evaluations), y(value(s)), { filled: s.feasible, size: 42,
        colour: s.feasible ? C.after : C.bad }).append('title').text(words(s));
    }
  }

  const nameOf = (k) => D.clean(mt.result().objectives)[k - 1];

  function words(s) {
    const o = nameOf(s.objective);
    const value = T.isNumber(s.value) && o
      ? `, ${o.text} ${T.withUnit(T.short(s.value, 6), D.objectiveUnit(o.text))}` : '';
    const missed = T.isNumber(s.violation) ? `, missed by ${T.short(s.violation, 3)} tolerances`
      : '';
    return `${s.evaluations} evaluations${value}` + (s.feasible ? ', all goals met' : missed);
  }

  function padded(list) {
    const [a, b] = d3.extent(list);
    const room = b > a ? 0.06 * (b - a) : Math.max(Math.abs(a) * 0.05, 1e-9);
    return [a - room, b + room];
  }

  function draw(k, g, w) {
    const list = steps(k);
    const box = { left: 70, right: w - 20, top: 10 };
    const last = Math.max(2, ...list.map((s) => s.evaluations));
    const x = d3.scaleLog([Math.max(1, Math.min(...list.map((s) => s.evaluations))) * 0.9,
      last * 1.05], [box.left, box.right]);
    const values = list.filter((s) => T.isNumber(s.value));
    const o = nameOf(k);
    let bottom = box.top;
    const ends = { ticks: x.ticks(5).filter((v) => Number.isInteger(Math.log10(v)) ||
      last < 100), format: tenth };
    if (values.length > 0) {
      bottom += PANEL.value;
      const y = d3.scaleLinear(padded(values.map((s) => s.value)), [bottom, box.top]);
      F.axisLeft(g, y, [box.top, bottom], T.fit(o ? D.objectiveTitle(o.text) : 'objective',
        PANEL.value), box);
      stairs(g, values, x, y, (s) => s.value, box.right);
      if (misses(list)) {
        bottom += PANEL.gap;
      }
    }
    if (misses(list)) {
      const top = bottom;
      bottom += PANEL.violation;
      const shown = list.filter((s) => T.isNumber(s.violation));
      const most = Math.max(10, ...shown.map((s) => s.violation)) * 1.5;
      const y = d3.scaleLog([LEAST * 0.7, most], [bottom, top]).clamp(true);
      F.axisLeft(g, y, [top, bottom], T.fit('missed by [tolerances]', PANEL.violation + 20),
        Object.assign({}, box, { ticks: tens(LEAST, most, 5), format: tenth }));
      F.line(g, box.left, y(1), box.right, y(1), C.good, { 'stroke-width': 2,
        'stroke-dasharray': '6 4' });
      stairs(g, shown, x, y, (s) => Math.max(s.violation, LEAST), box.right);
    }
    F.axisBelow(g, x, [box.left, box.right], 'evaluations of designs',
      Object.assign({ top: box.top, bottom }, ends));
    const items = [{ words: 'all goals met', draw: (q, a, b) =>
      F.mark(q, 'circle', a, b, { size: 42 }) }];
    if (list.some((s) => !s.feasible)) {
      items.push({ words: 'some missed', draw: (q, a, b) =>
        F.mark(q, 'circle', a, b, { size: 42, filled: false, colour: C.bad }) });
    }
    if (misses(list)) {
      items.push({ words: 'the tolerance', draw: (q, a, b) => F.line(q, a - 12, b, a + 12, b,
        C.good, { 'stroke-width': 2, 'stroke-dasharray': '6 4' }) });
    }
    return bottom + 44 + F.legend(g, items, 0, bottom + 44, w);
  }

  function lead(k) {
    const list = met(steps(k));
    const all = steps(k);
    if (list.length === 0) {
      return 'No design that meets all goals was found.';
    }
    const end = list[list.length - 1];
    const size = Math.max(Math.abs(end.value), 1e-9);
    const near = list.find((s, i) => list.slice(i).every((q) =>
      Math.abs(q.value - end.value) <= NEAR * size));
    return `The first design that meets all goals came after ${list[0].evaluations} of ` +
      `${all[all.length - 1].evaluations} evaluations, one within ${100 * NEAR} % of the ` +
      `best after ${near.evaluations}.`;
  }

  function table(k) {
    const o = nameOf(k);
    return { columns: ['evaluations', 'round', o ? D.objectiveTitle(o.text) : 'objective',
      'missed by [tolerances]', 'all goals met'],
    rows: steps(k).map((s) => [s.evaluations, s.round, s.value, s.violation,
      s.feasible ? 'yes' : 'no']) };
  }

  mt.chartHistory = function () {
    const n = Math.max(1, D.clean(mt.result().objectives).length);
    return d3.range(1, n + 1).map((k) => ({
      id: 'history-' + k, place: 'history',
      title: () => 'How the search converged' + (n > 1 ? ': ' + nameOf(k).text : ''),
      lead: () => lead(k), draw: (g, w) => draw(k, g, w), table: () => table(k),
      has: () => steps(k).length > 1,
    }));
  };
})();
