/**
 * What can one practise alone? Drills: one break, or ten tries that are scored, with what one's errors let expect; the best score, which this browser
 * keeps. The position of the day is dealt from the date, and so are its errors: everybody who plays the same stroke has the same luck.
 */

import { breakWords, many } from "./play_level.js";
import { ask, by, kept, make } from "./play_parts.js";

const TRIES = 10, POWER = 2, PINK = 0.89225, BLACK = 1.4605;
/** A first pot of the day may err by so much [rad], and is one of so many tables. */
const WIDE = 0.006, DEALS = 60;
const COLOURS = { yellow: [0.292, -1.0475], green: [-0.292, -1.0475], brown: [0, -1.0475], blue: [0, 0], pink: [0, PINK], black: [0, BLACK] };
const DOTS = ["🟡", "🟢", "🟤", "🔵", "🩷", "⚫"];

const draw = () => Math.floor(Math.random() * 2 ** 48);
const within = (low, high) => low + (high - low) * Math.random();
const side = () => Math.sign(Math.random() - 0.5);
const open = state => state.lines.some(line => line.open);
const fair = stroke => !stroke.fouls.length;
const potted = stroke => Number(fair(stroke) && stroke.points > 0);
const dealt = (layout, seed = draw()) => ask("new", { layout, seed, game: "snooker" });
const laid = (reds, colours = COLOURS) => ask("position", { position: { cue: [side() * within(0.2, 0.4), within(0.3, 0.6)], reds, ...colours, on: "red" } });
const both = (x, y) => [[x, y], [-x, y]];
const today = () => new Date().toISOString().slice(0, 10);

async function dealDay(date) {
  for (let k = 0; ; k++) {
    const state = await dealt("random:3", Number(date.replaceAll("-", "")) * DEALS + k);
    if (k === DEALS - 1 || state.lines.some(line => line.open && line.tolerance > WIDE)) return state;
  }
}

/** Of each: how its table is dealt, and `run` for one break, else the `score` of a try, `made` in words, and what `share` of a stroke's samples to expect. */
const DRILLS = {
  day: { name: "Position of the day", about: "The same for everybody: one break, with an amateur's mistakes", run: true, table: drills => dealDay(drills.date) },
  here: { name: "This position", about: "As the balls lie now, ten times", made: "made", table: ({ position }) => ask("position", position) },
  line_up: { name: "Line-up", about: "Reds on the middle line: one break", run: true, table: () => dealt("line_up") },
  tee: { name: "The T", about: "Ten reds in a T about the pink: one break", run: true, table: () => laid([0.12, 0.24, 0.36].flatMap(x => both(x, PINK)).concat([1, 2, 3, 4].map(k => [0, PINK + k * (BLACK - PINK) / 5]))) },
  cross: { name: "The X", about: "Nine reds in an X between pink and black: one break", run: true, table: () => laid([[0, 1.176], ...[0.09, 0.18].flatMap(d => [...both(d, 1.176 - d), ...both(d, 1.176 + d)])]) },
  colours: { name: "Clearing the colours", about: "All six from their spots: one break, 27 points clear the table", run: true, table: () => dealt("colours") },
  blue_black: { name: "Blue and black only", about: "Six reds, no other colour: one break", run: true, table: () => laid([...both(0.3, 0.35), ...both(0.45, 0.75), ...both(0.3, 1.15)], { blue: COLOURS.blue, black: COLOURS.black }) },
  long_pots: {
    name: "Long pots", about: "A red from baulk, ten times", made: "potted", score: potted, share: found => found.scored,
    table: () => ask("position", { position: { cue: [within(-0.5, 0.5), within(-1.35, -1.1)], reds: [[within(-0.5, 0.5), within(0.1, 0.6)]], black: [0, BLACK], on: "red" } }),
  },
  safeties: {
    name: "Safeties", about: "Ten safeties: a point if nothing can be potted, two for a snooker", points: true, table: () => dealt("safety"),
    score: (stroke, state) => (!fair(stroke) || stroke.points ? 0 : state.snookered ? 2 : Number(!open(state))),
  },
  escapes: { name: "Escapes", about: "Ten snookers: strike a ball on", made: "fair", score: stroke => Number(fair(stroke)), share: found => 1 - found.foul, table: () => dealt("escape") },
};
const KEPT = ["now", "before", "counted", "tries", "score", "over", "position", "expected", "weighed", "best", "said", "date", "balls"];

export class Drills {
  constructor(app) {
    Object.assign(this, { app, now: null, said: null });
    by("drill-again").onclick = () => this.begin(this.now);
    by("drill-end").onclick = () => this.end();
    by("drill-copy").onclick = async () => {
      const { name } = await ask("person", {}).catch(() => ({}));
      await navigator.clipboard.writeText(this.shared(name)).catch(() => {});
      by("drill-copy").textContent = "Copied";
    };
    this.list();
  }

  list() {
    by("drill-list").replaceChildren(...Object.entries(DRILLS).map(([key, { name, about }]) => {
      const best = key === "here" ? undefined : key === "day" ? this.first?.score : kept.get("best", {})[key];
      const said = best === undefined ? "" : key === "day" ? `. Yours today: ${best}` : `. Your best: ${best}`;
      const button = make("button", {}, name, make("small", { textContent: about + said }));
      button.onclick = () => (this.now ? this.begin(key) : this.app.sure("Discard this frame and begin a drill?", name, () => this.begin(key)));
      return button;
    }));
  }

  /** Is there a drill that is over, and was shown to its end? */
  get done() { return Boolean(this.now && this.over && !this.dealing && !this.app.behind); }

  /** The first try of today's position, which counts: {date, score, balls}. */
  get first() { const one = kept.get("day", {}); return one.date === today() ? one : undefined; }

  /** Go on with the drill of a page that was loaded anew. */
  resume() {
    if (this.app.state.practice) Object.assign(this, kept.get("drill", {}));
    if (this.now && !this.over && !DRILLS[this.now].run && this.app.state.strokes > this.counted) this.count(0);  // it was not seen to its end
    this.show();
  }

  async begin(key) {
    const { app } = this, { state } = app, own = state.noise[state.players[0] === "person" ? 0 : 1];
    if (key === "here" && this.now !== "here") {
      if (state.phase !== "stroke") { app.trouble(new Error("There is no stroke to play here.")); return; }
      const { cue, ...others } = state.positions, colours = Object.entries(others).filter(([name]) => !name.startsWith("red"));
      const reds = Object.entries(others).flatMap(([name, place]) => (name.startsWith("red") ? [place] : []));
      this.position = { position: { cue, reds, ...Object.fromEntries(colours), on: state.ball_on, in_hand: state.in_hand }, free_ball: state.free_ball };
    }
    if (!this.now) this.before = state.by_link ? null : { players: state.players, noise: state.noise, practice: state.practice, cue: state.cue };
    Object.assign(this, { now: key, tries: 0, score: 0, over: false, dealing: true, said: "", expected: 0, weighed: 0, best: null, date: today(), balls: "" });  // no stroke on the table before
    by("drills").open = false;
    this.show();
    const seated = { players: ["person", "person"], noise: [own, own], practice: true };
    await app.try(() => ask("players", key === "day" ? { ...seated, noise: ["amateur", "amateur"], cue: "real" } : seated));
    app.aim.set({ speed: POWER });
    await this.deal();
    app.compact();
  }

  async deal() {
    this.dealing = Boolean(this.now);  // no stroke on the table of the last try
    if (!this.dealing) return;
    const { app } = this;
    await app.try(() => DRILLS[this.now].table(this));
    this.dealing = false;
    this.counted = app.state.strokes;
    this.show();
    app.settle();
    if (this.now !== "here") return;
    if (this.tries) app.aim.set(this.struck ?? {});  // the last stroke, to be corrected
    else this.advised = ask("advise", { n: 1, noise: app.state.noise[0], revision: app.state.revision }).then(({ suggestions: [one] = [] }) => one, () => undefined);
  }

  /** Before a stroke: how often it succeeds with the errors of this seat, and in a repeated position what the best one makes. */
  async weigh(body) {
    const drill = DRILLS[this.now];
    if (!drill || drill.run || this.over || this.now === "safeties") return;
    if (this.now === "here" && !this.best) {
      const one = await this.advised;
      this.best = { chance: one?.chance ?? null, pot: one ? one.kind === "pot" : open(this.app.state) };
    }
    const { choice, nominate, ...stroke } = body, { side: x, top, aim, elevation } = body;
    this.struck = { side: x, top, aim, elevation };
    const found = await ask("destinations", stroke).catch(() => ({ stale: true }));
    if (found.stale) return;
    this.expected += (drill.share ?? (this.best.pot ? DRILLS.long_pots : DRILLS.escapes).share)(found);
    this.weighed++;
  }

  async played(stroke) {
    const drill = DRILLS[this.now];
    if (!drill || this.over) return;
    const score = drill.score ?? (this.best?.pot === false ? DRILLS.escapes.score : potted);
    const got = drill.run ? potted(stroke) && stroke.points : score(stroke, this.app.state);
    if (drill.run && got) { this.score = stroke.break; this.balls += stroke.pots.map(ball => (ball < 16 ? "🔴" : DOTS[ball - 16])).join(""); }
    this.said = drill.run ? null : `Try ${this.tries + 1} of ${TRIES}: ${stroke.words}`;
    await this.count(got);
  }

  /** A try is over. */
  async count(got) {
    const drill = DRILLS[this.now], { app } = this;
    if (!drill.run) this.score += got;
    this.tries++;
    this.counted = app.state.strokes;
    this.over = drill.run ? !got || app.state.phase === "over" : this.tries === TRIES;
    if (this.over) {
      if (this.now === "day" && !this.first && this.date === today()) kept.set("day", { date: this.date, score: this.score, balls: this.balls });
      const best = kept.get("best", {});
      kept.set("best", { ...best, [this.now]: Math.max(best[this.now] ?? 0, this.score) });
      this.list();
    }
    this.show();
    if (this.over) app.settle();
    else if (!drill.run) await this.deal();
  }

  async end() {
    await this.stop();
    this.app.begin();
  }

  /** There is no drill any more: whoever sat here before sits here again. */
  async stop() {
    const { before } = this;
    Object.assign(this, { now: null, before: null, said: null });
    this.show();
    if (before) await this.app.try(() => ask("players", before));
  }

  /** The result of the day in a line, for others. */
  shared(name) {
    const { date, score, balls } = this.first ?? this;
    return `Snooker, position of the day ${date}: ${name ? `${name} made ` : ""}${score} of 51 ${balls || "–"}`;
  }

  words() {
    const { now, tries, score, over, expected, weighed, best } = this, { name, about, run, made, points } = DRILLS[now], record = kept.get("best", {})[now];
    const yours = record === undefined || now === "here" ? "" : ` Your best is ${record}.`;
    if (run && over) {
      const how = score > 7 ? breakWords(score) : score ? many(score, "point") : "nothing potted";
      const counts = now !== "day" ? yours : this.first && this.first.score !== score ? ` Your first try counts: ${this.first.score} of 51.` : " That counts for today.";
      return `${name}: ${how}.${counts}`;
    }
    if (!tries) return `${name}. ${about}.${now === "day" && this.first ? ` You made ${this.first.score} today; this one is for practice.` : yours}`;
    if (run) return `${name}: ${score} so far.`;
    const advised = best?.chance != null ? `, ${(best.chance * tries).toFixed(1)} as advised` : "";
    const chance = weighed === tries ? ` Expected with these mistakes: ${expected.toFixed(1)} as you aimed${advised}.` : "";
    return `${name}: ${points ? `${many(score, "point")} in ${tries} ${tries === 1 ? "try" : "tries"}` : `${score} of ${tries} ${made}`}.${chance}${over ? yours : ""}`;
  }

  show() {
    kept.set("drill", Object.fromEntries(KEPT.map(name => [name, this[name]])));
    by("drill").hidden = !this.now;
    by("drill").classList.toggle("over", Boolean(this.over));
    by("drill-copy").hidden = !(this.now === "day" && this.over);
    by("drill-copy").textContent = "Copy the result";
    by("drill-again").hidden = Boolean(this.over);  // the large button says "Try again" then
    if (this.now) by("drill-words").textContent = by("drill-words").title = this.words();
  }
}
