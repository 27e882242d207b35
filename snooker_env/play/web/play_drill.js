/**
 * What can one practise alone? Drills: tables set up again and again, strokes that are scored, and the best score, which this browser keeps.
 */

import { ask, by, kept, make } from "./play_parts.js";

const TRIES = 10;
const dealt = layout => () => ask("new", { layout, seed: Math.floor(Math.random() * 2 ** 48), game: "snooker" });
const open = state => state.lines.some(line => line.open);
const fair = stroke => !stroke.fouls.length;
const within = (low, high) => low + (high - low) * Math.random();

const DRILLS = {
  line_up: { name: "Line-up", about: "Clear the line: the points of one break", run: true, table: dealt("line_up"), score: stroke => stroke.points },
  long_pots: {
    name: "Long pots", about: "Ten reds from baulk: one point a pot", score: stroke => Number(stroke.points > 0),
    table: () => ask("position", { position: { cue: [within(-0.5, 0.5), within(-1.35, -1.1)], reds: [[within(-0.5, 0.5), within(0.1, 0.6)]], black: [0, 1.4605], on: "red" } }),
  },
  safeties: {
    name: "Safeties", about: "Ten safeties: one point if nothing can be potted, two for a snooker", table: dealt("safety"),
    score: (stroke, state) => (!fair(stroke) || stroke.points ? 0 : state.snookered ? 2 : Number(!open(state))),
  },
  escapes: { name: "Escapes", about: "Ten snookers: one point for each fair stroke", table: dealt("escape"), score: stroke => Number(fair(stroke)) },
};

export class Drills {
  constructor(app) {
    Object.assign(this, { app, now: null });
    by("drill-again").onclick = () => this.begin(this.now);
    by("drill-end").onclick = () => this.end();
    this.list();
  }

  list() {
    by("drill-list").replaceChildren(...Object.entries(DRILLS).map(([key, { name, about }]) => {
      const best = kept.get("best", {})[key], button = make("button", {}, name, make("small", { textContent: best === undefined ? about : `${about}. Best: ${best}` }));
      button.onclick = () => this.app.sure("Leave this frame for a drill?", name, () => this.begin(key));
      return button;
    }));
  }

  /** Go on with the drill of a page that was loaded anew. */
  resume() {
    if (this.app.state.practice) Object.assign(this, kept.get("drill", {}));
    if (this.now && !this.over && !DRILLS[this.now].run && this.app.state.strokes > this.counted) this.count(0);  // it was not seen to its end
    this.show();
  }

  async begin(key) {
    const { app } = this;
    this.before ??= app.state.practice || app.state.by_link ? null : { players: app.state.players, noise: app.state.noise, practice: false };
    Object.assign(this, { now: key, tries: 0, score: 0, over: false, dealing: true });  // no stroke on the table before
    by("drills").open = false;
    this.show();
    await app.try(() => ask("players", { players: ["person", "person"], practice: true }));
    await this.deal();
    app.compact();
  }

  async deal() {
    this.dealing = Boolean(this.now);  // no stroke on the table of the last try
    if (!this.dealing) return;
    await this.app.try(DRILLS[this.now].table);
    this.dealing = false;
    this.counted = this.app.state.strokes;
    this.show();
    this.app.settle();
  }

  async played(stroke) {
    const drill = DRILLS[this.now];
    if (!drill || this.over) return;
    const got = drill.score(stroke, this.app.state);
    if (got && drill.run) this.score = stroke.break;
    await this.count(got);
  }

  /** A try is over. */
  async count(got) {
    const drill = DRILLS[this.now];
    if (!drill.run) this.score += got;
    this.tries++;
    this.counted = this.app.state.strokes;
    this.over = drill.run ? !got || this.app.state.phase === "over" : this.tries === TRIES;
    if (this.over) {
      const best = kept.get("best", {});
      kept.set("best", { ...best, [this.now]: Math.max(best[this.now] ?? 0, this.score) });
      this.list();
    }
    this.show();
    if (!this.over && !drill.run) await this.deal();
  }

  async end() {
    await this.stop();
    this.app.begin();
  }

  /** There is no drill any more: whoever sat here before sits here again. */
  async stop() {
    const { before } = this;
    Object.assign(this, { now: null, before: null });
    this.show();
    if (before) await this.app.try(() => ask("players", before));
  }

  show() {
    const { now, before, counted, tries, score, over } = this;
    kept.set("drill", { now, before, counted, tries, score, over });
    by("drill").hidden = !now;
    if (!now) return;
    const { name, about, run } = DRILLS[now], best = kept.get("best", {})[now] ?? 0;
    const ends = `${name}${over || run ? "" : `, ${tries + 1} of ${TRIES}`}: ${score}${run && !over ? " points" : ""}. Best: ${best}.`;
    by("drill-words").textContent = over || tries ? ends : `${ends} ${about}.`;
  }
}
