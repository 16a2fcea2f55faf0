// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters between their bounds, each on a scale of its own: what the chosen design makes of
// the original one, and where it would go on if it were allowed to.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const HEAD = 16; // titles of the columns
  const ROW = 44;
  const LINE = 14; // a row whose bar is short has its values in a line of their own
  const BAR = 10;

  const hasBounds = (p) => T.isNumber(p.lower) && T.isNumber(p.upper) && p.upper > p.lower;
  const isLogarithmic = (p) => p.lower > 0 && String(p.measure).startsWith('logarithmic') &&
    p.upper / p.lower > 3;

  // A common scale of changes for those without bounds.
  function changeScale(parameters, range) {
    const changes = parameters.map((p) => p.change_percent).filter(T.isNumber);
    const most = Math.max(1, ...changes.map(Math.abs)) * 1.15;
    return d3.scaleLinear([-most, most], range);
  }

  function marksOf(p, range, changes) {
    if (hasBounds(p)) {
      const low = Math.min(p.lower, p.original ?? p.lower, p.recommended ?? p.lower);
      const high = Math.max(p.upper, p.original ?? p.upper, p.recommended ?? p.upper);
      const scale = (isLogarithmic(p) && low > 0 ? d3.scaleLog : d3.scaleLinear)(
        [low, high], range);
      const place = (v) => T.isNumber(v) ? scale(v) : null;
      return { from: scale(p.lower), to: scale(p.upper),
        before: place(p.original), after: place(p.recommended) };
    }
    return { from: null, to: null, before: changes(0), after: changes(p.change_percent ?? 0) };
  }

  const isSame = (p) => T.short(p.original) === T.short(p.recommended);
  const valueWords = (p, changed) => changed && !isSame(p)
    ? T.short(p.original) + ' \u2192 ' + T.short(p.recommended) : T.short(p.recommended);

  // The numbers of the bounds under their marks, as one text where these are close. Returns
  // how much room both leave between them.
  function drawBounds(g, p, y, m, box) {
    const look = { size: 11, colour: C.soft };
    const words = [T.short(p.lower), T.short(p.upper)];
    const widths = words.map((t) => T.width(t, 11));
    if (m.to - m.from > widths[0] + widths[1] + 8) {
      F.text(g, m.from, y + 35, words[0], look);
      F.text(g, m.to, y + 35, words[1], Object.assign({ anchor: 'end' }, look));
      return { from: m.from + widths[0] + 8, to: m.to - widths[1] - 8 };
    }
    const both = T.fit(words.join(' to '), box.right - box.left, 11);
    const half = T.width(both, 11) / 2;
    const x = Math.max(box.left + half, Math.min(box.right - half, (m.from + m.to) / 2));
    F.text(g, x, y + 35, both, Object.assign({ anchor: 'middle' }, look));
    return { from: 0, to: 0 };
  }

  // The values under their mark: between the bounds' numbers, or in a line of their own.
  // Returns the height that this takes.
  function drawValues(g, p, y, m, box, inside) {
    const words = valueWords(p, box.changed);
    const half = T.width(words, 11) / 2;
    const own = inside.to - inside.from < 2 * half;
    const from = own ? box.left : inside.from;
    const to = Math.max(from + 2 * half, own ? box.right : inside.to);
    const at = m.after === null ? (from + to) / 2 : m.after;
    const x = Math.max(from + half, Math.min(to - half, at));
    F.text(g, Math.min(x, box.end - half), y + 35 + (own ? LINE : 0), words,
      { anchor: 'middle', size: 11, halo: true }).attr('data-parameter', p.name);
    return own ? LINE : 0;
  }

  function drawRow(g, p, y, box, changes) {
    const m = marksOf(p, [box.left, box.right], changes);
    const middle = y + 14;
    let inside = { from: box.left, to: box.right };
    if (m.from !== null) {
      F.rect(g, m.from, middle - BAR / 2, m.to - m.from, BAR, C.range);
      F.line(g, m.from, middle - 9, m.from, middle + 9,
        p.at_bound === 'lower' ? C.bad : C.soft,
        { 'stroke-width': p.at_bound === 'lower' ? 5 : 1.5 });
      F.line(g, m.to, middle - 9, m.to, middle + 9, p.at_bound === 'upper' ? C.bad : C.soft,
        { 'stroke-width': p.at_bound === 'upper' ? 5 : 1.5 });
      inside = drawBounds(g, p, y, m, box);
    } else {
      F.line(g, box.left, middle, box.right, middle, C.line);
    }
    if (box.changed && m.before !== null) {
      if (m.after !== null) {
        F.arrow(g, m.before, m.after, middle, C.after);
      }
      F.mark(g, 'circle', m.before, middle, { colour: C.before, filled: false })
        .append('title').text('originally ' + T.sig(p.original, 6));
    }
    if (m.after !== null) {
      F.mark(g, 'diamond', m.after, middle).append('title').text(T.sig(p.recommended, 6));
    }
    return y + ROW + drawValues(g, p, y, m, box, inside);
  }

  function drawWords(g, p, y, box) {
    const name = T.titled(p.name, p.unit);
    F.text(g, 0, y + 18, T.fit(name, box.left - 10), {}).append('title').text(name);
    const x = box.right + 12;
    const bound = p.at_bound ? 'at ' + p.at_bound + ' bound' : '';
    if (box.changed) {
      F.text(g, x, y + 18, T.percent(p.change_percent),
        { bold: Math.abs(p.change_percent) >= 0.05 });
    }
    if (bound) {
      F.text(g, x, y + 33, bound, { size: 11, colour: C.bad });
    }
  }

  function draw(g, w) {
    const changed = mt.choice().kind !== 'original';
    const parameters = D.clean(mt.choice().design.parameters);
    const names = parameters.map((p) => T.width(T.titled(p.name, p.unit)));
    const words = T.width('at upper bound', 11) + 12;
    const box = { left: Math.min(Math.max(...names) + 14, w * 0.3), right: w - words - 4,
      end: w, changed };
    const changes = changeScale(parameters, [box.left + 8, box.right - 8]);
    if (changed) {
      F.text(g, box.right + 12, 11, 'change [%]', { size: 11, colour: C.soft });
    }
    F.text(g, 0, 11, 'parameter [unit]', { size: 11, colour: C.soft });
    let y = HEAD;
    for (const p of parameters) {
      drawWords(g, p, y, box);
      y = drawRow(g, p, y, box, changes);
    }
    const title = parameters.some(hasBounds)
      ? 'from lower to upper bound, each on its own scale'
      : 'change [%]; no bounds in the result';
    const half = T.width(title) / 2;
    const middle = Math.max(half, Math.min(w - half, (box.left + box.right) / 2));
    F.text(g, middle, y + 12, title, { anchor: 'middle' });
    return y + 22 + F.legend(g, items(parameters, changed), 0, y + 20, w);
  }

  function items(parameters, changed) {
    const made = [];
    if (changed) {
      made.push({ words: 'original', draw: (g, x, y) =>
        F.mark(g, 'circle', x, y, { colour: C.before, filled: false }) });
    }
    made.push({ words: changed ? mt.choice().short : 'value', draw: (g, x, y) =>
      F.mark(g, 'diamond', x, y) });
    if (parameters.some(hasBounds)) {
      made.push({ words: 'allowed', draw: (g, x, y) =>
        F.rect(g, x - 11, y - 5, 22, 10, C.range) });
    }
    if (parameters.some((p) => p.at_bound && hasBounds(p))) {
      made.push({ words: 'a bound that holds the design', draw: (g, x, y) =>
        F.line(g, x, y - 8, x, y + 8, C.bad, { 'stroke-width': 5 }) });
    }
    return made;
  }

  function table() {
    return {
      columns: ['name', 'unit', 'lower', 'upper', 'original', 'recommended',
        'change_percent', 'at_bound'],
      rows: D.clean(mt.choice().design.parameters).map((p) => [p.name, p.unit,
        p.lower ?? null, p.upper ?? null, p.original, p.recommended, p.change_percent,
        p.at_bound]),
    };
  }

  function lead() {
    const held = D.clean(mt.choice().design.parameters).filter((p) => p.at_bound);
    if (held.length === 0) {
      return '';
    }
    const names = held.slice(0, 4).map((p) => p.name).join(', ');
    return names + (held.length > 4 ? ' and ' + (held.length - 4) + ' more' : '') +
      (held.length === 1 ? ' lies at a bound.' : ' lie at a bound.');
  }

  mt.chartParameters = {
    id: 'parameters', title: 'Parameters within their bounds', lead, draw, table,
    has: () => D.clean(mt.choice().design.parameters).length > 0,
  };
})();
