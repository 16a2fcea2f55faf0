// SPDX-License-Identifier: GPL-3.0-or-later
// Frequency responses of designs: their points, what lies between these, scales and signs that
// figures of them share.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const MOST = 12; // of a study with more only the first are drawn
  const STEPS = 300; // even ones in log frequency where a curve is looked at between its points
  const DECADES = 12; // below the highest value that a scale shows
  const BESIDE = 4; // so far beyond that
  const LOG10 = Math.LN10;

  const asked = () => D.clean(mt.result().curves).slice(0, MOST);
  // Beyond these a scale has no room for what lies beside them; drawn there.
  const DRAWN = [1e-290, 1e290];

  const positive = (x) => T.isNumber(x) && x > 0;

  // Points { f, m, p } of curve k at a design, phases turned on; pieces end at resonances that
  // nothing damps, where they go up without end.
  function read(design, k) {
    const c = asked()[k];
    const own = D.clean(design && design.curves)[k];
    const drawn = own && own.drawn;
    const at = [];
    let before = 0;
    D.clean(drawn && drawn.frequency_hz).forEach((f, i) => {
      const m = D.clean(drawn.magnitude)[i];
      const p = D.clean(drawn.phase_deg)[i];
      if (positive(f) && positive(m) && T.isNumber(p) && f >= c.lower_hz * (1 - 1e-6) &&
        f <= c.upper_hz * (1 + 1e-6) && (at.length === 0 || f >= at[at.length - 1].f)) {
        before = at.length === 0 ? p - 360 * Math.round(p / 360) : turned(p, before);
        at.push({ f, m: Math.min(Math.max(m, DRAWN[0]), DRAWN[1]), p: before });
      }
    });
    const extremes = D.clean(own && own.extremes).filter((x) => positive(x.frequency_hz) &&
      x.frequency_hz >= c.lower_hz && x.frequency_hz <= c.upper_hz);
    const poles = extremes.filter((x) => x.kind === 'resonance').map((x) => x.frequency_hz);
    const peaks = extremes.filter((x) => x.kind === 'peak' && positive(x.magnitude));
    return { at, poles, peaks, pieces: divide(at, poles), own };
  }

  // The phase nearest to the one before; of two that are as near the smaller.
  function turned(p, before) {
    const near = p - 360 * Math.round((p - before) / 360);
    const other = near > before ? near - 360 : near + 360;
    const even = Math.abs(Math.abs(near - before) - 180) < 1e-6;
    return even && (Math.abs(other) < Math.abs(near) || Math.abs(other) === Math.abs(near) &&
      other < near) ? other : near;
  }

  function divide(at, poles) {
    const pieces = [[]];
    for (const point of at) {
      const last = pieces[pieces.length - 1];
      const pole = last.length > 0 &&
        poles.find((f) => f > last[last.length - 1].f && f <= point.f);
      if (pole) {
        pieces.push([]);
      }
      pieces[pieces.length - 1].push(point);
    }
    return pieces.filter((piece) => piece.length > 0);
  }

  // Straight over log f: phase, and magnitude in its logarithm.
  function between(a, b, f) {
    const part = b.f > a.f ? Math.log(f / a.f) / Math.log(b.f / a.f) : 0;
    return { f, m: Math.pow(a.m, 1 - part) * Math.pow(b.m, part), p: a.p + part * (b.p - a.p) };
  }

  // The points of a piece, and as many more between them as a turn of a few degrees needs, at
  // the frequencies of `more`, too.
  function fine(piece, more) {
    const made = [];
    piece.forEach((b, i) => {
      if (i > 0) {
        const a = piece[i - 1];
        const n = Math.min(40, Math.ceil(Math.abs(b.p - a.p) / 4 +
          Math.abs(Math.log(b.m) - Math.log(a.m)) * 5));
        const inside = (more || []).filter((f) => f > a.f && f < b.f);
        for (let k = 1; k < n; k++) {
          inside.push(a.f * Math.pow(b.f / a.f, k / n));
        }
        inside.sort((x, y) => x - y).forEach((f) => made.push(between(a, b, f)));
      }
      made.push(b);
    });
    return made;
  }

  // Least and greatest value worth a scale: of peaks without height, and of zeros, what lies a
  // step beside them.
  function extent(r) {
    const even = [];
    for (const piece of r.pieces) {
      const low = Math.log(piece[0].f);
      const high = Math.log(piece[piece.length - 1].f);
      let i = 1;
      for (let k = 0; k <= STEPS; k++) {
        const f = Math.exp(low + (high - low) * (k + 0.5) / (STEPS + 1));
        while (i < piece.length - 1 && piece[i].f < f) {
          i++;
        }
        const m = piece.length > 1 ? between(piece[i - 1], piece[i], f).m : piece[0].m;
        if (positive(m)) {
          even.push(m);
        }
      }
    }
    const [low, high] = d3.extent(r.at, (a) => a.m);
    return [Math.max(low, (d3.min(even) || low) / BESIDE),
      r.poles.length > 0 ? (d3.max(even) || high) * BESIDE : high];
  }

  // What is shown: the original design, and the one that is chosen.
  function shown(k) {
    const choice = mt.choice();
    const list = choice.kind === 'original' ? [] : [{ words: 'original', before: true,
      r: read(mt.result().baseline, k) }];
    list.push({ words: choice.short, before: false, r: read(choice.design, k) });
    return list.filter((s) => s.r.at.length > 0);
  }

  const stroke = (s) => s.before ? { stroke: C.before, 'stroke-width': 1.4,
    'stroke-dasharray': '6 4' } : { stroke: C.after, 'stroke-width': 2 };

  function path(g, s, d) {
    const made = g.append('path').attr('d', d).attr('fill', 'none')
      .attr('stroke-linejoin', 'round');
    for (const [name, value] of Object.entries(stroke(s))) {
      made.attr(name, value);
    }
    return made;
  }

  const dot = (g, s, x, y) => F.mark(g, s.before ? 'square' : 'circle', x, y,
    { colour: s.before ? C.before : C.after, filled: !s.before, size: 45 });

  const keys = (list) => list.map((s) => ({ words: s.words, draw: (g, x, y) => {
    path(g, s, `M${x - 13},${y}H${x + 13}`);
    dot(g, s, x, y);
  } }));

  // --- scales ---

  function padded(values) {
    const real = values.filter(positive);
    const high = real.length > 0 ? d3.max(real) : 1;
    const low = Math.max(real.length > 0 ? d3.min(real) : 1, high * Math.pow(10, -DECADES),
      Number.MIN_VALUE * 1e20);
    const pad = Math.max(1.15, Math.exp(0.05 * (Math.log(high) - Math.log(low))));
    return [low / pad, Math.min(high * pad, Number.MAX_VALUE / 10)];
  }

  // Values of a logarithmic scale: decades, or 1, 2, 5 of few.
  function ticks([low, high], most) {
    const decades = (Math.log(high) - Math.log(low)) / LOG10;
    const step = Math.max(1, Math.ceil(decades / most));
    const parts = decades < most / 2.5 ? [1, 2, 5] : [1];
    const made = [];
    for (let e = Math.floor(Math.log(low) / LOG10); e <= Math.log(high) / LOG10; e++) {
      for (const part of e % step === 0 ? parts : []) {
        made.push(Number(part + 'e' + e));
      }
    }
    const within = made.filter((v) => v >= low && v <= high);
    return within.length > 1 ? within
      : d3.scaleLinear().domain([low, high]).ticks(3).filter((v) => v > 0);
  }

  const room = (values) => 30 + Math.max(...values.map((v) => T.width(T.short(v), 11)), 10);

  function clip(g, box, id) {
    F.rect(g.append('clipPath').attr('id', id), box.left, box.top, box.right - box.left,
      box.bottom - box.top, C.paper);
    return g.append('g').attr('clip-path', `url(#${id})`);
  }

  // Words beside a point where they are on no others; else its tooltip has to do.
  function labels(g, box, size) {
    const taken = [];
    const put = (x, y, words, tint) => {
      const w = T.width(words, size) + 4;
      for (const [dx, dy] of [[8, -6], [-w - 4, -6], [8, 14], [-w - 4, 14]]) {
        const r = [x + dx, y + dy - size, x + dx + w, y + dy + 3];
        if (r[0] >= box.left && r[2] <= box.right && r[1] >= box.top && r[3] <= box.bottom &&
          taken.every((t) => r[2] < t[0] || r[0] > t[2] || r[3] < t[1] || r[1] > t[3])) {
          taken.push(r);
          return F.text(g, x + dx, y + dy, words, { size, colour: tint, halo: true });
        }
      }
      return null;
    };
    put.block = (x, y) => taken.push([x - 5, y - 5, x + 5, y + 5]);
    return put;
  }

  // Bands of what turns: each order once.
  function turning(c) {
    const made = new Map();
    for (const e of D.clean(mt.result().excitations)) {
      for (const o of D.clean(e.orders)) {
        const low = o.order * e.speed_lower_hz;
        const high = o.order * e.speed_upper_hz;
        if (positive(low) && high >= low && high >= c.lower_hz && low <= c.upper_hz) {
          made.set(e.name + ' ' + o.label, { low: Math.max(low, c.lower_hz),
            high: Math.min(high, c.upper_hz), label: o.label, of: e.name });
        }
      }
    }
    return [...made.values()];
  }

  const name = (c) => c.output + ' by ' + c.input + (new Set(asked().map((a) =>
    a.configuration)).size > 1 || D.clean(mt.result().baseline.frequencies).some((f) =>
    f.configuration !== c.configuration) ? ', ' + c.configuration : '');

  mt.responses = {
    asked, read, fine, between, extent, shown, path, dot, keys, padded, ticks, room, clip,
    labels, turning, name, positive, stroke,
  };
})();
