// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors of three numbers, as arrays; a matrix is the list of its columns.
(function () {
    'use strict';

    function add(a, b, s) {
        return [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
    }

    function sub(a, b) {
        return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    }

    function scaled(a, s) {
        return [s * a[0], s * a[1], s * a[2]];
    }

    function dot(a, b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }

    function cross(a, b) {
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0]];
    }

    function unit(a) {
        const length = Math.hypot(a[0], a[1], a[2]);
        return length > 0 ? scaled(a, 1 / length) : [0, 0, 1];
    }

    // Two directions across a, so that (first, second, a) is right-handed.
    function across(a) {
        const least = a.map(Math.abs).reduce((k, x, i, all) => (x < all[k] ? i : k), 0);
        const seed = [0, 0, 0];
        seed[least] = 1;
        const first = unit(cross(a, seed));
        return [first, cross(unit(a), first)];
    }

    window.mt = window.mt || {};
    window.mt.space = { add, sub, scaled, dot, cross, unit, across };
})();
