/**
 * How is a table drawn in a browser, and how does a replay play? By one module on a 2-D canvas; it loads nothing.
 *
 * `decode` turns a replay into strokes that know where every ball is at any time: each phase of a ball's motion is a closed form, computed
 * in the order of `snooker_env/physics/cloth.py`, so that places are equal to the simulation's. `TableView` draws a table from its scene,
 * in metres. `Player` plays a replay and has the controls; `mount` makes one.
 *
 * Frame: origin at the table's centre, +x to the yellow side, +y to the black end, SI units. On screen +y goes right and +x goes down.
 *
 * Beyond the contract: `Stroke.turn(ball, t)` and `Stroke.trace(ball, t, lines)`; `frame.depth` (0 on the cloth to 1 gone into a pocket);
 * `Player` has `time`, `stroke`, `playing`, `speed`, `positions()`, `skip(strokes)` and the options `autoplay`, `speed`, `paths`, `ghosts`,
 * `spin` ("off", "cue", "all"), `labels`, `fill` (as high as its parent), `keys` (who is listened to for keys), `onstroke`, `ontime`, `onend`.
 */

const GONE = 0, ROLL = 2, SLIDE = 3, FALLING = 4, BEND = 5;
const BALL_BALL = 0, CUSHION = 1, JAW = 2, POT = 3;
/** What a stroke's event is called; those without a name are no stops for a step. */
const EVENTS = ["touches", "cushion", "jaw", "potted", "rolls", "rests", "drops", "comes back"];
const TURN = 2 * Math.PI;

/** Colours of things that a scene does not name. */
const PALETTE = {
  floor: [17, 18, 21], cloth: [36, 148, 76], cloth_edge: [15, 78, 40], line: [214, 226, 190], cushion: [30, 124, 64], nose: [86, 186, 118],
  wood: [104, 52, 26], wood_edge: [52, 25, 12], leather: [70, 46, 32], leather_edge: [112, 78, 54], hole: [5, 5, 6], path_edge: [8, 30, 16],
  shadow: [0, 14, 5], lamp: [255, 252, 240], bar: [12, 15, 24], bar_edge: [58, 66, 88], bar_accent: [196, 32, 48], text: [240, 240, 236],
  text_quiet: [164, 170, 184],
};

const css = (rgb, alpha = 1) => `rgba(${rgb.map(Math.round).join()},${alpha})`;
/** A colour on the way from one to another. */
const mix = (a, b, share) => a.map((value, k) => value + (b[k] - value) * share);
const WHITE = [255, 255, 255], BLACK = [0, 0, 0];

// ---------------------------------------------------------------------------------------------------------------- a replay's strokes

/** Base64 of little-endian numbers, as all browsers keep them, to an array of them. */
const numbers = (text, Type) => new Type(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);

/** The rotation q, then one by the vector (x, y, z) [rad]; quaternions are [w, x, y, z]. */
function turned(q, x, y, z) {
  const angle = Math.hypot(x, y, z);
  if (angle < 1e-12) return q;
  const w = Math.cos(angle / 2), s = Math.sin(angle / 2) / angle;
  x *= s; y *= s; z *= s;
  const [a, b, c, d] = q;
  return [w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c, w * c + y * a + z * b - x * d, w * d + z * a + x * c - y * b];
}

/** Step [s] in which the orientation of a ball is followed where its axis of rotation turns. */
const STEP = 1 / 240;

/** One stroke of a replay: its data, and where the balls are at any time. */
class Stroke {
  constructor(data, replay, previous) {
    Object.assign(this, data);
    this.R = replay.R;
    this.decel = replay.spin_decel;
    this.previous = previous;
    this.first = numbers(data.start, Float64Array);
    this.rows = numbers(data.paths.f8, Float64Array);
    this.spins = numbers(data.paths.f4, Float32Array);
    this.codes = numbers(data.paths.u1, Uint8Array);
    this.logs = Array.from({ length: data.n }, () => []);
    for (let s = 0; s < data.paths.count; s++) this.logs[this.codes[2 * s]].push(s);
    this.here = new Uint8Array(data.n);
    for (const ball of data.on_table) this.here[ball] = 1;
    this.turns = new Map();
    if (data.after) {
      const places = numbers(data.after.places, Float64Array), on = new Uint8Array(data.n);
      for (const ball of data.after.on_table) on[ball] = 1;
      this.later = { x: places.filter((_, k) => k % 2 === 0), y: places.filter((_, k) => k % 2), on };
    }
  }

  /** Which segment of a ball holds at time t: its place in the ball's log, or -1 before the first. */
  find(ball, t) {
    const log = this.logs[ball];
    let low = -1, high = log.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.rows[7 * log[middle]] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  /** Velocity and spin in segment s, dt after its start: [vx, vy, wx, wy, wz]. */
  motion(s, dt) {
    const { rows, spins, R } = this, k = 7 * s, state = this.codes[2 * s + 1];
    const ax = rows[k + 5], ay = rows[k + 6], vx = rows[k + 3] + ax * dt, vy = rows[k + 4] + ay * dt, z = spins[3 * s + 2];
    const wz = Math.sign(z) * Math.max(0, Math.abs(z) - this.decel * dt);
    if (state !== SLIDE && state !== FALLING) return [vx, vy, -vy / R, vx / R, wz];
    return [vx, vy, spins[3 * s] + 2.5 * ay * dt / R, spins[3 * s + 1] - 2.5 * ax * dt / R, wz];
  }

  /** Place in segment s, dt after its start; the order of the arithmetic is that of the simulation. */
  place(s, dt) {
    const { rows } = this, k = 7 * s;
    return [rows[k + 1] + (rows[k + 3] + 0.5 * rows[k + 5] * dt) * dt, rows[k + 2] + (rows[k + 4] + 0.5 * rows[k + 6] * dt) * dt];
  }

  /** All balls at time t [s]: x, y, vx, vy, wx, wy, wz, `on` the table (1 or 0), and `depth`, how far a ball has gone into its pocket. */
  at(t) {
    const n = this.n, out = { on: this.here.slice() };
    for (const name of ["x", "y", "vx", "vy", "wx", "wy", "wz", "depth"]) out[name] = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      const k = this.find(i, t);
      if (k < 0) {
        out.x[i] = this.first[2 * i]; out.y[i] = this.first[2 * i + 1]; out.depth[i] = 1 - out.on[i];
        continue;
      }
      const log = this.logs[i], s = log[k], dt = t - this.rows[7 * s];
      [out.x[i], out.y[i]] = this.place(s, dt);
      [out.vx[i], out.vy[i], out.wx[i], out.wy[i], out.wz[i]] = this.motion(s, dt);
      if (this.decel > 0 && t >= this.duration) out.wx[i] = out.wy[i] = out.wz[i] = 0;
      if (this.state(s) === GONE) out.on[i] = 0;
      let fell = k;
      while (fell >= 0 && (this.state(log[fell]) === GONE || this.state(log[fell]) === FALLING)) fell--;
      if (!this.here[i]) out.depth[i] = 1;
      else if (fell < k) out.depth[i] = Math.min(1, ((t - this.rows[7 * log[fell + 1]]) / 0.2) ** 2); // it falls 0.2 m in 0.2 s
    }
    return out;
  }

  state(s) { return this.codes[2 * s + 1]; }

  /** The table when everything has come to rest. */
  get end() { return this.at(this.duration); }

  /** The orientation of a ball at time t, a quaternion: followed from its start, the same whichever way a time is come to. */
  turn(ball, t) {
    const k = this.find(ball, t), log = this.logs[ball], known = this.turns.get(ball) ?? [];
    this.turns.set(ball, known);
    if (!known.length) {
      const before = this.previous;
      known.push({ at: 0, q: before && ball < before.n ? before.turn(ball, before.duration) : turned([1, 0, 0, 0], ball + 0.4, 0.5 - ball, 2 * ball) });
    }
    for (let j = known.length - 1; j <= k; j++) { // the orientation at the start of segment j
      const end = this.rows[7 * log[j]];
      known.push({ at: end, q: j ? this.rolled(log[j - 1], known[j], end) : known[0].q, steps: null });
    }
    return k < 0 ? known[0].q : this.rolled(log[k], known[k + 1], Math.min(t, this.duration));
  }

  /** On from the start of segment s to time t. Constant or linear spin about one axis: exact in one step; else by the middle of small ones. */
  rolled(s, start, t) {
    const dt = t - start.at, k = 7 * s, { rows } = this, z = this.spins[3 * s + 2];
    if (this.state(s) === GONE || !(dt > 0)) return start.q;
    const straight = this.state(s) === ROLL && !z || !(rows[k + 3] || rows[k + 4] || rows[k + 5] || rows[k + 6] || z);
    const step = (q, from, to) => {
      const [, , x, y, w] = this.motion(s, (from + to) / 2), h = to - from;
      return turned(q, x * h, y * h, w * h);
    };
    if (straight) return step(start.q, 0, dt);
    start.steps ??= [start.q];
    const whole = Math.floor(dt / STEP);
    for (let m = start.steps.length; m <= whole; m++) start.steps.push(step(start.steps[m - 1], (m - 1) * STEP, m * STEP));
    return step(start.steps[whole], whole * STEP, dt);
  }

  /** Add a ball's way until time t to two paths in metres, where it slides and where it rolls. A parabola is a quadratic curve, exactly. */
  trace(ball, t, slide, roll) {
    const log = this.logs[ball], { rows } = this;
    for (let j = 0; j < log.length; j++) {
      const s = log[j], k = 7 * s, from = rows[k], to = Math.min(t, j + 1 < log.length ? rows[7 * log[j + 1]] : this.duration);
      if (from >= t) break;
      if (!(to > from) || !(rows[k + 3] || rows[k + 4]) || this.state(s) === GONE) continue;
      const path = this.state(s) === ROLL || this.state(s) === BEND ? roll : slide, half = (to - from) / 2;
      path.moveTo(rows[k + 1], rows[k + 2]);
      path.quadraticCurveTo(rows[k + 1] + rows[k + 3] * half, rows[k + 2] + rows[k + 4] * half, ...this.place(s, to - from));
    }
  }
}

/** A replay (`{"format": "snooker-replay", "version": 1, ...}`) with its strokes ready to be evaluated. */
export function decode(replay) {
  if (replay?.format !== "snooker-replay" || replay.version !== 1)
    throw new Error(`this is no replay that can be read here: format ${replay?.format}, version ${replay?.version}; snooker-replay, 1 is`);
  let last = null;
  return { ...replay, strokes: replay.strokes.map(data => (last = new Stroke(data, replay, last))) };
}

// ------------------------------------------------------------------------------------------------------------------------ the table

/** A canvas of its own, and its context. */
function sheet(width, height) {
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, Math.ceil(width));
  canvas.height = Math.max(1, Math.ceil(height));
  return [canvas, canvas.getContext("2d")];
}

/** Grey unrest for cloth and wood, the same at every call. */
function unrest(size, strength) {
  const [canvas, pen] = sheet(size, size), image = pen.createImageData(size, size);
  for (let k = 0, seed = 1; k < image.data.length; k += 4) {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    image.data.fill(seed & 0x8000000 ? 255 : 0, k, k + 3);
    image.data[k + 3] = (seed >>> 16 & 255) * strength;
  }
  pen.putImageData(image, 0, 0);
  return canvas;
}

/** Draws a table on a canvas. What never moves is drawn once for each size. */
export class TableView {
  /** options: `margin` [m] around the table. */
  constructor(canvas, scene, options = {}) {
    this.canvas = canvas;
    this.scene = scene;
    this.options = { margin: 0.02, ...options };
    this.pen = canvas.getContext("2d", { alpha: false });
    this.colours = { ...PALETTE, ...scene.palette };
    this.R = scene.ball_radius;
    this.resize();
  }

  /** How much wider than high the table is, on screen. */
  static aspect(scene, margin = 0.02) {
    const [[x0, x1], [y0, y1]] = scene.extent, out = 2 * ((scene.cushions.length ? scene.rail : 0.03) + margin);
    return (y1 - y0 + out) / (x1 - x0 + out);
  }

  /** Fit the table into the canvas as it is laid out now. */
  resize() {
    const { canvas, scene } = this, [[x0, x1], [y0, y1]] = scene.extent;
    this.ratio = Math.min(window.devicePixelRatio || 1, 3);
    const width = canvas.clientWidth || canvas.width / this.ratio, height = canvas.clientHeight || canvas.height / this.ratio;
    const w = Math.max(1, Math.round(width * this.ratio)), h = Math.max(1, Math.round(height * this.ratio));
    if (canvas.width !== w) canvas.width = w;
    if (canvas.height !== h) canvas.height = h;
    const out = 2 * ((scene.cushions.length ? scene.rail : 0.03) + this.options.margin);
    this.scale = Math.min(w / (y1 - y0 + out), h / (x1 - x0 + out));
    this.left = w / 2 - this.scale * (y0 + y1) / 2;
    this.top = h / 2 - this.scale * (x0 + x1) / 2;
    this.sprites = new Map();
    this.still = null;
  }

  /** CSS pixels on the canvas of a place [m]. */
  toScreen(x, y) { return [(this.left + this.scale * y) / this.ratio, (this.top + this.scale * x) / this.ratio]; }

  /** The place [m] of CSS pixels on the canvas. */
  toTable(px, py) { return [(py * this.ratio - this.top) / this.scale, (px * this.ratio - this.left) / this.scale]; }

  /** From here on a pen draws in metres. */
  metres(pen) { pen.setTransform(0, this.scale, this.scale, 0, this.left, this.top); }

  // ------------------------------------------------------------------------------------------------------ what never moves

  paint() {
    const { scene, colours, canvas: { width, height } } = this, [[x0, x1], [y0, y1]] = scene.extent;
    const [still, pen] = sheet(width, height), px = 1 / this.scale;
    const box = (p, out, round = 0) => { p.beginPath(); p.roundRect(x0 - out, y0 - out, x1 - x0 + 2 * out, y1 - y0 + 2 * out, round); };
    const layer = draw => {
      const [own, p] = sheet(width, height);
      this.metres(p);
      draw(p);
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.drawImage(own, 0, 0);
      this.metres(pen);
    };
    const polygon = (p, points) => { p.beginPath(); points.forEach(([x, y], k) => (k ? p.lineTo(x, y) : p.moveTo(x, y))); };
    const texture = (p, image, along, across, swap) => { // stretched along y, or along x where swapped
      const pattern = p.createPattern(image, "repeat"), a = along * px, b = across * px;
      pattern.setTransform(swap ? new DOMMatrix([a, 0, 0, b, 0, 0]) : new DOMMatrix([0, a, b, 0, 0, 0]));
      p.fillStyle = pattern;
      p.fill();
    };
    pen.fillStyle = css(colours.floor);
    pen.fillRect(0, 0, width, height);
    this.metres(pen);
    const framed = scene.cushions.length > 0, bed = framed ? scene.cushion : scene.rail + 9;

    if (framed) {
      pen.shadowColor = "rgba(0,0,0,.8)";
      pen.shadowBlur = 0.04 * this.scale;
      box(pen, scene.rail - 0.004, 0.07);
      pen.fillStyle = css(colours.hole);
      pen.fill();
      pen.shadowBlur = 0;
    }
    for (const [x, y, r] of scene.falls) { // the leather at the back of a pocket, lost in the dark further down
      const glow = pen.createRadialGradient(x, y, 0.35 * r, x, y, 1.05 * r);
      glow.addColorStop(0, css(colours.hole));
      glow.addColorStop(1, css(mix(colours.hole, colours.leather, 0.6)));
      pen.fillStyle = glow;
      pen.beginPath(); pen.arc(x, y, 1.05 * r, 0, TURN); pen.fill();
    }

    layer(p => { // the slate with its cloth, cut out at the falls
      box(p, bed);
      p.fillStyle = css(colours.cloth);
      p.fill();
      texture(p, unrest(256, 0.1), 1.5, 0.8);
      texture(p, unrest(200, 0.045), 11, 2);
      p.strokeStyle = p.fillStyle = css(colours.line, 0.92);
      p.lineWidth = Math.max(0.0035, 1.2 * px);
      for (const line of scene.lines ? [scene.lines.baulk, scene.lines.d] : []) { polygon(p, line); p.stroke(); }
      for (const [x, y] of scene.lines?.spots ?? []) { p.beginPath(); p.arc(x, y, Math.max(0.006, 1.4 * px), 0, TURN); p.fill(); }
      for (const [x, y, r] of scene.falls) {
        const bent = p.createRadialGradient(x, y, r, x, y, r + 0.014);
        bent.addColorStop(0, css(colours.cloth_edge));
        bent.addColorStop(1, css(colours.cloth_edge, 0));
        p.fillStyle = bent;
        p.beginPath(); p.arc(x, y, r + 0.014, 0, TURN); p.fill();
        p.globalCompositeOperation = "destination-out";
        p.fillStyle = "#000";
        p.beginPath(); p.arc(x, y, r, 0, TURN); p.fill();
        p.globalCompositeOperation = "source-over";
      }
    });

    pen.save();
    box(pen, bed);
    pen.clip();
    scene.cushions.forEach((points, k) => {
      const nose = scene.noses[k], a = nose[nose.length / 2 - 1 | 0], b = nose[nose.length / 2 | 0], back = points[points.length - 1];
      const [nx, ny] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], flat = Math.abs(a[0] - b[0]) < Math.abs(a[1] - b[1]);
      const [bx, by] = flat ? [back[0], ny] : [nx, back[1]], slope = pen.createLinearGradient(nx, ny, bx, by);
      [[0, mix(colours.cushion, colours.nose, 0.35)], [0.12, colours.cushion], [0.75, mix(colours.cushion, BLACK, 0.22)], [1, mix(colours.cushion, BLACK, 0.5)]]
        .forEach(([at, rgb]) => slope.addColorStop(at, css(rgb)));
      polygon(pen, points);
      pen.shadowColor = css(colours.shadow, 0.75);
      pen.shadowBlur = 0.022 * this.scale;
      pen.fillStyle = slope;
      pen.fill();
      pen.shadowBlur = 0;
      texture(pen, unrest(256, 0.06), 1.5, 0.8);
      polygon(pen, nose);
      pen.strokeStyle = css(colours.nose, 0.9);
      pen.lineWidth = Math.max(0.0032, px);
      pen.stroke();
    });
    pen.restore();

    if (framed) layer(p => {
      const { rail } = scene, grain = unrest(256, 0.16), inner = bed + 0.006;
      box(p, rail, 0.085);
      p.save(); p.clip();
      for (const [ax, ay] of [[-1, 0], [1, 0], [0, -1], [0, 1]]) { // four boards, mitred
        const edge = (out, side) => ax ? [ax < 0 ? x0 - out : x1 + out, side ? y1 + out : y0 - out] : [side ? x1 + out : x0 - out, ay < 0 ? y0 - out : y1 + out];
        const [ix, iy] = edge(inner), [ox, oy] = edge(rail), board = p.createLinearGradient(ix, iy, ax ? ox : ix, ay ? oy : iy);
        [[0, 0.5], [0.07, -0.1], [0.35, -0.16], [0.6, 0.08], [0.9, 0.3], [1, 0.75]].forEach(([at, dark]) =>
          board.addColorStop(at, css(dark > 0 ? mix(colours.wood, colours.wood_edge, dark) : mix(colours.wood, colours.lamp, -dark))));
        polygon(p, [edge(0, 0), edge(rail, 0), edge(rail, 1), edge(0, 1)]);
        p.fillStyle = board;
        p.fill();
        texture(p, grain, 24, 1.3, ay !== 0);
      }
      p.restore();
      box(p, rail - 0.002, 0.083);
      p.strokeStyle = css(colours.wood_edge); p.lineWidth = 0.004; p.stroke();
      box(p, inner - 0.003);
      p.lineWidth = 0.006; p.stroke();
      const hole = (x, y, u, v, half) => {
        const d = Math.hypot(u - x, v - y), ex = (u - x) / d, ey = (v - y) / d, turn = Math.atan2(ey, ex);
        p.beginPath();
        p.moveTo(x - ex * 0.02 - ey * half, y - ey * 0.02 + ex * half);
        p.arc(u, v, half, turn + Math.PI / 2, turn - Math.PI / 2, true);
        p.lineTo(x - ex * 0.02 + ey * half, y - ey * 0.02 - ex * half);
      };
      p.lineJoin = "round";
      for (const [x, y, u, v, half] of scene.throats) {
        hole(x, y, u, v, half + 0.017);
        p.shadowColor = "rgba(0,0,0,.7)"; p.shadowBlur = 0.012 * this.scale;
        p.fillStyle = css(colours.leather); p.fill();
        p.shadowBlur = 0;
        hole(x, y, u, v, half + 0.011);
        p.strokeStyle = css(colours.leather_edge, 0.8); p.lineWidth = 0.005; p.stroke();
      }
      p.globalCompositeOperation = "destination-out";
      box(p, bed); p.fill();
      for (const throat of scene.throats) { hole(...throat); p.fill(); }
    });

    pen.setTransform(1, 0, 0, 1, 0, 0); // the lamps: bright in the middle, dimmer to the ends
    const [cx, cy] = [this.left + this.scale * (y0 + y1) / 2, this.top + this.scale * (x0 + x1) / 2];
    pen.setTransform(this.scale * (y1 - y0), 0, 0, this.scale * (x1 - x0), cx, cy);
    const light = pen.createRadialGradient(0, 0, 0, 0, 0, 0.85);
    [[0, "rgba(255,255,225,.10)"], [0.4, "rgba(255,255,225,.03)"], [0.55, "rgba(0,0,0,0)"], [1, "rgba(0,0,0,.4)"]].forEach(stop => light.addColorStop(...stop));
    pen.fillStyle = light;
    pen.fillRect(-9, -9, 18, 18);
    return still;
  }

  // ------------------------------------------------------------------------------------------------------------------ balls

  /** A ball's picture, or (rgb null) its shadow: [canvas, half its width]. */
  sprite(rgb, radius) {
    const key = `${rgb} ${radius}`;
    if (this.sprites.has(key)) return this.sprites.get(key);
    const half = Math.ceil(radius * (rgb ? 1 : 1.7)) + 1, [canvas, pen] = sheet(2 * half, 2 * half);
    const disc = (stops, r) => {
      const look = pen.createRadialGradient(half, half, 0, half, half, r);
      stops.forEach(([at, colour]) => look.addColorStop(at, colour));
      pen.fillStyle = look;
      pen.beginPath(); pen.arc(half, half, r, 0, TURN); pen.fill();
    };
    if (rgb) {
      const lit = mix(rgb, WHITE, 0.16), rim = mix(mix(rgb, BLACK, 0.52), this.colours.cloth, 0.16);
      disc([[0, css(lit)], [0.35, css(mix(lit, rgb, 0.6))], [0.68, css(mix(rgb, BLACK, 0.1))], [0.9, css(mix(rgb, BLACK, 0.36))], [1, css(rim)]], radius);
      disc([[0, css(this.colours.lamp, 0.3)], [0.5, css(this.colours.lamp, 0.1)], [1, css(this.colours.lamp, 0)]], 0.72 * radius);
    } else {
      const { shadow } = this.colours;
      disc([[0, css(shadow, 0.8)], [0.5, css(shadow, 0.72)], [0.68, css(shadow, 0.4)], [0.85, css(shadow, 0.12)], [1, css(shadow, 0)]], 1.7 * radius);
    }
    this.sprites.set(key, [canvas, half]);
    return [canvas, half];
  }

  /** The lamps as they are seen in a ball at (x, y): two rows along the table, where the sphere is a mirror. */
  lamps(pen, x, y, px, py, radius) {
    const [[x0, x1], [y0, y1]] = this.scene.extent;
    pen.beginPath();
    for (let k = 0; k < 10; k++) {
      const dx = (x0 + x1) / 2 + (k % 2 - 0.5) * 0.5 * (x1 - x0) - x, dy = (y0 + y1) / 2 + ((k >> 1) - 2) * 0.2 * (y1 - y0) - y;
      const far = Math.hypot(dx, dy, 1), norm = Math.hypot(dx, dy, 1 + far), nx = dx / norm, ny = dy / norm, size = radius * (1 + far) / norm;
      pen.moveTo(px + radius * ny + 0.1 * size, py + radius * nx);
      pen.ellipse(px + radius * ny, py + radius * nx, 0.1 * size, 0.05 * size, 0, 0, TURN);
    }
    pen.fillStyle = css(this.colours.lamp, 0.9);
    pen.fill();
  }

  /** Spots on the ball's surface, turned with it: six, where a ball's axes come out. */
  spots(pen, q, rgb, px, py, radius, alpha) {
    const [w, a, b, c] = q, axes = [
      [1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)], [2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)],
      [2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)],
    ];
    pen.fillStyle = css(rgb, alpha);
    for (const axis of axes) for (const sign of [1, -1]) {
      const [x, y, z] = axis.map(value => value * sign);
      if (z < 0.03) continue;
      pen.beginPath();
      pen.ellipse(px + 0.96 * radius * y, py + 0.96 * radius * x, 0.27 * radius * z, 0.27 * radius, Math.atan2(x, y), 0, TURN);
      pen.fill();
    }
  }

  // ---------------------------------------------------------------------------------------------------------------- a frame

  /** Draw the table with what lies on it now; every part of the frame but x, y and on may be missing. */
  draw(frame) {
    this.still ??= this.paint();
    const { pen, scene, scale, colours } = this, radius = this.R * scale, dot = this.ratio;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.globalAlpha = 1;
    pen.drawImage(this.still, 0, 0);
    for (const heat of frame.heat ?? []) this.heat(heat);
    for (const line of frame.lines ?? []) this.line(line);
    const at = (x, y) => [this.left + scale * y, this.top + scale * x];
    for (const { x, y, ball, alpha = 0.45 } of frame.rings ?? []) {
      const [px, py] = at(x, y);
      if (ball !== undefined) {
        const [image, half] = this.sprite(scene.balls[ball].rgb, radius);
        pen.globalAlpha = alpha;
        pen.drawImage(image, px - half, py - half);
        pen.globalAlpha = 1;
      }
      pen.strokeStyle = css(colours.text, Math.min(1, alpha + 0.3));
      pen.lineWidth = 1.5 * dot;
      pen.beginPath(); pen.arc(px, py, radius, 0, TURN); pen.stroke();
    }
    const balls = [], [shadow, wide] = this.sprite(null, radius), [[x0, x1], [y0, y1]] = scene.extent;
    for (let i = 0; i < frame.x.length; i++) {
      const depth = frame.depth?.[i] ?? (frame.on[i] ? 0 : 1);
      if (frame.on[i] ? depth >= 1 && !frame.depth : depth >= 1) continue;
      balls.push([i, depth, ...at(frame.x[i], frame.y[i])]);
      if (depth) continue;
      const [, , px, py] = balls.at(-1); // away from the lamps
      pen.drawImage(shadow, px - wide + radius * 0.5 * (frame.y[i] - (y0 + y1) / 2) / (y1 - y0), py - wide + radius * (0.14 + 0.5 * (frame.x[i] - (x0 + x1) / 2) / (x1 - x0)));
    }
    balls.sort((a, b) => b[1] - a[1]);
    for (const [i, depth, px, py] of balls) this.ball(frame, i, depth, px, py, radius);
    for (const i of frame.highlight ?? []) {
      const [px, py] = at(frame.x[i], frame.y[i]);
      pen.strokeStyle = css(colours.aim ?? [255, 240, 150]);
      pen.lineWidth = 2 * dot;
      pen.beginPath(); pen.arc(px, py, radius + 3 * dot, 0, TURN); pen.stroke();
    }
    if (frame.cue) this.cue(frame.cue);
  }

  ball(frame, i, depth, px, py, radius) {
    const { pen, scene } = this, { rgb, letter } = scene.balls[i], [image, half] = this.sprite(rgb, radius), turn = frame.turns?.[i];
    if (depth) { // into the nearest pocket: smaller, darker, towards its middle
      const [x, y] = scene.falls.reduce((a, b) => (Math.hypot(a[0] - frame.x[i], a[1] - frame.y[i]) < Math.hypot(b[0] - frame.x[i], b[1] - frame.y[i]) ? a : b), [frame.x[i], frame.y[i]].map(v => v + 9));
      const near = Math.hypot(x - frame.x[i], y - frame.y[i]) < 0.2 ? 0.5 * depth * this.scale : 0, size = half * (1 - 0.3 * depth);
      const [u, v] = [px + (y - frame.y[i]) * near, py + (x - frame.x[i]) * near];
      pen.globalAlpha = 1 - depth;
      pen.drawImage(image, u - size, v - size, 2 * size, 2 * size);
      pen.globalAlpha = 1;
      return;
    }
    pen.drawImage(image, px - half, py - half);
    const pale = 0.3 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2] > 110;
    if (turn) this.spots(pen, turn, i ? (pale ? BLACK : WHITE) : this.colours.bar_accent, px, py, radius, i ? 0.32 : 0.9);
    if (radius > 3) this.lamps(pen, frame.x[i], frame.y[i], px, py, radius);
    if (!frame.labels) return;
    pen.font = `700 ${Math.max(1.25 * radius, 9 * this.ratio)}px system-ui,sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "alphabetic";
    pen.lineJoin = "round";
    const text = letter.toUpperCase(), box = pen.measureText(text), down = (box.actualBoundingBoxAscent - box.actualBoundingBoxDescent) / 2;
    pen.strokeStyle = css(pale ? WHITE : BLACK, 0.75);
    pen.lineWidth = 0.3 * radius;
    pen.strokeText(text, px, py + down);
    pen.fillStyle = css(pale ? BLACK : WHITE);
    pen.fillText(text, px, py + down);
  }

  /** A line of points, or a `path` in metres, at least 3 pixels wide, with a dark edge. */
  line({ points = [], path, colour, width = 0.007, dash = [], arrow }) {
    const { pen, scale } = this, wide = Math.max(width, 3 * this.ratio / scale), way = path ?? new Path2D();
    const paint = Array.isArray(colour) ? css(colour) : colour ?? css(this.colours.text);
    points.forEach(([x, y], k) => (k ? way.lineTo(x, y) : way.moveTo(x, y)));
    if (arrow && points.length > 1) {
      const [[ax, ay], [bx, by]] = points.slice(-2), turn = Math.atan2(by - ay, bx - ax), size = 4 * wide;
      for (const side of [-2.6, 2.6]) { way.moveTo(bx, by); way.lineTo(bx + size * Math.cos(turn + side), by + size * Math.sin(turn + side)); }
    }
    this.metres(pen);
    pen.lineJoin = pen.lineCap = "round";
    pen.setLineDash(dash);
    for (const [style, thick] of [[css(this.colours.path_edge, 0.55), wide + 2 * this.ratio / scale], [paint, wide]]) {
      pen.strokeStyle = style;
      pen.lineWidth = thick;
      pen.stroke(way);
    }
    pen.setLineDash([]);
    pen.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** Cells (ny rows along y, of nx along x), the stronger the more is in them. */
  heat({ x0, y0, cell, nx, ny, values, rgb }) {
    const [canvas, p] = sheet(nx, ny), image = p.createImageData(nx, ny), most = values.reduce((a, b) => Math.max(a, b), 0);
    for (let k = 0; k < nx * ny; k++) {
      image.data.set(rgb, 4 * k);
      image.data[4 * k + 3] = most ? 225 * Math.sqrt(values[k] / most) : 0;
    }
    p.putImageData(image, 0, 0);
    this.metres(this.pen);
    this.pen.drawImage(canvas, x0, y0, nx * cell, ny * cell);
    this.pen.setTransform(1, 0, 0, 1, 0, 0);
  }

  /** The cue, its tip `pull` behind the ball at (x, y). */
  cue({ x, y, aim, pull = 0.05, elevation = 0, alpha = 1 }) {
    const { pen } = this, ex = Math.cos(aim), ey = Math.sin(aim), short = Math.cos(elevation);
    const back = d => this.R + pull + d * short, half = d => 0.0048 + 0.0095 * d / 1.45;
    const part = (from, to, colour) => {
      pen.beginPath();
      for (const [d, side] of [[from, 1], [to, 1], [to, -1], [from, -1]])
        pen.lineTo(x - ex * back(d) - ey * side * half(d), y - ey * back(d) + ex * side * half(d));
      pen.fillStyle = colour;
      pen.fill();
    };
    this.metres(pen);
    pen.globalAlpha = alpha;
    pen.shadowColor = css(this.colours.shadow, 0.6);
    pen.shadowBlur = 0.02 * this.scale;
    pen.shadowOffsetY = 0.015 * this.scale;
    part(0, 1.45, "#d9b27c");
    pen.shadowColor = "transparent";
    part(0.95, 1.45, "#20130d"); part(0.93, 0.95, "#8c5a2c"); part(0.008, 0.018, "#d8c27a"); part(0, 0.008, "#3c6a9c");
    pen.globalAlpha = 1;
    pen.shadowBlur = pen.shadowOffsetY = 0;
    pen.setTransform(1, 0, 0, 1, 0, 0);
  }
}

// ---------------------------------------------------------------------------------------------------------------------- the player

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
/** Seconds shown before a stroke, while the cue is drawn back, and after it. */
const LEAD = 0.9, PAUSE = 1.4;
const KEYS = [["space, tap", "play, pause"], ["← →", "event back, on"], ["shift ← →", "stroke back, on"], ["↑ ↓", "faster, slower"], ["home end", "first, last moment"],
  ["p", "paths"], ["g", "ghost balls"], ["s", "spots that show spin"], ["l", "letters on balls"], ["?", "this help"]];
const ICONS = { play: "M7 4v16l13-8z", pause: "M6 4h4v16H6zM14 4h4v16h-4z", skip: "M4 5l8 7-8 7zM12 5l8 7-8 7z", step: "M9 5l8 7-8 7z" };
const STYLE = `
.snk{position:relative;display:flex;flex-direction:column;justify-content:center;box-sizing:border-box;background:var(--floor);color:var(--text);font:15px/1.3 system-ui,"Segoe UI",Roboto,Helvetica,Arial,sans-serif;font-variant-numeric:tabular-nums;outline:0;overflow:hidden}
.snk *{box-sizing:border-box}.snk-fill{height:100%}.snk-stage{position:relative;min-height:0}.snk-stage canvas{position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:manipulation}
.snk-score{display:flex;flex-wrap:wrap;justify-content:center;align-items:stretch;background:var(--bar);border-top:3px solid var(--bar_accent);font-size:clamp(14px,1.6vw,24px)}
.snk-score>*{display:flex;align-items:center;gap:.6em;padding:.3em .8em;min-width:0}.snk-who{flex:1 1 30%;font-weight:600}.snk-who+.snk-who{flex-direction:row-reverse}.snk-who span{flex:1;overflow:hidden;text-overflow:ellipsis;white-space:nowrap}.snk-who+.snk-who span{text-align:right}
.snk-who b{background:#e9ecf2;color:#10131c;padding:.05em .5em;min-width:2.4em;text-align:center;border-radius:2px}.snk-turn{box-shadow:inset 0 -3px var(--bar_accent);background:var(--bar_edge)}
.snk-now{flex:1 0 100%;justify-content:center;gap:.4em 1.4em!important;flex-wrap:wrap;font-size:.8em;border-top:1px solid var(--bar_edge)}.snk i{display:inline-block;width:.8em;height:.8em;border-radius:50%;margin:0 1px;vertical-align:-.06em;box-shadow:inset 0 0 0 1px #fff5}
.snk-info{display:flex;align-items:center;gap:10px;padding:4px 10px;min-height:58px;color:var(--text_quiet);font-size:14px}.snk-info canvas{width:50px;height:50px;flex:none}.snk-words{flex:1;text-align:right;color:var(--text);font-size:16px}
.snk-bar{position:relative;height:32px;margin:0 14px;cursor:pointer;touch-action:none}.snk-bar::before,.snk-fillbar{content:"";position:absolute;left:0;right:0;top:13px;height:6px;border-radius:3px;background:var(--bar_edge)}.snk-fillbar{right:auto;background:var(--bar_accent)}
.snk-bar u{position:absolute;top:10px;width:2px;height:12px;background:var(--text_quiet);opacity:.7}.snk-thumb{position:absolute;top:7px;width:18px;height:18px;margin-left:-9px;border-radius:50%;background:var(--text)}
.snk-keys{display:flex;flex-wrap:wrap;justify-content:center;gap:4px;padding:2px 6px 8px}.snk button{min-width:42px;height:40px;padding:0 8px;border:0;border-radius:6px;background:#ffffff12;color:inherit;font:inherit;cursor:pointer}.snk button:hover{background:#ffffff2a}
.snk button[aria-pressed=true]{box-shadow:inset 0 -3px var(--bar_accent);background:#ffffff24}.snk svg{width:22px;height:22px;fill:currentColor;vertical-align:middle}.snk :focus-visible,.snk:focus-visible{outline:2px solid #ffd75e;outline-offset:-2px}
.snk output{min-width:4.2em;line-height:40px;text-align:center}.snk-help{position:absolute;inset:0;margin:auto;width:min(92%,380px);height:fit-content;max-height:96%;overflow:auto;padding:14px 18px;background:var(--bar);border:1px solid var(--bar_edge);border-radius:8px;z-index:2}.snk-help td{padding:2px 14px 2px 0}.snk [hidden]{display:none}`;

/** A new element with a class and a text, put into its parent. */
function put(parent, tag, name, text) {
  const made = document.createElement(tag);
  if (name) made.className = name;
  if (text) made.textContent = text;
  parent?.append(made);
  return made;
}

/** Plays a replay in an element. */
export class Player {
  constructor(element, replay, options = {}) {
    const data = (this.replay = decode(replay)), still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!data.strokes.length) throw new Error("a replay must hold at least one stroke");
    this.options = { autoplay: true, speed: 1, paths: !data.players.length, ghosts: true, spin: "cue", labels: false, fill: false, ...options };
    this.strokes = data.strokes;
    this.show = { paths: this.options.paths, ghosts: this.options.ghosts, labels: this.options.labels };
    this.spin = this.options.spin;
    this.speed = this.options.speed;
    this.k = 0;
    this.playing = false;
    this.leads = data.strokes.map(stroke => (stroke.cue ? LEAD : 0));
    let sum = 0;
    this.starts = data.strokes.map((stroke, k) => (sum += this.leads[k] + stroke.duration + PAUSE) - stroke.duration - PAUSE);
    this.total = sum - PAUSE;
    this.t = -this.leads[0];
    this.build(element);
    this.tick = this.tick.bind(this);
    this.watch = new ResizeObserver(() => { this.view.resize(); this.update(); });
    this.watch.observe(this.stage);
    this.update();
    if (this.options.autoplay && !still) this.play();
  }

  /** Which stroke is shown, from 0. */
  get stroke() { return this.k; }
  /** Time within the stroke [s]; below 0 before it. */
  get time() { return this.t; }

  build(element) {
    const { replay, options } = this, root = (this.root = put(element, "div", options.fill ? "snk snk-fill" : "snk")), { scene } = replay;
    root.tabIndex = 0;
    root.setAttribute("role", "group");
    root.setAttribute("aria-label", replay.title || "replay");
    for (const [name, rgb] of Object.entries({ ...PALETTE, ...scene.palette })) root.style.setProperty(`--${name}`, css(rgb));
    put(root, "style", "", STYLE);
    this.stage = put(root, "div", "snk-stage");
    this.stage.style.aspectRatio = TableView.aspect(scene);
    this.canvas = put(this.stage, "canvas");
    this.canvas.onclick = () => this.toggle();
    this.view = new TableView(this.canvas, scene);
    if (replay.players.length) {
      const bar = put(root, "div", "snk-score");
      this.who = replay.players.map(name => { const one = put(bar, "div", "snk-who"); put(one, "span", "", name); return [one, put(one, "b")]; });
      this.now = put(bar, "div", "snk-now");
    }
    const info = put(root, "div", "snk-info");
    this.tip = put(info, "canvas");
    this.about = put(info, "div");
    this.words = put(info, "div", "snk-words");
    this.words.setAttribute("aria-live", "polite");
    this.bar = put(root, "div", "snk-bar");
    for (const [name, value] of Object.entries({ role: "slider", tabindex: 0, "aria-label": "time", "aria-valuemin": 0, "aria-valuemax": this.total.toFixed(2) })) this.bar.setAttribute(name, value);
    this.done = put(this.bar, "div", "snk-fillbar");
    const many = Math.ceil(this.strokes.length / 300);
    this.strokes.forEach((stroke, k) => {
      if (!k || k % many) return;
      const mark = put(this.bar, "u");
      mark.style.left = `${100 * (this.starts[k] - this.leads[k]) / this.total}%`;
    });
    this.thumb = put(this.bar, "div", "snk-thumb");
    const drag = event => {
      const box = this.bar.getBoundingClientRect();
      this.seekTotal((event.clientX - box.left) / box.width * this.total);
    };
    this.bar.onpointerdown = event => { this.pause(); this.bar.setPointerCapture(event.pointerId); drag(event); };
    this.bar.onpointermove = event => this.bar.hasPointerCapture(event.pointerId) && drag(event);
    const row = put(root, "div", "snk-keys");
    const button = (label, icon, act, back) => {
      const made = put(row, "button", "", icon ? "" : label);
      made.type = "button";
      made.title = label;
      made.setAttribute("aria-label", label);
      if (icon) made.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"${back ? ' style="transform:scaleX(-1)"' : ""}><path d="${ICONS[icon]}"/></svg>`;
      made.onclick = act;
      return made;
    };
    button("previous stroke", "skip", () => this.skip(-1), true);
    button("previous event", "step", () => this.step(-1), true);
    this.main = button("play", "play", () => this.toggle());
    button("next event", "step", () => this.step(1));
    button("next stroke", "skip", () => this.skip(1));
    button("−", "", () => this.faster(-1)).setAttribute("aria-label", "slower");
    this.pace = put(row, "output");
    button("+", "", () => this.faster(1)).setAttribute("aria-label", "faster");
    this.toggles = Object.fromEntries(["paths", "ghosts", "spin", "labels"].map(name => [name, button(name, "", () => this.flip(name))]));
    button("?", "", () => this.help()).setAttribute("aria-label", "help");
    this.sheet = put(root, "table", "snk-help");
    this.sheet.hidden = true;
    for (const [keys, what] of KEYS) { const line = put(this.sheet, "tr"); put(line, "td", "", keys); put(line, "td", "", what); }
    this.keys = options.keys ?? root;
    this.onkey = event => this.key(event);
    this.keys.addEventListener("keydown", this.onkey);
  }

  key(event) {
    const pressed = event.key.length === 1 ? event.key.toLowerCase() : event.key, way = { ArrowLeft: -1, ArrowRight: 1 }[pressed];
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName)) return;
    if (pressed === " " && event.target.tagName === "BUTTON") return; // it presses that button
    const acts = {
      " ": () => this.toggle(), ArrowUp: () => this.faster(1), ArrowDown: () => this.faster(-1), Home: () => this.seekTotal(0), End: () => this.seekTotal(this.total),
      p: () => this.flip("paths"), g: () => this.flip("ghosts"), s: () => this.flip("spin"), l: () => this.flip("labels"), "?": () => this.help(),
      Escape: () => { this.sheet.hidden = true; },
    };
    if (way) { if (event.shiftKey) this.skip(way); else this.step(way); } else if (acts[pressed]) acts[pressed](); else return;
    event.preventDefault();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }
  help() { this.sheet.hidden = !this.sheet.hidden; }
  faster(way) {
    const k = SPEEDS.findIndex(speed => speed >= this.speed);
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, (k < 0 ? SPEEDS.length : k) + way))];
    this.update();
  }
  flip(name) {
    if (name === "spin") this.spin = { cue: "all", all: "off", off: "cue" }[this.spin];
    else this.show[name] = !this.show[name];
    this.update();
  }

  play() {
    const last = this.strokes.length - 1;
    if (this.k === last && this.t >= this.strokes[last].duration) this.seek(0, -this.leads[0]);
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
    this.k = Math.min(this.strokes.length - 1, Math.max(0, stroke));
    this.t = Math.min(this.strokes[this.k].duration + (this.k < this.strokes.length - 1 ? PAUSE : 0), Math.max(-this.leads[this.k], t));
    if (before !== this.k) this.options.onstroke?.(this.k);
    this.update();
  }

  seekTotal(sum) {
    let k = this.strokes.length - 1;
    while (k > 0 && this.starts[k] - this.leads[k] > sum) k--;
    this.seek(k, sum - this.starts[k]);
  }

  /** On by a stroke, or back: first to the beginning of this one. */
  skip(way) {
    const k = this.k + (way < 0 && this.t > 0.5 ? 0 : way);
    if (k < this.strokes.length) this.seek(k, k < 0 || way < 0 ? 0 : -this.leads[k]); else this.seek(k, Infinity);
  }

  /** To the next event (+1) or the last one (-1), over strokes' ends. */
  step(way) {
    this.pause();
    const stroke = this.strokes[this.k], stops = [0, ...stroke.events.filter(event => EVENTS[event[1]]).map(event => event[0]), stroke.duration];
    const next = way > 0 ? stops.find(t => t > this.t + 1e-9) : stops.findLast(t => t < this.t - 1e-9);
    if (next !== undefined) this.seek(this.k, next);
    else if (way > 0 ? this.k < this.strokes.length - 1 : this.k > 0) this.seek(this.k + way, way > 0 ? 0 : this.strokes[this.k - 1].duration);
  }

  tick(now) {
    this.waiting = null;
    if (!this.playing) return;
    const stroke = this.strokes[this.k], rest = this.t < 0 || this.t >= stroke.duration;
    const dt = this.clock === null ? 0 : Math.min(0.1, (now - this.clock) / 1000) * (rest ? Math.max(1, this.speed) : this.speed);
    this.clock = now;
    const last = this.k === this.strokes.length - 1, end = stroke.duration + (last ? 0 : PAUSE), t = this.t + dt;
    if (t < end) this.seek(this.k, t);
    else if (last) {
      this.playing = false;
      this.seek(this.k, end);
      this.options.onend?.();
      return;
    } else this.seek(this.k + 1, -this.leads[this.k + 1]);
    this.waiting = requestAnimationFrame(this.tick);
  }

  /** What lies on the table now. */
  frame() {
    const stroke = this.strokes[this.k], { t } = this, over = t > stroke.duration + PAUSE / 2 && stroke.later;
    const frame = over ? { ...stroke.later } : stroke.at(t), { balls } = this.replay.scene;
    frame.labels = this.show.labels;
    if (this.spin !== "off") frame.turns = Array.from({ length: this.spin === "cue" ? 1 : stroke.n }, (_, ball) => stroke.turn(ball, t));
    if (over) return frame;
    if (this.show.paths) {
      frame.lines = [];
      stroke.logs.forEach((log, ball) => {
        if (!log.length || t <= 0) return;
        const slide = new Path2D(), roll = new Path2D(), colour = mix(balls[ball].rgb, WHITE, 1 / 3);
        stroke.trace(ball, t, slide, roll);
        frame.lines.push({ path: roll, colour }, { path: slide, colour: mix(colour, WHITE, 0.3), dash: [0.012, 0.022] });
      });
    }
    if (this.show.ghosts && t > 0) frame.rings = this.ghosts(stroke).filter(ring => ring.t < t);
    if (stroke.cue && t < 0.35) {
      const u = 1 + t / LEAD, draw = 0.03 + 0.1 * Math.min(1, stroke.cue.speed / 4);
      const pull = t >= 0 ? -Math.min(0.16, t * stroke.cue.speed * 0.4) : u < 0.75 ? 0.012 + draw * (1 - Math.cos(Math.PI * u / 0.75)) / 2 : (0.012 + draw) * (1 - ((u - 0.75) / 0.25) ** 2);
      frame.cue = { x: stroke.first[0], y: stroke.first[1], aim: stroke.cue.aim, pull, elevation: stroke.cue.elevation, alpha: t > 0 ? 1 - t / 0.35 : Math.min(1, 4 * u) };
    }
    return frame;
  }

  /** Where the cue ball was when it met other balls. */
  ghosts(stroke) {
    stroke.met ??= stroke.events.filter(([, kind, i, j]) => kind === BALL_BALL && (i === 0 || j === 0)).map(([t]) => {
      const { x, y } = stroke.at(t);
      return { x: x[0], y: y[0], t, ball: 0, alpha: 0.3 };
    });
    return stroke.met;
  }

  /** [[x, y], ...] [m] of all balls as they are on screen. */
  positions() { return Array.from(this.shown.x, (x, k) => [x, this.shown.y[k]]); }

  // ------------------------------------------------------------------------------------------------------------ what is said

  /** Draw and say everything anew. */
  update() {
    this.shown = this.frame();
    this.view.draw(this.shown);
    const stroke = this.strokes[this.k], over = this.t >= stroke.duration, sum = this.starts[this.k] + this.t, part = `${100 * sum / this.total}%`;
    this.done.style.width = this.thumb.style.left = part;
    this.say(stroke, over);
    this.options.ontime?.(this.t, this.k);
  }

  say(stroke, over) {
    const name = ball => this.replay.scene.balls[ball].name, { cue } = stroke, paused = !this.playing;
    const event = paused && stroke.events.findLast(one => Math.abs(one[0] - this.t) < 1e-9 && EVENTS[one[1]]);
    const left = Array.from(this.shown.on).reduce((count, on, ball) => count + (ball && ball < 16 ? on : 0), 0);
    const said = [this.k, over, this.playing, this.speed, this.spin, Object.values(this.show), left, event, this.tip.clientWidth].join();
    if (said === this.said) { this.bar.setAttribute("aria-valuenow", (this.starts[this.k] + this.t).toFixed(2)); return; }
    this.said = said;
    this.main.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${ICONS[paused ? "play" : "pause"]}"/></svg>`;
    this.main.setAttribute("aria-label", paused ? "play" : "pause");
    this.pace.textContent = `${this.speed}×`;
    for (const [key, one] of Object.entries(this.toggles)) one.setAttribute("aria-pressed", key === "spin" ? this.spin !== "off" : this.show[key]);
    const count = this.strokes.length > 1 ? `stroke ${this.k + 1} of ${this.strokes.length}` : "", parts = [count];
    if (cue) parts.push(`${cue.speed.toFixed(2)} m/s`, Math.abs(cue.top) < 0.05 ? "" : cue.top > 0 ? "top" : "screw", Math.abs(cue.side) < 0.05 ? "" : cue.side > 0 ? "right side" : "left side", cue.elevation > 0.1 ? `cue raised ${(cue.elevation * 57.3).toFixed(0)}°` : "");
    this.about.textContent = parts.filter(Boolean).join(" · ");
    const met = event && `${event[0].toFixed(3)} s: ${name(event[2])} ${EVENTS[event[1]]}${event[1] === BALL_BALL ? ` ${name(event[3])}` : ""}`;
    this.words.textContent = met || (over ? stroke.words : "") || this.replay.title || "";
    this.drawTip(cue);
    if (this.who) this.score(stroke, over, left);
  }

  /** The cue ball as the player sees it, and where the tip strikes it. */
  drawTip(cue) {
    const { tip } = this, size = (tip.width = tip.height = Math.round(50 * this.view.ratio)), pen = tip.getContext("2d"), R = size * 0.46, c = size / 2;
    tip.hidden = !cue;
    if (!cue) return;
    const [image, half] = this.view.sprite(this.replay.scene.balls[0].rgb, R);
    pen.drawImage(image, c - half, c - half);
    pen.strokeStyle = "#0004";
    pen.beginPath(); pen.moveTo(c - R, c); pen.lineTo(c + R, c); pen.moveTo(c, c - R); pen.lineTo(c, c + R); pen.stroke();
    pen.fillStyle = css(this.view.colours.bar_accent);
    pen.beginPath(); pen.arc(c + R * cue.side, c - R * cue.top, 0.17 * R, 0, TURN); pen.fill();
  }

  score(stroke, over, left) {
    const before = this.strokes[this.k - 1], given = stroke.score, { balls } = this.replay.scene, mine = stroke.player ?? 0;
    const scores = over ? given : before ? before.score : given.map((points, k) => points - (k === mine ? stroke.points : stroke.penalty));
    this.who.forEach(([one, box], k) => {
      box.textContent = scores[k] ?? 0;
      one.classList.toggle("snk-turn", stroke.player === k);
    });
    const same = before && before.player === stroke.player, run = over ? stroke.break : same ? before.break : 0, pots = [];
    for (let k = over ? this.k : this.k - 1; run > 0 && k >= 0 && this.strokes[k].player === stroke.player && this.strokes[k].points > 0; k--) pots.unshift(...this.strokes[k].pots);
    this.now.textContent = "";
    const dot = (parent, ball) => { put(parent, "i").style.background = css(balls[ball].rgb); };
    const points = put(this.now, "span", "", `break ${run} `);
    pots.forEach(ball => dot(points, ball));
    if (stroke.n === 22) put(this.now, "span", "", `reds ${left}`);
    if (stroke.ball_on) {
      const on = put(this.now, "span", "", "on "), ball = balls.findIndex(one => one.name === stroke.ball_on);
      if (ball >= 0) dot(on, ball);
      on.append(` ${stroke.ball_on}`);
    }
  }

  /** Stop, and leave the element as it was. */
  destroy() {
    this.playing = false;
    cancelAnimationFrame(this.waiting);
    this.watch.disconnect();
    this.keys.removeEventListener("keydown", this.onkey);
    this.root.remove();
  }
}

/** A player of a replay in an element. */
export function mount(element, replay, options) { return new Player(element, replay, options); }
