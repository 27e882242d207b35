/**
 * What does the advisor say, and where would the balls stop? Its list of strokes, and clouds of the stopping points of cue ball and object ball.
 */

import { numbers } from "./table.js";
import { ask, by, fill, Latest, make, setting } from "./play_parts.js";

const GUIDES = { line: "aim line", paths: "paths of the balls", spread: "paths, and where they stop" };
const CUE_CLOUD = [255, 255, 255], BALL_CLOUD = [255, 196, 60];
const CELL = 0.02;
const RAIL = 0.1;

/** Points as a smooth map: counts in cells, each spread over its neighbours. */
export function cloud(places, extent, rgb) {
  const [[x0, x1], [y0, y1]] = extent, nx = Math.ceil((x1 - x0) / CELL), ny = Math.ceil((y1 - y0) / CELL);
  let values = new Float32Array(nx * ny);
  for (let k = 0; k < places.length; k += 2) {
    const i = Math.floor((places[k] - x0) / CELL), j = Math.floor((places[k + 1] - y0) / CELL);
    if (i >= 0 && i < nx && j >= 0 && j < ny) values[j * nx + i]++;
  }
  for (const step of [1, nx, 1, nx]) {
    const spread = new Float32Array(nx * ny);
    for (let k = step; k < values.length - step; k++) spread[k] = 0.25 * (values[k - step] + values[k + step]) + 0.5 * values[k];
    values = spread;
  }
  return { x0, y0, cell: CELL, nx, ny, values, rgb };
}

const percent = share => `${Math.round(100 * share)} %`;

export class Advisor {
  constructor(app) {
    this.app = app;
    this.list = [];
    this.hover = null;
    this.found = null;
    this.wait = new Latest("destinations", (found, input) => this.take(found, input), error => this.wrong(error));
    by("pockets").replaceChildren(...app.pockets.map(({ name }) => make("span", { textContent: name })));
    setting("guide", GUIDES, "line", () => this.changed());
    by("advise").onclick = () => this.advise();
  }

  /** The table has changed: earlier advice no longer applies. */
  clear() {
    this.list = [];
    this.hover = this.found = null;
    this.wait.drop();
    by("advice").replaceChildren();
    by("advice-order").textContent = "";
    by("odds").textContent = "";
  }

  /** The cue ball in hand was moved: suggestions with their own place remain valid. */
  placed() {
    this.found = null;
    if (!this.list.every(one => one.place)) this.clear();
  }

  /** The pockets' names beside them, while there is advice that names them. */
  marks() {
    const marks = by("pockets"), { view, pockets, aiming } = this.app;
    marks.hidden = !(aiming && this.list.length);
    if (marks.hidden) return;
    pockets.forEach(({ x, y }, k) => {
      const [px, py] = view.upright ? view.toScreen(x * 0.76, y * 0.94) : view.toScreen(x + Math.sign(x) * RAIL, Math.abs(y) > 1 ? y - Math.sign(y) * 0.29 : 0.3);
      marks.children[k].className = pockets[k].key === (this.hover ?? this.taken)?.pocket ? "meant" : "";
      Object.assign(marks.children[k].style, { left: `${px}px`, top: `${py}px` });
    });
  }

  changed() {
    const { app } = this;
    if (!app.aiming || by("guide").value === "line") { this.found = null; this.wait.drop(); this.say(); app.redraw(); return; }
    this.question(app.aim.wish, true);
  }

  question(wish, own) {
    const { state } = this.app, body = { speed: wish.speed, side: wish.side, top: wish.top, aim: wish.aim, elevation: wish.elevation, revision: state.revision };
    if (state.in_hand && wish.place) body.place = wish.place;
    if (this.hover) body.noise = this.noise;
    this.wait.ask(body, { revision: state.revision, own });
  }

  take(found, input) {
    const { app } = this;
    if (found.stale || input.revision !== app.state.revision || !app.aiming || input.own && this.hover) return;
    const spread = by("guide").value === "spread" || this.hover;
    found.heat = spread ? [cloud(numbers(found.ball, Float32Array), app.scene.extent, BALL_CLOUD), cloud(numbers(found.cue, Float32Array), app.scene.extent, CUE_CLOUD)] : [];
    this.found = found;
    this.say();
    app.redraw();
  }

  wrong(error) {
    this.found = null;
    by("odds").textContent = error.message;
  }

  say() {
    const odds = by("odds"), { found } = this;
    odds.hidden = by("guide").value === "line";
    odds.replaceChildren();
    if (!found) return;
    const dot = rgb => { const one = make("i"); one.style.background = `rgb(${rgb})`; return one; };
    odds.append(dot(CUE_CLOUD), "cue ball");
    if (found.first) {
      odds.append(" ", dot(BALL_CLOUD), `${found.first.replace(/ \d+$/, "")}: potted ${Math.round(100 * found.potted)} %`);
    } else odds.append(": strikes no ball");
    for (const [words, share] of [["foul", found.foul], ["in-off", found.in_off]]) {
      if (Math.round(100 * share)) odds.append(", ", make("span", { className: share > 0.5 ? "trouble" : "", textContent: `${words} ${Math.round(100 * share)} %` }));
    }
  }

  async advise() {
    const button = by("advise"), { app } = this, { revision } = app.state;
    button.disabled = true;
    button.textContent = "Hint …";
    try {
      const found = await ask("advise", { agent: by("agent").value, n: 5, revision });
      if (found.suggestions && revision === app.state.revision) {
        this.noise = found.noise;
        if (!app.state.practice) app.state.hints[app.state.striker]++;  // as the server does
        this.show(found);
      }
    } catch (error) {
      by("advice").replaceChildren(make("li", { className: "trouble", textContent: error.message }));
    }
    button.disabled = false;
    button.textContent = "Hint";
    app.show();
  }

  show({ order, suggestions }) {
    this.list = suggestions;
    this.taken = null;
    const items = suggestions.map((one, k) => {
      const [low, high] = (one.win_interval ?? one.chance_interval).map(value => Math.round(100 * value));
      const [least, most] = one.points_interval.map(value => value.toFixed(1));
      const visit = one.kind === "pot" ? `points ${least} to ${most}` : `fair ${low} to ${high} %`;
      const range = one.win_interval ? `win chance ${low} to ${high} %` : visit;
      const [what, ...how] = one.words.split("; ")[0].split(", "), told = this.told(one, what, how);
      const button = make("button", { title: `${range} (95 % interval)` }, make("b", { textContent: told.figure }), told.what, make("small", { textContent: told.how }));
      button.setAttribute("aria-pressed", "false");
      button.onpointerenter = event => event.pointerType === "mouse" && this.preview(k);
      button.onfocus = () => this.preview(k);
      button.onpointerleave = event => event.pointerType === "mouse" && this.preview(-1);
      button.onblur = () => this.preview(-1);
      button.onclick = () => this.adopt(k);
      return make("li", {}, button);
    });
    by("advice").replaceChildren(...items);
    const said = order.replace("errors", "mistakes");
    by("advice-order").textContent = this.app.state.phase === "choice" ? `If you play, ${said[0].toLowerCase()}${said.slice(1)}` : said;
    by("advice").scrollIntoView({ block: "nearest" });
    this.app.redraw();
  }

  told(one, what, how) {
    const pocket = one.kind === "pot" ? ` to ${how.shift()}` : "", figure = one.win ?? null;
    const points = `${one.points.toFixed(1)} points`, chance = word => /^(pot|fair) /.test(word);
    return {
      what: `${what[0].toUpperCase()}${what.slice(1)}${pocket}`, how: [...how.filter(chance), ...how.filter(word => !chance(word))].join(", "),
      figure: figure !== null ? `win ${percent(figure)}` : one.kind === "pot" ? points : `fair ${percent(one.chance)}`,
    };
  }

  /** Show a suggestion and its clouds; -1: the player's stroke again. */
  preview(k) {
    const one = this.list[k] ?? null;
    if (one === this.hover) return;
    this.hover = one;
    this.found = null;
    if (one && this.app.aiming) this.question(one, false);
    else this.changed();
    this.app.redraw();
  }

  /** Take over the stroke of a suggestion. */
  adopt(k) {
    const one = this.list[k], { app } = this;
    by("advice").querySelectorAll("button").forEach((button, j) => button.setAttribute("aria-pressed", String(j === k)));
    this.hover = null;
    this.taken = one;
    if (one.place && app.state.in_hand) {
      [app.balls.x[0], app.balls.y[0]] = one.place;
      app.aim.place(...one.place);
    }
    app.compact();
    by("play").focus();
    app.aim.set({ speed: one.speed, side: one.side, top: one.top, aim: one.aim, elevation: one.elevation });
  }

  /** Drawing of the advice. */
  overlay() {
    const out = { heat: this.found?.heat ?? [], lines: [], rings: [] }, { balls } = this.app.scene;
    const tint = ball => balls[ball].rgb.map(value => Math.round(value + (255 - value) / 3));
    const draw = (paths, width, alpha) => {
      for (const [ball, points] of Object.entries(paths ?? {})) out.lines.push({ points, colour: `rgba(${tint(Number(ball))},${alpha})`, width });
    };
    if (this.hover) {
      draw(this.hover.paths, 0.006, 1);
      for (const [ball, points] of Object.entries(this.hover.paths)) out.rings.push({ x: points.at(-1)[0], y: points.at(-1)[1], ball: Number(ball), alpha: 0.35 });
    } else {
      if (!this.taken) for (const one of this.list) draw(one.paths, 0.0025, 0.4);
      draw(this.found?.paths, 0.004, 0.9);
    }
    return out;
  }
}
