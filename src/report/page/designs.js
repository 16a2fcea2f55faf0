// SPDX-License-Identifier: GPL-3.0-or-later
// The designs of a result, and which of them everything shows.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});
  const T = mt.text;

  let result = null;
  let designs = [];
  let chosen = 0;
  const listeners = [];

  const clean = (list) => Array.isArray(list) ? list : [];

  function pointLabel(trade, point) {
    return trade.vary.map((v, i) => v.quantity + ' ' +
      T.withUnit(T.short(point.values[i], 4), v.unit)).join(', ');
  }

  // Recommendations, then the best designs of the trade study's points; where there is neither
  // the original design stands alone.
  function collect() {
    const made = clean(result.recommendations).map((design) => ({
      design, kind: 'recommendation', rank: design.rank,
      short: 'No. ' + design.rank, label: 'Recommendation ' + design.rank,
    }));
    clean(result.trade && result.trade.points).forEach((point, i) => {
      if (point.best && !point.numbers) {
        made.push({
          design: point.best, kind: 'trade', point, index: i, short: 'T' + (i + 1),
          label: 'Trade point: ' + pointLabel(result.trade, point),
        });
      }
    });
    if (made.length === 0 || result.recommendations.length === 0) {
      made.unshift({
        design: result.baseline, kind: 'original', rank: 0, short: 'original',
        label: 'Original design',
      });
    }
    return made;
  }

  // What an objective named by the study or its trade study is worth at a design.
  function objective(design, name) {
    const known = { change: 'change', misfit: 'misfit', clearance: 'clearance_percent' };
    if (known[name]) {
      return design[known[name]];
    }
    const own = clean(design.objectives).find((o) => o.text === name);
    return own ? own.recommended : design.score;
  }

  const direction = (name) => name === 'clearance' ? -1 : 1; // 1: less is better

  function objectiveUnit(name) {
    const own = clean(result.objectives).find((o) => o.type === name || o.text === name);
    return name === 'clearance' ? '%' : own && own.unit ? own.unit : '';
  }

  function objectiveTitle(name) {
    const words = { change: 'total change', clearance: 'least clearance' };
    return T.titled(words[name] || name, objectiveUnit(name));
  }

  // Text of a mode: "1" or "1, rocking".
  const modeName = (f) => f.name ? f.mode + ', ' + f.name : String(f.mode);

  // Does a goal of this mode fail, or is it within a band's margin?
  function missed(design, f) {
    const near = clean(design.clearances).some((c) => c.configuration === f.configuration &&
      c.mode === f.mode && (c.side === 'inside' ||
      T.isNumber(c.percent) && c.percent < c.margin_percent * (1 - 1e-6) - 1e-9));
    const goals = clean(design.goals).some((g) => !g.met && !g.weighted &&
      g.configuration === f.configuration &&
      (g.name ? g.name === f.name : g.mode === f.mode));
    return near || goals;
  }

  // Bands that a configuration keeps clear of; the original design has them, too.
  function bands(design, configuration) {
    const own = clean(design.gap_assignment).length > 0 ? design.gap_assignment
      : clean(result.baseline.gap_assignment);
    return own.filter((b) => configuration === undefined ||
      b.configuration === configuration);
  }

  // "4P" of "4P of UH-60" where there is one source only.
  function bandName(b) {
    const all = clean(result.excitations);
    const end = all.length === 1 ? ' of ' + all[0].name : '';
    return end && b.band.endsWith(end) ? b.band.slice(0, -end.length)
      : end ? b.band.replace(end + ' (', ' (') : b.band;
  }

  mt.result = () => result;
  mt.designs = () => designs;
  mt.choice = () => designs[chosen];
  mt.choose = (i) => {
    if (i >= 0 && i < designs.length && i !== chosen) {
      chosen = i;
      listeners.forEach((f) => f());
    }
  };
  mt.onChoice = (f) => listeners.push(f);
  mt.openResult = (data) => {
    result = data;
    designs = collect();
    chosen = 0;
  };
  mt.design = {
    clean, pointLabel, objective, objectiveUnit, objectiveTitle, direction, modeName, missed,
    bands, bandName,
  };
})();
