// SPDX-License-Identifier: GPL-3.0-or-later
// All designs in parallel coordinates: a line per design across one axis per parameter and
// objective. The axes lie below each other, which has room for any number of them. Dragging
// along an axis keeps the designs within; a pointer shows one, a click chooses it.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const ROW = 46;
  const LOG_FROM = 50;
  const ranges = new Map(); // what was dragged: axis -> [low, high]

  function designs() {
    const base = { design: mt.result().baseline, kind: 'original', label: 'Original design' };
    const own = mt.designs().map((d, at) => Object.assign({ at }, d));
    return own.some((d) => d.kind === 'original') ? own : [base].concat(own);
  }

  const parameter = (i) => (d) => d.parameters && d.parameters[i]
    ? d.parameters[i].recommended : null;

  function axes() {
    const r = mt.result();
    const parameters = D.clean(r.variables).map((name, i) => ({
      name: T.titled(name, (D.clean(r.baseline.parameters)[i] ||
        D.clean((r.recommendations[0] || {}).parameters)[i] || {}).unit),
      value: parameter(i),
    }));
    const wanted = new Set(D.clean(r.objectives).map((o) => o.type === 'expression' ? o.text
      : o.type).concat(D.clean(r.trade && r.trade.objectives), ['change', 'clearance']));
    wanted.delete('none');
    const objectives = [...wanted].map((name) => ({ name: D.objectiveTitle(name),
      value: (d) => D.objective(d, name), objective: true }));
    return parameters.concat(objectives).filter((a) => {
      const all = designs().map((d) => a.value(d.design)).filter(T.isNumber);
      return all.length > 1 && d3.max(all) > d3.min(all);
    });
  }

  function scaleOf(axis, range) {
    const all = designs().map((d) => axis.value(d.design)).filter(T.isNumber);
    const [low, high] = d3.extent(all);
    const log = low > 0 && high / low > LOG_FROM;
    return (log ? d3.scaleLog : d3.scaleLinear)([low, high], range);
  }

  function passes(d, list) {
    return list.every((a) => {
      const range = ranges.get(a.name);
      const v = a.value(d.design);
      return !range || T.isNumber(v) && v >= range[0] && v <= range[1];
    });
  }

  function look(d) {
    if (d.at !== undefined && mt.designs()[d.at] === mt.choice()) {
      return { stroke: C.ink, width: 3, dash: null };
    }
    if (d.kind === 'original') {
      return { stroke: C.before, width: 2, dash: '6 4' };
    }
    if (!d.design.feasible) {
      return { stroke: C.bad, width: 1, dash: '2 3' };
    }
    return d.kind === 'trade' ? { stroke: C.other, width: 1, dash: null }
      : { stroke: C.after, width: 2, dash: null };
  }

  function drawLines(g, list, scales, top) {
    const layer = g.append('g');
    const height = (d) => mt.designs()[d.at] === mt.choice() ? 2 : d.kind === 'trade' ? 0 : 1;
    const order = designs().slice().sort((a, b) => height(a) - height(b));
    for (const d of order) {
      const at = list.map((a, i) => ({ x: scales[i](a.value(d.design)), y: top + i * ROW,
        ok: T.isNumber(a.value(d.design)) }));
      const path = d3.line().defined((p) => p.ok).x((p) => p.x).y((p) => p.y)(at);
      const l = look(d);
      const made = layer.append('path').datum(d).attr('d', path).attr('fill', 'none')
        .attr('stroke', l.stroke).attr('stroke-width', l.width)
        .attr('stroke-dasharray', l.dash).attr('class', 'design');
      made.append('title').text(d.label + (d.design.grade ? ', ' + d.design.grade : ''));
      F.on(made, 'pointerenter', () => made.attr('stroke-width', l.width + 2.5));
      F.on(made, 'pointerleave', () => made.attr('stroke-width', l.width));
      F.on(made, 'click', () => d.at !== undefined && mt.choose(d.at));
    }
    return layer;
  }

  function drawAxes(g, list, scales, box) {
    list.forEach((a, i) => {
      const y = box.top + i * ROW;
      F.line(g, box.left, y, box.right, y, C.soft);
      const [low, high] = scales[i].domain();
      F.text(g, box.left - 10, y + 4, T.fit(a.name, box.left - 12, 12, a.objective),
        { anchor: 'end', bold: a.objective }).append('title').text(a.name);
      F.text(g, box.left, y + 15, T.short(low), { size: 11, colour: C.soft, halo: true });
      F.text(g, box.right, y + 15, T.short(high), { size: 11, colour: C.soft, anchor: 'end',
        halo: true });
    });
  }

  function brushes(g, list, scales, box, fade) {
    list.forEach((a, i) => {
      const y = box.top + i * ROW;
      const brush = d3.brushX().extent([[box.left, y - 9], [box.right, y + 9]])
        .on('brush end', () => {
          const { selection } = d3.event;
          if (selection) {
            ranges.set(a.name, selection.map(scales[i].invert));
          } else {
            ranges.delete(a.name);
          }
          fade();
        });
      const layer = g.append('g').attr('class', 'brush').call(brush);
      const kept = ranges.get(a.name);
      if (kept) {
        layer.call(brush.move, kept.map(scales[i]));
      }
    });
  }

  function draw(g, w) {
    const list = axes();
    const names = list.map((a) => T.width(a.name, 12, a.objective));
    const box = { left: Math.min(Math.max(...names) + 18, w * 0.34), right: w - 14, top: 14 };
    const scales = list.map((a) => scaleOf(a, [box.left, box.right]));
    const under = g.append('g');
    const lines = drawLines(g, list, scales, box.top);
    drawAxes(under, list, scales, box);
    const fade = () => lines.selectAll('.design').attr('stroke-opacity', (d) =>
      passes(d, list) ? 0.9 : 0.08);
    brushes(g, list, scales, box, fade);
    lines.raise();
    fade();
    const y = box.top + (list.length - 1) * ROW + 24;
    return y + F.legend(g, items(), 0, y, w);
  }

  function items() {
    const stroke = (colour, width, dash) => (g, x, y) => F.line(g, x - 12, y, x + 12, y,
      colour, { 'stroke-width': width, 'stroke-dasharray': dash || 'none' });
    const kinds = designs();
    const made = [{ words: 'shown: ' + mt.choice().short, draw: stroke(C.ink, 3) },
      { words: 'original', draw: stroke(C.before, 2, '6 4') }];
    if (kinds.some((d) => d.kind === 'recommendation')) {
      made.push({ words: 'recommendations', draw: stroke(C.after, 2) });
    }
    if (kinds.some((d) => d.kind === 'trade')) {
      made.push({ words: 'trade points', draw: stroke(C.other, 1) });
    }
    if (kinds.some((d) => d.kind !== 'original' && !d.design.feasible)) {
      made.push({ words: 'goals not met', draw: stroke(C.bad, 1, '2 3') });
    }
    return made;
  }

  function table() {
    const list = axes();
    return { columns: ['design', 'grade'].concat(list.map((a) => a.name)),
      rows: designs().map((d) => [d.label, d.design.grade].concat(list.map((a) =>
        a.value(d.design)))) };
  }

  mt.chartParallel = {
    id: 'parallel', title: 'All designs', draw, table,
    lead: () => 'Each line is a design.',
    hint: 'Drag along an axis to keep those within; click a line to show its design ' +
      'everywhere.',
    has: () => designs().length > 2 && axes().length > 1,
  };
})();
