// SPDX-License-Identifier: GPL-3.0-or-later
// What moves which frequency: a heat map of elasticities. And how much the shapes of modes are
// those of their references: the modal assurance criterion (MAC).
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const CELL = { least: 44, most: 92, height: 26 };

  // --- sensitivity ---

  const withSlopes = () => D.clean(mt.choice().design.frequencies).filter((f) =>
    f.sensitivity && T.isNumber(f.recommended_hz) && f.recommended_hz > 0);

  const parameters = () => D.clean(mt.choice().design.parameters).filter((p) =>
    withSlopes().some((f) => T.isNumber(f.sensitivity[p.name])));

  // Per cent of frequency for one per cent of the parameter.
  function elasticity(f, p) {
    const slope = f.sensitivity[p.name];
    const value = T.isNumber(slope) && T.isNumber(p.recommended)
      ? slope * p.recommended / f.recommended_hz : null;
    return T.isNumber(value) ? value : null;
  }

  const WHOLE = 1000; // elasticities are about 1; what is that large has no room for decimals
  const shown = (x) => Math.abs(x) < 0.0005 ? '0' : Math.abs(x) >= WHOLE ? T.short(x, 2)
    : x.toFixed(Math.abs(x) < 0.1 ? 3 : 2).replace('-', '\u2212');

  // A panel of so many frequencies as the width holds; the configuration stands above its own.
  function panel(g, list, rows, at, w, colours, left) {
    const wide = Math.min(CELL.most, (w - left - 4) / list.length);
    const top = at + 34;
    let from = 0;
    list.forEach((f, k) => {
      const last = k === list.length - 1 || list[k + 1].configuration !== f.configuration;
      if (last) {
        const x = left + from * wide;
        const room = (k + 1 - from) * wide;
        F.text(g, x + room / 2, at + 12, T.fit(f.configuration, room - 6, 11, true),
          { anchor: 'middle', size: 11, bold: true }).append('title').text(f.configuration);
        from = k + 1;
      }
      const name = f.name && T.width(f.name, 11) < wide - 4 ? f.name : 'mode ' + f.mode;
      F.text(g, left + (k + 0.5) * wide, at + 28, T.fit(name, wide, 11),
        { anchor: 'middle', size: 11, colour: C.soft }).append('title')
        .text('mode ' + D.modeName(f));
    });
    rows.forEach((p, i) => {
      const y = top + i * CELL.height;
      F.text(g, left - 8, y + 17, T.fit(p.name, left - 10), { anchor: 'end' })
        .append('title').text(p.name);
      list.forEach((f, k) => {
        const e = elasticity(f, p);
        const x = left + k * wide;
        const fill = e === null ? C.panel : colours(e);
        F.rect(g, x + 1, y + 1, wide - 2, CELL.height - 2, fill).append('title').text(
          `${f.configuration} mode ${D.modeName(f)}: ` + (e === null ? 'no single slope'
            : `${T.sig(e)} % per % of ${p.name}`));
        F.text(g, x + wide / 2, y + 17, e === null ? '\u2013' : T.fit(shown(e), wide, 11),
          { anchor: 'middle', size: 11, colour: e === null ? C.soft : F.inkOn(fill) })
          .attr('pointer-events', 'none');
      });
    });
    return top + rows.length * CELL.height + 10;
  }

  function drawSensitivity(g, w) {
    const list = withSlopes();
    const rows = parameters();
    const left = Math.min(Math.max(...rows.map((p) => T.width(p.name))) + 14, w * 0.32);
    const columns = Math.max(1, Math.floor((w - left - 4) / CELL.least));
    const all = list.flatMap((f) => rows.map((p) => elasticity(f, p))).filter(T.isNumber);
    const most = Math.max(1e-12, ...all.map(Math.abs));
    const colours = (e) => d3.interpolateRdBu(0.5 - 0.5 * Math.sign(e) *
      Math.sqrt(Math.abs(e) / most) * 0.92);
    const panels = Math.ceil(list.length / columns);
    const size = Math.ceil(list.length / panels);
    let y = 0;
    for (let i = 0; i < panels; i++) {
      y = panel(g, list.slice(i * size, (i + 1) * size), rows, y, w, colours, left);
    }
    const range = `${shown(-most)} (blue) to ${shown(most)} (red)`;
    return y + F.legend(g, [{ words: '% of frequency per % of parameter, ' + range,
      draw: (k, a, b) => {
      for (let i = 0; i < 8; i++) {
        F.rect(k, a - 12 + i * 3, b - 6, 3.3, 12, colours(most * (i - 3.5) / 3.5));
      }
    } }], 0, y, w);
  }

  function leadSensitivity() {
    const best = withSlopes().flatMap((f) => parameters().map((p) => ({ f, p,
      e: elasticity(f, p) }))).filter((c) => T.isNumber(c.e))
      .reduce((a, b) => a === null || Math.abs(b.e) > Math.abs(a.e) ? b : a, null);
    return best === null ? '' : `Strongest: 1 % more ${best.p.name} moves ` +
      `${best.f.configuration} mode ${D.modeName(best.f)} by ${T.percent(best.e, 2)}.`;
  }

  mt.chartSensitivity = {
    id: 'sensitivity', title: 'What moves which frequency', lead: leadSensitivity,
    draw: drawSensitivity,
    table: () => ({ columns: ['configuration', 'mode', 'name', 'parameter',
      'percent_per_percent', 'hz_per_unit'],
    rows: withSlopes().flatMap((f) => parameters().map((p) => [f.configuration, f.mode, f.name,
      p.name, elasticity(f, p), f.sensitivity[p.name] ?? null])) }),
    has: () => withSlopes().length > 0 && parameters().length > 0,
  };

  // --- MAC ---

  const withMac = (design) => D.clean(design.frequencies).filter((f) => T.isNumber(f.mac));

  function originalMac(f) {
    const same = withMac(mt.result().baseline).find((b) => b.reference === f.reference &&
      b.configuration === f.configuration && (f.name ? b.name === f.name : b.mode === f.mode));
    return same ? same.mac : null;
  }

  const limitOf = (f) => {
    const goal = D.clean(mt.choice().design.goals).find((q) => q.type === 'mac' &&
      q.configuration === f.configuration && (q.name ? q.name === f.name : q.mode === f.mode));
    return goal ? goal.at_least : null;
  };

  const macName = (f) => `${f.configuration} mode ${D.modeName(f)}`;

  function drawMac(g, w) {
    const list = withMac(mt.choice().design);
    const changed = mt.choice().kind !== 'original';
    const all = list.flatMap((f) => [f.mac, originalMac(f), limitOf(f)]).filter(T.isNumber);
    const least = Math.min(...all);
    const low = least > 0.9 ? 1 - (1 - least) * 1.25 - 1e-5 : 0;
    const left = Math.min(Math.max(...list.map((f) => T.width(macName(f)))) + 14, w * 0.4);
    const right = w - 70;
    const x = d3.scaleLinear([low, 1], [left, right]);
    const bottom = list.length * 26;
    F.axisBelow(g, x, [left, right], 'MAC with the reference (1: the same shape)',
      { top: 0, bottom, format: (v) => T.short(v, 6),
        count: Math.max(2, Math.round((right - left) / 110)) });
    list.forEach((f, i) => {
      const y = i * 26 + 13;
      F.text(g, left - 8, y + 4, T.fit(macName(f), left - 10), { anchor: 'end' })
        .append('title').text(macName(f) + ' against ' + f.reference);
      F.line(g, x(low), y, x(f.mac), y, C.after, { 'stroke-width': 3, 'stroke-opacity': 0.45 });
      if (T.isNumber(limitOf(f))) {
        F.line(g, x(limitOf(f)), y - 9, x(limitOf(f)), y + 9, C.good, { 'stroke-width': 3 });
      }
      if (changed && T.isNumber(originalMac(f))) {
        F.mark(g, 'circle', x(originalMac(f)), y, { colour: C.before, filled: false });
      }
      F.mark(g, 'diamond', x(f.mac), y);
      F.text(g, right + 12, y + 4, T.fit(T.sig(f.mac, 5), w - right - 12));
    });
    const items = [{ words: changed ? mt.choice().short : 'MAC', draw: (k, a, b) =>
      F.mark(k, 'diamond', a, b) }];
    if (changed && list.some((f) => T.isNumber(originalMac(f)))) {
      items.push({ words: 'original', draw: (k, a, b) =>
        F.mark(k, 'circle', a, b, { colour: C.before, filled: false }) });
    }
    if (list.some((f) => T.isNumber(limitOf(f)))) {
      items.push({ words: 'at least', draw: (k, a, b) =>
        F.line(k, a, b - 7, a, b + 7, C.good, { 'stroke-width': 3 }) });
    }
    return bottom + 42 + F.legend(g, items, 0, bottom + 42, w);
  }

  mt.chartMac = {
    id: 'mac', title: 'Shapes against their references', draw: drawMac,
    table: () => ({ columns: ['configuration', 'mode', 'name', 'reference', 'original_mac',
      'mac', 'at_least'],
    rows: withMac(mt.choice().design).map((f) => [f.configuration, f.mode, f.name, f.reference,
      originalMac(f), f.mac, limitOf(f)]) }),
    has: () => withMac(mt.choice().design).length > 0,
  };
})();
