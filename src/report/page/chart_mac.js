// SPDX-License-Identifier: GPL-3.0-or-later
// Whose shape is whose: MAC between the modes of a configuration and those of a reference, of
// the original design and of the one that is chosen. One figure for each reference.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const CELL = { least: 40, most: 72, height: 28 };
  const SURE = 0.9; // what is called the same shape
  const fill = (x) => d3.interpolateBlues(0.04 + 0.92 * Math.max(0, Math.min(1, x)));

  // A MAC is 0 to 1; what a file says else has the room that there is.
  const shown = (x, wide) => !T.isNumber(x) ? '\u2013' : Math.abs(x) < 10 ? x.toFixed(2)
    : T.fit(T.short(x, 2), wide - 4, 11);

  const matrices = (design) => D.clean(design.mac_matrices).filter((m) =>
    D.clean(m.rows).length > 0 && D.clean(m.reference_modes).length > 0);
  const same = (m, key) => m.configuration === key.configuration &&
    m.reference === key.reference;
  const find = (design, key) => matrices(design).find((m) => same(m, key));

  function rowName(design, m, row) {
    const f = D.clean(design.frequencies).find((q) => q.configuration === m.configuration &&
      q.mode === row.mode);
    return 'mode ' + (f ? D.modeName(f) : row.mode);
  }

  // What is drawn of a reference: panels of designs.
  function panels(key) {
    const chosen = mt.choice();
    const list = [{ title: chosen.kind === 'original' ? 'original' : chosen.short,
      design: chosen.design }];
    if (chosen.kind !== 'original') {
      list.unshift({ title: 'original', design: mt.result().baseline });
    }
    return list.map((p) => Object.assign(p, { m: find(p.design, key) })).filter((p) => p.m);
  }

  function panel(g, p, at, left, wide) {
    const columns = p.m.reference_modes;
    F.text(g, left, at + 12, p.title, { size: 11, bold: true });
    columns.forEach((mode, k) => F.text(g, left + (k + 0.5) * wide, at + 28,
      T.fit(T.short(mode, 4), wide - 4, 11), { anchor: 'middle', size: 11, colour: C.soft }));
    p.m.rows.forEach((row, i) => {
      const y = at + 34 + i * CELL.height;
      const name = rowName(p.design, p.m, row);
      F.text(g, left - 8, y + 18, T.fit(name, left - 10), { anchor: 'end' }).append('title')
        .text(name);
      row.values.forEach((value, k) => {
        const tint = T.isNumber(value) ? fill(value) : C.panel;
        F.rect(g, left + k * wide + 1, y + 1, wide - 2, CELL.height - 2, tint).append('title')
          .text(`${p.title}: ${name}, mode ${columns[k]} of ${p.m.reference}: MAC ` +
            T.sig(value, 4));
        F.text(g, left + (k + 0.5) * wide, y + 18, shown(value, wide), { anchor: 'middle',
          size: 11, colour: F.inkOn(tint), bold: value >= SURE })
          .attr('pointer-events', 'none').attr('data-mac', value);
      });
    });
    return at + 34 + p.m.rows.length * CELL.height + 14;
  }

  function draw(key, g, w) {
    const list = panels(key);
    const names = list.flatMap((p) => p.m.rows.map((row) => rowName(p.design, p.m, row)));
    const left = Math.min(Math.max(...names.map((n) => T.width(n))) + 14, w * 0.32);
    const count = Math.max(...list.map((p) => p.m.reference_modes.length));
    const room = (w - left - 4) / count;
    const wide = Math.max(Math.min(CELL.most, room), Math.min(CELL.least, room));
    let y = 0;
    F.text(g, left, y + 12, T.fit('modes of ' + key.reference, w - left, 12),
      { colour: C.soft });
    y += 20;
    for (const p of list) {
      y = panel(g, p, y, left, wide);
    }
    return y + F.legend(g, [{ words: 'MAC, 0 to 1 (the same shape); ' +
      `${SURE} and more in bold`, draw: (k, a, b) => {
      for (let i = 0; i < 8; i++) {
        F.rect(k, a - 12 + i * 3, b - 6, 3.3, 12, fill(i / 7));
      }
    } }], 0, y, w);
  }

  // The mode of the reference that each row is most like, and where that is another than its
  // own.
  function lead(key) {
    const m = find(mt.choice().design, key);
    if (!m) {
      return '';
    }
    const found = m.rows.map((row) => ({ row, k: d3.maxIndex(row.values) }))
      .filter((q) => q.k >= 0);
    const sure = found.filter((q) => q.row.values[q.k] >= SURE);
    const moved = sure.filter((q) => m.reference_modes[q.k] !== q.row.mode).map((q) =>
      `mode ${q.row.mode} is mode ${m.reference_modes[q.k]} of the reference`);
    const count = `${sure.length} of ${m.rows.length} modes have the shape of one of the ` +
      `reference's (MAC ${SURE} or more)`;
    return moved.length > 0 ? `${count}; ${moved.slice(0, 3).join(', ')}.` : `${count}.`;
  }

  function table(key) {
    const list = panels(key);
    const modes = list.length > 0 ? list[0].m.reference_modes : [];
    return { columns: ['design', 'configuration', 'mode', 'name'].concat(
      modes.map((k) => `mac_reference_mode_${k}`)),
    rows: list.flatMap((p) => p.m.rows.map((row) => {
      const name = rowName(p.design, p.m, row).split(', ').slice(1).join(', ');
      return [p.title, p.m.configuration, row.mode, name].concat(row.values);
    })) };
  }

  mt.chartMacMatrix = function () {
    const all = mt.designs().map((d) => d.design).concat(mt.result().baseline);
    const keys = [];
    all.flatMap(matrices).forEach((m) => {
      if (!keys.some((key) => same(m, key))) {
        keys.push({ configuration: m.configuration, reference: m.reference });
      }
    });
    return keys.map((key, i) => ({
      id: 'mac-matrix-' + (i + 1), place: 'mac-matrix',
      title: () => `Modes of ${key.configuration} and of ${key.reference}: MAC`,
      lead: () => lead(key), draw: (g, w) => draw(key, g, w), table: () => table(key),
      has: () => panels(key).length > 0,
    }));
  };
})();
