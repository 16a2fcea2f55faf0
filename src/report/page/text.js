// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as people read them, texts that fit their room, labels that keep clear of each other.
(function () {
  'use strict';
  const mt = (window.mt = window.mt || {});

  const FONT = 'system-ui, sans-serif';
  const SIZE = 12; // px, of all texts in figures unless they say otherwise
  const MINUS = '\u2212';
  const ELLIPSIS = '\u2026';

  const isNumber = (x) => typeof x === 'number' && Number.isFinite(x);

  // "24.88": so many significant digits; whole numbers keep all of theirs.
  function sig(x, digits) {
    const n = digits || 4;
    if (!isNumber(x)) {
      return '\u2013';
    }
    if (x === 0) {
      return '0';
    }
    const size = Math.abs(x);
    const power = size >= 1e6 || size < 1e-4;
    let text = power ? x.toExponential(n - 1) : x.toPrecision(n);
    if (power) {
      text = text.replace(/\.?0*e/, 'e').replace('e+', 'e');
    } else if (text.includes('e')) { // a whole number of more digits
      text = x.toFixed(0);
    }
    return text.replace(/-/g, MINUS);
  }

  // "24.9" without zeros that tell nothing: for axes and bounds.
  function short(x, digits) {
    const text = sig(x, digits);
    return text.includes('e') || !text.includes('.') ? text : text.replace(/\.?0+$/, '');
  }

  // "+4.1 %"
  function percent(x, digits) {
    if (!isNumber(x)) {
      return '\u2013';
    }
    if (Math.abs(x) < 5e-10) { // rounding
      return '0 %';
    }
    return (x > 0 ? '+' : '') + short(x, digits || 3) + ' %';
  }

  const withUnit = (text, unit) => unit ? text + ' ' + unit : text;
  const titled = (text, unit) => unit ? text + ' [' + unit + ']' : text;

  const pen = document.createElement('canvas').getContext('2d');
  const widths = new Map();

  function width(text, size, bold) {
    const key = (bold ? 'b' : 'n') + (size || SIZE) + text;
    if (!widths.has(key)) {
      pen.font = (bold ? '600 ' : '') + (size || SIZE) + 'px ' + FONT;
      widths.set(key, pen.measureText(text).width);
    }
    return widths.get(key);
  }

  // As much of the text as the room holds.
  function fit(text, room, size, bold) {
    if (width(text, size, bold) <= room) {
      return text;
    }
    let n = text.length;
    while (n > 0 && width(text.slice(0, n) + ELLIPSIS, size, bold) > room) {
      n--;
    }
    return n > 0 ? text.slice(0, n).trimEnd() + ELLIPSIS : '';
  }

  // The text in lines no longer than the room; a word that is, is cut.
  function wrap(text, room, size) {
    const lines = [];
    let line = '';
    for (const word of text.split(' ')) {
      const longer = line === '' ? word : line + ' ' + word;
      if (width(longer, size) <= room) {
        line = longer;
      } else {
        if (line !== '') {
          lines.push(line);
        }
        line = fit(word, room, size);
      }
    }
    lines.push(line);
    return lines;
  }

  // Labels { x, width } side by side between low and high, in as few lines as greed finds:
  // each gets `at` (its left end) and `lane`; the number of lanes is returned.
  function lanes(labels, low, high, gap) {
    const ends = [];
    for (const l of labels.slice().sort((a, b) => a.x - b.x)) {
      l.at = Math.max(low, Math.min(high - l.width, l.x - l.width / 2));
      l.lane = ends.findIndex((end) => end + gap <= l.at);
      if (l.lane < 0) {
        l.lane = ends.length;
      }
      ends[l.lane] = l.at + l.width;
    }
    return ends.length;
  }

  // Heights near those of the labels { y }, no two closer than gap, within low..high where that
  // has room for all: each label gets `at`. Labels that meet form a block around their mean.
  function spread(labels, gap, low, high) {
    const blocks = [];
    for (const l of labels.slice().sort((a, b) => a.y - b.y)) {
      let block = { members: [l], sum: l.y };
      const top = (b) => {
        const span = (b.members.length - 1) * gap;
        const mean = b.sum / b.members.length - span / 2;
        return Math.max(low, Math.min(high - span, mean));
      };
      for (let last = blocks[blocks.length - 1];
        last && top(last) + last.members.length * gap > top(block);
        last = blocks[blocks.length - 1]) {
        blocks.pop();
        block = { members: last.members.concat(block.members), sum: last.sum + block.sum };
      }
      block.top = top(block);
      blocks.push(block);
    }
    for (const b of blocks) {
      b.members.forEach((l, i) => {
        l.at = b.top + i * gap;
      });
    }
  }

  mt.text = {
    FONT, SIZE, isNumber, sig, short, percent, withUnit, titled, width, fit, wrap, lanes,
    spread,
  };
})();
