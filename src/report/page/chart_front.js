// SPDX-License-Identifier: GPL-3.0-or-later
// The Pareto front of a trade study, and in words what it costs to move along it.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const BENT = 0.05; // a front that leaves its chord by less is straight

  const trade = () => mt.result().trade;

  function points() {
    const [a, b] = trade().objectives;
    return trade().points.filter((p) => p.best && p.best.feasible).map((p) => ({ p,
      x: D.objective(p.best, a), y: D.objective(p.best, b) }))
      .filter((q) => T.isNumber(q.x) && T.isNumber(q.y));
  }

  // From the end where the first objective is best to that where the second is.
  function front() {
    const way = D.direction(trade().objectives[0]);
    const made = points().filter((q) => q.p.pareto).sort((a, b) => way * (a.x - b.x));
    return made.filter((q, i) => i === 0 || q.x !== made[i - 1].x || q.y !== made[i - 1].y);
  }

  // Where the front is farthest from its chord, both objectives from 0 to 1.
  function knee(list) {
    const first = list[0];
    const last = list[list.length - 1];
    const u = (q) => (q.x - first.x) / (last.x - first.x);
    const v = (q) => (q.y - first.y) / (last.y - first.y);
    let best = null;
    for (const q of list.slice(1, -1)) {
      const bend = (v(q) - u(q)) / Math.SQRT2; // more gained than paid
      if (bend > BENT && (best === null || bend > best.bend)) {
        best = { q, bend };
      }
    }
    return best ? best.q : null;
  }

  const amount = (x, name) => T.withUnit(T.short(Math.abs(x), 3), D.objectiveUnit(name));

  // "26 % more clearance", "0.4 more change": what is won, or paid.
  function part(x, name, won) {
    const more = (D.direction(name) < 0) === won;
    return `${amount(x, name)} ${more ? 'more' : 'less'} ${name}`;
  }

  function deal(from, to) {
    const [cost, gain] = trade().objectives;
    return `${part(to.y - from.y, gain, true)} for ${part(to.x - from.x, cost, false)}`;
  }

  function lead() {
    const list = front();
    const [cost, gain] = trade().objectives;
    if (list.length < 2) {
      return 'One design is best in both objectives.';
    }
    const first = list[0];
    const last = list[list.length - 1];
    const at = knee(list);
    if (at === null) {
      return `Along the front you get ${deal(first, last)}. It has no knee: the price hardly ` +
        'changes on the way.';
    }
    const rate = (a, b) => Math.abs((b.x - a.x) / (b.y - a.y));
    const ratio = rate(at, last) / rate(first, at);
    return `The knee is at ${cost} ${amount(at.x, cost)}, ${gain} ${amount(at.y, gain)}: up ` +
      `to there you get ${deal(first, at)}; beyond it ${deal(at, last)}, ` +
      `${T.short(ratio, 2)} times the price.`;
  }

  function draw(g, w) {
    const t = trade();
    const marks = mt.tradeMarks;
    const all = points();
    const list = front();
    const box = { left: 62, right: w - 18, top: 12, bottom: 12 + Math.max(220,
      Math.min(380, w * 0.45)) };
    const x = d3.scaleLinear(marks.padded(d3.extent(all, (q) => q.x)), [box.left, box.right]);
    const y = d3.scaleLinear(marks.padded(d3.extent(all, (q) => q.y)), [box.bottom, box.top]);
    F.axisBelow(g, x, [box.left, box.right], D.objectiveTitle(t.objectives[0]), box);
    F.axisLeft(g, y, [box.top, box.bottom], D.objectiveTitle(t.objectives[1]), box);
    g.append('path').attr('fill', 'none').attr('stroke', C.after).attr('stroke-width', 2)
      .attr('d', d3.line().x((q) => x(q.x)).y((q) => y(q.y))(list));
    for (const q of all.slice().sort((a, b) => a.p.pareto - b.p.pareto)) {
      const made = q.p.pareto ? F.mark(g, 'diamond', x(q.x), y(q.y))
        : F.mark(g, 'circle', x(q.x), y(q.y), { colour: C.before, filled: false,
          size: 50 });
      marks.choosable(made, q.p).append('title').text(marks.words(q.p));
      if (marks.isChosen(q.p)) {
        F.mark(g, 'circle', x(q.x), y(q.y), { colour: C.ink, size: 260 })
          .attr('fill', 'none').attr('pointer-events', 'none');
      }
    }
    const at = list.length > 2 ? knee(list) : null;
    if (at) {
      const words = 'knee';
      const end = x(at.x) + 14 + T.width(words) < box.right;
      F.text(g, x(at.x) + (end ? 12 : -12), y(at.y) + 16, words,
        { anchor: end ? 'start' : 'end', bold: true, halo: true });
    }
    return box.bottom + 44 + F.legend(g, [
      { words: 'on the front', draw: (k, a, b) => F.mark(k, 'diamond', a, b) },
      { words: 'beaten in one objective, no better in the other', draw: (k, a, b) =>
        F.mark(k, 'circle', a, b, { colour: C.before, filled: false, size: 50 }) },
    ], 0, box.bottom + 42, w);
  }

  function table() {
    const t = trade();
    return { columns: t.vary.map((v) => T.titled(v.quantity, v.unit)).concat(t.objectives,
      ['pareto']), rows: points().map((q) => q.p.values.concat([q.x, q.y, q.p.pareto])) };
  }

  mt.chartFront = {
    id: 'front', title: 'Pareto front', lead, draw, table,
    has: () => trade() !== null && D.clean(trade().objectives).length === 2 &&
      front().length > 0,
  };
})();
