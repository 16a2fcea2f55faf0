// SPDX-License-Identifier: GPL-3.0-or-later
// What all scripts of a page share: its data, elements, numbers.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});

  function block(id) {
    const element = document.getElementById(id);
    return element ? JSON.parse(element.textContent) : null;
  }

  // The result of a report; the scene of a report (null: it has none) or of a show.
  mt.data = () => block('data');
  mt.scene = () => block('scene');

  // An element with attributes; whatever its text holds stays text.
  mt.element = function (parent, name, attributes, text) {
    const element = document.createElement(name);
    for (const key of Object.keys(attributes || {})) {
      element.setAttribute(key, attributes[key]);
    }
    if (text !== undefined && text !== null) {
      element.textContent = text;
    }
    if (parent) {
      parent.appendChild(element);
    }
    return element;
  };

  // A number with so many significant digits, without powers of ten where it needs none; null
  // (not applicable): a dash.
  mt.number = function (x, digits) {
    if (x === null || x === undefined || !Number.isFinite(x)) {
      return '-';
    }
    const size = Math.abs(x);
    const text = x.toPrecision(digits || 4);
    return size === 0 ? '0' : size >= 1e-4 && size < 1e7 ? String(Number(text)) : text;
  };

  // What the colours of the page are now: they follow light, dark and print.
  mt.colour = (name) =>
    getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();

  // Offer a text or a blob as a file.
  mt.save = function (name, content, type) {
    const blob = content instanceof Blob ? content : new Blob([content], { type: type });
    const link = mt.element(null, 'a', { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
})();
