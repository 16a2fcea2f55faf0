// SPDX-License-Identifier: GPL-3.0-or-later
// A large trade study is in its page as a few whole points and a table of the numbers of all
// (io/write_result_page.c): here it becomes a list of points again, of which most are numbers
// alone and cannot be chosen.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});

  const at = (column, k) => column && column.length > 0 ? column[k] : null;

  function design(grid, k, model) {
    return {
      feasible: grid.feasible[k] === 1, score: at(grid.score, k), change: at(grid.change, k),
      misfit: at(grid.misfit, k), clearance_percent: at(grid.clearance_percent, k),
      objectives: grid.objectives.map((column, i) => ({
        text: (model.objectives[i] || {}).text, recommended: at(column, k) })),
      parameters: model.parameters.map((p, i) => ({ name: p.name, unit: p.unit,
        display_unit: p.display_unit, display_factor: p.display_factor,
        recommended: at(grid.parameters[i], k) })),
    };
  }

  mt.gridded = function (result) {
    const grid = result.grid;
    if (!grid) {
      return result;
    }
    const trade = result.trade;
    const model = (trade.points.find((p) => p.best.parameters.length > 0) || {}).best
      || result.baseline;
    const whole = new Map(grid.at.map((k, i) => [k, trade.points[i]]));
    trade.whole = trade.points.length;
    trade.points = grid.status.map((status, k) => whole.get(k) || {
      values: grid.values.map((column) => column[k]), status: grid.statuses[status],
      pareto: grid.pareto[k] === 1, numbers: true,
      best: grid.has_design[k] === 1 ? design(grid, k, model)
        : { feasible: false, objectives: [], parameters: [] },
    });
    return result;
  };
})();
