/**
 * Where are the balls of a replay at any time? `decode` makes strokes that know it.
 *
 * Each phase of motion is a closed form, in the arithmetic of `physics/cloth.py`, so places equal the simulation's.
 * Frame: origin at the table's centre, +x to the yellow side, +y to the black end, SI units.
 *
 * The files of this folder are joined to one module, `table.js` (`web/__init__.py`): a name of an earlier file is
 * known in the later ones.
 */

const { PI, abs, atan2, ceil, cos, floor, hypot, max, min, round, sign, sin, sqrt } = Math;
const TURN = 2 * PI;

/** States of a ball in a segment of its motion, and the kind of event between two balls. */
const GONE = 0;
const ROLL = 2;
const SLIDE = 3;
const FALLING = 4;
const BEND = 5;
const AIR = 6;
const BALL_BALL = 0;

/** Step [s] of a ball's orientation where its axis turns. */
const STEP = 1 / 120;
/** A flight that is higher is shown from the side [m]. */
const HIGH = 0.01;
/** Time [s] in which a ball falls out of sight. */
const FALL = 0.2;

/** Numbers from base64. */
export const numbers = (text, Type) => new Type(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);

/** The rotation q, then one by the vector (x, y, z) [rad]; quaternions are [w, x, y, z]. */
function turned(q, x, y, z) {
  const angle = hypot(x, y, z);
  if (angle < 1e-12) return q;
  const w = cos(angle / 2);
  const s = sin(angle / 2) / angle;
  x *= s;
  y *= s;
  z *= s;
  const [a, b, c, d] = q;
  return [
    w * a - x * b - y * c - z * d,
    w * b + x * a + y * d - z * c,
    w * c + y * a + z * b - x * d,
    w * d + z * a + x * c - y * b,
  ];
}

/** A stroke's data, and where the balls are at any time. */
class Stroke {
  constructor(data, replay, previous) {
    Object.assign(this, data, { R: replay.R, decel: replay.spin_decel, previous, turns: new Map() });
    const { n, paths, after } = data;
    const flags = balls => Uint8Array.from({ length: n }, (_, ball) => balls.includes(ball));
    this.first = numbers(data.start, Float64Array);
    this.here = flags(data.on_table);
    this.logs = Array.from({ length: n }, () => []); // by ball: its segments, in order of time
    const rows = numbers(paths.f8, Float64Array);
    const spins = numbers(paths.f4, Float32Array);
    const codes = numbers(paths.u1, Uint8Array);
    const heights = paths.height && numbers(paths.height, Float64Array); // where balls fly
    for (let s = 0; s < paths.count; s++) {
      const [t0, x, y, vx, vy, ax, ay] = rows.subarray(7 * s);
      const [wx, wy, wz] = spins.subarray(3 * s);
      const [ball, state] = codes.subarray(2 * s);
      const [z, uz] = heights?.subarray(2 * s) ?? [0, 0];
      this.logs[ball].push({ t0, x, y, vx, vy, ax, ay, wx, wy, wz, state, z, uz });
    }
    if (!after) return;
    const places = numbers(after.places, Float64Array);
    this.later = {
      x: places.filter((_, k) => k % 2 === 0),
      y: places.filter((_, k) => k % 2),
      on: flags(after.on_table),
    };
  }

  /** Which segment of a ball's log holds at time t; -1 before the first. */
  find(ball, t) {
    return this.logs[ball].findLastIndex(segment => segment.t0 <= t);
  }

  /** [x, y, vx, vy, wx, wy, wz] at time t of a segment; the order of the arithmetic is that of the simulation. */
  moving({ t0, x, y, vx, vy, ax, ay, wx, wy, wz, state }, t) {
    const { R } = this;
    const dt = t - t0;
    const u = vx + ax * dt;
    const v = vy + ay * dt;
    const slips = state === SLIDE || state === FALLING || state === AIR;
    return [
      x + (vx + 0.5 * ax * dt) * dt,
      y + (vy + 0.5 * ay * dt) * dt,
      u,
      v,
      slips ? wx + 2.5 * ay * dt / R : -v / R,
      slips ? wy - 2.5 * ax * dt / R : u / R,
      state === AIR ? wz : sign(wz) * max(0, abs(wz) - this.decel * dt),
    ];
  }

  /** Height of a ball in the air above the bed, at time t of a segment [m]; else 0. */
  height({ t0, z, uz, state }, t) {
    const dt = t - t0;
    return state === AIR ? max(0, z + (uz - 0.5 * this.paths.g * dt) * dt) : 0;
  }

  /** Whether a ball flies higher than `HIGH` at about time t. */
  flies(t) {
    const high = ({ z, uz, state }) => state === AIR && z + max(0, uz) ** 2 / (2 * this.paths.g) > HIGH;
    this.flights ??= this.logs.flatMap(log => log.flatMap((one, k) => high(one) ? [[one.t0, log[k + 1]?.t0]] : []));
    return this.flights.some(([from, until]) => t > from - 0.5 && t < until + 0.5);
  }

  /** All balls at time t [s]: x, y, vx, vy, wx, wy, wz, height `z`, `on` the table (1 or 0), `depth` in a pocket. */
  at(t) {
    const names = ["x", "y", "vx", "vy", "wx", "wy", "wz"];
    const out = { on: this.here.slice(), depth: Float64Array.from(this.here, here => 1 - here) };
    for (const name of [...names, "z"]) out[name] = new Float64Array(this.n);
    const still = this.decel > 0 && t >= this.duration;
    this.logs.forEach((log, i) => {
      const k = this.find(i, t);
      const values = k < 0 ? this.first.subarray(2 * i, 2 * i + 2) : this.moving(log[k], t);
      values.forEach((value, c) => {
        out[names[c]][i] = still && c > 3 ? 0 : value;
      });
      if (k < 0 || !this.here[i]) return;
      out.z[i] = this.height(log[k], t);
      if (log[k].state === GONE) out.on[i] = 0;
      let fell = k + 1; // with this segment it went over the edge
      while (fell && [GONE, FALLING].includes(log[fell - 1].state)) fell--;
      if (fell <= k) out.depth[i] = min(1, ((t - log[fell].t0) / FALL) ** 2);
    });
    return out;
  }

  /** The orientation of a ball at time t, a quaternion that depends on t alone. */
  turn(ball, t) {
    const k = this.find(ball, t);
    const log = this.logs[ball];
    const known = this.turns.get(ball) ?? [{ q: this.firstTurn(ball) }]; // at the start, then of each segment
    this.turns.set(ball, known);
    for (let j = known.length - 1; j <= k; j++) {
      known.push({ q: j ? this.rolled(log[j - 1], known[j], log[j].t0) : known[0].q });
      known[j].steps = null; // or a match would fill the memory
    }
    return k < 0 ? known[0].q : this.rolled(log[k], known[k + 1], min(t, this.duration));
  }

  /** A ball's orientation at the start: that at the end of the stroke before, else one of its own. */
  firstTurn(ball) {
    const before = this.previous;
    if (ball < before?.n) return before.turn(ball, before.duration);
    return turned([1, 0, 0, 0], ball + 0.4, 0.5 - ball, 2 * ball);
  }

  /** From the start of a segment to time t: in one exact step where the axis stays, else by the middles of small ones. */
  rolled(segment, start, t) {
    const { t0, state, wz } = segment;
    if (state === GONE || t <= t0) return start.q;
    const step = (q, from, to) => {
      const spin = this.moving(segment, (from + to) / 2).slice(4);
      return turned(q, ...spin.map(w => w * (to - from)));
    };
    if (state === ROLL && !wz) return step(start.q, t0, t);
    start.steps ??= [start.q];
    const whole = floor((t - t0) / STEP);
    for (let m = start.steps.length; m <= whole; m++) {
      start.steps.push(step(start.steps[m - 1], t0 + (m - 1) * STEP, t0 + m * STEP));
    }
    return step(start.steps[whole], t0 + whole * STEP, t);
  }

  /** Add a ball's path until time t to two paths in metres. A parabola is a quadratic curve, exactly. */
  trace(ball, t, slide, roll) {
    this.logs[ball].forEach((segment, j, log) => {
      const { t0, x, y, vx, vy, state } = segment;
      const end = min(t, log[j + 1]?.t0 ?? this.duration);
      const half = (end - t0) / 2;
      if (half <= 0 || !(vx || vy)) return;
      const path = state === ROLL || state === BEND ? roll : slide;
      path.moveTo(x, y);
      path.quadraticCurveTo(x + vx * half, y + vy * half, ...this.moving(segment, end).slice(0, 2));
    });
  }
}

/** A replay with its strokes ready to be evaluated. */
export function decode(replay) {
  if (replay?.format !== "snooker-replay" || replay.version !== 2) {
    throw new Error(`no replay of version 2: ${replay?.format} ${replay?.version}`);
  }
  let last = null;
  const strokes = replay.strokes.map(data => (last = new Stroke(data, replay, last)));
  return { win_chance: null, luck: null, ...replay, strokes };
}
