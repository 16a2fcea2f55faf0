// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency responses in the complex plane (Nyquist's diagram): every resonance is a loop.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const R = mt.responses;
  const C = F.colour;

  const FLATTEST = 0.45; // of a plane, height to width
  const NEAR = 24; // px from the origin, where all low and high frequencies are
  const MARKS = 5; // frequencies that are told at even steps along log f

  const complex = (a) => [a.m * Math.cos(a.p * Math.PI / 180),
    a.m * Math.sin(a.p * Math.PI / 180)];

  // Lines of a design, what is beyond `most` left out.
  function lines(s, most) {
    return s.r.pieces.flatMap((piece) => {
      const made = [[]];
      for (const a of s.r.poles.length > 0 ? R.fine(piece) : piece) {
        if (a.m <= most) {
          made[made.length - 1].push(a);
        } else if (made[made.length - 1].length > 0) {
          made.push([]);
        }
      }
      return made.filter((line) => line.length > 0);
    });
  }

  function layout(list, w) {
    const most = Math.max(...list.map((s) => R.extent(s.r)[1])) * (1 + 1e-9);
    const parts = list.map((s) => ({ s, lines: lines(s, most) }));
    const all = parts.flatMap((part) => part.lines.flat().map(complex));
    const [left, right] = d3.extent(all.map((z) => z[0]).concat(0));
    const [low, high] = d3.extent(all.map((z) => z[1]).concat(0));
    const margin = R.room(d3.ticks(low, high, 10).concat(low, high)) + 10;
    const width = Math.min(w - margin - 14, 640);
    const span = Math.max(right - left, high - low, most * 1e-6, Number.MIN_VALUE * 1e20) * 1.1;
    let unit = width / Math.max(right - left, span * FLATTEST);
    const height = Math.max(width * FLATTEST, Math.min(width, (high - low) * unit * 1.1));
    unit = Math.min(width / ((right - left) * 1.1 || span),
      height / ((high - low) * 1.1 || span));
    const box = { left: margin, right: margin + width, top: 10, bottom: 10 + height };
    const x = d3.scaleLinear([(left + right - width / unit) / 2,
      (left + right + width / unit) / 2], [box.left, box.right]);
    const y = d3.scaleLinear([(low + high - height / unit) / 2,
      (low + high + height / unit) / 2], [box.bottom, box.top]);
    return { parts, box, x, y };
  }

  // Frequencies along a design: its peaks, and a few between the ends.
  function marks(s, c) {
    const even = d3.range(MARKS).map((i) => c.lower_hz *
      Math.pow(c.upper_hz / c.lower_hz, (i + 0.5) / MARKS));
    return s.r.peaks.map((e) => e.frequency_hz).concat(even);
  }

  function at(parts, f) {
    for (const line of parts.lines) {
      for (let i = 1; i < line.length; i++) {
        if (f >= line[i - 1].f && f <= line[i].f) {
          return R.between(line[i - 1], line[i], f);
        }
      }
    }
    return null;
  }

  function draw(g, w, c, k) {
    const list = R.shown(k);
    const p = layout(list, w);
    const { box, x, y } = p;
    const middle = (box.left + box.right) / 2;
    F.axisBelow(g, x, [box.left, box.right], T.fit(T.titled('real part', c.unit),
      2 * Math.min(middle, w - middle) - 8), box);
    F.axisLeft(g, y, [box.top, box.bottom], T.fit(T.titled('imaginary part', c.unit),
      box.bottom - box.top), box);
    const put = R.labels(g, box, 11);
    put.block(x(0), y(0));
    const curve = d3.line().x((a) => x(complex(a)[0])).y((a) => y(complex(a)[1]))
      .curve(d3.curveCatmullRom);
    for (const part of p.parts) {
      R.path(g, part.s, part.lines.map((line) => curve(line)).join(''));
    }
    for (const part of p.parts.slice().reverse()) {
      for (const f of marks(part.s, c)) {
        const a = at(part, f);
        if (a) {
          const z = complex(a);
          R.dot(g, part.s, x(z[0]), y(z[1])).append('title')
            .text(`${part.s.words}: ${T.sig(a.m)} at ${T.sig(f)} Hz`);
          if (!part.s.before && Math.hypot(x(z[0]) - x(0), y(z[1]) - y(0)) > NEAR) {
            put(x(z[0]), y(z[1]), T.sig(f, 3) + ' Hz', C.after);
          }
        }
      }
    }
    const cx = x(0);
    const cy = y(0);
    F.line(g, cx - 6, cy, cx + 6, cy, C.ink);
    F.line(g, cx, cy - 6, cx, cy + 6, C.ink);
    return box.bottom + 44 + F.legend(g, R.keys(list), 0, box.bottom + 42, w);
  }

  const table = (c, k) => ({
    columns: ['design', 'frequency_hz', T.titled('re', c.unit), T.titled('im', c.unit)],
    rows: R.shown(k).flatMap((s) => s.r.at.map((a) => [s.words, a.f].concat(complex(a)))),
  });

  const lead = (k) => 'From low to high frequencies; marks at peaks and on the way.' +
    (R.shown(k).some((s) => s.r.poles.length > 0)
      ? ' Loops of resonances that nothing damps have no size, and are left out.' : '');

  mt.chartNyquist = () => R.asked().map((c, k) => ({
    id: 'nyquist-' + (k + 1), place: 'nyquist', title: 'In the complex plane: ' + R.name(c),
    lead: () => lead(k), draw: (g, w) => draw(g, w, c, k), table: () => table(c, k),
    has: () => R.positive(c.lower_hz) && c.upper_hz > c.lower_hz &&
      R.shown(k).some((s) => s.r.at.length > 1 && s.r.poles.length === 0),
  }));
})();
