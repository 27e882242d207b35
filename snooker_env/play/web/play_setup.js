/**
 * How is a position set up? Balls are dragged on the table and off it, and the server validates every change.
 */

import { ask, by, fill, intoD, Latest, make, ServerError } from "./play_parts.js";

/** How near a dropped ball snaps: to a spot [ball radii], to touch a cushion or a ball [m]. */
const SPOT = 0.8, NEAR = 0.008;
const ON = ["automatic", "red", "any_colour", "yellow", "green", "brown", "blue", "pink", "black"];

export class SetUp {
  constructor(app) {
    this.app = app;
    this.open = false;
    this.held = null;
    this.picked = -1;
    this.wrong = -1;
    this.check = new Latest("position", found => this.complain(found.error && new ServerError(found.error)), error => this.complain(error));
    const canvas = by("table");
    canvas.addEventListener("pointerdown", event => this.open && this.down(event));
    document.addEventListener("pointermove", event => this.held && this.move(event));
    for (const kind of ["pointerup", "pointercancel"]) document.addEventListener(kind, event => this.held && this.up(event));
    by("set").onclick = () => this.begin();
    by("set-cancel").onclick = () => this.end();
    by("set-done").onclick = () => this.done();
    by("set-clear").onclick = () => { this.keep(); this.balls.on.fill(0, 1, 16); by("set-on").value = ON[0]; this.changed(); };
    by("set-undo").onclick = () => this.undo();
    by("set-mirror").onclick = () => this.mirror();
    for (const id of ["set-on", "set-striker", "set-score-0", "set-score-1", "set-hand", "set-free"]) by(id).onchange = () => this.changed();
  }

  begin() {
    const { app } = this, { state, balls: { x, y, on } } = app;
    app.still();
    app.put(state);
    this.balls = { x: x.slice(), y: y.slice(), on: on.slice() };
    this.open = true;
    this.kept = [];
    app.compact(false);
    fill(by("set-on"), ON, state.ball_on ?? ON[0]);
    fill(by("set-striker"), ["0", "1"], String(state.striker), value => state.labels[Number(value)]);
    for (const k of [0, 1]) { by(`set-name-${k}`).textContent = state.labels[k]; by(`set-score-${k}`).value = state.scores[k]; }
    by("set-hand").checked = state.in_hand;
    by("set-free").checked = state.free_ball;
    app.mode("setup");
    this.changed();
  }

  /** Keep the balls as they are, for Undo. */
  keep() {
    const { x, y, on } = this.balls;
    this.kept.push({ balls: { x: x.slice(), y: y.slice(), on: on.slice() }, hand: by("set-hand").checked, wanted: by("set-on").value });
  }

  undo() {
    const last = this.kept.pop();
    if (!last) return;
    this.balls = last.balls;
    by("set-hand").checked = last.hand;
    by("set-on").value = last.wanted;
    this.changed();
  }

  /** Left for right; a colour on its own spot stays there. */
  mirror() {
    this.keep();
    const { x, y } = this.balls, { spots } = this.app.scene.lines;
    for (let i = 0; i < x.length; i++) if (i < 16 || Math.hypot(x[i] - spots[i - 16][0], y[i] - spots[i - 16][1]) > 1e-4) x[i] = -x[i];
    this.changed();
  }

  /** The place for a ball dropped at (x, y): a spot, frozen to a cushion or touching a ball, if that is near. */
  snap(ball, x, y) {
    const { scene: { extent, lines }, view: { R } } = this.app, { balls } = this, spot = lines?.spots.find(([sx, sy]) => Math.hypot(sx - x, sy - y) < SPOT * R);
    if (spot) return spot;
    const frozen = (value, [low, high]) => (Math.abs(value - low - R) < NEAR ? low + R : Math.abs(high - R - value) < NEAR ? high - R : Math.round(value * 1e4) / 1e4);
    [x, y] = [frozen(x, extent[0]), frozen(y, extent[1])];
    for (let i = 0; i < balls.x.length; i++) {
      const dx = x - balls.x[i], dy = y - balls.y[i], far = Math.hypot(dx, dy);
      if (i !== ball && balls.on[i] && Math.abs(far - 2 * R) < NEAR) return [balls.x[i] + dx * 2 * R / far, balls.y[i] + dy * 2 * R / far];
    }
    return [x, y];
  }

  end() {
    this.open = false;
    this.app.bubble("");
    this.app.mode("play");
  }

  /** The position in the format of the protocol; also records which ball each red in it is. */
  request() {
    const { x, y, on } = this.balls, position = { reds: [] };
    this.reds = [];
    for (let i = 0; i < on.length; i++) {
      if (!on[i]) continue;
      if (i > 0 && i < 16) { position.reds.push([x[i], y[i]]); this.reds.push(i); } else position[this.app.names[i]] = [x[i], y[i]];
    }
    if (by("set-on").value !== ON[0]) position.on = by("set-on").value;
    position.in_hand = by("set-hand").checked;
    const scores = [0, 1].map(k => {
      const score = by(`set-score-${k}`);
      return Number(score.value = Math.min(score.max, Math.max(0, Math.trunc(score.value))));
    });
    return { position, scores, striker: Number(by("set-striker").value), free_ball: by("set-free").checked };
  }

  changed() {
    this.tray();
    by("set-undo").disabled = !this.kept.length;
    this.check.ask({ ...this.request(), check: true });
    this.app.redraw();
  }

  async done() {
    try {
      const state = await ask("position", this.request());
      this.end();
      this.app.take(state);
    } catch (error) { this.complain(error); }
  }

  /** Show an error beside the ball that it is about. */
  complain(error) {
    if (!this.open) return;
    const red = /^reds\[(\d+)\]/.exec(error?.field ?? ""), named = this.app.names.indexOf((error?.field ?? "").replace(/\[.*/, ""));
    this.wrong = red ? this.reds[Number(red[1])] ?? -1 : named;
    const words = error ? this.plain(error) : "", beside = error && this.wrong >= 0 && this.balls.on[this.wrong];
    by("set-wrong").textContent = beside ? "" : words;
    by("set-done").disabled = Boolean(error);
    this.app.bubble(beside ? words : "", this.balls.x[this.wrong], this.balls.y[this.wrong]);
    this.app.redraw();
  }

  plain(error) {
    const called = name => (/^reds?\b/.test(name) ? "red" : name === "cue" ? "cue ball" : name.replaceAll("_", " ")), ball = called(error.field ?? "");
    const said = error.said ?? error.message, on = String(error.value ?? "").replace(/'/g, ""), other = /^overlaps ([a-z]+(\[\d+\])?) at/.exec(said)?.[1];
    if (/^overlaps the cushion/.test(said)) return `The ${ball} overlaps a cushion.`;
    if (/^overlaps jaw/.test(said)) return `The ${ball} overlaps the edge of a pocket.`;
    if (other) return ball === "red" && called(other) === "red" ? "Two reds overlap." : `The ${ball} overlaps the ${called(other)}.`;
    if (/must name balls of which one is on/.test(said)) return on === "red" ? "There is no red left to be on." : `The ${called(on)} is not on the table, so it cannot be on.`;
    if (/while reds are on/.test(said)) return `While there are reds, red or any colour is on, not the ${called(on)}.`;
    const lowest = /'any_colour' or '(\w+)', the lowest/.exec(said);
    if (lowest) return `Any colour, or the lowest on the table, the ${lowest[1]}, is on, not the ${called(on)}.`;
    if (/must be on the table while/.test(said)) return "The cue ball must be on the table.";
    if (/outside the D/.test(said)) return "A cue ball in hand must lie in the D.";
    return error.message.replace(/reds\[\d+\]/g, "red");
  }

  tray() {
    const { balls } = this.app.scene;
    by("tray").replaceChildren(...balls.flatMap((ball, i) => {
      if (this.balls.on[i] || i > 0 && i < 16 && this.balls.on.slice(1, i).some(on => !on)) return [];
      const many = i > 0 && i < 16 ? this.balls.on.slice(1, 16).filter(on => !on).length : 1;
      const made = make("button", { textContent: many > 1 ? many : "", title: i && i < 16 ? `red (${many} off the table)` : ball.name });
      made.setAttribute("aria-label", made.title);
      made.setAttribute("aria-pressed", String(this.picked === i));
      made.style.background = `rgb(${ball.rgb})`;
      made.onpointerdown = event => { this.picked = i; this.keep(); this.held = { ball: i }; made.releasePointerCapture?.(event.pointerId); };
      made.onclick = () => { this.picked = i; this.tray(); };
      return [made];
    }));
    if (!by("tray").children.length) by("tray").textContent = "Every ball is on the table.";
  }

  inside(x, y) {
    const [[x0, x1], [y0, y1]] = this.app.scene.extent, out = 0.06;
    return x > x0 - out && x < x1 + out && y > y0 - out && y < y1 + out;
  }

  down(event) {
    const [x, y] = this.app.aim.at(event), { balls } = this, reach = event.pointerType === "touch" ? 2.5 : 1.3;
    let best = reach * this.app.view.R, ball = -1;
    for (let i = 0; i < balls.x.length; i++) {
      const far = Math.hypot(balls.x[i] - x, balls.y[i] - y);
      if (balls.on[i] && far < best) { best = far; ball = i; }
    }
    if (ball >= 0) { this.keep(); this.held = { ball }; }
    else if (this.picked >= 0 && this.inside(x, y)) { this.keep(); this.held = { ball: this.picked }; this.move(event); }
    this.picked = -1;
    event.preventDefault();
  }

  move(event) {
    const { ball } = this.held, [x, y] = this.app.aim.at(event), over = document.elementFromPoint(event.clientX, event.clientY) === by("table");
    this.balls.on[ball] = Number(over && this.inside(x, y));
    if (this.balls.on[ball]) {
      const place = [this.balls.x[ball], this.balls.y[ball]] = this.snap(ball, x, y);
      if (ball === 0 && Math.hypot(...intoD(...place, this.app.scene.lines).map((value, k) => value - place[k])) > 1e-6) by("set-hand").checked = false;
      this.picked = -1;
      this.check.ask({ ...this.request(), check: true });
    }
    this.app.redraw();
  }

  up() {
    const { balls: { x, y, on }, held: { ball } } = this, last = this.kept.at(-1).balls;
    if (on[ball] === last.on[ball] && x[ball] === last.x[ball] && y[ball] === last.y[ball]) this.kept.pop();  // a mere tap
    this.held = null;
    this.changed();
  }
}
