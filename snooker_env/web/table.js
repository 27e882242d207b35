/**
 * How is a table drawn in a browser, and how does a replay play? By one module on a 2-D canvas; it loads nothing.
 *
 * `decode` makes strokes that give every ball's place at any time: each phase of motion is a closed form, in the arithmetic of
 * `physics/cloth.py`, so places equal the simulation's. `TableView` draws a table from its scene, `mount` makes a `Player`.
 *
 * Frame: origin at the table's centre, +x to the yellow side, +y to the black end, SI units. On screen +y goes right and +x down.
 *
 * A frame may have `depth` (0 on the cloth, 1 gone into a pocket), a line a `path` (Path2D in metres). A player's options are
 * `autoplay`, `speed`, `paths`, `ghosts`, `spin` ("cue", "all", "off"), `labels`, `fill` (as high as its parent), `keys` (what listens),
 * `onstroke(stroke)`, `ontime(t, stroke)`, `onend()`.
 */

const GONE = 0, ROLL = 2, SLIDE = 3, FALLING = 4, BEND = 5, BALL_BALL = 0;
/** Words for events, by kind; a kind without is no stop for a step. */
const EVENTS = ["touches", "meets a cushion", "meets a jaw", "is potted", "rolls", "rests", "drops", "comes back"];
const { PI, abs, atan2, ceil, cos, floor, hypot, max, min, round, sign, sin, sqrt } = Math, TURN = 2 * PI;

const WHITE = [255, 255, 255], BLACK = [0, 0, 0];

const css = (rgb, alpha = 1) => (rgb.map ? `rgba(${rgb.map(round)},${alpha})` : rgb);
/** A colour, darker or lighter. */
const lit = (rgb, light) => rgb.map(value => min(255, value * light));
/** A colour between two. */
const mix = (a, b, share) => a.map((value, k) => value + (b[k] - value) * share);

/** Numbers from base64. */
const numbers = (text, Type) => new Type(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);

/** The rotation q, then one by the vector (x, y, z) [rad]; quaternions are [w, x, y, z]. */
function turned(q, x, y, z) {
	const angle = hypot(x, y, z);
	if (angle < 1e-12) return q;
	const w = cos(angle / 2), s = sin(angle / 2) / angle;
	x *= s; y *= s; z *= s;
	const [a, b, c, d] = q;
	return [w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c, w * c + y * a + z * b - x * d, w * d + z * a + x * c - y * b];
}

/** Step [s] of a ball's orientation where its axis turns. */
const STEP = 1 / 120;

/** A stroke's data, and where the balls are at any time. */
class Stroke {
	constructor(data, replay, previous) {
		Object.assign(this, data, { R: replay.R, decel: replay.spin_decel, previous, turns: new Map() });
		const { n, paths: { count, f8, f4, u1 }, after } = data, flags = balls => Uint8Array.from({ length: n }, (_, ball) => balls.includes(ball));
		const rows = numbers(f8, Float64Array), spins = numbers(f4, Float32Array), codes = numbers(u1, Uint8Array);
		this.first = numbers(data.start, Float64Array);
		this.here = flags(data.on_table);
		this.logs = Array.from({ length: n }, () => []); // by ball: its segments, in order of time
		for (let s = 0; s < count; s++) {
			const [t0, x, y, vx, vy, ax, ay] = rows.subarray(7 * s), [wx, wy, wz] = spins.subarray(3 * s);
			this.logs[codes[2 * s]].push({ t0, x, y, vx, vy, ax, ay, wx, wy, wz, state: codes[2 * s + 1] });
		}
		if (!after) return;
		const places = numbers(after.places, Float64Array);
		this.later = { x: places.filter((_, k) => k % 2 === 0), y: places.filter((_, k) => k % 2), on: flags(after.on_table) };
	}

	/** Which segment of a ball's log holds at time t; -1 before the first. */
	find(ball, t) { return this.logs[ball].findLastIndex(segment => segment.t0 <= t); }

	/** [x, y, vx, vy, wx, wy, wz] at time t of a segment; the order of the arithmetic is that of the simulation. */
	moving({ t0, x, y, vx, vy, ax, ay, wx, wy, wz, state }, t) {
		const { R } = this, dt = t - t0, v = vx + ax * dt, w = vy + ay * dt, slips = state === SLIDE || state === FALLING;
		return [x + (vx + 0.5 * ax * dt) * dt, y + (vy + 0.5 * ay * dt) * dt, v, w, slips ? wx + 2.5 * ay * dt / R : -w / R,
			slips ? wy - 2.5 * ax * dt / R : v / R, sign(wz) * max(0, abs(wz) - this.decel * dt)];
	}

	/** All balls at time t [s]: x, y, vx, vy, wx, wy, wz, `on` the table (1 or 0), `depth` in a pocket. */
	at(t) {
		const out = { on: this.here.slice(), depth: Float64Array.from(this.here, here => 1 - here) }, names = "x y vx vy wx wy wz".split(" ");
		for (const name of names) out[name] = new Float64Array(this.n);
		this.logs.forEach((log, i) => {
			const k = this.find(i, t), still = this.decel > 0 && t >= this.duration, values = k < 0 ? this.first.subarray(2 * i, 2 * i + 2) : this.moving(log[k], t);
			values.forEach((value, c) => { out[names[c]][i] = still && c > 3 ? 0 : value; });
			if (k < 0 || !this.here[i]) return;
			if (log[k].state === GONE) out.on[i] = 0;
			let fell = k + 1; // with this segment it went over the edge
			while (fell && [GONE, FALLING].includes(log[fell - 1].state)) fell--;
			if (fell <= k) out.depth[i] = min(1, ((t - log[fell].t0) / 0.2) ** 2); // it falls 0.2 m in 0.2 s
		});
		return out;
	}

	/** The table at rest. */
	get end() { return this.at(this.duration); }

	/** The orientation of a ball at time t, a quaternion that depends on t alone. */
	turn(ball, t) {
		const k = this.find(ball, t), log = this.logs[ball], before = this.previous, known = this.turns.get(ball) ?? []; // at the start, then of each segment
		this.turns.set(ball, known);
		if (!known.length) known.push({ q: ball < before?.n ? before.turn(ball, before.duration) : turned([1, 0, 0, 0], ball + 0.4, 0.5 - ball, 2 * ball) });
		for (let j = known.length - 1; j <= k; j++) {
			known.push({ q: j ? this.rolled(log[j - 1], known[j], log[j].t0) : known[0].q });
			known[j].steps = null; // or a match would fill the memory
		}
		return k < 0 ? known[0].q : this.rolled(log[k], known[k + 1], min(t, this.duration));
	}

	/** From the start of a segment to time t: in one exact step where the axis stays, else by the middles of small ones. */
	rolled(segment, start, t) {
		const { t0, state, wz } = segment;
		if (state === GONE || t <= t0) return start.q;
		const step = (q, from, to) => turned(q, ...this.moving(segment, (from + to) / 2).slice(4).map(spin => spin * (to - from)));
		if (state === ROLL && !wz) return step(start.q, t0, t);
		start.steps ??= [start.q];
		const whole = floor((t - t0) / STEP);
		for (let m = start.steps.length; m <= whole; m++) start.steps.push(step(start.steps[m - 1], t0 + (m - 1) * STEP, t0 + m * STEP));
		return step(start.steps[whole], t0 + whole * STEP, t);
	}

	/** Add a ball's path until time t to two paths in metres. A parabola is a quadratic curve, exactly. */
	trace(ball, t, slide, roll) {
		this.logs[ball].forEach((segment, j, log) => {
			const { t0, x, y, vx, vy, state } = segment, end = min(t, log[j + 1]?.t0 ?? this.duration), half = (end - t0) / 2;
			if (half <= 0 || !(vx || vy)) return;
			const path = state === ROLL || state === BEND ? roll : slide;
			path.moveTo(x, y);
			path.quadraticCurveTo(x + vx * half, y + vy * half, ...this.moving(segment, end).slice(0, 2));
		});
	}
}

/** A replay with its strokes ready to be evaluated. */
export function decode(replay) {
	if (replay?.format !== "snooker-replay" || replay.version !== 1) throw new Error(`no replay of version 1: ${replay?.format} ${replay?.version}`);
	let last = null;
	return { ...replay, strokes: replay.strokes.map(data => (last = new Stroke(data, replay, last))) };
}

function sheet(width, height) {
	const canvas = Object.assign(document.createElement("canvas"), { width: ceil(width), height: ceil(height) });
	return [canvas, canvas.getContext("2d")];
}

/** Grain for cloth and wood, reproducible. */
function unrest(strength) {
	const [canvas, pen] = sheet(256, 256), image = pen.createImageData(256, 256);
	for (let k = 0, seed = 1; k < 65536; k++) {
		seed = Math.imul(seed, 1664525) + 1013904223 | 0;
		image.data.set([...(seed > 0 ? WHITE : BLACK), abs(seed) / 2 ** 23 * strength], 4 * k);
	}
	pen.putImageData(image, 0, 0);
	return canvas;
}

/** Fill what a pen has drawn, with a gradient by its stops [place, colour]. */
function fill(pen, filling, ...stops) {
	for (const [at, colour] of stops) filling.addColorStop(at, colour);
	pen.fillStyle = filling;
	pen.fill();
}

/** The same, or a line, with a soft shadow around it. */
function cast(pen, colour, blur, ...filling) {
	pen.shadowColor = colour;
	pen.shadowBlur = blur;
	if (filling.length) fill(pen, ...filling); else pen.stroke();
	pen.shadowColor = "#0000";
}

function disc(pen, x, y, radius, filling, ...stops) {
	pen.beginPath();
	pen.arc(x, y, radius, 0, TURN);
	if (filling) fill(pen, filling, ...stops); else pen.stroke();
}

/** A disc with a gradient from its middle to its edge. */
function glow(pen, x, y, radius, ...stops) { disc(pen, x, y, radius, pen.createRadialGradient(x, y, 0, x, y, radius), ...stops); }

/** Set a pen's line style. */
const nib = (pen, strokeStyle, lineWidth) => Object.assign(pen, { strokeStyle, lineWidth });

function polyline(pen, points, width, colour) {
	pen.beginPath();
	for (const point of points) pen.lineTo(...point);
	if (!width) return;
	nib(pen, colour, width).stroke();
}

/** Draws a table; its constant parts once for each size. */
export class TableView {
	constructor(canvas, scene) {
		Object.assign(this, { canvas, scene, R: scene.ball_radius });
		this.pen = canvas.getContext("2d", { alpha: false });
		this.colours = scene.palette;
		this.ink = Object.fromEntries(Object.entries(this.colours).map(([name, rgb]) => [name, css(rgb)]));
		const [lamp, pen] = sheet(32, 32);
		glow(pen, 16, 16, 16, ...[[0, 1], [0.3, 0.8], [0.6, 0.2], [1, 0]].map(([at, alpha]) => [at, css(this.colours.lamp, alpha)]));
		this.lamp = lamp;
		this.resize();
	}

	/** Breadth, height [m]. */
	static size(scene) {
		const [[x0, x1], [y0, y1]] = scene.extent, out = scene.cushions.length ? 2 * scene.rail + 0.04 : 0.1;
		return [y1 - y0 + out, x1 - x0 + out];
	}

	/** Fit the canvas to its layout. */
	resize() {
		const { canvas, scene } = this, [[x0, x1], [y0, y1]] = scene.extent, [wide, high] = TableView.size(scene);
		this.ratio = min(devicePixelRatio, 3);
		const w = (canvas.width = round(canvas.clientWidth * this.ratio) || canvas.width), h = (canvas.height = round(canvas.clientHeight * this.ratio) || canvas.height);
		this.scale = min(w / wide, h / high);
		this.left = w / 2 - this.scale * (y0 + y1) / 2;
		this.top = h / 2 - this.scale * (x0 + x1) / 2;
		this.sprites = new Map();
		if (this.still?.width !== w || this.still?.height !== h) this.still = null;
	}

	/** CSS pixels on the canvas of a place [m]. */
	toScreen(x, y) { return this.pixel(x, y).map(value => value / this.ratio); }

	/** The place [m] of CSS pixels on the canvas. */
	toTable(px, py) { return [(py * this.ratio - this.top) / this.scale, (px * this.ratio - this.left) / this.scale]; }

	/** The canvas's own pixels of a place [m]. */
	pixel(x, y) { return [this.left + this.scale * y, this.top + this.scale * x]; }

	/** Let a pen draw in metres. */
	metres(pen) { pen.setTransform(0, this.scale, this.scale, 0, this.left, this.top); }

	/** The table without balls, as a canvas. */
	paint() {
		const { scene, scene: { rail, lines }, colours, ink, scale, canvas: { width, height } } = this, [[x0, x1], [y0, y1]] = scene.extent, px = 1 / scale;
		const [still, pen] = sheet(width, height), framed = scene.cushions.length > 0, bed = framed ? scene.cushion : 9;
		const start = (out, round = 0) => {
			pen.beginPath();
			pen.roundRect(x0 - out, y0 - out, x1 - x0 + 2 * out, y1 - y0 + 2 * out, round);
		};
		const texture = (strength, along, across, swap) => { // stretched along y, or along x
			const pattern = pen.createPattern(unrest(strength), "repeat"), a = along * px, b = across * px;
			pattern.setTransform(new DOMMatrix(swap ? [a, 0, 0, b, 0, 0] : [0, a, b, 0, 0, 0]));
			fill(pen, pattern);
		};
		pen.fillStyle = ink.floor;
		pen.fillRect(0, 0, width, height);
		this.metres(pen);

		if (framed) {
			const { wood } = colours, corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
			const at = ([x, y], out) => [x + sign(x) * out, y + sign(y) * out];
			start(rail, 0.085);
			cast(pen, "#000c", 0.04 * scale, ink.wood_edge);
			start(rail - 0.003, 0.082);
			pen.save();
			pen.clip();
			corners.forEach((one, k) => { // four boards, mitred, round outside, with a groove inside
				const next = corners[(k + 1) % 4], [ix, iy] = at(one, bed), [ox, oy] = at(one, rail), end = k % 2 === 0;
				polyline(pen, [one, at(one, rail), at(next, rail), next]);
				fill(pen, pen.createLinearGradient(ix, iy, end ? ix : ox, end ? oy : iy), ...[[0, 0.5], [0.07, 1.1], [0.12, 1.4], [0.16, 1.1], [0.7, 1.2], [0.8, 1.6], [0.9, 1.2], [1, 0.4]].map(([part, light]) => [part, css(lit(wood, light))]));
				texture(0.07, 30, 1.6, end);
			});
			pen.restore();
		}
		const pocket = ([x, y, u, v, half], rim, from = hypot(u - x, v - y)) => { // from its back so far to its mouth
			const turn = atan2(v - y, u - x), ex = cos(turn), ey = sin(turn), wide = half + rim, bx = u - ex * from, by = v - ey * from;
			polyline(pen, [[bx - ey * wide, by + ex * wide]]);
			pen.arc(u, v, wide, turn + PI / 2, turn - PI / 2, true);
			pen.lineTo(bx + ey * wide, by - ex * wide);
			return pen.createRadialGradient(u, v, 0, u, v, half);
		};
		for (const throat of scene.throats) fill(pen, pocket(throat, 0), [0.6, ink.hole], [1, css(lit(colours.leather, 0.6))]); // its inside, in the dark

		pen.save();
		start(bed);
		pen.clip();
		fill(pen, ink.hole);
		pen.save();
		start(9);
		for (const [x, y, r] of scene.falls) { pen.moveTo(x + r, y); pen.arc(x, y, r, 0, TURN); } // the slate is cut out there
		pen.clip("evenodd");
		start(bed);
		fill(pen, ink.cloth);
		texture(0.025, 3, 1);
		texture(0.018, 40, 5);
		const chalk = css(colours.line, 0.9);
		for (const points of lines ? [lines.baulk, lines.d] : []) polyline(pen, points, max(0.0035, 1.2 * px), chalk);
		for (const [x, y] of lines?.spots ?? []) disc(pen, x, y, max(0.006, 1.4 * px), chalk);
		for (const [x, y, r] of scene.falls) // the cloth bends down
			glow(pen, x, y, r + 0.014, [r / (r + 0.014), ink.cloth_edge], [1, css(colours.cloth_edge, 0)]);
		pen.restore();
		scene.cushions.forEach((points, k) => {
			const nose = scene.noses[k], a = nose[(nose.length >> 1) - 1], b = nose[nose.length >> 1], [x, y] = points[0];
			const slope = abs(a[0] - b[0]) > abs(a[1] - b[1]) ? pen.createLinearGradient(0, a[1], 0, y) : pen.createLinearGradient(a[0], 0, x, 0);
			polyline(pen, points);
			cast(pen, css(colours.shadow, 0.9), 0.03 * scale, slope, [0, css(lit(colours.cushion, 1.2))], [1, css(lit(colours.cushion, 0.72))]);
			pen.save();
			pen.clip();
			for (const [wide, alpha] of [[0.02, 0.3], [0.011, 0.7]]) polyline(pen, nose, max(wide, 2 * px), css(colours.nose, alpha)); // the light on its edge
			pen.restore();
		});
		pen.restore();
		for (const throat of scene.throats) { // its leather, cut off where both ends lie on the cushions
			const [x, y, u, v, half] = throat, long = hypot(u - x, v - y), over = (side, at) => {
				const dx = (x - u) / long, dy = (y - v) / long, wide = side * (half + 0.02), a = u + dx * at - dy * wide, b = v + dy * at + dx * wide;
				return max(abs(a) - x1, abs(b) - y1) > bed - 0.007;
			};
			let from = -0.05;
			while (from < long && (over(1, from) || over(-1, from))) from += 0.001;
			for (const [rim, wide, light, shadow] of [[0.01, 0.02, 0.7, 0.02], [0.01, 0.014, 1.2, 0], [0.0085, 0.006, 2.1, 0]]) { // bright along its ridge
				pocket(throat, rim, from);
				cast(nib(pen, css(lit(colours.leather, light)), wide), "#000c", shadow * scale);
			}
		}

		pen.setTransform(scale * (y1 - y0), 0, 0, scale * (x1 - x0), ...this.pixel((x0 + x1) / 2, (y0 + y1) / 2)); // the lamps: brightest in the middle
		glow(pen, 0, 0, 2, [0, "#ffffe008"], [0.17, "#0000"], [0.42, "#0003"]);
		return still;
	}

	/** A ball's picture, or its shadow if rgb is null: [canvas, half its width]. */
	sprite(rgb, radius) {
		const key = `${rgb} ${radius}`, known = this.sprites.get(key);
		if (known) return known;
		const reach = rgb ? radius : 1.7 * radius, half = ceil(reach) + 1, [canvas, pen] = sheet(2 * half, 2 * half);
		const { cloth, shadow } = this.colours, dark = min(0.56, 0.02 * radius); // small ones keep their colour
		glow(pen, half, half, reach, ...(rgb ? [0, 0.3, 0.5, 0.7, 0.85, 0.95, 1].map(d => { // lit from above and by the cloth
			const z = sqrt(1 - d * d), edge = (1 - z) ** 2.5;
			return [d, css(lit(rgb, (1.06 - dark * (1 - z)) * (1 - dark * edge)).map((value, k) => min(255, value + 26 * z ** 6 + 0.22 * edge * cloth[k])))];
		}) : [[0.4, 0.65], [0.68, 0.3], [0.85, 0.1], [1, 0]].map(([at, alpha]) => [at, css(shadow, alpha)])));
		this.sprites.set(key, [canvas, half]);
		return [canvas, half];
	}

	/** The four lamps over the table in the mirror of a ball at (x, y), the far ones faint; in a small ball one light. */
	lamps(x, y, px, py, radius) {
		const { pen, lamp, scene: { extent: [, [, y1]] } } = this, clear = min(1, max(0, radius / 9 - 0.8));
		const shine = (u, v, size, alpha) => {
			pen.globalAlpha = alpha;
			pen.drawImage(lamp, px + radius * (u - size), py + radius * (v - size), 2 * radius * size, 2 * radius * size);
		};
		let u = 0, v = 0, all = 0;
		for (let k = 0; k < 4; k++) {
			const dy = (k - 1.5) * y1 / 2 - y, far = hypot(x, dy, 0.95), norm = hypot(x, dy, 0.95 + far), light = (0.95 / far) ** 2;
			if (clear) shine(dy / norm, -x / norm, 0.22, clear * min(1, 0.2 + light));
			u += light * dy / norm; v -= light * x / norm; all += light;
		}
		shine(u / all, v / all, 0.55, 0.8 - 0.5 * clear);
		pen.globalAlpha = 1;
	}

	/** Spots on a ball where its six half axes come out, turned with it. */
	spots([w, a, b, c], colour, px, py, radius) {
		const { pen } = this, axes = [[1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)],
			[2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)], [2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)]];
		pen.beginPath();
		for (const axis of axes) {
			const [x, y, z] = axis[2] < 0 ? axis.map(value => -value) : axis, u = px + 0.96 * radius * y, v = py + 0.96 * radius * x, size = 0.27 * radius, turn = atan2(x, y);
			pen.moveTo(u + size * z * cos(turn), v + size * z * sin(turn));
			pen.ellipse(u, v, size * z, size, turn, 0, TURN);
		}
		fill(pen, colour);
	}

	/** Draw the table with a frame, of which only x, y and on are required. */
	draw(frame) {
		this.still ??= this.paint();
		const { pen, scene, ink, ratio, scene: { extent: [[x0, x1], [y0, y1]] } } = this, radius = this.R * this.scale;
		pen.resetTransform();
		pen.drawImage(this.still, 0, 0);
		for (const heat of frame.heat ?? []) this.heat(heat);
		for (const line of frame.lines ?? []) this.line(line);
		for (const { x, y, ball, alpha = 0.45 } of frame.rings ?? []) {
			const [px, py] = this.pixel(x, y);
			pen.globalAlpha = alpha;
			if (ball !== undefined) this.stamp(scene.balls[ball].rgb, px, py, radius);
			pen.globalAlpha = min(1, alpha + 0.3);
			nib(pen, ink.text, 1.5 * ratio);
			disc(pen, px, py, radius);
			pen.globalAlpha = 1;
		}
		const depth = i => frame.depth?.[i] ?? 1 - frame.on[i], here = [...frame.x.keys()].filter(i => depth(i) < 1).sort((a, b) => depth(b) - depth(a));
		for (const i of here) if (!depth(i)) { // shadows fall away from the lamps
			const x = frame.x[i], y = frame.y[i], [px, py] = this.pixel(x, y);
			this.stamp(null, px + radius * y / (y1 - y0) / 2, py + radius * (0.14 + x / (x1 - x0) / 2), radius);
		}
		for (const i of here) if (depth(i)) this.falling(frame.x[i], frame.y[i], depth(i), scene.balls[i].rgb); else this.ball(frame, i, radius);
		nib(pen, ink.aim, 2 * ratio);
		for (const i of frame.highlight ?? []) disc(pen, ...this.pixel(frame.x[i], frame.y[i]), radius + 3 * ratio);
		if (frame.cue) this.cue(frame.cue);
	}

	stamp(rgb, px, py, radius, size = 1) {
		const [image, half] = this.sprite(rgb, radius), wide = half * size;
		this.pen.drawImage(image, px - wide, py - wide, 2 * wide, 2 * wide);
	}

	/** A ball falling into the nearest pocket: darker, smaller, further in. */
	falling(x, y, depth, rgb) {
		const [u, v] = this.scene.falls.find(fall => hypot(fall[0] - x, fall[1] - y) < 0.2) ?? [x, y];
		const part = sqrt(depth) / 2;
		this.pen.globalAlpha = 1 - depth;
		this.stamp(rgb, ...this.pixel(x + (u - x) * part, y + (v - y) * part), this.R * this.scale, 1 - 0.3 * depth);
		this.pen.globalAlpha = 1;
	}

	ball(frame, i, radius) {
		const { pen } = this, x = frame.x[i], y = frame.y[i], at = this.pixel(x, y), { rgb, letter: name } = this.scene.balls[i], letter = name.toUpperCase(), turn = frame.turns?.[i];
		const pale = 0.3 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2] > 110, [ink, edge] = pale ? [BLACK, WHITE] : [WHITE, BLACK];
		this.stamp(rgb, ...at, radius);
		if (turn) this.spots(turn, i ? css(ink, 0.32) : this.ink.bar_accent, ...at, radius);
		this.lamps(x, y, ...at, radius);
		if (!frame.labels) return;
		const size = max(1.25 * radius, 9 * this.ratio);
		at[1] += 0.36 * size; // half a capital letter
		pen.font = `700 ${size}px system-ui,sans-serif`;
		pen.textAlign = "center";
		pen.lineJoin = "round";
		nib(pen, css(edge, 0.75), 0.3 * radius).strokeText(letter, ...at);
		pen.fillStyle = css(ink);
		pen.fillText(letter, ...at);
	}

	/** A line through points, or a `path` in metres, at least 3 pixels wide, with a dark edge. */
	line({ points = [], path, colour = this.ink.text, width = 0.007, dash = [], arrow }) {
		const { pen } = this, px = this.ratio / this.scale, wide = max(width, 3 * px), way = path ?? new Path2D();
		for (const point of points) way.lineTo(...point);
		if (arrow && points.length > 1) {
			const [[ax, ay], [bx, by]] = points.slice(-2), turn = atan2(by - ay, bx - ax), size = 4 * wide;
			for (const side of [-2.6, 2.6]) { way.moveTo(bx, by); way.lineTo(bx + size * cos(turn + side), by + size * sin(turn + side)); }
		}
		this.metres(pen);
		pen.lineJoin = pen.lineCap = "round";
		pen.setLineDash(dash);
		for (const [style, thick] of [[css(this.colours.path_edge, 0.55), wide + 2 * px], [css(colour), wide]]) {
			nib(pen, style, thick).stroke(way);
		}
		pen.setLineDash([]);
		pen.resetTransform();
	}

	/** Cells, ny rows along y of nx along x, stronger for larger values. */
	heat({ x0, y0, cell, nx, ny, values, rgb }) {
		const [canvas, p] = sheet(nx, ny), image = p.createImageData(nx, ny), most = values.reduce((a, b) => max(a, b), 0) || 1;
		for (let k = 0; k < nx * ny; k++) image.data.set([...rgb, 225 * sqrt(values[k] / most)], 4 * k);
		p.putImageData(image, 0, 0);
		this.metres(this.pen);
		this.pen.drawImage(canvas, x0, y0, nx * cell, ny * cell);
		this.pen.resetTransform();
	}

	/** The cue, its tip `pull` [m] behind the ball at (x, y). */
	cue({ x, y, aim, pull = 0.05, elevation = 0, alpha = 1 }) {
		const { pen } = this, ex = cos(aim), ey = sin(aim);
		const part = (from, to, colour) => {
			polyline(pen, [[from, 1], [to, 1], [to, -1], [from, -1]].map(([d, side]) => {
				const back = this.R + pull + d * cos(elevation), half = side * (0.0048 + 0.0065 * d);
				return [x - ex * back - ey * half, y - ey * back + ex * half];
			}));
			cast(pen, css(this.colours.shadow, 0.4), 0.02 * this.scale, colour);
		};
		this.metres(pen);
		pen.globalAlpha = alpha;
		part(0, 1.45, "#d9b27c");
		part(0.95, 1.45, "#20130d");
		part(0, 0.008, "#3c6a9c");
		pen.globalAlpha = 1;
		pen.resetTransform();
	}
}

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
/** Seconds shown before a stroke and after it. */
const LEAD = 0.9, PAUSE = 1.4;
/** Key, what it does, its button's icon or word (none: no button), method, argument. */
const COMMANDS = [
	["Shift+←", "previous stroke", "back", "skip", -1], ["←", "previous event", "last", "step", -1], ["Space", "play or pause", "play", "toggle"],
	["→", "next event", "next", "step", 1], ["Shift+→", "next stroke", "on", "skip", 1], ["↓", "slower", "−", "faster", -1], ["↑", "faster", "+", "faster", 1],
	["p", "paths, dashed where a ball slides", "paths", "flip", "paths"], ["g", "cue ball where it met others", "ghosts", "flip", "ghosts"],
	["s", "spots that show spin", "spin", "flip", "spin"], ["l", "letters on balls", "labels", "flip", "labels"],
	["Home", "first moment", "", "seekTotal", 0], ["End", "last moment", "", "seekTotal", Infinity], ["?", "help", "?", "help"], ["Esc", "close this", "", "help", true],
];
/** Names of keys above. */
const NAMES = { " ": "Space", Escape: "Esc", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓" };
const ICONS = { play: "M7 4v16l13-8z", pause: "M6 4h4v16H6zM14 4h4v16h-4z", on: "M4 5l8 7-8 7zM12 5l8 7-8 7z", next: "M9 5l8 7-8 7z",
	back: "M20 5l-8 7 8 7zM12 5l-8 7 8 7z", last: "M15 5l-8 7 8 7z" };
const STYLE = `
.sn{position:relative;container-type:inline-size;display:flex;flex-direction:column;justify-content:center;background:var(--floor);color:var(--text);overflow:hidden;
font:15px/1.3 system-ui,sans-serif;font-variant-numeric:tabular-nums}
.sn *{box-sizing:border-box}.sn>*{flex:none}.sn-fill{height:100%}
.sn .sn-stage{position:relative;flex:0 1 auto;min-height:0}.sn-stage canvas{position:absolute;width:100%;height:100%;touch-action:manipulation}
.sn-score{display:flex;background:var(--bar);border-top:3px solid var(--bar_accent);font-size:clamp(14px,1.5cqw,26px);line-height:2}
.sn-score>*{display:flex;column-gap:.6em;padding:.1em .8em;align-items:center}.sn-who{flex:1 1 0;min-width:0;font-weight:600}.sn-now+.sn-who{flex-direction:row-reverse;text-align:right}
.sn-who span{flex:1;overflow:hidden;text-overflow:ellipsis;white-space:nowrap}.sn-who b{background:var(--text);color:var(--bar);line-height:1.5;min-width:2.6em;text-align:center}
.sn-turn{background:var(--bar_edge)}.sn .sn-now{flex:0 0 39em;flex-wrap:wrap;column-gap:1em;font-size:.8em}.sn-now *{flex:0 0 4.4em;white-space:pre}.sn-now :first-child{flex:1}.sn-now span:last-child{flex:0 0 14em}
.sn i{display:inline-block;width:.85em;height:.85em;border-radius:50%;margin:0 1px;vertical-align:-.08em;box-shadow:inset 0 0 0 1px #fff6}
.sn-bar{position:relative;height:30px;margin:0 14px;cursor:pointer;touch-action:none}.sn-bar *{position:absolute;top:12px;height:6px;background:var(--bar_accent)}
.sn-bar :first-child{width:100%;background:var(--bar_edge)}.sn-bar u{width:2px;background:var(--text_quiet)}.sn-bar b{z-index:1;top:6px;width:18px;height:18px;margin-left:-9px;border-radius:9px;background:var(--text)}
.sn-foot{display:flex;flex-wrap:wrap;align-items:center;gap:6px 10px;padding:0 10px 8px}.sn-foot>*{flex:1 1 250px}.sn-words{text-align:right}
.sn-about{display:flex;align-items:center;gap:10px;min-height:50px;color:var(--text_quiet)}.sn-about canvas{width:50px;height:50px}
.sn-foot .sn-keys{flex:0 1 auto;display:flex;flex-wrap:wrap;justify-content:center;gap:4px}.sn-keys span{display:flex;gap:4px}.sn output{width:3.4em;align-self:center;text-align:center}
.sn button{min-width:42px;height:40px;padding:0 8px;border:0;border-radius:6px;background:#fff1;color:inherit;font:inherit;cursor:pointer}.sn button:hover{background:#fff3}
.sn [aria-pressed=true]{box-shadow:inset 0 -3px var(--bar_accent)}.sn svg{width:22px;fill:currentColor;vertical-align:middle}
.sn:focus-visible,.sn :focus-visible{outline:2px solid var(--aim)}
.sn-help{position:absolute;inset:0;margin:auto;padding:12px;background:var(--bar);border:1px solid var(--bar_edge)}.sn-help td{padding:2px 8px}
@media (max-height:500px){.sn .sn-about{min-height:0;zoom:.6;font-size:24px}.sn-score{line-height:1.5}.sn output{width:2.2em}.sn button{padding:0 4px;min-width:40px}}
@container (max-width:900px){.sn-score{flex-wrap:wrap}.sn-who{flex-basis:40%}.sn-now,.sn-keys{order:1}.sn .sn-now{flex:1 0 100%}.sn-words{text-align:left}}
@container (max-width:500px){.sn-score{font-size:16px}.sn .sn-now :first-child{flex-basis:100%}.sn-foot .sn-keys{flex:1 0 100%}.sn button{flex:1;height:clamp(40px,7vh,60px)}.sn output{width:2.6em}}`;

const put = (parent, tag) => parent.appendChild(document.createElement(tag));

const setAll = (element, attributes) => Object.entries(attributes).forEach(([name, value]) => element.setAttribute(name, value));

/** Plays a replay in an element. */
export class Player {
	constructor(element, replay, options = {}) {
		const data = decode(replay), { strokes } = data;
		if (!strokes.length) throw new Error("a replay must hold at least one stroke");
		this.options = { autoplay: !matchMedia("(prefers-reduced-motion: reduce)").matches, ...options };
		const { paths = !data.players.length, ghosts = true, spin = "cue", labels = false, speed = 1 } = options;
		Object.assign(this, { replay: data, strokes, speed, show: { paths, ghosts, spin, labels }, k: 0, playing: false });
		this.leads = strokes.map(stroke => (stroke.cue ? LEAD : 0));
		this.t = -this.leads[0];
		this.total = -PAUSE;
		this.starts = strokes.map((stroke, k) => { // on the scale of the whole replay
			this.total += this.leads[k] + stroke.duration + PAUSE;
			return this.total - stroke.duration;
		});
		this.build(element);
		this.tick = this.tick.bind(this);
		this.watch = new ResizeObserver(() => { this.view.resize(); this.update(); });
		this.watch.observe(this.canvas);
		this.update();
		if (this.options.autoplay) this.play();
	}

	get stroke() { return this.k; }
	/** Time within the stroke [s]; below 0 before it. */
	get time() { return this.t; }
	get isLast() { return this.k === this.strokes.length - 1; }

	build(element) {
		const { replay: { scene, players, title }, options } = this, root = (this.root = put(element, "div"));
		const [wide, high] = TableView.size(scene), who = '<div class="sn-who"><span></span><b></b></div>', now = '<div class="sn-now"></div>';
		setAll(root, { class: options.fill ? "sn sn-fill" : "sn", tabindex: 0, role: "group", "aria-label": title || "replay" });
		root.innerHTML = `<style>${STYLE}</style><div class="sn-stage" style="aspect-ratio:${wide / high}"><canvas></canvas></div>
			${players.length ? `<div class="sn-score">${[who, now, who].slice(0, players.length + 1).join("")}</div>` : ""}
			<div class="sn-bar" role="slider" tabindex="0" aria-label="time" aria-valuemin="0" aria-valuemax="${this.total.toFixed(1)}"><div></div><div></div><b></b></div>
			<div class="sn-foot"><div class="sn-about"><canvas></canvas><span></span></div><div class="sn-keys"></div><div class="sn-words" aria-live="polite"></div></div>
			<table class="sn-help" hidden></table>`;
		[this.canvas, this.tip] = root.querySelectorAll("canvas");
		this.canvas.onclick = () => this.toggle();
		this.view = new TableView(this.canvas, scene);
		for (const name in this.view.ink) root.style.setProperty(`--${name}`, this.view.ink[name]);
		this.who = [...root.querySelectorAll(".sn-who")];
		this.who.forEach((one, k) => { one.firstChild.textContent = players[k]; });
		const sheet = this.part("help"), bar = (this.bar = this.part("bar")), keys = this.part("keys"), drag = event => this.seekTotal((event.clientX - bar.getBoundingClientRect().left) / bar.clientWidth * this.total);
		[, this.done, this.thumb] = bar.children;
		this.starts.forEach((start, k) => { if (k % ceil(this.strokes.length / 200) === 0) put(bar, "u").style.left = `${100 * (start - this.leads[k]) / this.total}%`; });
		bar.onpointerdown = event => { this.pause(); bar.setPointerCapture(event.pointerId); drag(event); };
		bar.onpointermove = event => { if (bar.hasPointerCapture(event.pointerId)) drag(event); };
		sheet.onclick = () => this.help();
		let both;
		this.buttons = {};
		for (const [key, what, shows, act, way] of COMMANDS) {
			const row = put(sheet, "tr");
			put(row, "td").textContent = key;
			put(row, "td").textContent = what;
			if (!shows) continue;
			if (shows === "−") both = put(keys, "span"); // stay on one row
			const button = (this.buttons[shows] = put(act === "faster" ? both : keys, "button"));
			setAll(button, { type: "button", title: `${what} (${key})`, "aria-label": what });
			if (ICONS[shows]) this.icon(button, shows); else button.textContent = shows;
			if (shows === "−") this.pace = put(both, "output");
			button.onclick = () => this[act](way);
		}
		this.keys = options.keys ?? root;
		this.onkey = event => this.key(event);
		this.keys.addEventListener("keydown", this.onkey);
	}

	part(name) { return this.root.querySelector(`.sn-${name}`); }

	icon(button, name) { button.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${ICONS[name]}"/></svg>`; }

	key(event) {
		const { target, shiftKey, key: one } = event, named = NAMES[one] ?? (one.length > 1 ? one : one.toLowerCase());
		const found = COMMANDS.find(([key]) => key === (shiftKey && one.startsWith("Arrow") ? `Shift+${named}` : named));
		if (!found || event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName)) return;
		if (named === "Space" && target.tagName === "BUTTON" || named === "Esc" && this.part("help").hidden) return; // for that button, for others
		this[found[3]](found[4]);
		event.preventDefault();
	}

	toggle() { if (this.playing) this.pause(); else this.play(); }
	help(hide) { this.part("help").toggleAttribute("hidden", hide); }

	faster(way) {
		this.speed = (way > 0 ? SPEEDS.find(speed => speed > this.speed) : SPEEDS.findLast(speed => speed < this.speed)) ?? this.speed;
		this.update();
	}

	/** Switch paths, ghosts or labels, or go on to the next choice of spin. */
	flip(name) {
		this.show[name] = name === "spin" ? { cue: "all", all: "off", off: "cue" }[this.show.spin] : !this.show[name];
		this.update();
	}

	play() {
		if (this.isLast && this.t >= this.strokes[this.k].duration) this.seekTotal(0);
		this.playing = true;
		this.clock = null;
		this.waiting ??= requestAnimationFrame(this.tick);
		this.update();
	}

	pause() {
		this.playing = false;
		this.update();
	}

	/** Show a stroke at a time within it [s]. */
	seek(stroke, t = 0) {
		const before = this.k;
		this.k = min(this.strokes.length - 1, max(0, stroke));
		this.t = min(this.strokes[this.k].duration + (this.isLast ? 0 : PAUSE), max(-this.leads[this.k], t));
		if (before !== this.k) this.options.onstroke?.(this.k);
		this.update();
	}

	/** Show a time of the whole replay [s]. */
	seekTotal(sum) {
		const k = max(0, this.starts.findLastIndex((start, j) => start - this.leads[j] <= sum));
		this.seek(k, sum - this.starts[k]);
	}

	/** On by a stroke, or back, first to the start of this one. */
	skip(way) {
		const k = this.k + (way < 0 && this.t > 0.5 ? 0 : way);
		this.seek(k, k < this.strokes.length ? -LEAD : Infinity);
	}

	/** Stop at the next event (+1) or the one before (-1). */
	step(way) {
		this.pause();
		const { events, duration } = this.strokes[this.k], stops = [0, ...events.filter(event => EVENTS[event[1]]).map(event => event[0]), duration];
		const next = way > 0 ? stops.find(t => t > this.t + 1e-8) : stops.findLast(t => t < this.t - 1e-8);
		if (next !== undefined) this.seek(this.k, next);
		else if (this.strokes[this.k + way]) this.seek(this.k + way, way > 0 ? 0 : Infinity);
	}

	tick(now) {
		this.waiting = null;
		if (!this.playing) return;
		const { duration } = this.strokes[this.k], end = duration + (this.isLast ? 0 : PAUSE), rest = this.t < 0 || this.t >= duration;
		const t = this.t + min(0.1, (now - (this.clock ?? now)) / 1000) * (rest ? max(1, this.speed) : this.speed);
		this.clock = now;
		if (this.isLast && t >= end) this.playing = false;
		if (this.isLast || t < end) this.seek(this.k, t); else this.seek(this.k + 1, -LEAD);
		if (this.playing) this.waiting = requestAnimationFrame(this.tick); else this.options.onend?.();
	}

	frame() {
		const stroke = this.strokes[this.k], { t, show, replay: { scene } } = this, over = t > stroke.duration + PAUSE / 2 && stroke.later;
		const frame = over ? { ...stroke.later } : stroke.at(t);
		frame.labels = show.labels;
		if (show.spin !== "off") frame.turns = Array.from({ length: show.spin === "cue" ? 1 : stroke.n }, (_, ball) => stroke.turn(ball, t));
		if (over) return frame;
		if (show.paths && t > 0) frame.lines = stroke.logs.flatMap((log, ball) => {
			if (!log.length) return [];
			const slide = new Path2D(), roll = new Path2D(), colour = mix(scene.balls[ball].rgb, WHITE, 1 / 3);
			stroke.trace(ball, t, slide, roll);
			return [{ path: roll, colour }, { path: slide, colour: mix(colour, WHITE, 0.3), dash: [0.012, 0.022] }];
		});
		if (show.ghosts) { // the cue ball where it met others
			const met = ([at]) => { const { x, y } = stroke.at(at); return { x: x[0], y: y[0], at, ball: 0, alpha: 0.3 }; };
			stroke.met ??= stroke.events.filter(([, kind, i, j]) => kind === BALL_BALL && !(i && j)).map(met);
			frame.rings = stroke.met.filter(ring => ring.at < t);
		}
		if (stroke.cue && t < 0.35) { // drawn back, through the ball, away
			const { speed, aim, elevation } = stroke.cue, pull = t < 0 ? (0.06 + 0.02 * min(5, speed)) * sin(PI * (-t / LEAD) ** 0.6) : -min(0.16, 0.4 * t * speed);
			frame.cue = { x: stroke.first[0], y: stroke.first[1], aim, elevation, pull, alpha: min(1, t < 0 ? 4 + 4 * t / LEAD : 1 - t / 0.35) };
		}
		return frame;
	}

	/** [[x, y], ...] [m] of all balls as they are on screen. */
	positions() { return Array.from(this.shown.x, (x, k) => [x, this.shown.y[k]]); }

	update() {
		const sum = this.starts[this.k] + this.t;
		this.shown = this.frame();
		this.view.draw(this.shown);
		this.done.style.width = this.thumb.style.left = `${100 * sum / this.total}%`;
		this.bar.setAttribute("aria-valuenow", sum.toFixed(1));
		this.say();
		this.options.ontime?.(this.t, this.k);
	}

	/** Update words and buttons if they have changed. */
	say() {
		const { k, playing, speed, show, t, replay: { scene: { balls }, title } } = this, stroke = this.strokes[k], { cue } = stroke, over = t >= stroke.duration;
		const event = !playing && stroke.events.findLast(one => one[0] === t && EVENTS[one[1]]), reds = this.shown.on.slice(1, 16).filter(Boolean).length;
		const key = JSON.stringify([k, over, playing, speed, show, reds, event, this.view.ratio]);
		if (key === this.said) return;
		this.said = key;
		this.icon(this.buttons.play, playing ? "pause" : "play");
		this.buttons.play.setAttribute("aria-label", playing ? "pause" : "play");
		this.pace.textContent = `${speed}×`;
		for (const name in show) this.buttons[name].setAttribute("aria-pressed", ![false, "off"].includes(show[name]));
		const about = [`${k + 1} of ${this.strokes.length}`, cue && `${cue.speed.toFixed(2)} m/s`, cue?.elevation > 0.1 && `raised ${round(cue.elevation * 360 / TURN)}°`];
		this.part("about").lastChild.textContent = about.filter(Boolean).join(" · ");
		const what = event && `${t.toFixed(3)} s: ${balls[event[2]].name} ${EVENTS[event[1]]} ${event[1] === BALL_BALL ? balls[event[3]].name : ""}`;
		this.part("words").textContent = (over && stroke.words) || what || title || "";
		this.drawTip(cue);
		if (this.who.length) this.score(stroke, over, reds);
	}

	/** The cue ball as the player sees it, and where the tip strikes it. */
	drawTip(cue) {
		const { tip, view } = this, size = (tip.width = tip.height = round(50 * view.ratio)), pen = tip.getContext("2d"), R = size * 0.46, c = size / 2;
		tip.hidden = !cue;
		if (!cue) return;
		disc(pen, c, c, R, css(this.replay.scene.balls[0].rgb));
		polyline(pen, [[c - R, c], [c + R, c], [c, c], [c, c - R], [c, c + R]], 1, "#0006");
		disc(pen, c + R * cue.side, c - R * cue.top, 0.17 * R, view.ink.bar_accent);
	}

	/** The score bar: as it was before the stroke until the balls rest. */
	score(stroke, over, reds) {
		const { strokes, replay: { scene: { balls } } } = this, upTo = over ? this.k : this.k - 1, seen = strokes[upTo], mine = stroke.player;
		this.who.forEach((one, k) => {
			one.lastChild.textContent = (seen ? seen.score[k] : stroke.score[k] - (k === mine ? stroke.points : stroke.penalty)) ?? 0;
			one.classList.toggle("sn-turn", mine === k);
		});
		const pots = [], run = seen?.player === mine ? seen?.break : 0, now = this.part("now");
		for (let k = upTo; run && strokes[k]?.player === mine && strokes[k].points; k--) pots.unshift(...strokes[k].pots);
		now.textContent = "";
		const say = (what, dots, after = "") => {
			const one = put(now, "span");
			one.append(what);
			for (const ball of dots) put(one, "i").style.background = css(balls[ball].rgb);
			one.append(after);
		};
		say(`break ${run} `, pots.slice(-12));
		if (stroke.n === 22) say(`reds ${reds}`, []);
		const next = over && stroke.points ? strokes[this.k + 1] : !over && stroke, what = next?.player === mine && next.ball_on; // nothing after the visit
		const on = what === "any colour" ? [16, 17, 18, 19, 20, 21] : [balls.findIndex(one => one.name.startsWith(what))];
		say(what ? "on " : "", on[0] < 0 ? [] : on, ` ${what || ""}`);
	}

	destroy() {
		this.playing = false;
		cancelAnimationFrame(this.waiting);
		this.watch.disconnect();
		this.keys.removeEventListener("keydown", this.onkey);
		this.root.remove();
	}
}

export function mount(element, replay, options) { return new Player(element, replay, options); }
