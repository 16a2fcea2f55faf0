// SPDX-License-Identifier: GPL-3.0-or-later
// Where the numbers come from: program, libraries, files, seed, and how exact the design is.
(function () {
  'use strict';
  const mt = window.mt;
  const T = mt.text;
  const D = mt.design;

  const greatest = (list) => list.filter(T.isNumber).reduce((a, b) => Math.max(a, b), 0);

  // The design's own numbers: they follow the choice.
  function exactness(design) {
    const rows = [];
    const f = D.clean(design.frequencies);
    if (f.some((m) => T.isNumber(m.residual))) {
      rows.push(['backward error of modes, at most',
        T.short(greatest(f.map((m) => m.residual)), 3) + ' (of order 1: exact to rounding)']);
    }
    if (f.some((m) => T.isNumber(m.orthogonality))) {
      rows.push(['loss of orthogonality, at most',
        T.short(greatest(f.map((m) => m.orthogonality)), 3)]);
    }
    if (T.isNumber(design.kkt_residual)) {
      rows.push(['KKT residual', T.short(design.kkt_residual, 3)]);
    }
    return rows;
  }

  // What gives the same answer, as somebody would type it in the folder of the study.
  function command(result) {
    const quoted = (text) => /^[\w./+=-]+$/.test(text) ? text
      : "'" + text.replace(/'/g, "'\\''") + "'";
    const options = { seed: '--seed', starts: '--starts', max_evaluations: '--max-evaluations',
      proof_s: '--proof' };
    // a bare number would be in the parameter's own unit, whatever it is shown in
    const inUnit = (o) => o.value + (o.display_factor > 0
      ? '*' + (o.display_unit === 'in' ? 'inch' : o.display_unit) : '');
    const asked = D.clean(result.run.overrides).map((o) => o.kind === 'parameter'
      ? ' --set ' + quoted(o.name + '=' + inUnit(o))
      : options[o.name] ? ' ' + options[o.name] + ' ' + o.value : '');
    return result.study && result.study.file
      ? 'modetune run ' + quoted(result.study.file) + asked.join('') : null;
  }

  function origin(result) {
    const r = result.run;
    const rows = [
      ['modetune', `${r.modetune || ''}, sources ${r.build ? r.build.commit : 'unknown'}`],
      ['compiler', r.build ? r.build.compiler : null],
      ['libraries', [r.blas, r.nlopt && 'NLopt ' + r.nlopt, r.gsl && 'GSL ' + r.gsl]
        .filter(Boolean).join('; ')],
      ['command', command(result)],
      ['seed, local searches', `${r.seed}, ${r.starts}`],
      ['evaluations', String(r.evaluations)],
      ['run time', 'in timing.json, which "run" writes beside result.json'],
      ['cut by', r.cut_by],
    ];
    for (const o of D.clean(r.overrides)) {
      rows.push(['asked with', `${o.name} = ${T.withUnit(T.short(o.value, 10), o.unit)}`]);
    }
    for (const f of D.clean(r.inputs)) {
      rows.push([f.file, 'SHA-256 ' + f.sha256]);
    }
    return rows.filter((row) => row[1]);
  }

  mt.origin = function (into) {
    const section = d3.select(into).append('section').attr('class', 'origin')
      .attr('id', 'figure-origin');
    section.append('h2').text('Where this comes from');
    const table = section.append('div').attr('class', 'wide').append('table').append('tbody');
    const follow = () => {
      const rows = origin(mt.result()).concat(exactness(mt.choice().design));
      const tr = table.selectAll('tr').data(rows).join('tr');
      tr.selectAll('*').remove();
      tr.append('th').attr('scope', 'row').text((d) => d[0]);
      tr.append('td').text((d) => d[1]);
    };
    mt.onChoice(follow);
    follow();
  };
})();
