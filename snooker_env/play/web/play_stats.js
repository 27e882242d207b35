/**
 * How well was the frame played? Counted from its strokes, and the time that each person took, against a shot clock if there is one.
 *
 * A stroke is a try at a pot if it potted, or if the ball that it struck first passed a pocket within `NEAR`; every other stroke is a safety, which
 * succeeds if it is fair and the next stroke of the other pots nothing.
 */

import { decode } from "./table.js";
import { ask, by, make, setting } from "./play_parts.js";

const NEAR = 0.16, STEP = 0.02;
const LIMITS = { off: "none", "15 s": "15 s", "25 s": "25 s", "40 s": "40 s" };

/** How near [m] the ball that a decoded stroke struck first came to a pocket. */
function nearest(stroke, falls) {
  const met = stroke.events.find(([, kind, i, j]) => kind === 0 && (i === 0 || j === 0));
  if (!met) return Infinity;
  const ball = met[2] || met[3];
  let least = Infinity;
  for (let t = met[0]; t < stroke.duration; t += STEP) {
    const { x, y, vx, vy } = stroke.at(t);
    for (const fall of falls) least = Math.min(least, Math.hypot(fall[0] - x[ball], fall[1] - y[ball]));
    if (!vx[ball] && !vy[ball]) break;
  }
  return least;
}

/** Counts of both players from a frame's strokes: {tries, pots, safeties, safe, visits, points, best, fouls}. */
export function counted(strokes, falls) {
  const counts = [0, 1].map(() => ({ tries: 0, pots: 0, safeties: 0, safe: 0, visits: 0, points: 0, best: 0, fouls: 0 }));
  strokes.forEach((stroke, k) => {
    const one = counts[stroke.player], next = strokes[k + 1], foul = stroke.fouls.length > 0;
    if (strokes[k - 1]?.player !== stroke.player) one.visits++;
    one.points += stroke.points;
    one.best = Math.max(one.best, stroke.break);
    one.fouls += foul;
    if (stroke.points || nearest(stroke, falls) < NEAR) { one.tries++; one.pots += stroke.points > 0; return; }
    one.safeties++;
    one.safe += !foul && !(next && next.player !== stroke.player && next.points);
  });
  return counts;
}

export class Stats {
  constructor(app) {
    this.app = app;
    this.times = new Map();  // of a person's stroke, by its number: seconds
    this.at = performance.now();
    by("stats-open").onclick = by("over-stats").onclick = () => this.open();
    setting("limit", LIMITS, "off", () => { this.from = this.spent; this.show(); });
    setInterval(() => this.show(), 200);
  }

  /** A stroke is asked of a person, or no longer; on another table the clock begins anew. */
  turn(asked) {
    const { aimed } = this.app;
    if (asked && aimed !== this.key) { this.key = aimed; this.spent = this.from = 0; }
    this.asked = asked;
    this.show();
  }

  played() {
    if (this.asked) this.times.set(this.app.state.strokes, this.spent);
  }

  /** The shot clock, which runs from its choice on; when it has run down, the stroke is played as it is aimed. */
  show() {
    const limit = parseInt(by("limit").value), clock = by("clock"), now = performance.now();
    if (this.asked && !document.querySelector("dialog[open], #tour:not([hidden])")) this.spent += (now - this.at) / 1000;
    this.at = now;
    clock.hidden = !limit || !this.asked || document.hidden;
    if (clock.hidden) return;
    const left = limit - this.spent + this.from;
    clock.textContent = Math.max(0, Math.ceil(left));
    clock.classList.toggle("late", left < 5);
    if (left <= 0) { this.app.aim.up(false); this.app.play(); }
  }

  async open() {
    const { app } = this, { labels } = app.state;
    const { strokes } = await ask("strokes");
    const decoded = strokes.length ? decode({ format: "snooker-replay", version: 2, R: app.R, spin_decel: app.spin_decel, strokes }).strokes : [];
    const counts = counted(decoded, app.scene.falls), share = (part, all) => (all ? `${Math.round(100 * part / all)} % (${part} of ${all})` : "–");
    const spent = [0, 1].map(seat => strokes.flatMap((one, k) => (one.player === seat && this.times.has(k) ? [this.times.get(k)] : [])));
    const rows = [
      ["pots", one => share(one.pots, one.tries)], ["safeties", one => share(one.safe, one.safeties)], ["points per visit", one => (one.visits ? (one.points / one.visits).toFixed(1) : "–")],
      ["highest break", one => one.best], ["fouls", one => one.fouls],
      ["time per stroke", (_, k) => (spent[k].length ? `${(spent[k].reduce((a, b) => a + b) / spent[k].length).toFixed(0)} s` : "–")],
    ];
    for (const k of [0, 1]) by(`stats-${k}`).textContent = labels[k];
    by("stats-rows").replaceChildren(...rows.map(([name, what]) => make("tr", {}, make("td", { textContent: name }), ...counts.map((one, k) => make("td", { textContent: what(one, k) })))));
    by("stats").showModal();
  }
}
