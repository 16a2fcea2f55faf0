// SPDX-License-Identifier: GPL-3.0-or-later
// A result's values of parameters in the units that people are shown (display_unit), before
// anything is drawn: values are divided by display_factor, slopes by a parameter multiplied.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});

  const DIGITS = 14; // what a division may leave behind is no part of a number
  const clean = (list) => Array.isArray(list) ? list : [];

  function scaled(value, by) {
    return typeof value === 'number' ? Number((value * by).toPrecision(DIGITS)) : value;
  }

  // The members of a record, in its own unit of display.
  function turn(record, members) {
    if (record && record.display_factor > 0) {
      record.unit = record.display_unit;
      for (const member of members) {
        record[member] = scaled(record[member], 1 / record.display_factor);
      }
    }
  }

  // Numbers by the names of variables; of a list by their places.
  function turnAll(numbers, factors, power) {
    for (const name of Object.keys(numbers || {})) {
      if (factors[name] > 0) {
        numbers[name] = scaled(numbers[name], Math.pow(factors[name], power));
      }
    }
  }

  function turnDesign(design) {
    const parameters = clean(design && design.parameters);
    const factors = {};
    parameters.forEach((p) => { factors[p.name] = p.display_factor; });
    parameters.forEach((p) => turn(p, ['original', 'recommended', 'lower', 'upper',
      'measure_floor', 'measure_scale']));
    for (const moved of clean(design && design.frequencies).concat(
      clean(design && design.goals))) {
      turnAll(moved.sensitivity, factors, 1);
      turnAll(moved.worst_at, factors, -1);
    }
    for (const goal of clean(design && design.goals)) {
      const factor = goal.display_factor;
      Object.keys(goal.sensitivity || {}).forEach((name) => {
        goal.sensitivity[name] = scaled(goal.sensitivity[name], factor > 0 ? 1 / factor : 1);
      });
      turn(goal, ['value', 'target', 'at_least', 'at_most', 'worst']);
    }
    return factors;
  }

  mt.displayed = function (result) {
    const trade = result.trade || {};
    const designs = [result.baseline].concat(clean(result.recommendations),
      clean(trade.points).map((point) => point.best));
    const factors = Object.assign({}, ...designs.map(turnDesign));
    for (const point of clean(trade.points)) {
      turnAll(point.values, trade.vary.map((v) => v.display_factor), -1);
    }
    clean(trade.vary).forEach((v) => turn(v, []));
    clean(result.spread).forEach((s) => turn(s, ['value', 'low', 'high']));
    clean(result.published).forEach((p) => turn(p, ['published', 'computed', 'difference']));
    clean(result.run && result.run.overrides).forEach((o) => turn(o, ['value', 'original']));
    for (const relaxation of clean(result.relaxations)) {
      turn(relaxation, ['from', 'to']);
      turnAll(relaxation.design, factors, -1);
    }
    return result;
  };
})();
