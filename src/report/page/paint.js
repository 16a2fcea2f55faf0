// SPDX-License-Identifier: GPL-3.0-or-later
// Items (see symbols.js) onto a canvas or into an SVG, farthest first.
(function () {
    'use strict';

    const SVG = 'http://www.w3.org/2000/svg';
    const FONT = '12px system-ui, sans-serif';

    // Colours by name: of Okabe and Ito, darker or lighter where the paper asks for it.
    const LIGHT = { ink: '#1a1a1a', paper: '#ffffff', soft: '#8a8a8a', body: '#0072b2',
        spring: '#00735a', damper: '#8a4a78', sensor: '#b04a00', rotor: '#8a6100',
        far: '#c04000', ghost: '#a8a8a8' };
    const DARK = { ink: '#eaeaea', paper: '#15181c', soft: '#8f979f', body: '#56b4e9',
        spring: '#2cc79d', damper: '#dd9cc3', sensor: '#ff8c42', rotor: '#e8b03a',
        far: '#ff8c42', ghost: '#5a6168' };

    // The palette of the page as it is: its own ink and paper, and whichever set suits them.
    function palette(element) {
        const style = getComputedStyle(element);
        const dark = window.matchMedia('(prefers-color-scheme: dark)').matches;
        const set = { ...(dark ? DARK : LIGHT) };
        ['ink', 'paper'].forEach((name) => {
            const own = style.getPropertyValue('--' + name).trim();
            if (own) {
                set[name] = own;
            }
        });
        return set;
    }

    function sorted(items) {
        return items.map((item, k) => ({ item, k, depth: item.depth || 0 }))
            .sort((a, b) => a.depth - b.depth || a.k - b.k).map((entry) => entry.item);
    }

    function trace(context, item) {
        context.beginPath();
        if (item.ellipse) {
            const [x, y, a, b, angle] = item.ellipse;
            context.ellipse(x, y, Math.max(a, 0.1), Math.max(b, 0.1), angle, 0, 2 * Math.PI);
            return;
        }
        item.path.forEach((p) => context.lineTo(p[0], p[1])); // the first one begins
        if (item.closed) {
            context.closePath();
        }
    }

    function toCanvas(context, items, colours) {
        context.lineJoin = 'round';
        context.lineCap = 'round';
        sorted(items).forEach((item) => {
            if (item.text !== undefined) {
                context.font = FONT;
                context.fillStyle = colours[item.fill];
                context.textAlign = item.anchor === 'middle' ? 'center' : 'start';
                context.fillText(item.text, item.at[0], item.at[1]);
                return;
            }
            trace(context, item);
            if (item.fill) {
                context.globalAlpha = item.alpha || 1;
                context.fillStyle = colours[item.fill];
                context.fill();
                context.globalAlpha = 1;
            }
            if (item.stroke) {
                context.globalAlpha = item.faint || 1;
                context.strokeStyle = colours[item.stroke];
                context.lineWidth = item.width || 1;
                context.setLineDash(item.dash || []);
                context.stroke();
                context.globalAlpha = 1;
            }
        });
        context.setLineDash([]);
    }

    function element(name, attributes) {
        const made = document.createElementNS(SVG, name);
        Object.entries(attributes).forEach(([key, value]) => {
            if (value !== null && value !== undefined) {
                made.setAttribute(key, value);
            }
        });
        return made;
    }

    const short = (x) => String(Math.round(100 * x) / 100);

    function toElement(item, colours) {
        if (item.text !== undefined) {
            const text = element('text', { x: short(item.at[0]), y: short(item.at[1]),
                'text-anchor': item.anchor, fill: colours[item.fill], 'font-size': 12,
                'font-family': 'system-ui, sans-serif' });
            text.textContent = item.text;
            return text;
        }
        const look = { fill: item.fill ? colours[item.fill] : 'none',
            'fill-opacity': item.fill && item.alpha ? item.alpha : null,
            stroke: item.stroke ? colours[item.stroke] : null,
            'stroke-width': item.stroke ? item.width || 1 : null,
            'stroke-opacity': item.stroke && item.faint ? item.faint : null,
            'stroke-dasharray': item.dash ? item.dash.join(' ') : null };
        if (item.ellipse) {
            const [x, y, a, b, angle] = item.ellipse;
            const turn = `rotate(${short(angle * 180 / Math.PI)} ${short(x)} ${short(y)})`;
            return element('ellipse', { ...look, cx: short(x), cy: short(y), rx: short(a),
                ry: short(b), transform: angle ? turn : null });
        }
        const points = item.path.map((p) => short(p[0]) + ',' + short(p[1])).join(' ');
        return element(item.closed ? 'polygon' : 'polyline', { ...look, points });
    }

    // An <svg> of the items; with a paper behind them unless colours has none.
    function toSvg(items, colours, width, height) {
        const svg = element('svg', { viewBox: `0 0 ${width} ${height}`, width, height,
            'stroke-linejoin': 'round', 'stroke-linecap': 'round' });
        if (colours.behind) {
            svg.append(element('rect', { width, height, fill: colours.behind }));
        }
        sorted(items).forEach((item) => svg.append(toElement(item, colours)));
        return svg;
    }

    const fileName = (name) => name.replace(/[^A-Za-z0-9._-]+/g, '_').slice(0, 100);

    function saveSvg(items, width, height, name) {
        const svg = toSvg(items, { ...LIGHT, behind: LIGHT.paper }, width, height);
        window.mt.save(fileName(name) + '.svg', new XMLSerializer().serializeToString(svg),
            'image/svg+xml');
    }

    function savePng(items, width, height, name) {
        const times = 3; // pixels of the file per pixel of the page
        const canvas = document.createElement('canvas');
        canvas.width = times * width;
        canvas.height = times * height;
        const context = canvas.getContext('2d');
        context.scale(times, times);
        context.fillStyle = LIGHT.paper;
        context.fillRect(0, 0, width, height);
        toCanvas(context, items, LIGHT);
        canvas.toBlob((blob) => window.mt.save(fileName(name) + '.png', blob, 'image/png'),
            'image/png');
    }

    window.mt.paint = { LIGHT, palette, toCanvas, toSvg, saveSvg, savePng };
})();
