// SPDX-License-Identifier: GPL-3.0-or-later
// The frame of a figure: heading, sentence, drawing, its numbers as a table, and buttons that
// save it. Colours are written into the drawing as on paper, so that a saved figure stands
// alone; the page's style maps them where the screen is dark.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});
  const T = mt.text;

  // Okabe and Ito's colours and greys.
  const colour = {
    ink: '#1a1a1a', soft: '#5a5a5a', line: '#d6d6d6', paper: '#ffffff', panel: '#f1f3f5',
    before: '#707070', after: '#0072b2', bad: '#d55e00', good: '#00795a', band: '#f0b48f',
    margin: '#fae3d3', range: '#dfedf7', other: '#a0527f', amber: '#b37400',
  };
  const LEAST_WIDTH = 260;
  const MOST_WIDTH = 1184;
  const PAPER_WIDTH = 680; // of A4 without its margins
  const MANY_COLUMNS = 9; // more of them need small letters on paper
  const TITLE_SIZE = 15;
  const PNG_SCALE = 2;
  const BESIDE = 10; // px that every figure leaves right of its scale
  const figures = [];

  const SHAPES = {
    circle: d3.symbolCircle, square: d3.symbolSquare, triangle: d3.symbolTriangle,
    diamond: d3.symbolDiamond, star: d3.symbolStar, plus: d3.symbolCross, wye: d3.symbolWye,
  };

  // f(event, datum), whatever version of d3 there is.
  function on(selection, type, f) {
    return selection.each(function (d) {
      this.addEventListener(type, (event) => f(event, d));
    });
  }

  // A mark of about the size of a circle of 5 px; a cross (x) is two strokes.
  function mark(g, shape, x, y, look) {
    const l = Object.assign({ colour: colour.after, filled: true, size: 80 }, look);
    const at = 'translate(' + x.toFixed(2) + ',' + y.toFixed(2) + ')';
    const path = g.append('path').attr('transform', at);
    if (shape === 'cross') {
      const r = Math.sqrt(l.size) / 2;
      return path.attr('d', `M${-r},${-r}L${r},${r}M${-r},${r}L${r},${-r}`)
        .attr('stroke', l.colour).attr('stroke-width', 2).attr('fill', 'none');
    }
    if (shape === 'diamond') { // d3's own is narrow
      const r = Math.sqrt(l.size / 2) * 1.05;
      return path.attr('d', `M0,${-r}L${r},0L0,${r}L${-r},0Z`).attr('fill', l.filled ? l.colour
        : colour.paper).attr('stroke', l.colour).attr('stroke-width', 1.6);
    }
    return path.attr('d', d3.symbol().type(SHAPES[shape]).size(l.size)())
      .attr('fill', l.filled ? l.colour : colour.paper)
      .attr('stroke', l.colour).attr('stroke-width', 1.6);
  }

  function line(g, x1, y1, x2, y2, stroke, more) {
    const made = g.append('line').attr('x1', x1).attr('y1', y1).attr('x2', x2)
      .attr('y2', y2).attr('stroke', stroke);
    for (const [name, value] of Object.entries(more || {})) {
      made.attr(name, value);
    }
    return made;
  }

  function rect(g, x, y, w, h, fill) {
    return g.append('rect').attr('x', x).attr('y', y).attr('width', Math.max(0, w))
      .attr('height', Math.max(0, h)).attr('fill', fill);
  }

  // look: anchor, size, colour, bold, halo (a rim of paper, over lines and bands)
  function text(g, x, y, words, look) {
    const l = look || {};
    const made = g.append('text').attr('x', x).attr('y', y)
      .attr('fill', l.colour || colour.ink).attr('text-anchor', l.anchor || 'start')
      .text(words);
    if (l.size) {
      made.attr('font-size', l.size);
    }
    if (l.bold) {
      made.attr('font-weight', 600);
    }
    if (l.halo) {
      made.attr('stroke', colour.paper).attr('stroke-width', 3)
        .attr('stroke-linejoin', 'round').attr('paint-order', 'stroke');
    }
    return made;
  }

  // An arrow from (x1, y) to (x2, y) that ends short of the marks at both.
  function arrow(g, x1, x2, y, stroke) {
    const way = Math.sign(x2 - x1);
    const from = x1 + way * 7;
    const to = x2 - way * 8;
    if ((to - from) * way < 3) {
      return;
    }
    line(g, from, y, to - way * 4, y, stroke, { 'stroke-width': 1.6 });
    g.append('path').attr('fill', stroke)
      .attr('d', `M${to},${y}L${to - way * 7},${y - 4}L${to - way * 7},${y + 4}Z`);
  }

  // Marks of a scale along y = bottom with the grid above it up to top, and the title below.
  // Returns the height that it needs.
  function axisBelow(g, scale, range, title, options) {
    const o = Object.assign({ count: Math.max(3, Math.round((range[1] - range[0]) / 90)) },
      options);
    let ticks = o.ticks || scale.ticks(o.count);
    let end = -Infinity;
    const shown = ticks.map((v) => ({ v, x: scale(v), words: (o.format || T.short)(v) }))
      .filter((t) => t.x >= range[0] - 1 && t.x <= range[1] + 1);
    for (const t of shown) {
      const half = T.width(t.words, 11) / 2;
      line(g, t.x, o.top, t.x, o.bottom, colour.line);
      const x = Math.max(half, Math.min(range[1] + BESIDE - half, t.x));
      if (x - half > end + 6) {
        text(g, x, o.bottom + 15, t.words,
          { anchor: 'middle', size: 11, colour: colour.soft });
        end = x + half;
      }
    }
    line(g, range[0], o.bottom, range[1], o.bottom, colour.soft);
    text(g, (range[0] + range[1]) / 2, o.bottom + 33, title, { anchor: 'middle' });
    return 40;
  }

  function axisLeft(g, scale, range, title, options) {
    const o = Object.assign({ count: Math.max(3, Math.round((range[1] - range[0]) / 55)) },
      options);
    for (const v of o.ticks || scale.ticks(o.count)) {
      const y = scale(v);
      line(g, o.left, y, o.right, y, colour.line);
      text(g, o.left - 6, y + 4, (o.format || T.short)(v),
        { anchor: 'end', size: 11, colour: colour.soft });
    }
    line(g, o.left, range[0], o.left, range[1], colour.soft);
    text(g, 0, 0, title, { anchor: 'middle' })
      .attr('transform', `translate(12,${(range[0] + range[1]) / 2})rotate(-90)`);
  }

  // Of letters on cells, whose colours do not follow the page's.
  function inkOn(fill) {
    const c = d3.rgb(fill);
    return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b > 140 ? '#000000' : '#fefefe';
  }

  // Items { words, draw(g, x, y) } in lines from y on; x, y: the middle of 26 px for the sign.
  // Returns the height used.
  function legend(g, items, x, y, w) {
    let at = x;
    let row = 0;
    for (const item of items) {
      const words = T.fit(item.words, w - 34);
      const need = 34 + T.width(words) + 16;
      if (at > x && at + need - 16 > x + w) {
        at = x;
        row++;
      }
      const middle = y + row * 20 + 10;
      item.draw(g, at + 13, middle);
      text(g, at + 32, middle + 4, words, { colour: colour.soft });
      at += need;
    }
    return (row + 1) * 20 + 4;
  }

  // --- data: one table, as CSV and as HTML ---

  // As the program's own CSV: what a spreadsheet would take for a formula gets an apostrophe.
  function field(value) {
    if (value === null || value === undefined || Number.isNaN(value)) {
      return '';
    }
    if (typeof value === 'number' || typeof value === 'boolean') {
      return String(value);
    }
    const words = String(value).replace(/[\u0000-\u001f\u007f]/g, ' ');
    return /^[ ']*[=+\-@\uff1d\uff0b\uff0d\uff20]/.test(words) ? "'" + words : words;
  }

  function csv(table) {
    return d3.csvFormatRows([table.columns].concat(table.rows).map((row) => row.map(field)))
      .replace(/\n/g, '\r\n') + '\r\n';
  }

  function cell(value) {
    if (typeof value === 'number') {
      return T.short(value, 6);
    }
    return value === null || value === undefined ? '\u2013' : String(value);
  }

  function fillTable(box, table) {
    box.selectAll('*').remove();
    const made = box.append('table');
    made.append('thead').append('tr').selectAll('th').data(table.columns).join('th')
      .attr('scope', 'col').text((d) => d);
    made.append('tbody').selectAll('tr').data(table.rows).join('tr').selectAll('td')
      .data((row) => row).join('td').attr('class', (d) => typeof d === 'number' ? 'n' : null)
      .text(cell);
  }

  // --- saving ---

  // The drawing with its title, on paper.
  function alone(f) {
    const copy = f.svg.node().cloneNode(true);
    const w = f.width;
    const title = f.title() + (mt.choice ? ' \u2013 ' + mt.choice().label : '');
    const lines = T.wrap(title, w - 8, TITLE_SIZE);
    const head = lines.length * 20 + 8;
    const svg = d3.select(copy).attr('xmlns', 'http://www.w3.org/2000/svg')
      .attr('viewBox', `0 ${-head} ${w} ${f.height + head}`).attr('width', w)
      .attr('height', f.height + head).attr('class', null);
    svg.selectAll('.brush').remove();
    svg.selectAll('*').attr('tabindex', null).attr('role', null).attr('style', null);
    svg.insert('rect', ':first-child').attr('x', 0).attr('y', -head).attr('width', w)
      .attr('height', f.height + head).attr('fill', colour.paper);
    lines.forEach((words, i) => text(svg, 4, i * 20 - head + 18, words,
      { size: TITLE_SIZE, bold: true }));
    return { source: new XMLSerializer().serializeToString(copy), w, h: f.height + head };
  }

  function savePng(f) {
    const drawing = alone(f);
    const image = new Image();
    image.onload = () => {
      const canvas = document.createElement('canvas');
      canvas.width = drawing.w * PNG_SCALE;
      canvas.height = drawing.h * PNG_SCALE;
      canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob((blob) => mt.save(f.file + '.png', blob), 'image/png');
    };
    image.src = 'data:image/svg+xml;charset=utf-8,' + encodeURIComponent(drawing.source);
  }

  const SAVERS = [
    ['SVG', (f) => mt.save(f.file + '.svg', alone(f).source, 'image/svg+xml')],
    ['PNG', savePng],
    ['CSV', (f) => mt.save(f.file + '.csv', csv(f.table()), 'text/csv')],
  ];

  // --- the frame ---

  let printing = false;

  const widthOf = (f) => printing ? PAPER_WIDTH
    : Math.max(LEAST_WIDTH, Math.min(MOST_WIDTH, f.box.node().clientWidth));

  function redraw(f) {
    const w = widthOf(f);
    f.width = w;
    f.svg.selectAll('*').remove();
    f.svg.append('title').text(f.title());
    f.height = Math.ceil(f.draw(f.svg, w));
    f.svg.attr('viewBox', `0 0 ${w} ${f.height}`).attr('width', w).attr('height', f.height);
  }

  function update(f) {
    const has = f.has();
    f.section.attr('hidden', has ? null : '');
    if (!has) {
      return;
    }
    f.heading.text(f.title());
    const lead = f.lead ? f.lead() : '';
    f.words.text(lead).attr('hidden', lead ? null : '');
    redraw(f);
    if (f.details.property('open')) {
      fillTable(f.data, f.table());
    }
  }

  // spec: id, title() or title, lead() and hint (sentences, may be missing), has() (is there
  // anything to draw?), draw(svg, width) -> height, table() -> { columns, rows }. `into`: its
  // place.
  function add(spec, into) {
    const f = Object.assign({ file: 'modetune_' + spec.id, width: 0, height: 0 }, spec);
    f.title = typeof spec.title === 'function' ? spec.title : () => spec.title;
    f.section = d3.select(into).append('section').attr('class', 'figure')
      .attr('id', 'figure-' + f.id);
    f.heading = f.section.append('h2');
    f.words = f.section.append('p').attr('class', 'lead');
    if (f.hint) { // what hands can do with it, which paper has no use for
      f.section.append('p').attr('class', 'lead screen').text(f.hint);
    }
    f.box = f.section.append('figure');
    f.svg = f.box.append('svg').attr('role', 'img').attr('font-family', T.FONT)
      .attr('font-size', T.SIZE);
    const bar = f.section.append('div').attr('class', 'tools');
    f.details = bar.append('details');
    f.details.append('summary').text('Numbers');
    f.data = f.details.append('div').attr('class', 'wide');
    on(f.details, 'toggle', () => {
      if (f.details.property('open')) {
        fillTable(f.data, f.table());
      }
    });
    const buttons = bar.append('div').attr('class', 'export');
    for (const [name, how] of SAVERS) {
      on(buttons.append('button').attr('type', 'button').text(name)
        .attr('aria-label', 'Save ' + f.title() + ' as ' + name), 'click', () => how(f));
    }
    figures.push(f);
    update(f);
    new ResizeObserver(() => {
      if (f.box.node().clientWidth > 0 && Math.abs(widthOf(f) - f.width) > 1) {
        redraw(f);
      }
    }).observe(f.box.node());
    return f;
  }

  // Paper has its own width, and shows what is folded on a screen.
  function print(now) {
    printing = now;
    for (const told of document.querySelectorAll('#told, .title details')) {
      told.open = now;
    }
    for (const table of document.querySelectorAll('main table')) {
      table.classList.toggle('dense', now && table.rows.length > 0 &&
        table.rows[0].cells.length > MANY_COLUMNS);
    }
    figures.forEach(update);
  }

  window.addEventListener('beforeprint', () => print(true));
  window.addEventListener('afterprint', () => print(false));

  mt.figure = {
    colour, mark, line, rect, text, inkOn, arrow, axisBelow, axisLeft, legend, add, csv, on,
    fillTable,
    shapes: Object.keys(SHAPES), updateAll: () => figures.forEach(update),
  };
})();
