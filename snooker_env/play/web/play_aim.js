/**
 * How is a stroke aimed? By pointer, wheel, keys and controls; `Aim` holds the intended stroke and reports every change.
 * `wish`: {speed [m/s], side, top (tip offset over R, right and up), aim [rad], elevation [rad]}.
 */

import { disc, nib } from "./table.js";
import { by, firstContact, intoD } from "./play_parts.js";

/** How far the cue is pulled back for the hardest stroke, and from which it is a stroke at all [m]; how softly the power begins. */
const PULL = 0.42, LEAST_PULL = 0.015, SOFT = 1.4;
/** The strip turns the aim by so much for each pixel [degrees]. */
const FINE = 0.01;
/** Half the breadth of the cue for mouse and finger [CSS pixels]. */
const GRASP = { mouse: 9, touch: 24 };
/** Offsets of a ball over its diameter from which it is struck less full. */
const FULLNESS = [[0.12, "full ball"], [0.38, "three-quarter ball"], [0.62, "half ball"], [0.87, "quarter ball"], [1, "thin"]];
const POWERS = [[1, "very soft"], [1.8, "soft"], [3, "medium"], [4.5, "firm"], [6, "hard"], [9, "very hard"]];

/** Offsets of a first aim over a ball's diameter; so many reds are a whole pack. */
const OFFSETS = [0, 0.5, -0.5, 0.8, -0.8, 0.93, -0.93], PACK = 12;

const DEGREE = Math.PI / 180;
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

export class Aim {
  /** app: `view`, `balls` (as shown), `state`, `aiming` (can this person play now?), `scene`, `limits`; changed(): called at every change. */
  constructor(app, changed, place) {
    Object.assign(this, { app, changed, place });
    this.wish = { speed: 2.5, side: 0, top: 0, aim: Math.PI / 2, elevation: 0 };
    this.held = null;
    this.wire();
  }

  wire() {
    const { limits } = this.app, speed = by("speed"), elevation = by("elevation"), canvas = by("table"), dial = by("dial");
    [speed.min, speed.max] = limits.speed;
    elevation.max = Math.round(limits.elevation[1] / DEGREE);
    speed.oninput = () => this.set({ speed: Number(speed.value) });
    elevation.oninput = () => this.set({ elevation: Math.min(limits.elevation[1], Number(elevation.value) * DEGREE) });
    const fine = by("fine");
    fine.addEventListener("pointerdown", event => fine.setPointerCapture(event.pointerId));
    fine.addEventListener("pointermove", event => fine.hasPointerCapture(event.pointerId) && event.movementX && this.turn(-FINE * event.movementX));
    by("centre").onclick = () => this.set({ side: 0, top: 0 });
    by("left").onclick = () => this.turn(0.05);
    by("right").onclick = () => this.turn(-0.05);
    by("nominate").onchange = () => this.set({});
    canvas.addEventListener("pointerdown", event => this.down(event));
    canvas.addEventListener("pointermove", event => this.move(event));
    canvas.addEventListener("pointerup", event => event.pointerId === this.finger && this.up(true));
    canvas.addEventListener("pointercancel", event => event.pointerId === this.finger && this.up(false));
    canvas.addEventListener("wheel", event => {
      if (!this.app.aiming) return;
      event.preventDefault();
      this.turn(event.deltaY < 0 ? 0.05 : -0.05);
    }, { passive: false });
    const tip = event => {
      const box = dial.getBoundingClientRect(), half = box.width / 2 / 1.08;
      this.tip((event.clientX - box.left - box.width / 2) / half, (box.top + box.height / 2 - event.clientY) / half);
    };
    dial.addEventListener("pointerdown", event => { dial.setPointerCapture(event.pointerId); tip(event); });
    dial.addEventListener("pointermove", event => dial.hasPointerCapture(event.pointerId) && tip(event));
    this.show();
  }

  set(part) {
    Object.assign(this.wish, part);
    this.show();
    this.changed();
  }

  /** The elevation at which the stroke is played: its own, or what the cue needs over what is in its way [rad]. */
  get elevation() { return Math.max(this.wish.elevation, this.app.room?.found?.elevation ?? 0); }

  /** Turn the aim by degrees, anticlockwise for positive ones. */
  turn(degrees) { this.set({ aim: this.wish.aim + degrees * DEGREE }); }

  tip(side, top) {
    const { offset } = this.app.limits, far = Math.hypot(side, top), k = far > offset ? offset / far : 1;
    this.set({ side: Math.abs(side * k) < 0.02 ? 0 : side * k, top: Math.abs(top * k) < 0.02 ? 0 : top * k });
  }

  faster(by_) { this.set({ speed: clamp(this.wish.speed + by_, ...this.app.limits.speed) }); }
  raise(degrees) { this.set({ elevation: clamp(this.wish.elevation + degrees * DEGREE, ...this.app.limits.elevation) }); }

  // ---- the pointer

  at(event) {
    const box = by("table").getBoundingClientRect();
    return this.app.view.toTable(event.clientX - box.left, event.clientY - box.top);
  }

  /** Is this another finger than the one that holds something? */
  other(event) { return this.held && event.pointerId !== this.finger; }

  down(event) {
    const { app } = this;
    if (!app.aiming || event.button > 0 || this.other(event)) return;
    this.finger = event.pointerId;
    const [x, y] = this.at(event), near = Math.hypot(x - app.balls.x[0], y - app.balls.y[0]), reach = event.pointerType === "touch" ? 3.5 : 2;
    const behind = this.onCue(x, y, event);
    this.held = app.state.in_hand && near < reach * app.view.R ? "ball" : behind ? "cue" : "aim";
    if (behind) this.pulled = { from: behind, before: this.wish.speed, pull: 0 };
    by("table").setPointerCapture(event.pointerId);
    if (this.held !== "cue") this.move(event);
  }

  /** How far behind the cue ball a place on the cue is [m]; 0 beside it. */
  onCue(x, y, event) {
    const { view, balls } = this.app, dx = balls.x[0] - x, dy = balls.y[0] - y, c = Math.cos(this.wish.aim), s = Math.sin(this.wish.aim);
    const back = dx * c + dy * s, aside = Math.abs(dy * c - dx * s) * view.scale / view.ratio;
    return back > 1.3 * view.R && aside < (GRASP[event.pointerType] ?? GRASP.mouse) ? back : 0;
  }

  /** Let the cue go: that is the stroke, unless it was hardly pulled. */
  up(whole) {
    const { held, pulled, app } = this;
    this.held = this.pulled = null;
    by("power").hidden = true;
    if (held !== "cue" || !app.aiming) { if (held) app.redraw(); return; }
    if (whole && pulled.pull > LEAST_PULL) app.play();
    else this.set({ speed: pulled.before });
  }

  pull(x, y) {
    const { app, pulled, wish } = this, [least, most] = app.limits.speed, { balls } = app;
    pulled.pull = clamp((balls.x[0] - x) * Math.cos(wish.aim) + (balls.y[0] - y) * Math.sin(wish.aim) - pulled.from, 0, PULL);
    this.set({ speed: least + (most - least) * (pulled.pull / PULL) ** SOFT });
    const [px, py] = app.view.toScreen(balls.x[0], balls.y[0]), power = by("power");
    power.hidden = false;
    power.textContent = pulled.pull > LEAST_PULL ? `${wish.speed.toFixed(1)} m/s` : "no stroke";
    Object.assign(power.style, { left: `${clamp(px, 60, by("stage").clientWidth - 60)}px`, top: `${py > 70 ? py - 45 : py + 45}px` });
  }

  move(event) {
    const { app } = this;
    if (!app.aiming || this.other(event)) return;
    const [x, y] = this.at(event);
    if (!this.held) { by("table").style.cursor = this.onCue(x, y, event) ? "grab" : ""; return; }
    if (this.held === "cue") this.pull(x, y);
    else if (this.held === "ball") {
      [app.balls.x[0], app.balls.y[0]] = app.state.anywhere ? [x, y] : intoD(x, y, app.scene.lines);
      this.place(app.balls.x[0], app.balls.y[0]);
      this.changed();
    } else if (Math.hypot(x - app.balls.x[0], y - app.balls.y[0]) > app.view.R) {
      this.set({ aim: Math.atan2(y - app.balls.y[0], x - app.balls.x[0]) });
    }
  }

  // ---- what is shown

  show() {
    const { wish } = this;
    by("speed").value = wish.speed;
    by("speed-out").textContent = `${POWERS.find(([most]) => wish.speed < most)[1]}, ${wish.speed.toFixed(2)} m/s`;
    by("elevation").value = wish.elevation / DEGREE;
    const raised = this.elevation / DEGREE;
    by("elevation-out").textContent = raised < 0.5 ? "level" : `${Math.round(raised)}°`;
    by("aim-out").textContent = this.words;
    by("fine").setAttribute("aria-valuetext", this.words);
    by("fine").style.setProperty("--turn", `${-wish.aim / DEGREE / FINE}px`);
    const words = [];
    if (wish.top) words.push(wish.top > 0 ? "top" : "screw");
    if (wish.side) words.push(`${wish.side > 0 ? "right" : "left"} side`);
    by("tip-words").textContent = words.join(", ") || "centre ball";
    this.drawDial();
  }

  /** How the first ball is struck, as a player says it; left and right are his. */
  get words() {
    const { app, wish } = this;
    if (!app.aiming) return "";
    const { balls, scene, view: { R }, names } = app, met = firstContact(balls, 0, wish.aim, scene.extent, R);
    if (met.ball < 0) return "cushion first";
    const x = balls.x[met.ball] - balls.x[0], y = balls.y[met.ball] - balls.y[0];
    const aside = (x * Math.sin(wish.aim) - y * Math.cos(wish.aim)) / (2 * R), full = FULLNESS.find(([most]) => Math.abs(aside) <= most) ?? FULLNESS[4];
    const side = full === FULLNESS[0] ? "" : aside > 0 ? ", left" : ", right";
    return `${names[met.ball].replace(/ \d+$/, "")}: ${full[1]}${side}`;
  }

  /** The cue ball as the player sees it; the dashed circle is the miscue limit, a ring a tip that the raised cue cannot reach. */
  drawDial() {
    const dial = by("dial"), ratio = Math.min(window.devicePixelRatio || 1, 3), size = Math.round((dial.clientWidth || 112) * ratio);
    if (dial.width !== size || dial.height !== size) dial.width = dial.height = size;
    const pen = dial.getContext("2d"), c = size / 2, R = c / 1.08, { wish, app } = this;
    pen.clearRect(0, 0, size, size);
    disc(pen, c, c, R, pen.createRadialGradient(c - 0.3 * R, c - 0.35 * R, 0.1 * R, c, c, R), [0, "#fffdf2"], [0.7, "#efe9d6"], [1, "#a49d89"]);
    nib(pen, "#0003", ratio).stroke(new Path2D(`M${c - R} ${c}H${c + R}M${c} ${c - R}V${c + R}`));
    pen.setLineDash([3 * ratio, 3 * ratio]);
    disc(nib(pen, "#0006", ratio), c, c, app.limits.offset * R);
    pen.setLineDash([]);
    const room = app.room?.found, { side, top } = room?.moved ? room : wish, x = c + side * R, y = c - top * R;
    if (room?.moved) disc(nib(pen, "#c42030", 2 * ratio), c + wish.side * R, c - wish.top * R, 0.13 * R);
    disc(pen, x, y, 0.15 * R, "#2c5f93");
    disc(pen, x, y, 0.06 * R, "#9cc4ea");
  }

  /** Drawing of the aim. */
  overlay() {
    const { app, wish } = this, { balls, scene: { extent }, view: { R } } = app, met = firstContact(balls, 0, wish.aim, extent, R);
    const lines = [{ points: [[balls.x[0], balls.y[0]], [met.x, met.y]], colour: [255, 255, 255], width: 0.003 }];
    if (met.ball >= 0) {
      const x = balls.x[met.ball], y = balls.y[met.ball], full = Math.atan2(y - met.y, x - met.x), way = full + (app.room?.thrown(met.ball) ?? 0);
      const far = Math.min(0.12 + 0.7 * Math.cos(wish.aim - full), firstContact({ ...balls, on: balls.on.with(0, 0) }, met.ball, way, extent, R).run);
      const to = met.to = [x + Math.cos(way) * far, y + Math.sin(way) * far];
      lines.push({ points: [[x, y], to], colour: [255, 226, 110], width: 0.003, dash: [0.02, 0.02] });
    }
    return {
      lines, rings: [{ x: met.x, y: met.y, ball: met.ball >= 0 ? 0 : undefined, alpha: 0.35 }],
      cue: { x: balls.x[0], y: balls.y[0], aim: wish.aim, pull: this.pulled ? 0.02 + this.pulled.pull : 0.045, elevation: this.elevation },
      met,
    };
  }
}

/** A first aim [rad] for a state: at the ball on with the widest pot, else at a reachable one, thinly while the pack is whole, so that Play alone is no foul;
 * `otherwise` if nothing is on. balls: as shown; names: of the balls by index. */
export function firstAim(state, balls, names, extent, R, otherwise) {
  const [cx, cy] = state.positions.cue, on = new Set(state.balls_on.map(name => names.indexOf(name)));
  const met = aim => firstContact(balls, 0, aim, extent, R).ball;
  const open = state.lines.filter(line => line.open && on.has(met(line.aim))).sort((a, b) => b.tolerance - a.tolerance)[0];
  if (open) return open.aim;
  const ways = [], packed = state.reds > PACK && on.size > PACK;
  for (const ball of on) {
    const x = balls.x[ball] - cx, y = balls.y[ball] - cy, far = Math.hypot(x, y), wide = Math.asin(Math.min(1, 2 * R / far));
    for (const offset of OFFSETS) {
      const aim = Math.atan2(y, x) + wide * offset, clear = met(aim) === ball;
      // a break off strikes an end red of the pack thinly; any other stroke the nearest ball, as full as it can
      const cost = packed ? 3 * (1 - Math.abs(offset)) - Math.abs(balls.x[ball]) : far + Math.abs(offset);
      ways.push({ aim, cost: cost + (clear ? 0 : 99) });
    }
  }
  return ways.sort((a, b) => a.cost - b.cost)[0]?.aim ?? otherwise;
}
