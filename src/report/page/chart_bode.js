// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency responses: magnitude in log-log scales, the phase below it (Bode's diagram), with
// peaks, what turns and what goals allow.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const R = mt.responses;
  const C = F.colour;

  const NAMED = 4; // peaks with words
  const AT_ONE = ' at one frequency';

  const limits = (c) => D.clean(c.limits).filter((l) => R.positive(l.lower_hz) &&
    l.upper_hz >= l.lower_hz);
  const asks = (l) => [[l.at_most, 'at most'], [l.at_least, 'at least'], [l.target, 'target']]
    .filter(([v]) => R.positive(v));

  function layout(c, list, w) {
    const values = list.flatMap((s) => R.extent(s.r))
      .concat(limits(c).flatMap((l) => asks(l).map(([v]) => v)));
    const size = R.padded(values);
    const height = Math.max(190, Math.min(320, w * 0.34));
    const heights = R.ticks(size, Math.floor(height / 34));
    const phases = list.flatMap((s) => s.r.at.map((a) => a.p));
    const step = [45, 90, 180, 360, 720, 1440].find((v) =>
      (d3.max(phases) - d3.min(phases)) / v < 5) || 7200;
    const low = Math.floor((d3.min(phases) + 5) / step) * step;
    const high = Math.max(low + step, Math.ceil((d3.max(phases) - 5) / step) * step);
    const left = Math.max(R.room(heights), R.room([low, high]));
    const x = d3.scaleLog().domain([c.lower_hz, c.upper_hz]).range([left, w - 14]);
    const bands = R.turning(c).map((b) => Object.assign(b, { width: T.width(T.fit(b.label, 70),
      11), x: (x(b.low) + x(b.high)) / 2 }));
    const lines = bands.length > 0 ? T.lanes(bands, left, w - 8, 6) : 0;
    const top = 8 + lines * 14;
    const box = { left, right: w - 14, top, bottom: top + height };
    const under = { left, right: w - 14, top: box.bottom + 12,
      bottom: box.bottom + 12 + height * 0.5 };
    return { c, x, box, under, bands, lines, heights,
      y: d3.scaleLog().domain(size).range([box.bottom, box.top]),
      p: d3.scaleLinear([low, high], [under.bottom - 6, under.top + 6]),
      turns: d3.range(low, high + step / 2, step) };
  }

  function drawBands(g, p) {
    for (const b of p.bands) {
      for (const box of [p.box, p.under]) {
        F.rect(g, p.x(b.low), box.top, Math.max(1.5, p.x(b.high) - p.x(b.low)),
          box.bottom - box.top, C.band).attr('fill-opacity', 0.5).append('title')
          .text(`${b.label} of ${b.of}`);
      }
      const base = p.box.top - 4 - (p.lines - 1 - b.lane) * 14;
      F.text(g, b.at, base, T.fit(b.label, 70), { size: 11, colour: C.bad });
    }
  }

  function drawLimits(g, p) {
    for (const l of limits(p.c)) {
      for (const [v, words] of asks(l)) {
        const y = p.y(v);
        const from = Math.max(p.box.left, p.x(l.lower_hz));
        const to = Math.min(p.box.right, p.x(l.upper_hz));
        (to - from < 2 ? point(g, words, from, y) : bracket(g, words, from, to, y))
          .append('title').text(`${l.pointer}: ${words} ${T.sig(v)} ${p.c.unit}`);
      }
    }
  }

  const point = (g, words, x, y) => F.mark(g, words.startsWith('target') ? 'diamond'
    : 'triangle', x, y, { colour: C.bad, size: 70 });

  function bracket(g, words, from, to, y) {
    const side = words.startsWith('at least') ? -6 : 6;
    return g.append('path').attr('d', `M${from},${y + side}V${y}H${to}V${y + side}`)
      .attr('fill', 'none').attr('stroke', C.bad).attr('stroke-width', 2.4);
  }

  // A piece goes up to the edge where a resonance has no height.
  function magnitude(s, p) {
    const top = p.box.top - 2;
    const y = (m) => Math.max(top, Math.min(p.box.bottom + 50, p.y(m)));
    return s.r.pieces.map((piece, i) => {
      const points = piece.map((a) => [p.x(a.f), y(a.m)]);
      const before = i > 0 && s.r.poles.find((f) => f <= piece[0].f &&
        f > s.r.pieces[i - 1][s.r.pieces[i - 1].length - 1].f);
      const last = piece[piece.length - 1].f;
      const next = i + 1 < s.r.pieces.length && s.r.poles.find((f) => f > last &&
        f <= s.r.pieces[i + 1][0].f);
      return d3.line()((before ? [[p.x(before), top]] : []).concat(points,
        next ? [[p.x(next), top]] : []));
    }).join('');
  }

  function drawCurves(g, p, list, k) {
    const above = R.clip(g, p.box, `clip-bode-${k}`);
    const below = R.clip(g, p.under, `clip-phase-${k}`);
    const put = R.labels(g, p.box, 11);
    for (const s of list) {
      R.path(above, s, magnitude(s, p));
      R.path(below, s, s.r.pieces.map((piece) => d3.line()(piece.map((a) =>
        [p.x(a.f), p.p(a.p)]))).join(''));
      if (s.r.at.length === 1) {
        R.dot(g, s, p.x(s.r.at[0].f), p.y(s.r.at[0].m));
      }
    }
    for (const s of list) {
      s.r.peaks.forEach((e) => put.block(p.x(e.frequency_hz), p.y(e.magnitude)));
    }
    for (const s of list.slice().reverse()) {
      const named = s.r.peaks.slice().sort((a, b) => b.magnitude - a.magnitude).slice(0, NAMED);
      for (const e of s.r.peaks) {
        const x = p.x(e.frequency_hz);
        const y = Math.max(p.box.top, Math.min(p.box.bottom, p.y(e.magnitude)));
        R.dot(g, s, x, y).append('title').text(`${s.words}: ${T.sig(e.magnitude)} at ` +
          `${T.sig(e.frequency_hz)} Hz, damping ratio ${T.sig(e.damping_ratio, 3)}`);
        if (!s.before && named.includes(e)) {
          put(x, y, T.sig(e.frequency_hz) + ' Hz', C.after);
        }
      }
      for (const f of s.r.poles) {
        F.mark(g, 'triangle', p.x(f), p.box.top + 5, { colour: s.before ? C.before : C.after,
          filled: !s.before, size: 60 }).append('title')
          .text(`${s.words}: infinite at ${T.sig(f)} Hz, nothing damps it`);
        if (!s.before) {
          put(p.x(f), p.box.top + 22, T.sig(f) + ' Hz', C.after);
        }
      }
    }
  }

  const measured = (c) => {
    const m = c.measured || {};
    return D.clean(m.frequency_hz).map((f, i) => ({ f, m: D.clean(m.magnitude)[i],
      p: D.clean(m.phase_deg)[i] })).filter((a) => R.positive(a.f) && R.positive(a.m) &&
      T.isNumber(a.p) && a.f >= c.lower_hz && a.f <= c.upper_hz);
  };

  const sign = (g, x, y) => F.mark(g, 'cross', x, y, { colour: C.other, size: 22 });

  // Phases by the turn that is nearest to that of the design.
  function drawMeasured(g, p, list) {
    const [low, high] = p.p.domain();
    const at = list.length > 0 ? list[list.length - 1].r.at : [];
    const place = d3.bisector((a) => a.f).left;
    for (const a of measured(p.c)) {
      const size = p.y(a.m);
      if (size >= p.box.top && size <= p.box.bottom) {
        sign(g, p.x(a.f), size);
      }
      const near = at[Math.min(at.length - 1, place(at, a.f))];
      const phase = a.p - 360 * Math.round((a.p - (near ? near.p : 0)) / 360);
      if (phase >= low && phase <= high) {
        sign(g, p.x(a.f), p.p(phase));
      }
    }
  }

  function legendItems(p, list) {
    const items = R.keys(list);
    if (measured(p.c).length > 0) {
      items.push({ words: 'measured', draw: sign });
    }
    if (list.some((s) => s.r.poles.length > 0)) {
      items.push({ words: 'infinite: nothing damps it', draw: (g, x, y) =>
        F.mark(g, 'triangle', x, y, { size: 60 }) });
    }
    for (const words of new Set(limits(p.c).flatMap((l) => asks(l).map(([, v]) => v +
      (l.upper_hz > l.lower_hz ? '' : AT_ONE))))) {
      items.push({ words: 'a goal: ' + words, draw: (g, x, y) => words.endsWith(AT_ONE)
        ? point(g, words, x, y) : bracket(g, words, x - 12, x + 12, y) });
    }
    if (p.bands.length > 0) {
      items.push({ words: 'what turns', draw: (g, x, y) => F.rect(g, x - 11, y - 6, 22, 12,
        C.band).attr('fill-opacity', 0.5) });
    }
    return items;
  }

  function draw(g, w, c, k) {
    const list = R.shown(k);
    const p = layout(c, list, w);
    const ticks = R.ticks(p.x.domain(), Math.floor(w / 50));
    F.axisBelow(g, p.x, [p.box.left, p.box.right], '', Object.assign({ ticks,
      format: () => '' }, p.box));
    F.axisLeft(g, p.y, [p.box.top, p.box.bottom], T.fit(T.titled('magnitude', c.unit),
      p.box.bottom - p.box.top), Object.assign({ ticks: p.heights }, p.box));
    F.axisLeft(g, p.p, [p.under.top, p.under.bottom], 'phase [deg]',
      Object.assign({ ticks: p.turns }, p.under));
    F.axisBelow(g, p.x, [p.box.left, p.box.right], 'frequency [Hz]', { left: p.box.left,
      right: p.box.right, top: p.under.top, bottom: p.under.bottom,
      ticks });
    drawBands(g, p);
    drawLimits(g, p);
    drawCurves(g, p, list, k);
    drawMeasured(g, p, list);
    return p.under.bottom + 44 + F.legend(g, legendItems(p, list), 0, p.under.bottom + 42, w);
  }

  function peaks(r) {
    const all = r.peaks.map((e) => [e.magnitude, e.frequency_hz])
      .concat(r.poles.map((f) => [Infinity, f])).sort((a, b) => b[0] - a[0]).slice(0, 2);
    return all.length === 0 ? 'no peak' : all.map(([m, f]) =>
      (m < Infinity ? T.sig(m) : 'infinite') + ' at ' + T.sig(f) + ' Hz').join(' and ');
  }

  function lead(c, k) {
    const told = R.shown(k).map((s) => s.words + ': ' + peaks(s.r));
    return (c.description ? c.description.replace(/\.?$/, '. ') : '') + 'Highest peaks, ' +
      told.join('; ') + '.';
  }

  const table = (c, k) => ({
    columns: ['design', 'frequency_hz', T.titled('magnitude', c.unit), 'phase_deg'],
    rows: R.shown(k).flatMap((s) => s.r.at.map((a) => [s.words, a.f, a.m, a.p]))
      .concat(measured(c).map((a) => ['measured', a.f, a.m, a.p])),
  });

  mt.chartBode = () => R.asked().map((c, k) => ({
    id: 'bode-' + (k + 1), place: 'bode', title: 'Response of ' + R.name(c),
    lead: () => lead(c, k), draw: (g, w) => draw(g, w, c, k), table: () => table(c, k),
    has: () => R.positive(c.lower_hz) && c.upper_hz > c.lower_hz && R.shown(k).length > 0,
  }));
})();
