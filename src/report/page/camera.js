// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that turns about a point: the eye lies at yaw and pitch around the scene, "up" stays
// up. Several views may look through one camera.
//
//   d = cos p (cos y e1 + sin y e2) + sin p e3     towards the eye
//   r = -sin y e1 + cos y e2                       to the right in the picture
//   u = d x r                                      up in the picture
//
// e3 is up in the scene: against gravity, where there is any.
(function () {
    'use strict';
    const { add, sub, scaled, dot, cross } = window.mt.space;

    const STEP = Math.PI / 36; // of an arrow key
    const ZOOM = 1.2;          // of the keys + and -
    const PER_PIXEL = 0.008;   // radians of a drag
    const PER_NOTCH = 0.0015;  // logarithm of the zoom per pixel of the wheel
    const DISTANCE = 2.5;      // of the eye of a perspective, in sizes of the scene
    const MARGIN = 0.86;       // of the picture that a fitted scene takes
    const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

    function upOf(scene) {
        const gravity = scene.gravity;
        if (gravity && gravity.some((g) => g !== 0)) {
            const size = gravity.map(Math.abs);
            const axis = size.indexOf(Math.max(...size));
            return { axis, sign: gravity[axis] > 0 ? -1 : 1 };
        }
        return { axis: scene.dimension === 2 ? 1 : 2, sign: 1 };
    }

    function basisOf(up) {
        const e1 = AXES[(up.axis + 1) % 3];
        const e2 = AXES[(up.axis + 2) % 3];
        const e3 = AXES[up.axis].map((x) => x * up.sign);
        return up.sign > 0 ? [e1, e2, e3] : [e2, e1, e3];
    }

    function makeCamera(scene) {
        const basis = basisOf(upOf(scene));
        const size = scene.size > 0 ? scene.size : 1;
        const listeners = [];
        const camera = { size, yaw: 0, pitch: 0, zoom: 1, centre: [0, 0, 0], half: [size, size],
            perspective: false };
        const shown = new Map();

        function frame() {
            const cy = Math.cos(camera.yaw);
            const sy = Math.sin(camera.yaw);
            const cp = Math.cos(camera.pitch);
            const sp = Math.sin(camera.pitch);
            const sum = (a, b, c) =>
                add(add(scaled(basis[0], a), basis[1], b), basis[2], c);
            const towards = sum(cp * cy, cp * sy, sp);
            const right = sum(-sy, cy, 0);
            return { towards, right, up: cross(towards, right) };
        }

        // What turns points into pixels of a picture of this width and height.
        camera.lens = function (width, height) {
            const f = frame();
            const fit = Math.min(width / (2 * camera.half[0]), height / (2 * camera.half[1]));
            const scale = MARGIN * camera.zoom * fit;
            const far = DISTANCE * size;
            const near = 0.1 * far; // nothing comes closer to the eye, or it would turn over
            const grow = (depth) =>
                (camera.perspective ? far / Math.max(far - depth, near) : 1);
            const lens = { scale, frame: f };
            lens.project = function (p) {
                const q = sub(p, camera.centre);
                const depth = dot(q, f.towards);
                const s = scale * grow(depth);
                return [width / 2 + s * dot(q, f.right), height / 2 - s * dot(q, f.up), depth];
            };
            lens.scaleAt = (p) => scale * grow(dot(sub(p, camera.centre), f.towards));
            lens.direction = (v) => [dot(v, f.right), -dot(v, f.up), dot(v, f.towards)];
            return lens;
        };

        // What is to be seen, told by each of those that look (by any key of theirs).
        camera.cover = function (who, points) {
            shown.set(who, points);
        };

        camera.listen = function (listener) {
            listeners.push(listener);
        };

        camera.changed = function () {
            listeners.forEach((listener) => listener());
        };

        camera.fit = function () {
            const f = frame();
            const points = [...shown.values()].flat();
            const range = [f.right, f.up, f.towards].map((axis) => {
                const at = points.map((p) => dot(p, axis));
                return at.reduce(([low, high], x) => [Math.min(low, x), Math.max(high, x)],
                    at.length > 0 ? [Infinity, -Infinity] : [-size / 2, size / 2]);
            });
            camera.centre = [0, 0, 0];
            [f.right, f.up, f.towards].forEach((axis, i) => {
                camera.centre = add(camera.centre, axis, (range[i][0] + range[i][1]) / 2);
            });
            const least = 0.05 * size; // a row seen from its end has no extent of its own
            camera.half = range.slice(0, 2)
                .map(([low, high]) => Math.max((high - low) / 2, least));
            camera.zoom = 1;
            camera.changed();
        };

        // The view along an axis of the scene: 0 is x, 1 is y, 2 is z; x and z are seen from
        // their far ends, y from the front.
        camera.lookAlong = function (axis) {
            const eye = AXES[axis].map((x) => (axis === 1 ? -x : x));
            const upward = dot(eye, basis[2]);
            if (Math.abs(upward) > 0.5) {
                const level = upOf(scene).axis === 0 ? AXES[1] : AXES[0];
                camera.pitch = Math.PI / 2; // from above
                camera.yaw = Math.atan2(-dot(level, basis[0]), dot(level, basis[1]));
            } else {
                camera.pitch = 0;
                camera.yaw = Math.atan2(dot(eye, basis[1]), dot(eye, basis[0]));
            }
            camera.fit();
        };

        camera.home = function () {
            if (scene.dimension === 2) {
                camera.lookAlong(2);
                return;
            }
            camera.yaw = -Math.PI / 3;
            camera.pitch = Math.PI / 7;
            camera.fit();
        };

        camera.turn = function (yaw, pitch) {
            camera.yaw += yaw;
            camera.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, camera.pitch + pitch));
            camera.changed();
        };

        camera.zoomBy = function (factor) {
            camera.zoom = Math.max(0.05, Math.min(200, camera.zoom * factor));
            camera.changed();
        };

        camera.pan = function (dx, dy, scale) {
            const f = frame();
            camera.centre = add(add(camera.centre, f.right, -dx / scale), f.up, dy / scale);
            camera.changed();
        };

        camera.setPerspective = function (on) {
            camera.perspective = on;
            camera.changed();
        };
        return camera;
    }

    // Keys of a view; true where the key meant something.
    function onKey(camera, key) {
        const turns = { ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP],
            ArrowDown: [0, -STEP] };
        if (turns[key]) {
            camera.turn(...turns[key]);
        } else if (key === '+' || key === '=') {
            camera.zoomBy(ZOOM);
        } else if (key === '-' || key === '_') {
            camera.zoomBy(1 / ZOOM);
        } else if (key === '0') {
            camera.fit();
        } else if ('xyz'.includes(key) && key.length === 1) {
            camera.lookAlong('xyz'.indexOf(key));
        } else {
            return false;
        }
        return true;
    }

    // Dragging, one finger or two, wheel and keys on a canvas. `lens` gives the lens of now.
    function attach(canvas, camera, lens) {
        const held = new Map(); // pointers that are down

        function spread() {
            const [a, b] = [...held.values()];
            return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2,
                d: Math.hypot(a.x - b.x, a.y - b.y) };
        }

        canvas.addEventListener('pointerdown', (event) => {
            held.set(event.pointerId, { x: event.clientX, y: event.clientY,
                pan: event.shiftKey || event.button === 1 || event.button === 2 });
            canvas.setPointerCapture(event.pointerId);
        });
        canvas.addEventListener('pointermove', (event) => {
            const from = held.get(event.pointerId);
            if (!from) {
                return;
            }
            const before = held.size === 2 ? spread() : null;
            const dx = event.clientX - from.x;
            const dy = event.clientY - from.y;
            from.x = event.clientX;
            from.y = event.clientY;
            if (before) {
                const now = spread();
                camera.pan(now.x - before.x, now.y - before.y, lens().scale);
                camera.zoomBy(before.d > 0 ? now.d / before.d : 1);
            } else if (from.pan) {
                camera.pan(dx, dy, lens().scale);
            } else {
                camera.turn(-dx * PER_PIXEL, dy * PER_PIXEL);
            }
        });
        const release = (event) => held.delete(event.pointerId);
        canvas.addEventListener('pointerup', release);
        canvas.addEventListener('pointercancel', release);
        canvas.addEventListener('contextmenu', (event) => event.preventDefault());
        canvas.addEventListener('wheel', (event) => {
            event.preventDefault();
            const pixels = event.deltaMode === 1 ? 16 * event.deltaY : event.deltaY;
            camera.zoomBy(Math.exp(-pixels * PER_NOTCH));
        }, { passive: false });
        canvas.addEventListener('keydown', (event) => {
            if (!event.ctrlKey && !event.altKey && !event.metaKey && onKey(camera, event.key)) {
                event.preventDefault();
            }
        });
    }

    window.mt.camera = makeCamera;
    window.mt.cameraAttach = attach;
})();
