// SPDX-License-Identifier: GPL-3.0-or-later
// The figures of a report in their order. A figure goes to the place of the page that is kept
// for it (an element with the id "place-<figure>"), the others follow at "figures".
(function () {
  'use strict';
  const mt = window.mt;

  const ORDER = ['chartFrequencies', 'chartParameters', 'chartRotor', 'chartBode',
    'chartNyquist', 'chartPsd', 'chartDrive',
    'chartTrade', 'chartFront', 'chartParallel', 'chartTolerance', 'chartSensitivity',
    'chartMac', 'chartMacMatrix', 'chartPublished', 'chartHistory', 'chartStarts',
    'chartSpent'];

  function place(id) {
    return document.getElementById('place-' + id) || document.getElementById('figures');
  }

  function start() {
    const data = mt.data();
    if (!data || !data.baseline || !document.getElementById('figures')) {
      return;
    }
    mt.openResult(mt.displayed(mt.gridded(data)));
    mt.alternatives.bar(place('choice'));
    mt.alternatives.table(place('alternatives'));
    for (const name of ORDER) {
      const charts = typeof mt[name] === 'function' ? mt[name]() : [mt[name]];
      for (const chart of charts) {
        if (chart) {
          mt.figure.add(chart, place(chart.place || chart.id));
        }
      }
    }
    mechanism(place('mechanism'));
    mt.origin(place('origin'));
    mt.onChoice(mt.figure.updateAll);
    mt.onChoice(tell);
    tell();
  }

  // The mechanism and its modes, where the page has them.
  function mechanism(into) {
    const scene = mt.scene();
    if (scene && mt.show) {
      const section = mt.element(into, 'section', { id: 'figure-mechanism' });
      mt.element(section, 'h2', {}, 'The mechanism');
      const note = mt.element(section, 'p', { class: 'lead', 'aria-live': 'polite' });
      mt.shown = mt.show(section, scene, { heading: 'h3', follows: true });
      const follow = () => {
        const { kind, rank, label } = mt.choice();
        const there = mt.shown.compare(kind === 'trade' ? null : rank);
        note.textContent = there ? '' : label + ' is not drawn; here is ' +
          mt.shown.compared() + '.';
        note.hidden = there;
      };
      mt.onChoice(follow);
      follow();
    }
  }

  // What the page tells of single designs follows the choice, too; what is drawn is not told.
  function tell() {
    const rank = String(mt.choice().rank);
    for (const part of document.querySelectorAll('[data-rank]')) {
      part.hidden = part.dataset.rank !== rank;
    }
    for (const part of document.querySelectorAll('.drawn')) {
      part.hidden = true;
    }
  }

  mt.whenRead(start);
})();
