// SPDX-License-Identifier: GPL-3.0-or-later
// The trade study: a curve over one quantity, a heat map over two. A click chooses the point's
// design.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const DARK = '#000000'; // on cells, whose colours do not follow the page's
  const LIGHT = '#fefefe';
  const TALL = 720; // px: rows are as high as they may be within
  const SEAM = 6; // px: narrower cells have none between them

  const trade = () => mt.result().trade;

  function objective() {
    const own = D.clean(trade().objectives)[0];
    const first = D.clean(mt.result().objectives)[0];
    return own || (first ? (first.type === 'expression' ? first.text : first.type) : 'change');
  }

  const value = (point) => point.best && point.best.feasible
    ? D.objective(point.best, objective()) : null;
  const isSolved = (point) => ['solved', 'fitted'].includes(point.status);
  const axisTitle = (v) => T.titled(v.quantity, v.unit);

  // What a mark of a point does: it can be clicked and reached by keys.
  function choosable(mark, point) {
    const at = mt.designs().findIndex((d) => d.point === point);
    if (at >= 0) {
      mark.attr('data-at', at).attr('tabindex', 0).attr('role', 'button');
      F.on(mark, 'click', () => mt.choose(at));
      F.on(mark, 'keydown', (event) => {
        if (event.key === 'Enter' || event.key === ' ') {
          event.preventDefault();
          mt.choose(at);
        }
      });
    }
    return mark;
  }

  const isChosen = (point) => mt.choice().point === point;

  function words(point) {
    return D.pointLabel(trade(), point) + ': ' + point.status +
      (T.isNumber(value(point)) ? ', ' + D.objectiveTitle(objective()) + ' ' +
        T.sig(value(point)) : '') + (point.pareto ? ', on the front' : '');
  }

  // --- one quantity ---

  function drawCurve(g, w) {
    const t = trade();
    const box = { left: 62, right: w - 16, top: 12, bottom: 12 + Math.max(200,
      Math.min(340, w * 0.4)) };
    const solved = t.points.filter((p) => T.isNumber(value(p)));
    const x = d3.scaleLinear(padded(d3.extent(t.points, (p) => p.values[0])),
      [box.left, box.right]);
    const y = d3.scaleLinear(padded(d3.extent(solved, value)), [box.bottom - 16, box.top]);
    F.axisBelow(g, x, [box.left, box.right], axisTitle(t.vary[0]), box);
    F.axisLeft(g, y, [box.top, box.bottom], D.objectiveTitle(objective()), box);
    const line = d3.line().defined((p) => T.isNumber(value(p))).x((p) => x(p.values[0]))
      .y((p) => y(value(p)));
    g.append('path').attr('d', line(t.points)).attr('fill', 'none').attr('stroke', C.after)
      .attr('stroke-width', 1.8);
    for (const p of t.points) {
      const at = x(p.values[0]);
      const look = T.isNumber(value(p)) ? { colour: C.after, filled: p.pareto || isSolved(p) }
        : { colour: C.bad };
      const made = T.isNumber(value(p)) ? F.mark(g, 'circle', at, y(value(p)), look)
        : F.mark(g, 'cross', at, box.bottom - 8, look);
      choosable(made, p).append('title').text(words(p));
      if (isChosen(p)) {
        F.mark(g, 'circle', at, T.isNumber(value(p)) ? y(value(p)) : box.bottom - 8,
          { colour: C.ink, size: 240 }).attr('fill', 'none');
      }
    }
    return box.bottom + 44 + F.legend(g, [
      { words: 'best design of the point', draw: (k, a, b) => F.mark(k, 'circle', a, b) },
      { words: 'no design meets the goals', draw: (k, a, b) =>
        F.mark(k, 'cross', a, b, { colour: C.bad }) },
    ], 0, box.bottom + 42, w);
  }

  function padded([low, high]) {
    if (!T.isNumber(low)) {
      return [0, 1];
    }
    const pad = high > low ? (high - low) * 0.06 : Math.max(Math.abs(high) * 0.05, 1e-9);
    return [low - pad, high + pad];
  }

  // --- two quantities ---

  function inkOn(fill) {
    const c = d3.rgb(fill);
    return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b > 140 ? DARK : LIGHT;
  }

  // Area of a sign that stays within its cell.
  const signSize = (size, most) => Math.min(most, (size.w * size.h) / 6);

  // Of values along an edge, `room` px each, those that have place for their words.
  function spaced(values, room, need) {
    const every = Math.max(1, Math.ceil(need / room));
    return values.map((v, i) => ({ v, i })).filter((q) => q.i % every === 0);
  }

  function drawCell(g, p, x, y, size, colours) {
    const v = value(p);
    const fill = T.isNumber(v) ? colours(v) : C.panel;
    const gap = Math.min(size.w, size.h) < SEAM ? 0 : 1;
    const box = F.rect(g, x + gap, y + gap, size.w - 2 * gap, size.h - 2 * gap, fill);
    choosable(box, p).append('title').text(words(p));
    const middle = x + size.w / 2;
    if (T.isNumber(v)) {
      const label = T.short(v, 3);
      if (T.width(label, 11) < size.w - 4 && size.h > 16) {
        F.text(g, middle, y + size.h - 9, label, { anchor: 'middle', size: 11,
          colour: inkOn(fill) }).attr('pointer-events', 'none');
      }
      if (p.pareto) {
        const corner = size.w > 16 && size.h > 16;
        F.mark(g, 'diamond', corner ? x + size.w - 8 : middle, corner ? y + 9
          : y + size.h / 2, { colour: inkOn(fill), size: signSize(size, 28) })
          .attr('pointer-events', 'none');
      }
    } else {
      F.mark(g, 'cross', middle, y + size.h / 2, { colour: C.bad, size: signSize(size, 80) })
        .attr('pointer-events', 'none');
    }
    if (isChosen(p)) {
      F.rect(g, x + 1, y + 1, size.w - 2, size.h - 2, 'none').attr('stroke', C.ink)
        .attr('stroke-width', 3).attr('pointer-events', 'none');
    }
  }

  function drawMap(g, w) {
    const t = trade();
    const xs = [...new Set(t.points.map((p) => p.values[1]))];
    const ys = [...new Set(t.points.map((p) => p.values[0]))].reverse();
    const left = 34 + Math.max(...ys.map((v) => T.width(T.short(v), 11)));
    const size = { w: Math.min(110, (w - left - 8) / xs.length),
      h: Math.max(4, Math.min(36, TALL / ys.length)) };
    const solved = t.points.map(value).filter(T.isNumber);
    const [low, high] = solved.length > 0 ? d3.extent(solved) : [0, 1];
    const colours = (v) => d3.interpolateCividis(1 - (high > low ? (v - low) / (high - low)
      : 0.5) * 0.92);
    for (const p of t.points) {
      drawCell(g, p, left + xs.indexOf(p.values[1]) * size.w, ys.indexOf(p.values[0]) * size.h,
        size, colours);
    }
    const bottom = ys.length * size.h;
    spaced(ys, size.h, 16).forEach(({ v, i }) => F.text(g, left - 6,
      i * size.h + size.h / 2 + 4, T.short(v), { anchor: 'end', size: 11, colour: C.soft }));
    const widest = Math.max(...xs.map((v) => T.width(T.short(v), 11)));
    spaced(xs, size.w, widest + 4).forEach(({ v, i }) => F.text(g,
      left + (i + 0.5) * size.w, bottom + 15, T.short(v),
      { anchor: 'middle', size: 11, colour: C.soft }));
    const middle = left + xs.length * size.w / 2;
    const below = axisTitle(t.vary[1]);
    F.text(g, Math.max(T.width(below) / 2, middle), bottom + 34, below, { anchor: 'middle' });
    const beside = T.fit(axisTitle(t.vary[0]), bottom);
    F.text(g, 0, 0, beside, { anchor: 'middle' })
      .attr('transform', `translate(12,${bottom / 2})rotate(-90)`);
    return bottom + 42 + F.legend(g, mapItems(t, colours, low, high), 0, bottom + 42, w);
  }

  function mapItems(t, colours, low, high) {
    const range = T.short(low, 3) + ' (yellow) to ' + T.short(high, 3) + ' (blue)';
    const items = [{ words: D.objectiveTitle(objective()) + ', ' + range, draw: (g, x, y) => {
      for (let i = 0; i < 8; i++) {
        F.rect(g, x - 12 + i * 3, y - 6, 3.3, 12, colours(low + (high - low) * i / 7));
      }
    } }];
    if (t.points.some((p) => !T.isNumber(value(p)))) {
      items.push({ words: 'no design meets the goals', draw: (g, x, y) =>
        F.mark(g, 'cross', x, y, { colour: C.bad }) });
    }
    if (t.points.some((p) => p.pareto)) {
      items.push({ words: 'on the front', draw: (g, x, y) =>
        F.mark(g, 'diamond', x, y, { colour: C.ink, size: 28 }) });
    }
    return items;
  }

  function table() {
    const t = trade();
    const names = D.clean(mt.result().variables);
    return {
      columns: t.vary.map(axisTitle).concat(['status', objective(), 'change',
        'clearance_percent', 'pareto'], names),
      rows: t.points.map((p) => p.values.concat([p.status, value(p),
        p.best ? p.best.change : null, p.best ? p.best.clearance_percent : null, p.pareto],
      names.map((n, i) => p.best && p.best.parameters[i]
        ? p.best.parameters[i].recommended : null))),
    };
  }

  function lead() {
    const n = trade().points.length;
    const solved = trade().points.filter((p) => T.isNumber(value(p))).length;
    const whole = trade().whole;
    return solved + ' of ' + n + ' points have a design that meets all goals.' +
      (whole === undefined ? '' : ' ' + whole + ' of them can be chosen' + (trade().points
        .some((p) => p.pareto) ? ', on the front' : '') + '; result.json has all designs.');
  }

  mt.tradeMarks = { choosable, isChosen, words, padded };
  mt.chartTrade = {
    id: 'trade', title: 'Trade study', lead, table,
    hint: 'A click on a point shows its best design everywhere.',
    draw: (g, w) => trade().vary.length === 1 ? drawCurve(g, w) : drawMap(g, w),
    has: () => trade() !== null && D.clean(trade().points).length > 0 &&
      [1, 2].includes(trade().vary.length),
  };
})();
