// SPDX-License-Identifier: GPL-3.0-or-later
// Rotor diagrams (Campbell): frequency over speed. Orders are lines through the origin, modes
// horizontals; where they meet within the operating range a mode is excited.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const PER_MINUTE = 60;
  const BEYOND_SPEED = 1.08; // the plot goes so far beyond the operating range
  const BEYOND_MODES = 1.15; // and above the highest mode that an order comes near to
  const NEAR = 2;

  const concerns = (e, f) => e.configurations.includes(f.configuration);

  function modesOf(e) {
    return D.clean(mt.choice().design.frequencies).filter((f) => concerns(e, f));
  }

  // Modes far above all orders would press the rest flat.
  function highest(e) {
    const orders = e.orders.map((o) => o.order).filter((o) => o > 0);
    const speed = e.speed_upper_hz * BEYOND_SPEED;
    const reach = Math.max(0, ...orders) * speed * (1 + e.margin_percent / 100) * BEYOND_MODES;
    const limit = T.isNumber(e.up_to_hz) ? Math.min(reach, e.up_to_hz) : reach;
    const all = D.clean(mt.result().baseline.frequencies).concat(...mt.designs()
      .filter((d) => d.kind === 'recommendation').map((d) => d.design.frequencies))
      .concat(modesOf(e)).filter((f) => concerns(e, f));
    const within = all.flatMap((f) => [f.original_hz, f.recommended_hz])
      .filter((x) => T.isNumber(x) && x <= limit);
    const modes = Math.max(0, ...within);
    const next = orders.map((o) => o * e.speed_lower_hz)
      .filter((x) => x > modes && x < NEAR * modes).map((x) => x * BEYOND_MODES);
    return Math.max(modes * BEYOND_MODES, Math.min(...orders) * speed, ...next);
  }

  function layout(e, w) {
    const high = highest(e);
    const speed = e.speed_upper_hz * BEYOND_SPEED;
    const ends = e.orders.map((o) => ({ o, atTop: o.order * speed > high,
      width: T.width(T.fit(o.label, 110), 12) }));
    const side = Math.max(10, ...ends.filter((l) => !l.atTop).map((l) => l.width)) + 16;
    const box = { left: 56, right: w - Math.min(side, w * 0.28) };
    const x = d3.scaleLinear([0, speed * PER_MINUTE], [box.left, box.right]);
    const top = ends.filter((l) => l.atTop).map((l) => Object.assign(l,
      { x: x(high / l.o.order * PER_MINUTE) }));
    box.topLines = top.length > 0 ? T.lanes(top, box.left - 30, box.right + 30, 6) : 0;
    box.top = 10 + box.topLines * 15;
    box.bottom = box.top + Math.max(240, Math.min(430, w * 0.48));
    const y = d3.scaleLinear([0, high], [box.bottom, box.top]);
    return { e, w, box, x, y, ends, top, high, speed };
  }

  function shade(g, p) {
    const { e, x, y, box } = p;
    const from = x(e.speed_lower_hz * PER_MINUTE);
    const to = x(e.speed_upper_hz * PER_MINUTE);
    F.rect(g, from, box.top, Math.max(2, to - from), box.bottom - box.top, C.range);
    for (const o of e.orders) {
      const low = o.order * (1 - e.margin_percent / 100);
      const high = o.order * (1 + e.margin_percent / 100);
      g.append('path').attr('fill', C.band).attr('fill-opacity', 0.45).attr('d',
        `M${from},${y(low * e.speed_lower_hz)}L${to},${y(low * e.speed_upper_hz)}` +
        `L${to},${y(high * e.speed_upper_hz)}L${from},${y(high * e.speed_lower_hz)}Z`);
    }
  }

  function orders(g, p) {
    const { e, x, y, box, speed } = p;
    for (const o of e.orders) {
      F.line(g, x(0), y(0), x(speed * PER_MINUTE), y(o.order * speed), C.bad,
        { 'stroke-width': 0.8 });
      F.line(g, x(e.speed_lower_hz * PER_MINUTE), y(o.order * e.speed_lower_hz),
        x(e.speed_upper_hz * PER_MINUTE), y(o.order * e.speed_upper_hz), C.bad,
        { 'stroke-width': 2 }).append('title')
        .text(`${o.label}: ${T.short(o.order, 6)} per turn`);
    }
    return box;
  }

  // Names at the right edge, pushed apart; those of lines that leave at the top above it.
  function orderNames(g, p) {
    const { y, box, speed } = p;
    const side = p.ends.filter((l) => !l.atTop);
    side.forEach((l) => Object.assign(l, { y: y(l.o.order * speed) }));
    T.spread(side, 14, box.top + 4, box.bottom - 4);
    for (const l of side) {
      F.line(g, box.right, l.y, box.right + 8, l.at, C.bad, { 'stroke-width': 0.8 });
      F.text(g, box.right + 10, l.at + 4, T.fit(l.o.label, Math.min(110, p.w - box.right - 10)),
        { colour: C.bad });
    }
    for (const l of p.top) {
      const base = box.top - 5 - (box.topLines - 1 - l.lane) * 15;
      F.line(g, l.x, box.top, l.at + l.width / 2, base + 2, C.bad, { 'stroke-width': 0.8 });
      F.text(g, l.at, base, T.fit(l.o.label, 110), { colour: C.bad, halo: true });
    }
  }

  function crossings(g, p, hz, tint, filled, words) {
    const { e, x, y } = p;
    for (const o of e.orders) {
      if (o.order > 0 && hz >= o.order * e.speed_lower_hz && hz <= o.order * e.speed_upper_hz) {
        const speed = hz / o.order * PER_MINUTE;
        F.mark(g, 'circle', x(speed), y(hz), { colour: tint, filled, size: 90 })
          .append('title').text(`${o.label} meets ${words} at ${T.sig(speed)} rpm`);
      }
    }
  }

  function modes(g, p, changed) {
    const { e, x, y, box, high } = p;
    const shown = modesOf(e);
    const labels = [];
    const several = e.configurations.length > 1;
    const column = box.left + 10 + (several ? 15 * e.configurations.length : 8);
    const room = Math.max(90, x(e.speed_lower_hz * PER_MINUTE) - column - 6);
    for (const f of shown) {
      const words = (several ? f.configuration + ' ' : '') + 'mode ' + D.modeName(f);
      const k = Math.max(0, e.configurations.indexOf(f.configuration));
      if (changed && T.isNumber(f.original_hz) && f.original_hz <= high) {
        F.line(g, box.left, y(f.original_hz), box.right, y(f.original_hz), C.before,
          { 'stroke-dasharray': '6 4', 'stroke-width': 1.3 }).append('title')
          .text(words + ' originally ' + T.sig(f.original_hz) + ' Hz');
        crossings(g, p, f.original_hz, C.before, false, words + ' originally');
      }
      if (T.isNumber(f.recommended_hz) && f.recommended_hz <= high) {
        const at = y(f.recommended_hz);
        F.line(g, box.left, at, box.right, at, C.after, { 'stroke-width': 1.8 })
          .append('title').text(words + ' ' + T.sig(f.recommended_hz, 6) + ' Hz');
        crossings(g, p, f.recommended_hz, C.bad, true, words);
        F.mark(g, F.shapes[k % F.shapes.length], box.left + 12 + 15 * k, at,
          { colour: C.after, size: 60 });
        labels.push({ y: at - 8, words: T.fit(words + ', ' + T.sig(f.recommended_hz) + ' Hz',
          room, 11) });
      }
    }
    const higher = shown.filter((f) => f.recommended_hz > high); // told above the labels
    T.spread(labels, 13, box.top + (higher.length > 0 ? 26 : 7), box.bottom - 5);
    for (const l of labels) { // lines pass behind them
      F.rect(g, column - 2, l.at - 6, T.width(l.words, 11) + 4, 13, C.paper)
        .attr('fill-opacity', 0.85);
      F.text(g, column, l.at + 4, l.words, { size: 11 });
    }
    return higher;
  }

  function legendItems(e, changed) {
    const items = [
      { words: 'operating range, ' + T.short(e.speed_lower_hz * PER_MINUTE) + ' to ' +
        T.short(e.speed_upper_hz * PER_MINUTE) + ' rpm',
      draw: (g, x, y) => F.rect(g, x - 11, y - 6, 22, 12, C.range) },
      { words: 'order (n per turn)', draw: (g, x, y) =>
        F.line(g, x - 11, y + 5, x + 11, y - 5, C.bad, { 'stroke-width': 2 }) },
    ];
    if (e.margin_percent > 0) {
      items.push({ words: 'its margin of ' + T.short(e.margin_percent) + ' %',
        draw: (g, x, y) => F.rect(g, x - 11, y - 6, 22, 12, C.band)
          .attr('fill-opacity', 0.6) });
    }
    if (changed) {
      items.push({ words: 'mode, original', draw: (g, x, y) => F.line(g, x - 13, y, x + 13, y,
        C.before, { 'stroke-dasharray': '6 4', 'stroke-width': 1.3 }) });
    }
    e.configurations.forEach((name, k) => items.push({
      words: (changed ? mt.choice().short + ' ' : 'modes ') + name, draw: (g, x, y) => {
        F.line(g, x - 13, y, x + 13, y, C.after, { 'stroke-width': 1.8 });
        F.mark(g, F.shapes[k % F.shapes.length], x, y, { colour: C.after, size: 60 });
      } }));
    items.push({ words: 'a mode is excited', draw: (g, x, y) =>
      F.mark(g, 'circle', x, y, { colour: C.bad, size: 90 }) });
    return items;
  }

  function draw(g, w, e, i) {
    const changed = mt.choice().kind !== 'original';
    const p = layout(e, w);
    const { box, x, y } = p;
    const id = 'clip-rotor-' + i;
    F.rect(g.append('clipPath').attr('id', id), box.left, box.top, box.right - box.left,
      box.bottom - box.top, C.paper);
    const inside = g.append('g').attr('clip-path', `url(#${id})`);
    shade(inside, p);
    F.axisBelow(g, x, [box.left, box.right], 'speed [rpm]', box);
    F.axisLeft(g, y, [box.bottom, box.top].reverse(), 'frequency [Hz]', box);
    orders(g.append('g').attr('clip-path', `url(#${id})`), p);
    const higher = modes(g, p, changed);
    orderNames(g, p);
    if (higher.length > 0) {
      F.text(g, box.left + 6, box.top + 13, higher.length + (higher.length === 1
        ? ' mode lies higher' : ' modes lie higher'), { size: 11, colour: C.soft,
        halo: true });
    }
    return box.bottom + 44 + F.legend(g, legendItems(e, changed), 0, box.bottom + 42, w);
  }

  function table(e) {
    return {
      columns: ['what', 'label', 'order', 'configuration', 'mode', 'name', 'original_hz',
        'recommended_hz', 'speed_lower_hz', 'speed_upper_hz', 'margin_percent'],
      rows: e.orders.map((o) => ['order', o.label, o.order, null, null, null, null, null,
        e.speed_lower_hz, e.speed_upper_hz, e.margin_percent])
        .concat(modesOf(e).map((f) => ['mode', null, null, f.configuration, f.mode, f.name,
          f.original_hz, f.recommended_hz, null, null, null])),
    };
  }

  function lead(e) {
    const met = [];
    for (const f of modesOf(e)) {
      for (const o of e.orders) {
        if (f.recommended_hz >= o.order * e.speed_lower_hz &&
          f.recommended_hz <= o.order * e.speed_upper_hz) {
          met.push(`${o.label} excites mode ${f.mode} of ${f.configuration}`);
        }
      }
    }
    const said = met.length === 0 ? 'Within the operating range no order meets a mode.'
      : met.slice(0, 3).join('; ') + (met.length > 3 ? ' and ' + (met.length - 3) + ' more'
        : '') + '.';
    return said + ' The modes are those of the mechanism at rest, without gyroscopic and '
      + 'centrifugal terms.';
  }

  mt.chartRotor = () => D.clean(mt.result().excitations).map((e, i) => ({
    id: 'rotor-' + (i + 1), place: 'rotor', title: 'Campbell diagram of ' + e.name,
    lead: () => lead(e), draw: (g, w) => draw(g, w, e, i), table: () => table(e),
    has: () => e.orders.length > 0 && modesOf(e).length > 0,
  }));
})();
