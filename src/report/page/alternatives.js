// SPDX-License-Identifier: GPL-3.0-or-later
// The recommendations side by side, and the choice that everything on the page follows.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const D = mt.design;

  const objectiveTitle = (o) => T.titled(o.type === 'change' ? 'change' : o.text, o.unit);

  function columns(result) {
    const made = [
      { name: 'grade', value: (d) => d.rank === 0 ? '\u2013'
        : d.grade || (d.feasible ? 'feasible' : 'not feasible') },
    ];
    D.clean(result.objectives).forEach((o, i) => made.push({ name: objectiveTitle(o),
      number: true, value: (d) => d.objectives[i] ? d.objectives[i].recommended : null }));
    if (!D.clean(result.objectives).some((o) => o.type === 'change')) {
      made.push({ name: 'change', number: true, value: (d) => d.change });
    }
    made.push({ name: 'clearance [%]', number: true, optional: true,
      value: (d) => d.clearance_percent });
    made.push({ name: 'misses by [%]', number: true, optional: true,
      value: (d) => d.violation_percent > 1e-6 ? d.violation_percent : null });
    D.clean(result.variables).forEach((name, i) => {
      const p = D.clean(result.baseline && result.baseline.parameters)[i];
      made.push({ name: T.titled(name, p ? p.unit : ''), number: true,
        value: (d) => d.parameters[i] ? d.parameters[i].recommended : null });
    });
    const designs = [result.baseline].concat(result.recommendations);
    return made.filter((c) => !c.optional || designs.some((d) => T.isNumber(c.value(d))));
  }

  // The table with a radio button in every row: arrow keys choose, as they do everywhere.
  function table(into) {
    const result = mt.result();
    const found = mt.designs().map((d, i) => Object.assign({ at: i }, d))
      .filter((d) => d.kind === 'recommendation');
    if (found.length === 0 || D.clean(result.variables).length === 0) {
      return;
    }
    // what they are compared with stands above them, and is not chosen: all figures show it
    const original = { at: -1, kind: 'original', rank: 'original', design: result.baseline };
    const own = [original].concat(found);
    const section = d3.select(into).append('section').attr('class', 'alternatives')
      .attr('id', 'alternatives');
    section.append('h2').text('Designs side by side');
    if (found.length > 1) {
      section.append('p').attr('class', 'lead screen')
        .text('Choose one, by click or arrow keys: the whole page shows it.');
    }
    const made = section.append('div').attr('class', 'wide').append('table');
    const shown = columns(result);
    made.append('thead').append('tr').selectAll('th').data([{ name: '' },
      { name: 'rank', number: true }].concat(shown)).join('th').attr('scope', 'col')
      .attr('class', (d) => d.number ? 'n' : null).text((d) => d.name);
    const rows = made.append('tbody').selectAll('tr').data(own).join('tr')
      .classed('original', (d) => d.kind === 'original');
    mt.figure.on(rows, 'click', (event, d) => mt.choose(d.at));
    const radios = rows.append('td').filter((d) => d.at >= 0 && found.length > 1)
      .append('input').attr('type', 'radio').attr('name', 'design')
      .attr('aria-label', (d) => 'Show ' + d.label.toLowerCase());
    mt.figure.on(radios, 'change', (event, d) => mt.choose(d.at));
    rows.append('td').attr('class', 'n').text((d) => d.rank);
    rows.each(function (d) {
      d3.select(this).selectAll('td.value').data(shown).join('td')
        .attr('class', (c) => c.number ? 'value n' : 'value').text((c) => {
          const x = c.value(d.design);
          return c.number ? T.short(x, 5) : x;
        });
    });
    const follow = () => {
      rows.classed('chosen', (d) => d.at === mt.designs().indexOf(mt.choice()));
      rows.select('input').property('checked', (d) => mt.designs()[d.at] === mt.choice());
    };
    mt.onChoice(follow);
    follow();
  }

  // The line that stays in sight: which design is shown, and the way to the others.
  function bar(into) {
    const designs = mt.designs();
    if (designs.length < 2) {
      return;
    }
    const nav = d3.select(into).append('nav').attr('class', 'choice')
      .attr('aria-label', 'Design shown');
    const step = (by) => () => mt.choose((designs.indexOf(mt.choice()) + by +
      designs.length) % designs.length);
    const button = (words, name, by) => mt.figure.on(nav.append('button').attr('type', 'button')
      .attr('aria-label', name).text(words), 'click', step(by));
    button('\u2039', 'Previous design', -1);
    const select = nav.append('select').attr('aria-label', 'Design shown');
    mt.figure.on(select, 'change', (event) => mt.choose(Number(event.target.value)));
    const kinds = [['recommendation', 'Recommendations'], ['original', 'As it is'],
      ['trade', 'Trade study']];
    for (const [kind, words] of kinds) {
      const own = designs.filter((d) => d.kind === kind);
      if (own.length > 0) {
        select.append('optgroup').attr('label', words).selectAll('option').data(own)
          .join('option').attr('value', (d) => designs.indexOf(d))
          .text((d) => d.label + (d.design.grade ? ' (' + d.design.grade + ')' : ''));
      }
    }
    button('\u203a', 'Next design', 1);
    const words = nav.append('span').attr('class', 'brief').attr('aria-live', 'polite');
    const follow = () => {
      const design = mt.choice().design;
      select.property('value', designs.indexOf(mt.choice()));
      const parts = [];
      if (T.isNumber(design.change)) {
        parts.push('change ' + T.short(design.change, 3));
      }
      if (T.isNumber(design.clearance_percent)) {
        parts.push('clearance ' + T.short(design.clearance_percent, 3) + ' %');
      }
      words.text(parts.join(' \u00b7 '));
    };
    mt.onChoice(follow);
    follow();
  }

  mt.alternatives = { table, bar };
})();
