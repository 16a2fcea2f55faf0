// SPDX-License-Identifier: GPL-3.0-or-later
// What a profile of vibration does: densities of input and output, and below them its tones.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const R = mt.responses;
  const C = F.colour;

  const INPUT_UNIT = 'm/s^2';

  const breakpoints = (d) => D.clean(d.frequency_hz).map((f, i) => ({ f,
    level: D.clean(d.level)[i] })).filter((b) => R.positive(b.f) && R.positive(b.level));
  const densities = (c) => D.clean(c.profile.densities).map(breakpoints)
    .filter((d) => d.length > 1);
  const tones = (c) => D.clean(c.profile.tones).filter((t) => R.positive(t.lower_hz) &&
    t.upper_hz >= t.lower_hz && t.upper_hz >= c.lower_hz && t.lower_hz <= c.upper_hz);

  // Straight in log-log scales; the sum of all; at a step from the side that is asked for.
  function density(all, f, side) {
    let sum = 0;
    for (const d of all) {
      for (let i = 1; i < d.length; i++) {
        const [a, b] = [d[i - 1], d[i]];
        const inside = side > 0 ? f >= a.f && f < b.f : f > a.f && f <= b.f;
        if (inside && b.f > a.f) {
          sum += a.level * Math.pow(b.level / a.level, Math.log(f / a.f) / Math.log(b.f / a.f));
        }
      }
    }
    return sum;
  }

  // Points [f, PSD] of a piece: G |H|^2, on both sides of every breakpoint.
  function output(piece, all, corners) {
    return R.fine(piece, corners).flatMap((a) => [-1, 1].map((side) =>
      [a.f, density(all, a.f, side) * a.m * a.m])
      .filter((point, i) => R.positive(point[1]) && (i === 0 || corners.includes(a.f))));
  }

  function input(c, all, corners) {
    return corners.filter((f) => f >= c.lower_hz && f <= c.upper_hz)
      .concat([c.lower_hz, c.upper_hz]).sort((a, b) => a - b)
      .flatMap((f) => [-1, 1].map((side) => [f, density(all, f, side)]))
      .filter((point) => R.positive(point[1]));
  }

  const squared = (unit) => (/^\w+$/.test(unit) ? unit : `(${unit})`) + '\u00b2';
  const shaken = (s) => s.r.own && s.r.own.vibration;
  const answers = (s) => D.clean(shaken(s) && shaken(s).tones)
    .filter((t) => R.positive(t.frequency_hz) && R.positive(t.peak));

  function layout(c, list, w) {
    const all = densities(c);
    const corners = [...new Set(all.flat().map((b) => b.f))];
    const same = c.output_unit === INPUT_UNIT;
    const lines = list.map((s) => ({ s, pieces: s.r.pieces.map((piece) =>
      output(piece, all, corners)) }));
    const given = input(c, all, corners);
    const ends = list.flatMap((s, i) => {
      const [least, most] = R.extent(s.r);
      const range = d3.extent(lines[i].pieces.flat(), (point) => point[1]);
      const of = d3.extent(given, (point) => point[1]);
      return [Math.max(range[0], least * least * of[0]),
        Math.min(range[1], most * most * of[1])];
    });
    const values = ends.concat(same ? given.map((v) => v[1]) : []);
    const stems = tones(c);
    const peaks = list.flatMap((s) => answers(s).map((t) => t.peak))
      .concat(same ? stems.map((t) => t.level) : []);
    const height = Math.max(180, Math.min(300, w * 0.32));
    const p = { c, all, lines, given: same ? given : [], stems, same,
      size: R.padded(values), peaks: R.padded(peaks) };
    p.ticks = R.ticks(p.size, Math.floor(height / 34));
    p.under = R.ticks(p.peaks, 3);
    const left = Math.max(R.room(p.ticks), R.room(p.under));
    p.x = d3.scaleLog().domain([c.lower_hz, c.upper_hz]).range([left, w - 14]);
    const upper = all.length > 0 ? height : 0;
    const lower = peaks.some(R.positive) ? Math.max(110, height * 0.5) : 0;
    p.box = { left, right: w - 14, top: 10, bottom: 10 + upper };
    p.low = { left, right: w - 14, top: p.box.bottom + (upper > 0 && lower > 0 ? 14 : 0) };
    p.low.bottom = p.low.top + lower;
    p.end = lower > 0 ? p.low : p.box;
    p.y = d3.scaleLog().domain(p.size).range([p.box.bottom, p.box.top]);
    p.z = d3.scaleLog().domain(p.peaks).range([p.low.bottom, p.low.top + 10]);
    return p;
  }

  const kept = (scale, v) => {
    const [low, high] = scale.domain();
    return scale(Math.max(low, Math.min(high, v)));
  };

  function drawDensities(g, p, k) {
    F.axisLeft(g, p.y, [p.box.top, p.box.bottom], T.fit(`PSD [${squared(p.c.output_unit)}/Hz]`,
      p.box.bottom - p.box.top), Object.assign({ ticks: p.ticks }, p.box));
    const inside = R.clip(g, p.box, `clip-psd-${k}`);
    const line = d3.line().x((v) => p.x(v[0])).y((v) => p.y(v[1]));
    inside.append('path').attr('d', line(p.given)).attr('fill', 'none')
      .attr('stroke', C.other).attr('stroke-width', 1.6).attr('stroke-dasharray', '2 3');
    for (const l of p.lines) {
      R.path(inside, l.s, l.pieces.map((piece) => line(piece) || '').join(''));
    }
  }

  function drawTones(g, p, list) {
    const { x, z, low } = p;
    F.axisLeft(g, z, [low.top, low.bottom], T.fit(T.titled('tones', p.c.output_unit),
      low.bottom - low.top), Object.assign({ ticks: p.under }, low));
    for (const t of p.stems) {
      const from = Math.max(low.left, x(t.lower_hz));
      const to = Math.min(low.right, x(t.upper_hz));
      const y = p.same && R.positive(t.level) ? kept(z, t.level) : low.bottom - 3;
      F.rect(g, from - 1, y - 1.5, Math.max(3, to - from + 2), 3, C.other).append('title')
        .text(`${t.tone}: ${T.sig(t.level)} ${INPUT_UNIT}, ${T.sig(t.lower_hz)} to ` +
          `${T.sig(t.upper_hz)} Hz`);
    }
    for (const s of list) {
      for (const t of answers(s)) {
        const at = x(t.frequency_hz) + (s.before ? -3 : 3);
        if (at < low.left - 5 || at > low.right + 5) {
          continue;
        }
        const stem = F.line(g, at, low.bottom, at, kept(z, t.peak), C.ink);
        for (const [name, value] of Object.entries(R.stroke(s))) {
          stem.attr(name, value);
        }
        R.dot(g, s, at, kept(z, t.peak)).append('title').text(`${s.words}, ${t.tone}: ` +
          `${T.sig(t.peak)} ${p.c.output_unit} at ${T.sig(t.frequency_hz)} Hz`);
      }
    }
  }

  function draw(g, w, c, k) {
    const list = R.shown(k);
    const p = layout(c, list, w);
    const frequencies = R.ticks(p.x.domain(), Math.floor(w / 50));
    for (const box of new Set([p.box, p.low])) {
      if (box.bottom > box.top) {
        F.axisBelow(g, p.x, [box.left, box.right], box === p.end ? 'frequency [Hz]' : '',
          Object.assign({ ticks: frequencies, format: box === p.end ? T.short : () => '' },
            box));
      }
    }
    if (p.all.length > 0) {
      drawDensities(g, p, k);
    }
    if (p.low.bottom > p.low.top) {
      drawTones(g, p, list);
    }
    const items = R.keys(list);
    if (p.same || p.low.bottom > p.low.top) {
      items.push({ words: 'the profile', draw: (place, x, y) => F.line(place, x - 13, y, x + 13,
        y, C.other, { 'stroke-width': 2, 'stroke-dasharray': '2 3' }) });
    }
    return p.end.bottom + 44 + F.legend(g, items, 0, p.end.bottom + 42, w);
  }

  function told(s, unit) {
    const v = shaken(s);
    return s.words + ': ' + (v && T.isNumber(v.peak) ? `${T.sig(v.rms)} ${unit} RMS, peak ` +
      `${T.sig(v.peak)} ${unit}` : 'no number' + (v && v.end !== 'finite' ? `, ${v.end}` : ''));
  }

  const lead = (c, k) => R.shown(k).map((s) => told(s, c.output_unit)).join('; ') +
    `. A peak is ${T.short(c.profile.sigma)} times the RMS and the tones.`;

  const table = (c, k) => {
    const p = layout(c, R.shown(k), 680);
    const named = (words, points) => points.map(([f, v]) => [words, null, f, v, null]);
    return {
      columns: ['what', 'tone', 'frequency_hz', 'psd', 'amplitude'],
      rows: named('profile', input(c, p.all, [...new Set(p.all.flat().map((b) => b.f))]))
        .concat(p.lines.flatMap((l) => named(l.s.words, l.pieces.flat())),
          p.lines.flatMap((l) => answers(l.s).map((t) =>
            [l.s.words, t.tone, t.frequency_hz, null, t.peak]))),
    };
  };

  mt.chartPsd = () => R.asked().map((c, k) => c.profile ? {
    id: 'psd-' + (k + 1), place: 'psd', title: 'Under ' + (c.profile.name || c.profile.file) +
      ': ' + R.name(c), lead: () => lead(c, k), draw: (g, w) => draw(g, w, c, k),
    table: () => table(c, k),
    has: () => R.positive(c.lower_hz) && c.upper_hz > c.lower_hz && R.shown(k).length > 0 &&
      (densities(c).length > 0 || tones(c).length > 0),
  } : null);
})();
