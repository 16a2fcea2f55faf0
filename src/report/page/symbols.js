// SPDX-License-Identifier: GPL-3.0-or-later
// What joints, springs, dampers and sensors look like: lists of items in pixels. An item is a
// path ({path, closed}) or an ellipse ({ellipse: [x, y, a, b, angle]}) or a text ({text, at}),
// with names of colours (fill, stroke), width, dash and depth. Every kind has a shape of its
// own: colour says nothing that the shape does not.
(function () {
    'use strict';
    const { add, scaled, dot, unit, across } = window.mt.space;

    const TURN = 2 * Math.PI;

    function polygon(n, x, y, r, phase) {
        const path = [];
        for (let k = 0; k < n; k++) {
            const a = phase + TURN * k / n;
            path.push([x + r * Math.cos(a), y + r * Math.sin(a)]);
        }
        return path;
    }

    function box(x, y, a, b) {
        return [[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]];
    }

    function gear(x, y, r) {
        const path = [];
        for (let k = 0; k < 32; k++) {
            const tooth = k % 4 < 2 ? 1.15 : 0.8;
            const a = TURN * k / 32;
            path.push([x + tooth * r * Math.cos(a), y + tooth * r * Math.sin(a)]);
        }
        return path;
    }

    function toothed(x, y, r) {
        const path = [[x - 1.3 * r, y + 0.6 * r]];
        for (let k = 0; k <= 8; k++) {
            path.push([x + (k / 4 - 1) * 1.3 * r, y + (k % 2 === 0 ? 0 : -0.7) * r]);
        }
        return path.concat([[x + 1.3 * r, y + 0.6 * r]]);
    }

    const circle = (x, y, r) => ({ ellipse: [x, y, r, r, 0] });
    const shape = (path) => ({ path, closed: true });
    const stroke = (...path) => ({ path, fill: null });

    // Of each type of joint, around x, y with radius r.
    const JOINTS = {
        revolute: (x, y, r) => [circle(x, y, r)],
        prismatic: (x, y, r) => [shape(box(x, y, 0.9 * r, 0.9 * r))],
        spherical: (x, y, r) => [shape(polygon(4, x, y, 1.3 * r, 0))],
        fixed: (x, y, r) => [stroke([x - r, y - r], [x + r, y + r]),
            stroke([x - r, y + r], [x + r, y - r])],
        cylindrical: (x, y, r) => [shape(box(x, y, r, r)), circle(x, y, 0.6 * r)],
        universal: (x, y, r) => [circle(x, y, r), stroke([x - r, y], [x + r, y]),
            stroke([x, y - r], [x, y + r])],
        planar: (x, y, r) => [shape(box(x, y, 1.4 * r, 0.5 * r))],
        'pin-in-slot': (x, y, r) => [shape(box(x, y, 1.5 * r, 0.8 * r)), circle(x, y, 0.5 * r)],
        distance: (x, y, r) => [shape(polygon(3, x, y, 0.9 * r, 0)),
            stroke([x - 1.3 * r, y], [x + 1.3 * r, y])],
        'point-on-line': (x, y, r) => [shape(polygon(3, x, y, 1.2 * r, -TURN / 4)),
            stroke([x - 1.4 * r, y + r], [x + 1.4 * r, y + r])],
        'point-on-plane': (x, y, r) => [shape(polygon(3, x, y, 1.2 * r, -TURN / 4))],
        orientation: (x, y, r) => [shape(polygon(6, x, y, 1.1 * r, 0))],
        gear: (x, y, r) => [shape(gear(x, y, r))],
        rack: (x, y, r) => [shape(toothed(x, y, r))]
    };

    function joint(type, at, r) {
        const other = (x, y, s) => [shape(polygon(5, x, y, 1.1 * s, -TURN / 4))];
        const look = { fill: 'paper', stroke: 'ink', width: 1.6 };
        return (JOINTS[type] || other)(at[0], at[1], r).map((item) => ({ ...look, ...item }));
    }

    // Places along the line from a to b (in pixels), and beside it.
    function ruler(a, b) {
        const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
        const t = length > 0 ? [(b[0] - a[0]) / length, (b[1] - a[1]) / length] : [1, 0];
        return { length, at: (along, beside) =>
            [a[0] + along * t[0] - beside * t[1], a[1] + along * t[1] + beside * t[0]] };
    }

    function zigzag(a, b, r) {
        const line = ruler(a, b);
        const lead = Math.min(0.2 * line.length, 3 * r);
        const room = Math.round((line.length - 2 * lead) / (2.4 * r));
        const teeth = Math.max(4, Math.min(12, 2 * room));
        const path = [a, line.at(lead, 0)];
        for (let k = 0; k < teeth; k++) {
            const along = lead + (line.length - 2 * lead) * (k + 0.5) / teeth;
            path.push(line.at(along, (k % 2 === 0 ? 0.9 : -0.9) * r));
        }
        return path.concat([line.at(line.length - lead, 0), b]);
    }

    // Places by angle and distance around an axis of the scene, as the eye sees it.
    function around(at, axis, lens) {
        const [e, f] = across(unit(axis || lens.frame.towards)).map((v) => lens.direction(v));
        return (angle, s) => [0, 1].map((k) =>
            at[k] + s * (Math.cos(angle) * e[k] + Math.sin(angle) * f[k]));
    }

    // A spiral around the axis.
    function spiral(at, axis, r, lens) {
        const on = around(at, axis, lens);
        const path = [];
        const turns = 2.25;
        for (let k = 0; k <= 72; k++) {
            const a = TURN * turns * k / 72;
            path.push(on(a, r * (1 + 2.4 * k / 72)));
        }
        return path;
    }

    function spring(type, a, b, axis, r, lens) {
        const look = { stroke: 'spring', width: 1.7 };
        const near = Math.hypot(b[0] - a[0], b[1] - a[1]) < 3 * r;
        const open = (path) => ({ ...look, path });
        if (type === 'link') {
            return []; // its line is drawn
        }
        if (type === 'torsion') {
            return [open(spiral(a, axis, r, lens))];
        }
        if (type === 'bar') {
            return [{ ...open([a, b]), width: 3.4 },
                { ...open([a, b]), stroke: 'paper', width: 1 }];
        }
        if (type === 'bushing') {
            const rings = (at) => [{ ...look, ...circle(at[0], at[1], 1.9 * r) },
                { ...look, ...circle(at[0], at[1], 1.4 * r), dash: [2, 2] }];
            return near ? rings(a) : [...rings(a), open(zigzag(a, b, r)), ...rings(b)];
        }
        return near ? [open(zigzag([a[0] - 2 * r, a[1]], [a[0] + 2 * r, a[1]], 0.9 * r))]
            : [open(zigzag(a, b, r))];
    }

    function damper(type, a, b, axis, r, lens) {
        const look = { stroke: 'damper', width: 1.6 };
        if (type === 'torsion') {
            const on = around(a, axis, lens);
            const arc = [];
            for (let k = 0; k <= 24; k++) {
                arc.push(on(0.4 + 5.4 * k / 24, 2.8 * r));
            }
            const end = [on(5.8, 2.3 * r), on(5.8, 3.3 * r)];
            return [arc, end].map((path) => ({ ...look, path }));
        }
        const near = Math.hypot(b[0] - a[0], b[1] - a[1]) < 3 * r;
        const line = near ? ruler([a[0] - 3 * r, a[1]], [a[0] + 3 * r, a[1]]) : ruler(a, b);
        const m = line.length / 2;
        const cup = [[1.3, -1], [-1, -1], [-1, 1], [1.3, 1]];
        const piston = m + 0.4 * r;
        return [[line.at(0, 0), line.at(m - r, 0)],
            cup.map(([along, beside]) => line.at(m + along * r, beside * r)),
            [line.at(piston, -0.7 * r), line.at(piston, 0.7 * r)],
            [line.at(piston, 0), line.at(line.length, 0)]].map((path) => ({ ...look, path }));
    }

    function arrow(a, b, colour, r) {
        const line = ruler(a, b);
        const head = Math.min(1.2 * r, line.length);
        const base = line.length - head;
        return [{ path: [a, b], stroke: colour, width: 1.7 },
            { path: [b, line.at(base, 0.45 * head), line.at(base, -0.45 * head)],
                closed: true, fill: colour, stroke: colour, width: 1 }];
    }

    // The ground where something holds on to it, seen from direction (x, y) of the picture.
    function ground(at, towards, r) {
        const length = Math.hypot(towards[0], towards[1]) || 1;
        const away = [-towards[0] / length, -towards[1] / length];
        const on = (along, behind) => [at[0] - along * away[1] * r + behind * away[0] * r,
            at[1] + along * away[0] * r + behind * away[1] * r];
        const lines = [[on(-2.2, 1.2), on(2.2, 1.2)]];
        for (let k = -2; k <= 2; k++) {
            lines.push([on(k * 0.9 + 0.3, 1.2), on(k * 0.9 - 0.5, 2.2)]);
        }
        return lines.map((path) => ({ path, stroke: 'ink', width: 1.2 }));
    }

    // The ellipsoid at + sum of axes a_k times the unit sphere: its outline is the ellipse of
    // P A A' P', whose half-axes come from a 2 x 2 eigenproblem.
    function ellipsoid(at, axes, lens) {
        const [x, y] = lens.project(at);
        const s = lens.scaleAt(at);
        const rows = axes.map((axis) => lens.direction(axis));
        const xx = rows.reduce((sum, v) => sum + v[0] * v[0], 0);
        const yy = rows.reduce((sum, v) => sum + v[1] * v[1], 0);
        const xy = rows.reduce((sum, v) => sum + v[0] * v[1], 0);
        const mean = (xx + yy) / 2;
        const half = Math.hypot((xx - yy) / 2, xy);
        return [x, y, s * Math.sqrt(mean + half), s * Math.sqrt(Math.max(mean - half, 0)),
            0.5 * Math.atan2(2 * xy, xx - yy)];
    }

    // The principal section across the k-th axis, as far as it lies on the side of the eye.
    function section(at, axes, k, lens) {
        const e = axes[(k + 1) % 3];
        const f = axes[(k + 2) % 3];
        const normal = (v) => axes.reduce((sum, axis) => {
            const square = dot(axis, axis);
            return square > 0 ? add(sum, axis, dot(v, axis) / (square * square)) : sum;
        }, [0, 0, 0]);
        const paths = [];
        let path = null;
        for (let i = 0; i <= 48; i++) {
            const a = TURN * i / 48;
            const v = add(scaled(e, Math.cos(a)), f, Math.sin(a));
            if (dot(normal(v), lens.frame.towards) < 0) {
                path = null;
                continue;
            }
            if (!path) {
                path = [];
                paths.push(path);
            }
            path.push(lens.project(add(at, v, 1)).slice(0, 2));
        }
        return paths.filter((p) => p.length > 1);
    }

    window.mt.symbols = { joint, spring, damper, arrow, ground, ellipsoid, section };
})();
