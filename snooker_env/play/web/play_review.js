/**
 * What did each stroke of the frame cost? The chance to win as a graph, both players' sums, and a list of strokes; of the chosen one its position, the
 * stroke as it was played and the best one on the table, which can be played again from there.
 */

import { ChanceGraph } from "./table.js";
import { ask, by, make } from "./play_parts.js";

/** How the stroke that was played and the best one are drawn. */
const INK = { played: { colour: "#ffffff", width: 0.005 }, best: { colour: "#ffd75e", width: 0.005, dash: [0.03, 0.02] } };
/** So many stand first; shares of the chance to win below this are sampling error. */
const FIRST = 3, LITTLE = 0.015;

const percent = share => `${Math.round(100 * share)}\u00a0%`.replace(/^-0/, "0").replace("-", "−");
const signed = share => `${share > 0 ? "+" : ""}${percent(share)}`;

export class Review {
  constructor(app) {
    Object.assign(this, { app, open: false, found: null, chosen: null, shown: null });
    by("review-open").onclick = by("over-review").onclick = () => this.begin();
    by("review-close").onclick = () => this.end();
    by("review-prev").onclick = () => this.step(-1);
    by("review-next").onclick = () => this.step(1);
    by("review-again").onclick = () => this.again();
  }

  /** Is there a review of this game? After "Play it again" it stands until as many strokes were played. */
  get kept() {
    const { begun, strokes } = this.app.state;
    return Boolean(this.found && !this.found.trouble) && begun === this.begun && (strokes < this.length || strokes === this.length && !this.left);
  }

  /** Ask for a review, unless there is one. */
  async begin() {
    const { app } = this, { begun, strokes } = app.state;
    app.still();
    app.held = true;
    this.open = true;
    this.choose(null);
    app.compact(false);
    app.fold(false);
    app.mode("review");
    by("panel").scrollTop = 0;
    by("review-close").focus({ preventScroll: true });
    if (this.kept) { this.show(); this.watch(); return; }
    Object.assign(this, { begun, length: strokes, left: false, found: null, line: null });
    this.show();
    try { this.take(await ask("review", {})); this.watch(); } catch (error) { this.trouble(error); }
  }

  /** Follow the review until it is done or closed. */
  async watch() {
    while (this.open && this.found.running) {
      await new Promise(done => setTimeout(done, 400));
      try {
        const found = await ask("reviewed", {});
        if (this.open) this.take(found);
      } catch (error) { this.trouble(error); return; }
    }
  }

  trouble(error) { this.found = { trouble: error.message }; this.show(); }

  take(found) { this.found = found; if (this.open) this.show(); }

  end(stop = true) {
    if (!this.open) return;
    this.open = false;
    const { app } = this;
    app.held = false;
    if (stop && this.found?.running) { this.found = null; ask("review", { stop: true }).catch(() => {}); }
    app.mode("play");
    app.catchUp();
    by("review-open").focus({ preventScroll: true });
  }

  /** The strokes in the order of the list: those that cost most, then the others as they were played. */
  get order() {
    const { strokes = [], costliest = [] } = this.found ?? {}, first = costliest.slice(0, FIRST);
    return [...first.map(number => strokes.find(one => one.number === number)), ...strokes.filter(one => !first.includes(one.number))];
  }

  show() {
    const { found, app } = this, { win_chance: chances, sides, done, total, running, trouble } = found ?? {};
    by("review-bar").hidden = !running;
    by("review-bar").max = total ?? 1;
    by("review-bar").value = done ?? 0;
    by("review-body").hidden = !sides;
    if (sides) {
      if (!this.line) this.graph([...found.concession ? chances : chances.slice(0, -1), found.result, found.result], chances.length - 1);
      const row = (name, className, ...said) => make("tr", { className }, make("td", { textContent: name }), ...said.map(textContent => make("td", { textContent })));
      const head = make("tr", {}, make("td"), ...app.state.labels.map(textContent => make("th", { scope: "col", textContent })));
      const rows = found.account.map(([name, whole]) => (["start", "end"].includes(name) ? row(name, "end", percent(whole / 100), percent(1 - whole / 100)) : row(name, "", signed(whole / 100), signed(-whole / 100))));
      if (found.adjusted !== null) {
        const share = Math.min(1, Math.max(0, found.adjusted));
        rows.push(row("end without luck", "", percent(share), percent(1 - share)));
      }
      by("review-sides").replaceChildren(head, ...rows);
      this.list();
    }
    this.say(trouble);
  }

  graph(chances, played) {
    const strokes = chances.slice(1).map(() => ({ duration: 1, words: "" })), { labels } = this.app.state;
    by("review-graph").replaceChildren();
    by("review-axis").textContent = `${labels[0]}: chance to win, by strokes`;
    this.line = new ChanceGraph(by("review-graph"), {
      total: strokes.length, starts: strokes.map((_, k) => k), strokes, replay: { win_chance: chances, luck: null, players: labels },
      strokeAt: at => Math.min(played - 1, Math.max(0, Math.floor(at))), skipTo: k => this.near(k + 1),
    });
  }

  list() {
    const list = by("review-list"), { order } = this, held = list.contains(document.activeElement) && document.activeElement.dataset.stroke;
    const { concession } = this.found, gave = Math.abs(concession) >= LITTLE;
    const end = make("li", { className: "gave" }, make("b", { textContent: percent(-Math.abs(concession)) }), `${this.app.state.labels[Number(concession > 0)]} conceded`,
      make("small", { textContent: `choice ${percent(Math.abs(concession))}: the chance to win that was given up` }));
    list.replaceChildren(...gave ? [end] : [], ...order.map((one, k) => {
      const cost = Math.max(0, one.choice) + Math.max(0, one.execution), parts = [["choice", one.choice], ["execution", one.execution]].filter(([, share]) => share >= LITTLE);
      const button = make("button", {}, make("b", { textContent: cost >= LITTLE ? percent(-cost) : "" }), `${one.number}. ${this.words(one.name)}`,
        make("small", { textContent: parts.map(([name, share]) => `${name} ${percent(share)}`).join(", ") || "nothing lost" }));
      button.dataset.stroke = one.number;
      button.setAttribute("aria-pressed", String(one.number === this.chosen));
      button.onclick = () => this.choose(one.number);
      return make("li", { className: k === FIRST ? "rest" : "" }, button);
    }));
    if (held) list.querySelector(`[data-stroke="${held}"]`)?.focus({ preventScroll: true });
  }

  words(text) { return text.replace(/ %/g, "\u00a0%"); }

  say(trouble) {
    const said = by("review-said"), one = this.order.find(({ number }) => number === this.chosen), { running } = this.found ?? { running: true };
    said.className = trouble ? "trouble" : "";
    const text = trouble || (one ? this.words(one.words) : running ? "Reviewing the strokes …" : "Choose a stroke: the costliest come first.");
    const dot = name => make("i", { className: name });
    said.replaceChildren(text[0].toUpperCase() + text.slice(1), ...one ? [make("small", {}, dot("played"), "as played", ...this.better ? [dot("best"), "the best"] : [], ...one.rough ? [" (first estimate)"] : [])] : []);
    for (const id of ["review-prev", "review-next"]) by(id).disabled = !this.order.length;
    by("review-again").disabled = !one || !this.shown;
  }

  /** Was there a better stroke than the chosen one? */
  get better() { return this.order.some(one => one.number === this.chosen && one.choice >= LITTLE); }

  /** The reviewed stroke nearest to this one in the frame. */
  near(number) {
    const all = (this.found.strokes ?? []).map(one => one.number);
    if (all.length) this.choose(all.reduce((a, b) => (Math.abs(b - number) < Math.abs(a - number) ? b : a)));
  }

  step(way) {
    const { order } = this, at = order.findIndex(({ number }) => number === this.chosen);
    this.choose(order[at < 0 ? 0 : (at + way + order.length) % order.length]?.number ?? null);
  }

  async choose(number) {
    this.chosen = number;
    this.shown = null;
    if (number !== null) {
      this.app.compact();
      this.line?.mark(number - 0.5);
      for (const button of by("review-list").querySelectorAll("button")) button.setAttribute("aria-pressed", String(button.dataset.stroke === String(number)));
      try {
        const shown = await ask("reviewed", { stroke: number });
        if (this.chosen !== number || !this.open) return;
        this.shown = shown;
        this.app.put(shown.table);
      } catch (error) { this.say(error.message); return; }
    }
    this.say();
    this.app.redraw();
  }

  /** Play from there: the game as it stood; what followed can be done again. */
  again() {
    const stroke = this.chosen;
    if (stroke === null) return;
    this.left = true;
    this.end(false);
    this.app.try(() => ask("again", { stroke }));
  }

  /** The stroke and a better one, for the drawing of the table. */
  overlay() {
    const lines = [], rings = [];
    for (const [name, ink] of Object.entries(INK)) if (name === "played" || this.better) for (const [ball, points] of Object.entries(this.shown?.[name]?.paths ?? {})) {
      lines.push({ points, ...ink });
      const [x, y] = points.at(-1);
      rings.push({ x, y, ball: Number(ball), alpha: name === "best" ? 0.6 : 0.3 });
    }
    return { lines, rings };
  }
}
