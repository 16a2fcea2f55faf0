// SPDX-License-Identifier: GPL-3.0-or-later
// Frequencies: one block per configuration with a lane per mode, bands behind them, an arrow
// from the original frequency to that of the chosen design. The scale ends where nothing is
// asked any more; modes above it are told in words.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const LANE = 24;
  const HEAD = 20; // a block's name
  const BAND_LINE = 15;
  const BLOCK_GAP = 14;
  const NEAR = 3; // modes so far above all that is asked are shown, too
  const LOG_FROM = 60; // a scale that spans more is logarithmic

  const isAsked = (f) => [f.target_hz, f.at_least_hz, f.at_most_hz].some(T.isNumber);

  // All designs share one scale, so that a choice moves marks only.
  function demands() {
    const values = [];
    const put = (x) => T.isNumber(x) && x > 0 ? values.push(x) : 0;
    const own = mt.designs().filter((d) => d.kind !== 'trade').map((d) => d.design);
    for (const design of own.concat(mt.choice().design)) {
      for (const f of D.clean(design.frequencies)) {
        [f.target_hz, f.at_least_hz, f.at_most_hz].forEach(put);
        if (isAsked(f)) {
          [f.original_hz, f.recommended_hz].forEach(put);
        }
      }
      D.bands(design).forEach((b) => [b.lower_hz, b.upper_hz, b.margin_lower_hz,
        b.margin_upper_hz].forEach(put));
    }
    return values;
  }

  // How far up responses are looked at: modes as far as that are shown, but no empty scale.
  function reach() {
    const curves = D.clean(mt.result().curves);
    const ranges = curves.concat(curves.flatMap((c) => D.clean(c.limits)),
      D.clean(mt.choice().design.responses));
    return Math.max(0, ...ranges.map((r) => r.upper_hz).filter(T.isNumber));
  }

  function extent(frequencies) {
    let values = demands();
    const upTo = D.clean(mt.result().excitations).map((e) => e.up_to_hz).filter(T.isNumber);
    const looked = reach();
    const all = frequencies.flatMap((f) => [f.original_hz, f.recommended_hz])
      .filter((x) => T.isNumber(x) && x > 0);
    if (values.length === 0) {
      const within = all.filter((x) => x <= looked);
      values = within.length > 0 ? within : all;
    }
    const asked = Math.max(...values);
    const beyond = looked > 0 ? Math.max(asked, looked, ...upTo)
      : Math.max(asked * NEAR, ...upTo);
    const most = Math.max(asked, ...all.filter((x) => x <= beyond));
    const inside = all.concat(values).filter((x) => x <= most);
    return { least: Math.min(...inside), most };
  }

  function makeScale(frequencies, left, right) {
    const e = extent(frequencies);
    if (e.most / e.least > LOG_FROM) {
      return d3.scaleLog([e.least * 0.8, e.most * 1.15], [left, right]);
    }
    return d3.scaleLinear([0, e.most * 1.06], [left, right]);
  }

  // A logarithmic axis has room for 1, 2, 5 of each decade only.
  function ticks(scale) {
    if (!scale.base) {
      return undefined;
    }
    const [low, high] = scale.domain();
    const made = [];
    for (let p = Math.floor(Math.log10(low)); p <= Math.log10(high); p++) {
      [1, 2, 5].forEach((k) => made.push(k * Math.pow(10, p)));
    }
    return made.filter((v) => v >= low && v <= high);
  }

  function blocksOf(design) {
    const blocks = d3.groups(D.clean(design.frequencies), (f) => f.configuration);
    return blocks.map(([name, frequencies]) => ({ name, frequencies }));
  }

  const isShown = (f, scale) => [f.original_hz, f.recommended_hz, f.target_hz, f.at_least_hz,
    f.at_most_hz].some((x) => T.isNumber(x) && x <= scale.domain()[1]);

  function words(f, changed) {
    const parts = [];
    const same = T.sig(f.original_hz) === T.sig(f.recommended_hz);
    if (changed && T.isNumber(f.original_hz) && !same) {
      parts.push(T.sig(f.original_hz) + ' \u2192 ' + T.sig(f.recommended_hz) + ' Hz');
    } else {
      parts.push(T.sig(f.recommended_hz) + ' Hz');
    }
    if (T.isNumber(f.target_hz)) {
      parts.push('target ' + T.short(f.target_hz, 5));
    }
    if (T.isNumber(f.at_least_hz)) {
      parts.push('\u2265 ' + T.short(f.at_least_hz, 5));
    }
    if (T.isNumber(f.at_most_hz)) {
      parts.push('\u2264 ' + T.short(f.at_most_hz, 5));
    }
    return parts.join(', ');
  }

  // Where the words of a lane stand: behind its marks, before them, or in a line of their own.
  function placeWords(lane, scale, left, right) {
    const xs = lane.marks.map(scale);
    const need = T.width(lane.words) + 2;
    const low = Math.min(...xs) - 14;
    const high = Math.max(...xs) + 14;
    if (high + need <= right) {
      return { x: high, anchor: 'start', own: false };
    }
    if (low - need >= left) {
      return { x: low, anchor: 'end', own: false };
    }
    return { x: right, anchor: 'end', own: true };
  }

  function drawBands(g, block, scale, box) {
    const labels = [];
    for (const b of block.bands) {
      const [low, high] = scale.domain();
      const clip = (x) => scale(Math.max(low, Math.min(high, x)));
      if (T.isNumber(b.margin_lower_hz) && b.margin_lower_hz < high) {
        const a = clip(b.margin_lower_hz);
        F.rect(g, a, box.top, clip(b.margin_upper_hz) - a, box.bottom - box.top, C.margin);
        const c = clip(b.lower_hz);
        F.rect(g, c, box.top, clip(b.upper_hz) - c, box.bottom - box.top, C.band)
          .append('title').text(`${b.band}: ${T.sig(b.lower_hz)} to ` +
            `${T.sig(b.upper_hz)} Hz, ${b.modes_below} modes below`);
        const label = T.fit(D.bandName(b), Math.min(220, (box.right - box.left) * 0.6), 11);
        labels.push({ x: (a + clip(b.margin_upper_hz)) / 2, width: T.width(label, 11),
          label });
      }
    }
    return labels;
  }

  function drawDemand(g, f, scale, y) {
    if (T.isNumber(f.target_hz)) {
      const x = scale(f.target_hz);
      F.line(g, x, y - 11, x, y + 11, C.good, { 'stroke-width': 3 });
    }
    [[f.at_least_hz, 1], [f.at_most_hz, -1]].forEach(([hz, way]) => {
      if (T.isNumber(hz) && hz <= scale.domain()[1]) {
        const x = scale(hz);
        F.line(g, x, y - 11, x, y + 11, C.good, { 'stroke-width': 2 });
        g.append('path').attr('fill', C.good)
          .attr('d', `M${x},${y - 11}l${way * 8},4l${-way * 8},4Z`);
      }
    });
  }

  function drawLane(g, lane, scale, y) {
    const f = lane.f;
    const top = scale.domain()[1];
    const bad = lane.bad;
    const tint = bad ? C.bad : C.after;
    drawDemand(g, f, scale, y);
    if (T.isNumber(f.lowest_hz) && f.lowest_hz < top) {
      const a = scale(f.lowest_hz);
      const b = scale(Math.min(top, f.highest_hz));
      F.line(g, a, y, b, y, tint, { 'stroke-width': 5, 'stroke-opacity': 0.35 });
    }
    const before = T.isNumber(f.original_hz) && f.original_hz <= top && f.original_hz > 0;
    const after = T.isNumber(f.recommended_hz) && f.recommended_hz <= top &&
      f.recommended_hz > 0;
    if (lane.changed && before && T.isNumber(f.recommended_hz)) {
      F.arrow(g, scale(f.original_hz), scale(Math.min(top, f.recommended_hz)), y, tint);
    }
    if (before && lane.changed) {
      F.mark(g, 'circle', scale(f.original_hz), y, { colour: C.before, filled: false })
        .append('title').text('originally ' + T.sig(f.original_hz, 6) + ' Hz');
    }
    if (after) {
      F.mark(g, 'diamond', scale(f.recommended_hz), y, { colour: tint })
        .append('title').text(T.sig(f.recommended_hz, 6) + ' Hz');
      if (bad) {
        F.mark(g, 'cross', scale(f.recommended_hz), y, { colour: C.paper, size: 20 });
      }
    }
  }

  function measure(design, scale, left, right, changed) {
    return blocksOf(design).map((b) => {
      const shown = b.frequencies.filter((f) => isShown(f, scale));
      const top = scale.domain()[1];
      const lanes = shown.map((f) => ({
        f, changed, bad: D.missed(design, f), words: words(f, changed),
        name: 'mode ' + D.modeName(f),
        marks: [f.original_hz, f.recommended_hz, f.target_hz, f.at_least_hz, f.at_most_hz,
          f.highest_hz, f.lowest_hz].filter(T.isNumber)
          .map((x) => Math.max(scale.domain()[0], Math.min(top, x))),
      }));
      lanes.forEach((l) => Object.assign(l, { place: placeWords(l, scale, left, right) }));
      const above = b.frequencies.filter((f) => !shown.includes(f) &&
        T.isNumber(f.recommended_hz));
      return Object.assign(b, { lanes, above, bands: D.bands(design, b.name) });
    });
  }

  function aboveWords(list) {
    const names = list.map((f) => 'mode ' + f.mode + ' at ' + T.sig(f.recommended_hz) + ' Hz');
    return 'above the scale: ' + names.slice(0, 3).join(', ') +
      (names.length > 3 ? ' and ' + (names.length - 3) + ' more' : '') + ' \u25b8';
  }

  function drawBlock(g, block, scale, at, box) {
    const bandsLayer = g.append('g');
    const labels = drawBands(g.append('g').remove(), block, scale, Object.assign({}, box,
      { top: 0, bottom: 0 }));
    const lines = T.lanes(labels, box.left, box.right, 10);
    const top = at + HEAD + lines * BAND_LINE;
    let y = top + 2;
    F.text(g, 0, at + 14, T.fit(block.name, box.right, 12, true), { bold: true });
    const drawn = [];
    for (const lane of block.lanes) {
      const extra = lane.place.own ? 14 : 0;
      drawn.push({ lane, y: y + extra + LANE / 2, textY: y + (extra ? 11 : LANE / 2 + 4) });
      y += LANE + extra;
    }
    const bottom = y + 2;
    drawBands(bandsLayer, block, scale, Object.assign({}, box, { top, bottom }));
    labels.forEach((l) => F.text(g, l.at, at + HEAD + l.lane * BAND_LINE + 10, l.label,
      { size: 11, colour: C.soft, halo: true }));
    F.line(g, box.left, top, box.right, top, C.line);
    const named = box.left - 8;
    for (const d of drawn) {
      const label = T.fit(d.lane.name, named);
      F.text(g, named, d.y + 4, label, { anchor: 'end' }).append('title').text(d.lane.name);
      drawLane(g, d.lane, scale, d.y);
      F.text(g, d.lane.place.x, d.textY, d.lane.words,
        { anchor: d.lane.place.anchor, halo: true, colour: d.lane.bad ? C.bad : C.ink })
        .attr('data-mode', block.name + ' ' + d.lane.f.mode);
    }
    if (block.above.length > 0) {
      const lines = T.wrap(aboveWords(block.above), box.right, 11);
      lines.forEach((l, i) => F.text(g, box.right, bottom + 14 + i * 14, l,
        { anchor: 'end', size: 11, colour: C.soft }));
      return bottom + lines.length * 14 + 2;
    }
    return bottom;
  }

  function sign(shape, look) {
    return (g, x, y) => F.mark(g, shape, x, y, look);
  }

  function legendItems(blocks, changed) {
    const lanes = blocks.flatMap((b) => b.lanes);
    const items = [];
    if (changed) {
      items.push({ words: 'original', draw: sign('circle', { colour: C.before,
        filled: false }) });
    }
    items.push({ words: changed ? mt.choice().short : 'frequency', draw: sign('diamond') });
    if (lanes.some((l) => l.bad)) {
      items.push({ words: 'goal missed or margin not kept', draw: (g, x, y) => {
        F.mark(g, 'diamond', x, y, { colour: C.bad });
        F.mark(g, 'cross', x, y, { colour: C.paper, size: 20 });
      } });
    }
    if (blocks.some((b) => b.bands.length > 0)) {
      items.push({ words: 'forbidden band', draw: (g, x, y) =>
        F.rect(g, x - 11, y - 6, 22, 12, C.band) });
    }
    if (blocks.some((b) => b.bands.some((k) => k.margin_upper_hz > k.upper_hz))) {
      items.push({ words: 'its margin', draw: (g, x, y) =>
        F.rect(g, x - 11, y - 6, 22, 12, C.margin) });
    }
    if (lanes.some((l) => T.isNumber(l.f.target_hz))) {
      items.push({ words: 'target', draw: (g, x, y) =>
        F.line(g, x, y - 7, x, y + 7, C.good, { 'stroke-width': 3 }) });
    }
    if (lanes.some((l) => T.isNumber(l.f.at_least_hz) || T.isNumber(l.f.at_most_hz))) {
      items.push({ words: 'limit, pointing to what is allowed', draw: (g, x, y) => {
        F.line(g, x - 3, y - 7, x - 3, y + 7, C.good, { 'stroke-width': 2 });
        g.append('path').attr('fill', C.good).attr('d', `M${x - 3},${y - 7}l8,4l-8,4Z`);
      } });
    }
    if (lanes.some((l) => T.isNumber(l.f.lowest_hz))) {
      items.push({ words: 'over the tolerances', draw: (g, x, y) =>
        F.line(g, x - 11, y, x + 11, y, C.after, { 'stroke-width': 5,
          'stroke-opacity': 0.35 }) });
    }
    return items;
  }

  function draw(g, w) {
    const design = mt.choice().design;
    const changed = mt.choice().kind !== 'original';
    const names = D.clean(design.frequencies).map((f) => T.width('mode ' + D.modeName(f)));
    const left = Math.min(Math.max(56, ...names) + 12, w * 0.32);
    const right = w - 12;
    const scale = makeScale(D.clean(design.frequencies), left, right);
    const blocks = measure(design, scale, left, right, changed);
    const grid = g.append('g');
    let y = 0;
    for (const block of blocks) {
      y = drawBlock(g, block, scale, y, { left, right }) + BLOCK_GAP;
    }
    y -= BLOCK_GAP - 4;
    F.axisBelow(grid, scale, [left, right], 'frequency [Hz]' +
      (scale.base ? ', logarithmic' : ''), { top: y - 4, bottom: y, ticks: ticks(scale) });
    return y + 44 + F.legend(g, legendItems(blocks, changed), 0, y + 42, w);
  }

  function table() {
    const design = mt.choice().design;
    const columns = ['what', 'configuration', 'mode', 'name', 'original_hz', 'recommended_hz',
      'target_hz', 'at_least_hz', 'at_most_hz', 'band', 'lower_hz', 'upper_hz',
      'margin_lower_hz', 'margin_upper_hz'];
    const rows = D.clean(design.frequencies).map((f) => ['mode', f.configuration, f.mode,
      f.name, f.original_hz, f.recommended_hz, f.target_hz, f.at_least_hz, f.at_most_hz]
      .concat(Array(5).fill(null)));
    for (const b of D.bands(design)) {
      rows.push(['band', b.configuration].concat(Array(7).fill(null), [b.band, b.lower_hz,
        b.upper_hz, b.margin_lower_hz, b.margin_upper_hz]));
    }
    return { columns, rows };
  }

  const beyond = (c) => c.percent - c.margin_percent;

  // The mode that is nearest to where it must not be.
  function nearest(design) {
    const all = D.clean(design.clearances).filter((c) => T.isNumber(c.percent));
    if (all.length === 0) {
      return '';
    }
    const c = all.reduce((a, b) => beyond(b) < beyond(a) ? b : a);
    const where = c.configuration + ' mode ' + c.mode + ' (' + T.sig(c.hz) + ' Hz), ';
    const asked = c.margin_percent > 0
      ? T.short(c.margin_percent, 3) + ' % is required.' : '';
    if (c.side === 'inside') {
      return 'Deepest inside a band: ' + where + T.short(-c.percent, 3) + ' % within ' +
        D.bandName(c) + '.';
    }
    return 'Nearest to a band: ' + where + (c.percent > 1e-6 ? T.short(c.percent, 3) + ' % ' +
      c.side + ' ' : 'at the edge of ') + D.bandName(c) + (asked ? '; ' + asked : '.');
  }

  function notDrawn(frequencies) {
    const scale = makeScale(frequencies, 0, 1);
    const n = frequencies.filter((f) => T.isNumber(f.recommended_hz) && !isShown(f, scale))
      .length;
    const what = (n === 1 ? ' mode above ' : ' modes above ') +
      T.short(scale.domain()[1], 3) + (n === 1 ? ' Hz is' : ' Hz are');
    return n > 0 ? n + what + ' not drawn.' : '';
  }

  function lead() {
    const design = mt.choice().design;
    const bad = D.clean(design.frequencies).filter((f) => D.missed(design, f));
    const asked = D.clean(design.frequencies).filter((f) => T.isNumber(f.error_percent));
    const parts = [];
    if (bad.length > 0) {
      parts.push(bad.length === 1 ? '1 mode is not where it must be.'
        : bad.length + ' modes are not where they must be.');
    } else if (asked.length > 0) {
      const worst = asked.reduce((a, b) =>
        Math.abs(b.error_percent) > Math.abs(a.error_percent) ? b : a);
      const miss = Math.abs(worst.error_percent);
      const all = asked.length === 1 ? 'The frequency asked for is met.'
        : 'All ' + asked.length + ' frequencies asked for are met.';
      parts.push(miss < 5e-4 ? all
        : 'Of ' + asked.length + ' frequencies asked for, ' + worst.configuration +
          ' mode ' + worst.mode + ' is off most, by ' + T.short(miss, 2) + ' %.');
    }
    parts.push(nearest(design), notDrawn(D.clean(design.frequencies)));
    return parts.filter((p) => p).join(' ');
  }

  mt.chartFrequencies = {
    id: 'frequencies', title: 'Frequencies', lead, draw, table,
    has: () => D.clean(mt.choice().design.frequencies).some((f) =>
      T.isNumber(f.recommended_hz)),
  };
})();
