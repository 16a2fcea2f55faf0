// SPDX-License-Identifier: GPL-3.0-or-later
// Tolerances: how far the parameters may be off, either way, before a band is met.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const BAR = 16;
  const LINE = 14;

  const box = () => mt.choice().design.tolerance_box;

  function rows() {
    const b = box();
    return [{ name: 'all together', percent: b.all_percent, edge: b.edge, all: true }].concat(
      D.clean(b.per_variable)).filter((r) => T.isNumber(r.percent));
  }

  // What there is to draw: of a design that stands on an edge one row says it all.
  const drawn = () => rows().some((r) => r.percent > 0) ? rows() : rows().slice(0, 1);

  function drawRow(g, r, y, x, frame) {
    const tint = r.all ? C.after : C.good;
    const from = x(-r.percent);
    const to = x(r.percent);
    const bar = F.rect(g, from, y + 2, Math.max(1.5, to - from), BAR, tint)
      .attr('fill-opacity', r.all ? 0.85 : 0.45).attr('stroke', tint);
    if (!box().proven) {
      bar.attr('stroke-dasharray', '4 3').attr('fill-opacity', 0.15);
    }
    F.text(g, frame.left - 10, y + 14, T.fit(r.name, frame.left - 12, 12, r.all),
      { anchor: 'end', bold: r.all }).append('title').text(r.name);
    const words = '\u00b1 ' + T.short(r.percent, 3) + ' %';
    const need = T.width(words, 12, true) + 8;
    const outside = to + need <= frame.right;
    F.text(g, outside ? to + 6 : x(0), y + 14, words, { bold: true, halo: true,
      anchor: outside ? 'start' : 'middle' });
    // most often it is one edge for all of them
    const told = r.edge && (r.all || r.edge !== box().edge);
    const lines = told ? T.wrap('then: ' + r.edge, frame.right - frame.left, 11) : [];
    lines.forEach((line, i) => F.text(g, frame.left, y + BAR + 13 + i * LINE, line,
      { size: 11, colour: C.soft, halo: true }));
    return y + BAR + 8 + lines.length * LINE + 6;
  }

  function draw(g, w) {
    const list = drawn();
    const names = list.map((r) => T.width(r.name, 12, r.all));
    const frame = { left: Math.min(Math.max(...names) + 14, w * 0.32), right: w - 14 };
    const most = Math.max(...list.map((r) => r.percent)) || 1;
    const x = d3.scaleLinear([-most * 1.04, most * 1.04], [frame.left, frame.right]);
    const grid = g.append('g');
    let y = 4;
    for (const r of list) {
      y = drawRow(g, r, y, x, frame);
    }
    F.axisBelow(grid, x, [frame.left, frame.right], 'allowed change, either way [%]',
      { top: 0, bottom: y });
    F.line(grid, x(0), 0, x(0), y, C.soft);
    return y + 42 + F.legend(g, items(list), 0, y + 40, w);
  }

  function items(list) {
    const bar = (tint, opacity) => (g, x, y) => F.rect(g, x - 11, y - 6, 22, 12, tint)
      .attr('fill-opacity', opacity).attr('stroke', tint)
      .attr('stroke-dasharray', box().proven ? null : '4 3');
    const sure = box().proven ? 'proven' : 'sampled, not proven';
    return [{ words: 'all parameters together (' + sure + ')',
      draw: bar(C.after, box().proven ? 0.85 : 0.15) }].concat(list.length > 1
      ? [{ words: 'each alone (' + sure + ')', draw: bar(C.good, box().proven ? 0.45 : 0.15) }]
      : []);
  }

  function lead() {
    const b = box();
    const sure = b.proven ? 'Proven' : 'Sampled, not proven';
    return T.isNumber(b.all_percent) ? `${sure}: all parameters may deviate by ` +
      `${T.short(b.all_percent, 3)} % at once` + (b.edge ? '; then ' + b.edge + '.' : '.') : '';
  }

  mt.chartTolerance = {
    id: 'tolerance', title: 'Tolerances that keep the bands', lead, draw,
    table: () => ({ columns: ['name', 'percent', 'edge', 'proven'],
      rows: rows().map((r) => [r.name, r.percent, r.edge, box().proven]) }),
    has: () => Boolean(box()) && rows().length > 0,
  };
})();
