// SPDX-License-Identifier: GPL-3.0-or-later
// A posed configuration (pose.js) through a lens (camera.js) to items (paint.js) and to what
// the pointer finds: [{at | from, to | ellipse, rank, text}], texts as lists of lines.
(function () {
    'use strict';
    const { add, unit, scaled } = window.mt.space;
    const symbols = window.mt.symbols;

    const SYMBOL = 5.5;     // radius of a symbol, px
    const CROWDED = 40;     // more symbols than these are drawn smaller
    const PIECES = 6;       // of a long line, each at its own depth
    const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'],
        [1e-9, 'n']];
    const IN_FRONT = 0.004; // of the size: what a symbol comes before the line that it lies on

    // Four digits that count, with a prefix, so that lengths and stiffnesses can be read.
    function quantity(value, unitName) {
        if (typeof value !== 'number' || !isFinite(value)) {
            return '–';
        }
        const rounded = Number(value.toPrecision(4));
        const size = Math.abs(rounded);
        const [factor, prefix] = PREFIXES.find(([f]) => size >= f) || [1, ''];
        return Number((rounded / factor).toPrecision(4)) + ' ' + prefix + unitName;
    }

    function weight(mass) {
        const rounded = Number(mass.toPrecision(4));
        return rounded >= 1 ? rounded + ' kg' : quantity(1000 * mass, 'g');
    }

    const STIFFNESS = { torsion: 'N·m/rad', axial: 'N/m', bar: 'N/m' };
    const DAMPING = { torsion: 'N·m·s/rad', axial: 'N·s/m' };

    const circle = (at, r) => ({ ellipse: [at[0], at[1], r, r, 0] });

    function between(configuration, pair) {
        const name = (i) => (configuration.bodies[i] ? configuration.bodies[i].name : '?');
        return pair.map(name).join(' – ');
    }

    function makeDrawing(configuration, posed, lens, options) {
        const items = [];
        const finds = [];
        const size = options.size;
        const count = posed.joints.length + posed.springs.length + posed.sensors.length;
        const crowd = Math.max(0.55, Math.min(1, Math.sqrt(CROWDED / (count + 1))));
        const r = SYMBOL * options.symbol * crowd;

        function put(list, depth, front) {
            const before = (front || 0) * IN_FRONT * size;
            list.forEach((item) => items.push({ ...item, depth: depth + before }));
        }


        function line(from, to, look, front) {
            for (let k = 0; k < PIECES; k++) {
                const a = add(scaled(from, 1 - k / PIECES), to, k / PIECES);
                const b = add(scaled(from, 1 - (k + 1) / PIECES), to, (k + 1) / PIECES);
                const p = lens.project(a);
                const q = lens.project(b);
                put([{ path: [p, q], ...look }], (p[2] + q[2]) / 2, front);
            }
        }

        function find(what, rank, ...text) {
            finds.push({ ...what, rank, text: text.filter((part) => part) });
        }

        function drawBody(body) {
            const { item, at, axes } = body;
            if (item.kind === 'ground') {
                return;
            }
            const p = lens.project(at);
            const told = item.mass > 0 ? 'mass ' + weight(item.mass) : null;
            if (!axes) {
                if (item.mass > 0 && item.kind !== 'link') {
                    const look = { fill: 'body', stroke: 'paper', width: 1 };
                    put([{ ...circle(p, 0.6 * r), ...look }], p[2], 1);
                }
                find({ at: p, r: r }, 2, item.name, told);
                return;
            }
            const outline = symbols.ellipsoid(at, axes, lens);
            const round = { stroke: 'body', width: 0.8, faint: 0.45 };
            put([{ ellipse: outline, fill: 'body', alpha: 0.16, stroke: 'body', width: 1.3 }],
                p[2]);
            [0, 1, 2].forEach((k) => symbols.section(at, axes, k, lens)
                .forEach((path) => put([{ path, ...round }], p[2], 0.5)));
            find({ ellipse: outline }, 4, item.name, told,
                'drawn as an ellipsoid of its mass and inertia');
        }

        function drawGround() {
            const seen = new Set();
            const mark = (at, towards) => {
                const key = Math.round(at[0] / 6) + ' ' + Math.round(at[1] / 6);
                if (!seen.has(key)) {
                    seen.add(key);
                    put(symbols.ground(at, towards, r), at[2], -1);
                }
            };
            [...posed.springs, ...posed.dampers].forEach(({ item, from, to }) => {
                const ends = [lens.project(from), lens.project(to)];
                const k = item.bodies.indexOf(0);
                if (k >= 0) {
                    const d = [ends[1 - k][0] - ends[k][0], ends[1 - k][1] - ends[k][1]];
                    mark(ends[k], Math.hypot(d[0], d[1]) < 2 * r ? [0, -1] : d);
                }
            });
            posed.joints.filter(({ item }) => item.bodies.includes(0))
                .forEach(({ at }) => mark(lens.project(at), [0, -1]));
        }

        function drawJoint({ item, from, at }) {
            const p = lens.project(at);
            if (from) {
                line(from, at, { stroke: 'ink', width: 2.4 });
                find({ from: lens.project(from), to: p }, 3, item.name, 'rod');
            }
            put(symbols.joint(item.type, p, r), p[2], 3);
            if (options.isFar(item)) {
                const look = { stroke: 'far', width: 1.6, dash: [3, 3] };
                put([{ ...circle(p, 2.1 * r), ...look }], p[2], 3);
            }
            find({ at: p, r: 1.3 * r }, 0, item.name, item.type + ' joint',
                between(configuration, item.bodies),
                item.distance > 0 && item.far
                    ? quantity(item.distance, 'm') + ' from ' + item.far : null);
        }

        function drawElement(make, units, kind) {
            return ({ item, from, to, axis }) => {
                const a = lens.project(from);
                const b = lens.project(to);
                const drawn = make(item.type, a, b, axis, r, lens);
                put(drawn, (a[2] + b[2]) / 2, 2);
                const value = kind === 'spring' ? item.stiffness : item.damping;
                const known = units[item.type] && typeof value === 'number' && value !== 0;
                const text = [item.name, item.type + ' ' + kind,
                    between(configuration, item.bodies),
                    known ? quantity(value, units[item.type]) : null];
                if (Math.hypot(a[0] - b[0], a[1] - b[1]) < 3 * r) {
                    find({ at: a, r: 2.4 * r }, 1, ...text);
                } else {
                    find({ from: a, to: b }, 1, ...text);
                }
            };
        }

        // An arrow of a fixed length in pixels at this place along this axis.
        function pointer(at, axis, colour, pixels) {
            const direction = lens.direction(unit(axis));
            const p = lens.project(at);
            const q = [p[0] + pixels * direction[0], p[1] + pixels * direction[1]];
            put(symbols.arrow(p, q, colour, r), p[2], 4);
            return p;
        }

        posed.lines.forEach(({ item, from, to }) => {
            const body = configuration.bodies[item.body];
            const ground = !body || body.kind === 'ground';
            line(from, to, { stroke: ground ? 'soft' : 'ink', width: ground ? 1.2 : 2.4 });
            find({ from: lens.project(from), to: lens.project(to) }, 3, body ? body.name : '',
                body && body.mass > 0 ? 'mass ' + weight(body.mass) : null);
        });
        posed.bodies.forEach(drawBody);
        drawGround();
        posed.springs.forEach(drawElement(symbols.spring, STIFFNESS, 'spring'));
        posed.dampers.forEach(drawElement(symbols.damper, DAMPING, 'damper'));
        posed.joints.forEach(drawJoint);
        posed.sensors.forEach(({ item, at, axis }) => {
            const p = axis ? pointer(at, axis, 'sensor', 4.2 * r) : lens.project(at);
            find({ at: p, r: r }, 1, item.name, 'sensor');
        });
        posed.loads.forEach(({ item, at, axis }) => {
            find({ at: pointer(at, axis, 'rotor', 6 * r), r: r }, 1, item.name, 'load');
        });
        return { items, finds };
    }

    // The configuration at rest, as grey lines and dots behind what moves.
    function ghost(posed, lens, size) {
        const bars = posed.springs.filter(({ item }) => item.type === 'bar');
        const masses = posed.bodies.filter(({ item, axes }) =>
            !axes && item.kind === 'body' && item.mass > 0);
        const dots = masses.map(({ at }) => ({ ...circle(lens.project(at), 0.7 * SYMBOL),
            stroke: 'ghost', width: 1.2, depth: -3 * size }));
        return dots.concat([...posed.lines, ...bars].map(({ from, to }) => {
            const p = lens.project(from);
            const q = lens.project(to);
            return { path: [p, q], stroke: 'ghost', width: 1.2, dash: [4, 3],
                depth: (p[2] + q[2]) / 2 - 2 * size };
        }));
    }

    // Axes of the scene (and of rotors) in the lower left corner, a length in the lower right.
    function furniture(scene, rotors, lens, { width, height }) {
        const items = [];
        const front = 10 * scene.size;
        const inset = rotors.length > 0 ? 56 : 34;
        const at = [inset, height - inset];

        function label(text, x, y, fill) {
            const half = 3.5 * text.length; // about, and it has to stay in the picture
            items.push({ text, at: [Math.max(x, half + 4), Math.min(y, height - 5)],
                anchor: 'middle', fill, depth: front });
        }

        function arm(axis, name, colour, length) {
            const d = lens.direction(unit(axis));
            if (Math.hypot(d[0], d[1]) < 0.2) {
                if (colour === 'rotor') { // towards the eye
                    items.push({ ...circle(at, 6), stroke: colour, width: 1.6, depth: front });
                    label(name, at[0], at[1] + 20, colour);
                }
                return;
            }
            const to = [at[0] + length * d[0], at[1] + length * d[1]];
            symbols.arrow(at, to, colour, 5).forEach((item) =>
                items.push({ ...item, depth: front }));
            label(name, at[0] + (length + 9) * d[0], at[1] + (length + 9) * d[1] + 4, colour);
        }

        [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => arm(axis, 'xyz'[k], 'soft', 18));
        rotors.forEach(({ item, axis }) => arm(axis, item.name.slice(0, 20), 'rotor', 34));
        const whole = 90 / lens.scale;
        const power = Math.pow(10, Math.floor(Math.log10(whole)));
        const length = [5, 2, 1].map((lead) => lead * power).find((x) => x <= whole) || power;
        const right = width - 14;
        const left = right - length * lens.scale;
        const y = height - 16;
        items.push({ path: [[left, y - 4], [left, y], [right, y], [right, y - 4]],
            stroke: 'soft', width: 1.2, depth: front });
        items.push({ text: quantity(length, 'm'), at: [(left + right) / 2, y - 6],
            anchor: 'middle', fill: 'soft', depth: front });
        return items;
    }

    function distanceTo(what, x, y) {
        if (what.at) {
            return Math.max(Math.hypot(x - what.at[0], y - what.at[1]) - what.r, 0);
        }
        if (what.ellipse) {
            const [cx, cy, a, b, angle] = what.ellipse;
            const u = (x - cx) * Math.cos(angle) + (y - cy) * Math.sin(angle);
            const v = -(x - cx) * Math.sin(angle) + (y - cy) * Math.cos(angle);
            return Math.hypot(u / Math.max(a, 1), v / Math.max(b, 1)) <= 1 ? 0 : Infinity;
        }
        const dx = what.to[0] - what.from[0];
        const dy = what.to[1] - what.from[1];
        const square = dx * dx + dy * dy;
        const along = (x - what.from[0]) * dx + (y - what.from[1]) * dy;
        const t = square > 0 ? Math.max(0, Math.min(1, along / square)) : 0;
        return Math.hypot(x - what.from[0] - t * dx, y - what.from[1] - t * dy);
    }

    // What lies under the pointer: the smallest kind within reach, the nearest of it.
    function pick(finds, x, y) {
        const REACH = 9;
        const found = finds.map((what) => ({ what, d: distanceTo(what, x, y) }))
            .filter((entry) => entry.d <= REACH)
            .sort((a, b) => a.what.rank - b.what.rank || a.d - b.d);
        return found.length > 0 ? found[0].what : null;
    }

    window.mt.drawing = { make: makeDrawing, ghost, furniture, pick, quantity, weight };
})();
