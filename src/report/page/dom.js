// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of a page. Texts become text nodes and nothing else: names come from files.
(function () {
    'use strict';

    // make('td', {class: 'number'}, 'text', child, ...): attributes that are null are left out,
    // functions listen ({click: f}), properties of the element begin with a dot
    // ({'.value': 3}).
    function make(name, attributes, ...children) {
        const made = document.createElement(name);
        Object.entries(attributes || {}).forEach(([key, value]) => {
            if (value === null || value === undefined || value === false) {
                return;
            }
            if (typeof value === 'function') {
                made.addEventListener(key, value);
            } else if (key[0] === '.') {
                made[key.slice(1)] = value;
            } else {
                made.setAttribute(key, value === true ? '' : value);
            }
        });
        children.flat().filter((child) => child !== null && child !== undefined)
            .forEach((child) => made.append(child));
        return made;
    }

    // A table with its header; rows are lists of cells (or of texts). Columns named
    // in `numbers` are aligned to the right.
    function table(header, rows, numbers) {
        const kind = (k) => (numbers && numbers.includes(k) ? 'number' : null);
        const cell = (name) => (content, k) =>
            make(name, { class: kind(k), scope: name === 'th' ? 'col' : null }, content);
        return make('table', {},
            make('thead', {}, make('tr', {}, header.map(cell('th')))),
            make('tbody', {}, rows.map((row) => (row instanceof HTMLTableRowElement ? row
                : make('tr', {}, row.map(cell('td')))))));
    }

    // A number with six digits that count; the page is read by people.
    function digits(value, count) {
        return typeof value === 'number' && isFinite(value)
            ? window.mt.number(value, count || 6).replace(/-/g, '\u2212') : '–';
    }

    window.mt = window.mt || {};
    window.mt.dom = { make, table, digits };
})();
