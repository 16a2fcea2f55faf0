// SPDX-License-Identifier: GPL-3.0-or-later
// Where everything of a configuration is: as it stands, moved by a mode, or at another position
// of its drive.
//
// A mode moves a point p of the body whose mass centre is c by s (t + r x (p - c)), to first
// order in s as the mode itself is: points that a joint holds together stay together. Bodies
// are stretched a little by it, which at the amplitudes drawn nobody sees.
(function () {
    'use strict';
    const { add, sub, cross } = window.mt.space;

    // The rotation of a pose (x y z, then its rows r00 r01 r02 r10 ...) times v.
    function turned(r, v) {
        return [3, 6, 9].map((k) => r[k] * v[0] + r[k + 1] * v[1] + r[k + 2] * v[2]);
    }

    function mover(configuration, state) {
        const bodies = configuration.bodies;
        const mode = state.mode === null ? null : configuration.modes[state.mode];
        const drive = configuration.drive;
        const position = drive && state.position !== null
            ? drive.positions[state.position] : null;
        const poses = position && position.poses;
        const s = state.displacement;

        function direction(i, v) {
            const w = poses ? turned(poses[i], v) : v;
            if (poses || !mode || !mode.motion[i]) {
                return w;
            }
            return add(w, cross(mode.motion[i].slice(3), w), s);
        }

        function point(i, p) {
            const centre = bodies[i].at;
            const lever = direction(i, sub(p, centre));
            const moved = poses ? poses[i].slice(0, 3)
                : mode && mode.motion[i] ? add(centre, mode.motion[i], s) : centre;
            return add(moved, lever, 1);
        }
        return { point, direction };
    }

    // The same lists as the configuration has, each with its places as they are in this state:
    // {mode: index or null, position: index or null, displacement: m}.
    function pose(configuration, state) {
        const { point, direction } = mover(configuration, state);
        const alive = (list) => list || [];
        const moved = (i, v) => (v ? direction(i, v) : null);

        const between = (list) => alive(list).map((item) => ({ item,
            from: point(item.bodies[0], item.from), to: point(item.bodies[1], item.to),
            axis: moved(item.bodies[0], item.axis) }));
        return {
            bodies: configuration.bodies.map((item, i) => ({ item, at: point(i, item.at),
                axes: item.ellipsoid
                    ? item.ellipsoid.axes.map((axis, k) =>
                        direction(i, axis.map((x) => x * item.ellipsoid.radii[k])))
                    : null })),
            lines: alive(configuration.lines).map((item) => ({ item,
                from: point(item.body, item.from), to: point(item.body, item.to) })),
            points: alive(configuration.points).map((item) => ({ item,
                at: point(item.body, item.at) })),
            // the point of a joint is one of its second body, its axis one of its first
            joints: alive(configuration.joints).filter((item) => item.at).map((item) => ({ item,
                from: item.from ? point(item.bodies[0], item.from) : null,
                at: point(item.bodies[1], item.at), axis: moved(item.bodies[0], item.axis) })),
            springs: between(configuration.springs),
            dampers: between(configuration.dampers),
            sensors: alive(configuration.sensors).map((item) => ({ item,
                at: point(item.body, item.at), axis: moved(item.body, item.axis) })),
            rotors: alive(configuration.rotors).map((item) => ({ item, axis: item.axis })),
            loads: alive(configuration.loads)
                .filter((item) => item.at && item.axis && item.body !== undefined)
                .map((item) => ({ item, at: point(item.body, item.at), axis: item.axis }))
        };
    }

    // All places that a picture of this has to show.
    function extent(posed) {
        const all = [];
        posed.bodies.forEach((body) => {
            if (body.axes) {
                body.axes.forEach((axis) =>
                    all.push(add(body.at, axis, 1), add(body.at, axis, -1)));
            } else if (body.item.kind !== 'ground') {
                all.push(body.at);
            }
        });
        [posed.lines, posed.springs, posed.dampers].forEach((list) =>
            list.forEach((line) => all.push(line.from, line.to)));
        [posed.joints, posed.sensors].forEach((list) =>
            list.forEach((item) => all.push(item.at, ...(item.from ? [item.from] : []))));
        return all;
    }

    window.mt.pose = pose;
    window.mt.poseExtent = extent;
})();
