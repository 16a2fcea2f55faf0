// SPDX-License-Identifier: GPL-3.0-or-later
// What all scripts of a page share: its data, elements, numbers.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});

  // What shows nothing of itself but changes how others are read (base/text.c), and what
  // JSON escapes.
  const HIDDEN = new RegExp('[\\u007f-\\u009f\\u00ad\\u061c\\u180e\\u200b-\\u200f' +
    '\\u2028-\\u202e\\u2060-\\u206f\\ufeff\\ufff9-\\ufffb]');
  const ANY = new RegExp(HIDDEN.source + '|\\\\(?:u[0-9a-fA-F]{4}|.)', 'g');

  // Of JSON text: hidden characters become their numbers, to be seen.
  function visible(json) {
    return json.replace(ANY, (found) => {
      const escaped = found.length === 6;
      const code = escaped ? parseInt(found.slice(2), 16) : found.charCodeAt(0);
      return (escaped || found.length === 1) && HIDDEN.test(String.fromCharCode(code))
        ? '\\\\u' + code.toString(16).padStart(4, '0') : found;
    });
  }

  // What report/page.h has packed, as it was: nothing is shared, all may be changed.
  function unpack([keys, shared, root]) {
    const open = (v) => {
      if (Array.isArray(v)) {
        return v.map(open);
      }
      if (v === null || typeof v !== 'object') {
        return v;
      }
      if (v['#'] !== undefined) {
        return open(shared[v['#']]);
      }
      const [k, ...values] = v['~'] || [];
      return Object.fromEntries(k === undefined
        ? Object.entries(v).map(([name, value]) => [name, open(value)])
        : keys[k].map((name, i) => [name, open(values[i])]));
    };
    return open(root);
  }

  function block(id) {
    const element = document.getElementById(id);
    const data = element ? JSON.parse(visible(element.textContent)) : null;
    return Array.isArray(data) ? unpack(data) : data;
  }

  // The script stands before what it reads.
  mt.whenRead = (begin) => document.readyState === 'loading'
    ? document.addEventListener('DOMContentLoaded', begin) : begin();

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
