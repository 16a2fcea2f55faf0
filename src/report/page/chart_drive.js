// SPDX-License-Identifier: GPL-3.0-or-later
// Frequencies over the position of a driven joint, where the page has the mechanism's scene.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const F = mt.figure;
  const D = mt.design;
  const C = F.colour;

  const SHOWN = {
    rad: { unit: 'deg', factor: 180 / Math.PI },
    m: { unit: 'mm', factor: 1000 },
  };
  const SAME = 1e-3; // curves that are nearer to each other are one
  const BEYOND = 1.15;

  // The scene's configurations of a design that are driven by this joint.
  function driven(scene, rank, joint) {
    const design = D.clean(scene.designs).find((d) => d.rank === rank);
    return design ? D.clean(design.configurations).filter((c) => c.drive &&
      c.drive.joint === joint && D.clean(c.drive.positions).length > 1) : [];
  }

  function joints(scene) {
    const all = D.clean(scene && scene.designs).flatMap((d) => D.clean(d.configurations));
    return [...new Set(all.filter((c) => c.drive && D.clean(c.drive.positions).length > 1)
      .map((c) => c.drive.joint))];
  }

  const alike = (a, b) => a.length === b.length && a.every((p, i) => {
    const q = b[i];
    return Math.abs(p.at - q.at) < SAME && D.clean(p.hz).every((x, k) =>
      Math.abs(x - D.clean(q.hz)[k]) <= SAME * Math.abs(x));
  });

  // One line per mode; a position that could not be analysed breaks it.
  function curvesOf(configurations, factor) {
    const kept = [];
    for (const c of configurations) {
      if (!kept.some((k) => alike(k.drive.positions, c.drive.positions))) {
        kept.push(c);
      }
    }
    return kept.flatMap((c) => {
      const n = Math.max(...c.drive.positions.map((p) => D.clean(p.hz).length));
      return d3.range(n).map((k) => ({ configuration: c.name, mode: k + 1,
        points: c.drive.positions.map((p) => ({ at: p.at * factor,
          hz: p.error ? null : D.clean(p.hz)[k] })) }));
    });
  }

  function content(scene, joint) {
    const rank = mt.choice().kind === 'recommendation' ? mt.choice().rank : 0;
    const now = driven(scene, rank, joint);
    const before = rank === 0 ? [] : driven(scene, 0, joint);
    const unit = SHOWN[(now[0] || before[0] || { drive: {} }).drive.unit] ||
      { unit: '', factor: 1 };
    return { now, before, unit, after: curvesOf(now, unit.factor),
      origin: curvesOf(before, unit.factor) };
  }

  // Bands and the two lowest modes of both designs, unless far above all bands.
  function top(c) {
    const design = mt.choice().design;
    const names = new Set(c.now.map((k) => k.name));
    const edges = D.bands(design).filter((b) => names.has(b.configuration))
      .map((b) => b.margin_upper_hz).filter(T.isNumber);
    const lowest = c.after.concat(c.origin).filter((k) => k.mode <= 2)
      .flatMap((k) => k.points.map((p) => p.hz)).filter(T.isNumber);
    const limit = Math.max(0, ...edges) * 3;
    const near = edges.length > 0 ? lowest.filter((x) => x < limit) : lowest;
    return Math.max(0, ...edges, ...near) * BEYOND;
  }

  function drawBands(g, c, y, box) {
    const seen = new Map();
    const names = new Set(c.now.map((k) => k.name));
    for (const b of D.bands(mt.choice().design)) {
      if (names.has(b.configuration) && b.margin_lower_hz < y.domain()[1]) {
        seen.set(b.band + b.lower_hz, b);
      }
    }
    const labels = [];
    for (const b of seen.values()) {
      const clip = (hz) => y(Math.min(y.domain()[1], hz));
      F.rect(g, box.left, clip(b.margin_upper_hz), box.right - box.left,
        clip(b.margin_lower_hz) - clip(b.margin_upper_hz), C.margin);
      F.rect(g, box.left, clip(b.upper_hz), box.right - box.left,
        clip(b.lower_hz) - clip(b.upper_hz), C.band);
      labels.push({ y: (clip(b.lower_hz) + clip(b.upper_hz)) / 2 + 4, words: D.bandName(b) });
    }
    return labels;
  }

  function drawCurves(g, curves, x, y, look) {
    const line = d3.line().defined((p) => T.isNumber(p.hz) && p.hz <= y.domain()[1])
      .x((p) => x(p.at)).y((p) => y(p.hz));
    for (const c of curves) {
      const path = line(c.points);
      if (!path) {
        continue; // all of it is above the scale
      }
      g.append('path').attr('d', path).attr('fill', 'none')
        .attr('stroke', look.colour).attr('stroke-width', look.width)
        .attr('stroke-dasharray', look.dash || null).append('title')
        .text(c.configuration + ' mode ' + c.mode);
    }
  }

  function draw(g, w, scene, joint) {
    const c = content(scene, joint);
    const box = { left: 56, right: w - 14, top: 10, bottom: 10 + Math.max(220,
      Math.min(380, w * 0.42)) };
    const at = c.after.concat(c.origin).flatMap((k) => k.points.map((p) => p.at));
    const x = d3.scaleLinear(d3.extent(at), [box.left, box.right]);
    const y = d3.scaleLinear([0, top(c)], [box.bottom, box.top]);
    const labels = drawBands(g, c, y, box);
    F.axisBelow(g, x, [box.left, box.right], T.titled('position of ' + joint, c.unit.unit),
      box);
    F.axisLeft(g, y, [box.top, box.bottom], 'frequency [Hz]', box);
    drawCurves(g, c.origin, x, y, { colour: C.before, width: 1.4, dash: '6 4' });
    drawCurves(g, c.after, x, y, { colour: C.after, width: 2 });
    for (const k of c.after) {
      const last = k.points.filter((p) => T.isNumber(p.hz) && p.hz <= y.domain()[1])[0];
      if (last) {
        labels.push({ y: y(last.hz) - 6, words: 'mode ' + k.mode, mode: true });
      }
    }
    T.spread(labels, 14, box.top + 10, box.bottom - 4);
    labels.forEach((l) => F.text(g, l.mode ? box.left + 6 : box.right - 6, l.at,
      T.fit(l.words, w * 0.4, 11), { size: 11, anchor: l.mode ? 'start' : 'end', halo: true,
        colour: l.mode ? C.ink : C.soft }));
    drawNamed(g, c, x, box);
    drawNearest(g, c, joint, x, y);
    return box.bottom + 44 + F.legend(g, items(c, joint), 0, box.bottom + 42, w);
  }

  // Where the model's configurations hold the joint.
  function drawNamed(g, c, x, box) {
    for (const k of c.now) {
      if (T.isNumber(k.drive.at)) {
        const at = x(k.drive.at * c.unit.factor);
        g.append('path').attr('fill', C.ink).attr('d',
          `M${at},${box.bottom}l-5,-9l10,0Z`).append('title').text(k.name);
      }
    }
  }

  const motionOf = (joint) => D.clean(mt.choice().design.motion).find((m) => m.drive === joint);

  function drawNearest(g, c, joint, x, y) {
    const m = motionOf(joint);
    if (m && T.isNumber(m.at) && T.isNumber(m.hz) && m.hz <= y.domain()[1]) {
      F.mark(g, 'star', x(m.at * c.unit.factor), y(m.hz), { colour: C.bad, size: 110 })
        .append('title').text(m.text);
    }
  }

  function items(c, joint) {
    const made = [{ words: mt.choice().kind === 'recommendation' ? mt.choice().short
      : 'original', draw: (g, x, y) => F.line(g, x - 12, y, x + 12, y, C.after,
      { 'stroke-width': 2 }) }];
    if (c.origin.length > 0) {
      made.push({ words: 'original', draw: (g, x, y) => F.line(g, x - 12, y, x + 12, y,
        C.before, { 'stroke-width': 1.4, 'stroke-dasharray': '6 4' }) });
    }
    made.push({ words: 'named configurations', draw: (g, x, y) => g.append('path')
      .attr('fill', C.ink).attr('d', `M${x},${y + 5}l-5,-9l10,0Z`) });
    if (D.bands(mt.choice().design).length > 0) {
      made.push({ words: 'forbidden band and margin', draw: (g, x, y) => {
        F.rect(g, x - 11, y - 7, 22, 14, C.margin);
        F.rect(g, x - 11, y - 4, 22, 8, C.band);
      } });
    }
    if (motionOf(joint)) {
      made.push({ words: 'nearest to a band', draw: (g, x, y) =>
        F.mark(g, 'star', x, y, { colour: C.bad, size: 110 }) });
    }
    return made;
  }

  function table(scene, joint) {
    const c = content(scene, joint);
    const rows = [['original', c.origin], [mt.choice().short, c.after]].flatMap(
      ([design, curves]) => curves.flatMap((k) => k.points.map((p) => [design,
        k.configuration, k.mode, p.at, p.hz ?? null])));
    return { columns: ['design', 'configuration', 'mode', 'position_' + c.unit.unit,
      'frequency_hz'], rows };
  }

  mt.chartDrive = () => {
    const scene = mt.scene ? mt.scene() : null;
    return joints(scene).map((joint, i) => ({
      id: 'drive-' + (i + 1), place: 'drive', title: 'Frequencies over the travel of ' + joint,
      lead: () => (motionOf(joint) || { text: '' }).text, draw: (g, w) =>
        draw(g, w, scene, joint), table: () => table(scene, joint),
      has: () => content(scene, joint).after.length > 0,
    }));
  };
})();
