// SPDX-License-Identifier: GPL-3.0-or-later
// Published values against ours: how far apart, in per cent of the published one.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const ROW = 20;
  const LINEAR = 1e-3; // per cent; differences up to it are drawn linearly, then by logarithm

  const all = () => D.clean(mt.result().published);
  const comparable = () => all().filter((p) => p.role !== 'not_comparable' &&
    T.isNumber(p.difference_percent));

  function look(p) {
    return p.holds ? { shape: p.role === 'verifies' ? 'diamond' : 'circle', colour: C.good,
      filled: p.role === 'verifies' } : { shape: 'cross', colour: C.bad };
  }

  function draw(g, w) {
    const list = comparable();
    const left = Math.min(Math.max(...list.map((p) => T.width(p.label || p.pointer))) + 14,
      w * 0.45);
    const right = w - 12;
    const most = Math.max(LINEAR * 10, ...list.map((p) => Math.abs(p.difference_percent)));
    // d3's symlog: ln(1 + |x|/c) with the sign of x
    const x = d3.scaleSymlog([-most * 1.5, most * 1.5], [left, right]).constant(LINEAR);
    const bottom = list.length * ROW + 4;
    const powers = d3.range(-3, Math.ceil(Math.log10(most)) + 1).map((k) => Math.pow(10, k));
    const marks = powers.filter((v) => v <= most * 1.5);
    const some = right - left > 460 ? marks : marks.filter((v, i) => (marks.length - 1 - i) % 2
      === 0);
    const ticks = some.map((v) => -v).reverse().concat([0], some);
    F.axisBelow(g, x, [left, right], 'computed less published [%]', { top: 0, bottom, ticks,
      format: (v) => T.short(v, 1) });
    F.line(g, x(0), 0, x(0), bottom, C.soft, { 'stroke-width': 1.5 });
    list.forEach((p, i) => {
      const y = i * ROW + ROW / 2 + 2;
      const l = look(p);
      F.text(g, left - 8, y + 4, T.fit(p.label || p.pointer, left - 10), { anchor: 'end',
        colour: p.holds ? C.ink : C.bad }).append('title').text(p.label || p.pointer);
      F.line(g, x(0), y, x(p.difference_percent), y, l.colour, { 'stroke-width': 1.5 });
      F.mark(g, l.shape, x(p.difference_percent), y, l).append('title').text(
        `published ${p.published}, computed ${T.sig(p.computed, 6)}, ` +
        `${T.percent(p.difference_percent)}; asked: ${p.demand || '-'}`);
    });
    return bottom + 42 + F.legend(g, items(list), 0, bottom + 42, w);
  }

  function items(list) {
    const made = [];
    const put = (test, words, shape, style) => list.some(test) && made.push({ words,
      draw: (g, x, y) => F.mark(g, shape, x, y, style) });
    put((p) => p.holds && p.role === 'verifies', 'holds, verifies', 'diamond',
      { colour: C.good });
    put((p) => p.holds && p.role !== 'verifies', 'holds, calibrates', 'circle',
      { colour: C.good, filled: false });
    put((p) => !p.holds, 'does not hold', 'cross', { colour: C.bad });
    return made;
  }

  function lead() {
    const judged = all().filter((p) => p.role !== 'not_comparable');
    const held = judged.filter((p) => p.holds).length;
    return held === judged.length ? (held === 1 ? 'The published value holds.'
      : `All ${held} published values that can be compared hold.`)
      : `${held} of ${judged.length} published values that can be compared hold.`;
  }

  mt.chartPublished = {
    id: 'published', title: 'Published against computed', lead, draw,
    table: () => ({ columns: ['label', 'kind', 'role', 'published', 'computed', 'difference',
      'difference_percent', 'asked', 'holds', 'source'],
    rows: all().map((p) => [p.label, p.kind, p.role, p.published, p.computed, p.difference,
      p.difference_percent, p.demand, p.holds, p.source]) }),
    has: () => comparable().length > 0,
  };
})();
