/**
 * How does the page play? It shows the server's game, animates each stroke, and sends the player's strokes and decisions.
 *
 * One request always waits for the next state. Balls, score bar and words are drawn from one `table`: the one before a stroke while it moves, the one
 * after it until the next moves, then the state's. What may be done comes from the state.
 */

import { decode, showChance, TableView } from "./table.js";
import { Aim, firstAim } from "./play_aim.js";
import { Advisor } from "./play_ask.js";
import { Clock } from "./play_clock.js";
import { Door } from "./play_door.js";
import { Drills } from "./play_drill.js";
import { Friend } from "./play_friend.js";
import { breakWords, ending, helped, opponents } from "./play_level.js";
import { ask, by, confirmed, DOWN, fill, isPerson, keep, kept, Latest, make } from "./play_parts.js";
import { Person } from "./play_person.js";
import { Review } from "./play_review.js";
import { Room } from "./play_room.js";
import { SetUp } from "./play_setup.js";
import { Share } from "./play_share.js";
import { Sound } from "./play_sound.js";
import { Tour } from "./play_tour.js";

const OWN = "own", FINE = 30, POWER = 2.5;
/** Slow motion, time of a call [ms], how long an agent's cue is seen before its stroke [s]. */
const SLOW = 0.2, CALLED = 1600, AGENTS_LEAD = 1;
/** Keys that go on while they are held: after [ms], by so many steps [1/ms]. */
const STEPS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", ..."wsadeq"], HOLD = 300, RATE = 0.03;
/** The loupe at the first contact shows so much of the table [m]; it is shown where balls are smaller [CSS pixels], and what is about lies so many of its breadths off its corner. */
const LOUPE = 0.24, SMALL = 9, CLEAR = 1.5;
const LAYOUTS = {
  break_off: "break-off", opened: "opened pack", line_up: "line-up", colours: "colours only", snookered: "snookered", escape: "hard escape", safety: "safety battle",
  "random:3": "three reds anywhere", "random:6": "six reds anywhere", "random:10": "ten reds anywhere", "pots:easy": "one easy pot", "pots:medium": "one fair pot", "pots:hard": "one hard pot",
};
const CUES = { real: "can be blocked", free: "never blocked" };
/** What may be chosen after the foul of a player with this name. */
const CHOICES = { play: () => "Play the balls as they lie", play_again: who => `${who} plays again from here`, replace: who => `Put the balls back: ${who} plays again`, anywhere: () => "Put the cue ball anywhere" };
/** A phone shows the controls of the stroke alone unless asked for all. */
const PHONE = matchMedia("(orientation: portrait) and (max-width: 640px), (max-height: 480px) and (orientation: landscape)");

const seed = () => Math.floor(Math.random() * 2 ** 48);

class Page {
  constructor(facts) {
    Object.assign(this, facts);
    this.started = new Promise(done => { this.start = done; });
    this.names = this.scene.balls.map(ball => ball.name);
    this.state = this.table = null;
    this.balls = { x: new Float64Array(22), y: new Float64Array(22), on: new Uint8Array(22) };
    this.played = 0;
    this.known = new Map();
    this.moving = null;
    this.held = false;
    this.kind = "play";
    for (const [name, rgb] of Object.entries(this.scene.palette)) document.documentElement.style.setProperty(`--${name}`, `rgb(${rgb})`);
    this.view = new TableView(by("table"), this.scene, true);
    this.loupe = new TableView(by("loupe"), this.scene, true);
    this.placing = new Latest("place", ({ state }) => { this.chosen = state.revision; this.take(state); }, error => this.trouble(error));
    this.aim = new Aim(this, () => { this.advisor.changed(); this.room.changed(); this.redraw(); }, (x, y) => this.placing.ask({ place: [x, y] }));
    this.advisor = new Advisor(this);
    this.room = new Room(this);
    this.setup = new SetUp(this);
    this.review = new Review(this);
    this.sound = new Sound();
    this.clock = new Clock(this);
    this.drills = new Drills(this);
    this.share = new Share(this);
    this.friend = new Friend(this);
    new Person(this);
    PHONE.onchange = () => this.fold(PHONE.matches);
    this.compact();
    new ResizeObserver(() => this.fit()).observe(by("stage"));
    this.menu = opponents(this.levels, this.opponents, this.noise);
    this.door = new Door(this, this.menu);
    this.wire();
    this.tour = new Tour(this);
  }

  wire() {
    const act = (id, what) => { by(id).onclick = () => this.try(what); };
    by("play").onclick = () => this.play();
    by("skip").onclick = () => this.skip();
    by("turn").onclick = () => this.hurry();
    by("fold").onclick = () => this.fold();
    document.addEventListener("pointerdown", () => this.sound.wake());
    by("go").onclick = () => this.goOn();
    by("slow").onclick = () => this.again(SLOW);
    act("undo", () => ask("undo", {}));
    act("redo", () => ask("redo", {}));
    by("concede").onclick = async () => { if (await confirmed("Concede the frame?", "Concede")) this.try(() => ask("concede", {})); };
    by("new").onclick = () => this.sure(`Discard this frame and begin a new game? ${this.state.by_link ? "This one stays under “Games by link”." : "This cannot be undone."}`, "New game", () => this.begin());
    by("again").onclick = () => this.again();
    by("next").onclick = () => this.once(() => (this.state.by_link ? this.friend.begin() : this.go("new", { breaker: 1 - this.state.breaker, seed: seed() })));
    by("over-close").onclick = () => { this.seen = this.table; this.show(); };
    by("save").onclick = () => this.try(async () => { keep("snooker-game.txt", await this.share.link(), "text/plain"); });
    by("replay").onclick = () => this.try(async () => { keep("snooker-replay.html", (await ask("replay_page")).html, "text/html"); });
    by("load").onclick = () => by("file").click();
    by("file").onchange = () => this.try(async () => {
      const [file] = by("file").files;
      if (file) this.share.open(await file.text().finally(() => { by("file").value = ""; }));
    });
    by("labels").checked = kept.get("labels", false);
    by("labels").onchange = () => { kept.set("labels", by("labels").checked); this.redraw(); };
    fill(by("rules"), this.games);
    by("rules").onchange = () => fill(by("layout"), by("rules").value === "six_red" ? ["break_off", "colours"] : Object.keys(LAYOUTS), undefined, name => LAYOUTS[name]);
    by("rules").onchange();
    by("level").onchange = () => this.level();
    for (const k of [0, 1]) {
      fill(by(`who-${k}`), this.players);
      fill(by(`noise-${k}`), Object.keys(this.noise), undefined, name => this.noise[name]);
      by(`who-${k}`).onchange = () => this.seats(k);
      by(`noise-${k}`).onchange = () => this.seats();
    }
    by("practice").onchange = () => this.seats();
    fill(by("cue"), this.cues, undefined, kind => CUES[kind]);
    by("cue").onchange = () => this.seats();
    by("help-open").onclick = () => by("help").showModal();
    for (const one of document.querySelectorAll("#panel details")) one.ontoggle = () => {
      if (one.open) one.scrollIntoView({ block: "nearest" });
    };
    document.addEventListener("click", event => event.detail && event.target.closest("button, summary, [type=range]")?.blur());  // keys are for the stroke again
    document.addEventListener("keydown", event => this.key(event));
    document.addEventListener("keyup", event => { if (event.code === this.pressed?.code) this.pressed = null; });
    window.onblur = () => { this.pressed = null; };
  }

  fold(wanted) {
    const folded = by("panel").classList.toggle("folded", wanted);
    by("fold").setAttribute("aria-expanded", String(!folded));
    if (folded) by("panel").scrollTop = 0;
  }

  /** Let a phone show the table; `otherwise`: whether another screen folds. */
  compact(otherwise) { if (PHONE.matches || otherwise !== undefined) this.fold(PHONE.matches); }

  /** Fit the table to the screen. */
  fit() {
    this.view.resize();
    this.loupe.resize();
    this.redraw();
  }

  // ---- the server's answers

  /** Run a request that returns the next state; show the error if it is refused. */
  async try(what) {
    try {
      const found = await what();
      if (found?.revision !== undefined) this.take(found);
    } catch (error) { this.trouble(error); }
  }

  trouble(error) {
    by("last").textContent = error.message;
    by("last").className = "trouble";
  }

  async watch() {
    for (;;) {
      if (document.hidden) await new Promise(done => document.addEventListener("visibilitychange", done, { once: true })); // another tab is visible
      try {
        const down = by("last").textContent === DOWN, after = this.state?.revision;
        const state = await ask("state", undefined, this.state ? `?after=${after}&wait=${down ? 0 : 20}` : "");
        this.take(state);
        if (down) { by("last").className = ""; this.show(); }
      } catch (error) {
        this.trouble(error);
        await new Promise(done => setTimeout(done, 1000));
      }
    }
  }

  /** Use a state, if it is newer than the current one. */
  take(state) {
    if (this.state && state.revision <= this.state.revision) return;
    const first = this.state === null, fresh = state.begun !== this.state?.begun, [me, who] = state.players, errors = this.levels.find(({ name }) => name === who)?.noise;
    this.state = state;
    this.strength = me === "person" && who in this.menu && (errors ?? state.noise[1]) === state.noise[1] ? who : OWN;
    if (first) { this.put(state); this.drills.resume(); }
    if (fresh || state.strokes < this.played) { this.still(); this.clock.key = null; }
    if (fresh) this.review.end();
    if (fresh && !first) {
      this.played = state.by_link?.visit ?? 0;
      this.replay = state.strokes > 0;
      if (!this.drills.now) this.aim.set({ speed: POWER });
    }
    by("last").className = "";
    this.seated();
    this.catchUp();
    this.start();
  }

  /** Animate all strokes that have not been shown yet, one after the other. */
  async catchUp() {
    if (this.busy || this.review.open) return;
    this.busy = true;
    try { await this.showAll(); } catch (error) { this.played = this.state.strokes; this.trouble(error); }
    this.busy = false;
    if (this.replay) this.replay = this.hurried = false;
    this.settle();
    const { scored } = this;
    this.scored = null;
    if (scored) this.drills.played(scored);
  }

  async showAll() {
    while (this.played < this.state.strokes) {
      if (!this.known.has(this.played)) {
        const { strokes } = await ask("strokes", undefined, `?from=${this.played}`);
        strokes.forEach((stroke, k) => this.known.set(this.played + k, stroke));
      }
      const stroke = this.known.get(this.played), shown = ++this.played;
      this.known.delete(shown - 1);
      if (!stroke) { this.played = this.state.strokes; break; }
      if (!this.hurried) await this.move(stroke);
      if (shown !== this.played || this.setup.open) continue;
      this.call(stroke);
      if (this.drills.now && this.played === this.state.strokes) this.scored = stroke;
      if (this.played < this.state.strokes && !this.hurried) await new Promise(done => setTimeout(done, 500));
      const { state } = this;
      if (state.paused && !state.trouble && this.played >= state.strokes && this.agentsAlone && !this.held && !this.replay) await this.try(() => ask("go", {}));
    }
  }

  /** Do two agents play, with a stroke to come? The page lets them go on when the last one has been shown. */
  get agentsAlone() { return this.door.host && !this.state.players.some(isPerson) && this.state.phase !== "over"; }

  /** Has the frame ended, and been shown? */
  get ended() { return this.state?.phase === "over" && !this.behind && !this.drills.now && this.door.host; }

  /** Does the game wait for Continue? */
  get waits() { return this.agentsAlone && this.held || !this.behind && this.state.paused; }

  /** Are there strokes that have not been shown yet? */
  get behind() { return Boolean(this.moving || this.busy || this.played < this.state.strokes); }

  /** Show no motion until a person is asked. */
  hurry() { this.hurried = !by("turn").hidden; this.skip(); }

  goOn() {
    if (this.drills.done) { this.drills.begin(this.drills.now); return; }
    if (this.ended) { by("next").click(); return; }
    this.held = !this.waits;
    if (!this.held && this.state.paused && !this.behind) this.try(() => ask("go", {}));
    this.show();
  }

  /** Ask for confirmation before a frame with strokes is discarded that is not over. */
  async sure(question, yes, then) {
    if (!this.state?.strokes || this.state.phase === "over" || await confirmed(question, yes)) then();
  }

  begin() {
    this.go("new", { layout: by("layout").value, game: by("rules").value, seed: seed() });
    by("start").open = false;
    this.compact();
  }

  async go(name, body) {
    await this.drills.stop();
    this.held = false;
    await this.try(() => ask(name, body));
  }

  /** Show this table: the state, or one of a stroke. */
  put(table) {
    this.table = table;
    this.balls.on.fill(0);
    for (const [name, [x, y]] of Object.entries(table.positions)) {
      const i = this.names.indexOf(name);
      this.balls.x[i] = x; this.balls.y[i] = y; this.balls.on[i] = 1;
    }
    this.show();
    this.redraw();
  }

  /** Show the state, and set a first aim. */
  settle() {
    if (this.moving || this.busy || this.review.open) return;
    const { state } = this;
    if (state.phase === "over" || state.players[state.striker] === "person") this.hurried = false;
    this.put(state);
    if (this.settled !== state.revision) {
      const moved = JSON.stringify([state.positions, state.ball_on, state.striker, state.strokes]);
      if (moved !== this.lay || this.phase === "choice") this.firstAim(state, moved !== this.lay);
      else if (this.chosen === state.revision) this.advisor.changed();
      this.lay = moved;
      if (state.phase === "over") this.compact();
      this.phase = state.phase;
      this.settled = state.revision;
      this.friend.settled().catch(error => this.trouble(error));
      this.room.changed();
    }
    this.clock.turn(this.aiming);
  }

  /** Set a first aim on a new table; not while the player places the cue ball: then advice for its own place stays. */
  firstAim(state, moved) {
    const key = JSON.stringify([state.ball_on, state.striker, state.strokes, Object.entries(state.positions).filter(([name]) => name !== "cue")]);
    if (key === this.aimed && (this.placing.busy || this.chosen === state.revision || this.aim.held === "ball")) {
      this.advisor.placed();
      this.advisor.changed();
      return;
    }
    if (moved) this.advisor.clear();
    if (state.phase !== "stroke") return;
    this.aimed = key;
    const aim = firstAim(state, this.balls, this.names, this.scene.extent, this.view.R, this.aim.wish.aim);
    this.aim.set({ aim, side: 0, top: 0, elevation: 0 });
  }

  // ---- motion

  call({ points, fouls, penalty, words, break: run }) {
    if (!points && !fouls.length) return;
    const call = by("call");
    call.textContent = fouls.length ? words.split(/[.;]/)[0] : run > points ? `break ${run}` : `+${points}`;
    call.className = fouls.length ? "foul" : "";
    call.hidden = false;
    clearTimeout(this.called);
    this.called = setTimeout(() => call.hidden = true, CALLED);
  }

  /** Animate a stroke until the balls rest or it is skipped. */
  move(data, rate = 1) {
    const stroke = decode({ format: "snooker-replay", version: 2, R: this.R, spin_decel: this.spin_decel, strokes: [data] }).strokes[0];
    return new Promise(done => {
      this.moving = { stroke, rate, at: this.state.players[stroke.player] === "person" || rate < 1 ? -0.4 : -AGENTS_LEAD, now: null, done };
      if (this.state.players[stroke.player] === "person") this.compact();
      this.clock.turn(false);
      this.room.changed();
      this.put(data.tables[0]);
    });
  }

  skip() {
    if (!this.moving) return;
    const { done, stroke } = this.moving;
    this.moving = null;
    this.put(stroke.tables[1]);
    done();
  }

  still() {
    this.played = this.state.strokes;
    this.known.clear();
    this.skip();
  }

  async again(rate = 1) {
    if (!this.state.strokes || this.behind || this.setup.open) return;
    this.busy = true;
    this.compact();
    try { await this.move((await ask("strokes", undefined, `?from=${this.state.strokes - 1}`)).strokes[0], rate); } catch (error) { this.moving = null; this.trouble(error); }
    this.busy = false;
    this.catchUp();
  }

  // ---- the player

  get aiming() {
    const { state } = this;
    return Boolean(state) && !this.behind && !this.drills.dealing && !this.drills.done && this.kind === "play" && state.phase === "stroke" && state.players[state.striker] === "person";
  }

  /** Do what is meant for this table alone: a second tap before the answer is none. */
  async once(what) {
    if (this.sending) return;
    this.sending = true;
    try { await what(); } finally { this.sending = false; }
  }

  play() {
    if (this.aiming) this.once(async () => {
      by("play").disabled = true;
      const { speed, side, top, aim, elevation } = this.aim.wish;
      await this.placing.quiet();  // the last place of a drag makes a new revision
      const { state } = this, body = { revision: state.revision, speed, side, top, aim, elevation };
      if (state.in_hand) body.place = state.positions.cue;
      if (by("nominate").value && state.nominations.includes(by("nominate").value)) body.nominate = by("nominate").value;
      await this.drills.weigh(body);
      await this.send(body);
    });
  }

  async send(body) {
    try {
      const { stroke, state, stale } = await ask("stroke", body);
      if (stale) throw new Error("The table has changed. Check it and play again.");
      if (stroke) { this.known.set(state.strokes - 1, stroke); this.advisor.clear(); }
      this.take(state);
    } catch (error) { this.trouble(error); }
    this.show();
  }

  /** The errors of who sits down: a level's own, a professional's of other agents, of a person those given. */
  errors(who, own) { return this.levels.find(({ name }) => name === who)?.noise ?? (isPerson(who) ? own : "professional"); }

  /** Seat the chosen opponent; the person errs as before. */
  async level() {
    const who = by("level").value;  // read first: the end of a drill fills the list again
    if (!(who in this.menu)) return;
    await this.drills.stop();  // and gives the person's own errors back
    const { players, noise } = this.state, own = noise[players.indexOf("person")] ?? "amateur";
    await this.go("players", { players: ["person", who], noise: [own, this.errors(who, own)], practice: false });
  }

  /** Send the players, a new one with errors of its own. */
  seats(changed = -1) {
    if (changed >= 0) by(`noise-${changed}`).value = this.errors(by(`who-${changed}`).value, "amateur");
    const [players, noise] = ["who", "noise"].map(name => [0, 1].map(k => by(`${name}-${k}`).value));
    this.held = false;
    this.try(() => ask("players", { players, noise, practice: by("practice").checked, cue: by("cue").value }));
  }

  mode(kind) {
    this.kind = kind;
    if (kind === "play") this.compact();
    this.advisor.clear();
    this.show();
    this.settle();
  }

  key(event) {
    this.sound.wake();
    const tag = event.target.tagName, key = event.key.length === 1 ? event.key.toLowerCase() : event.key, { aim } = this;
    if (event.ctrlKey || event.metaKey || tag === "SELECT" || tag === "INPUT" && event.target.type !== "checkbox") {
      if (!(key === "Enter" && event.target.type === "range")) return;
    }
    if ((key === "Enter" || key === " ") && ["BUTTON", "SUMMARY"].includes(tag)) return;
    if (event.altKey && !key.startsWith("Arrow")) return;
    const turn = event.shiftKey ? 1 : event.altKey ? 0.01 : 0.1, push = event.shiftKey ? 0.5 : 0.1, tip = (x, y) => aim.tip(aim.wish.side + x, aim.wish.top + y);
    const acts = document.querySelector("dialog[open]") ? key === "?" ? { "?": () => by("help").close() } : {} : this.setup.open ? { Escape: () => this.setup.end(), u: () => this.setup.undo() } : this.review.open ? { Escape: () => this.review.end(), ArrowUp: () => this.review.step(-1), ArrowDown: () => this.review.step(1), Enter: () => this.review.again() } : {
      " ": () => (event.shiftKey ? this.hurry() : this.skip()), Escape: () => (aim.held === "cue" ? aim.up(false) : this.skip()), u: () => by("undo").click(), r: () => by("redo").click(), v: () => this.again(), b: () => this.again(SLOW),
      m: () => this.sound.flip(), "?": () => by("help").showModal(),
      ...(this.ended || this.drills.done) && { Enter: () => this.goOn() },
      ...this.aiming && {
        ArrowLeft: () => aim.turn(turn), ArrowRight: () => aim.turn(-turn), ArrowUp: () => aim.faster(push), ArrowDown: () => aim.faster(-push),
        w: () => tip(0, 0.05), s: () => tip(0, -0.05), a: () => tip(-0.05, 0), d: () => tip(0.05, 0), c: () => aim.set({ side: 0, top: 0 }),
        e: () => aim.raise(1), q: () => aim.raise(-1), Enter: () => this.play(),
      },
      ...!by("tour").hidden && { Enter: () => by("tour-next").click(), Escape: () => by("tour-skip").click() },
    };
    if (!acts[key]) return;
    event.preventDefault();
    if (event.repeat) return;  // once a press
    acts[key]();
    if (STEPS.includes(key)) this.hold(event.code, acts[key]);
  }

  /** Go on with what a held key does, by the time and not by how often its keyboard repeats it. */
  hold(code, act) {
    const pressed = this.pressed = { code }, begun = performance.now() + HOLD;
    let done = 0;
    const on = now => {
      if (this.pressed !== pressed || !this.aiming) return;
      for (; done < RATE * (now - begun); done++) act();
      requestAnimationFrame(on);
    };
    requestAnimationFrame(on);
  }

  // ---- what is shown

  /** Who sits at the table, as the server says it. */
  seated() {
    const { state } = this;
    for (const k of [0, 1]) {
      by(`who-${k}`).value = state.players[k];
      by(`noise-${k}`).value = state.noise[k];
      by(`side-${k}`).querySelector(".name").textContent = state.labels[k];
    }
    fill(by("level"), [...Object.keys(this.menu), OWN], this.strength, name => this.menu[name]?.short ?? name);
    by("level-about").textContent = this.menu[this.strength]?.about ?? "";
    const own = by("level").lastChild;
    own.hidden = this.strength !== OWN;
    own.textContent = state.by_link ? "as before this game by link" : `${state.labels[1]}, mistakes: ${this.noise[state.noise[1]]}`;
    fill(by("agent"), state.advisers);
    by("practice").checked = state.practice;
    by("side-1").style.visibility = state.practice ? "hidden" : "";
    by("cue").value = state.cue;
    this.show();
  }

  show() {
    const { state, table } = this, busy = this.behind, mine = this.aiming, review = this.review.open, setup = this.setup.open || review;
    for (const [id, hide] of [["setup", !this.setup.open], ["review", !review], ["stroke", setup], ["ask", setup], ["act", setup], ["game", setup], ["last", setup]]) by(id).hidden = hide;
    const who = state.labels[table.striker], on = table.ball_on?.replace("_", " ");
    by("asked").textContent = review ? "Review of the frame" : setup ? "Set up a position" : this.moving ? `${who === "You" ? "You’re" : `${who} is`} at the table; ${on} is on` : this.drills.done ? "The drill is over." : table.words;
    if (by("last").className !== "trouble") by("last").textContent = this.drills.said ?? table.last;
    by("asked").title = by("asked").textContent;
    by("last").title = by("last").textContent;
    const choosing = state.phase === "choice" && !busy && !setup && state.players[state.striker] === "person";
    by("choices").hidden = !choosing;
    if (choosing && by("choices").dataset.for !== String(state.revision)) {
      by("choices").dataset.for = state.revision;
      by("panel").scrollTop = 0;
      const wins = state.choice_wins, best = wins.indexOf(Math.max(...wins));
      by("choices").replaceChildren(...state.choices.map((choice, k) => {
        const button = make("button", { className: k === best ? "best" : "" }, choice === "play" && state.free_ball ? "Play, with a free ball" : CHOICES[choice](state.labels[1 - state.striker]), make("small", { textContent: wins[k] === null ? "" : `win ${Math.round(100 * wins[k])} %` }));
        button.dataset.choice = choice;
        button.onclick = () => this.once(() => this.send({ choice }));
        return button;
      }));
    }
    by("go").hidden = !this.ended && !this.waits && !this.agentsAlone && !this.drills.done;
    by("go").textContent = this.drills.done ? "Try again" : this.ended ? this.next : this.waits ? "Continue" : "Pause";
    by("play").disabled = !mine;
    by("stroke").classList.toggle("idle", !mine);
    by("skip").hidden = !this.moving;
    by("turn").hidden = !this.moving || !this.replay && (state.players[table.striker] === "person" || !state.players.includes("person"));
    by("play").hidden = this.door.show() || Boolean(this.moving) || choosing || !by("go").hidden;
    if (!mine) by("odds").textContent = "";
    by("advise").disabled = !mine && !choosing;
    by("aim-out").textContent = this.aim.words;
    by("undo").disabled = !state.undo || this.drills.now;
    by("redo").disabled = !state.redo || this.drills.now;
    by("set").disabled = this.drills.now || state.by_link;
    by("again").disabled = by("slow").disabled = !state.strokes || busy;
    by("replay").disabled = !state.strokes;
    by("review-open").disabled = state.practice || !state.strokes && !this.review.kept;
    by("concede").disabled = !mine && !choosing;
    const named = mine && state.nominations.length > 0;
    by("nominate-row").classList.toggle("idle", !named);
    by("nominate").disabled = !named;
    fill(by("nominate"), named ? ["", ...state.nominations] : [""], by("nominate").value, value => value || (named ? "first struck" : "–"));
    this.score(on);
    this.over(!setup && !this.moving);
  }

  score(on) {
    const { table } = this, dot = name => { const one = make("i"); one.style.background = `rgb(${this.scene.balls[this.names.indexOf(name)].rgb})`; return one; };
    const put = (id, ...parts) => by(id).replaceChildren(...parts);
    for (const k of [0, 1]) {
      by(`side-${k}`).querySelector("b").textContent = table.scores[k];
      by(`side-${k}`).classList.toggle("turn", table.striker === k && table.phase !== "over");
    }
    showChance(by("win"), table.win_chance, this.state.labels, ` with ${this.noise[this.state.level]} mistakes`);
    put("n-break", "break ", make("b", { textContent: table.break }));
    if (!on) put("n-on", "frame over");
    else {
      const dots = on === "red" ? ["red 1"] : this.names.includes(on) ? [on] : this.names.slice(16);
      put("n-on", "on ", ...dots.map(dot), make("b", { textContent: on + (table.free_ball ? " + free ball" : "") }));
    }
    put("n-reds", "reds ", make("b", { textContent: table.reds }));
    put("n-left", ...on ? ["left ", make("b", { textContent: table.available })] : []);
    put("n-aid", helped(this.drills.now ? { ...this.state, hints: [0, 0], undone: 0 } : this.state).join(", "));
    const left = Math.max(0, Math.ceil(table.time_left ?? 0));
    put("n-time", ...table.time_left === null ? [] : ["time ", make("b", { textContent: `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}` })]);
  }

  /** The end of the frame, with the score from the side of the only person, else of the first seat. */
  over(rest) {
    const { table: { phase, winner, scores, last }, state: { labels } } = this, me = labels[1] === "You" ? 1 : 0, best = Math.max(0, ...this.state.breaks[winner] ?? []);
    by("over").hidden = !rest || this.drills.now || phase !== "over" || this.seen === this.table;
    if (phase !== "over") return;
    by("over-who").textContent = `${labels[winner]} won the frame${best < FINE ? "" : ` with ${breakWords(best)}`}`;
    by("next").textContent = this.next;
    by("over-score").textContent = `${labels[me]} ${scores[me]} : ${scores[1 - me]} ${labels[1 - me]}`;
    by("over-last").textContent = ending(this.state, last, me);
  }

  get next() { return this.state.by_link ? "New game by link" : "Next frame"; }

  /** An error message beside a place on the table. */
  bubble(text, x, y) {
    const bubble = by("bubble");
    bubble.hidden = !text;
    if (!text) return;
    bubble.textContent = text;
    bubble.style.left = 0;
    const [px, py] = this.view.toScreen(x, y), box = by("stage").getBoundingClientRect();
    bubble.style.left = `${Math.max(4, Math.min(box.width - bubble.offsetWidth - 4, px + 18))}px`;
    bubble.style.top = `${Math.max(4, Math.min(box.height - bubble.offsetHeight - 4, py + 18))}px`;
  }

  /** Draw at the next frame. */
  redraw() {
    this.asked ??= requestAnimationFrame(now => { this.asked = null; this.draw(now); });
  }

  /** The first contact, larger, in the corner that is farthest from the stroke: where balls are small. */
  contact(frame, { x, y, ball, to }) {
    const { view, loupe, scene } = this, box = by("stage"), shown = ball >= 0 && !this.advisor.hover && view.R * view.scale / view.ratio < SMALL;
    by("loupe").hidden = !shown;
    if (!shown) return;
    const [px, py] = view.toScreen(x, y), [ix, iy] = view.toScreen(this.balls.x[0], this.balls.y[0]), { style } = by("loupe");
    const aim = this.aim.wish.aim, cue = view.toScreen(this.balls.x[0] - 0.5 * Math.cos(aim), this.balls.y[0] - 0.5 * Math.sin(aim)), busy = [[px, py], [ix, iy], cue, to ? view.toScreen(...to) : cue];
    const room = ([left, top]) => Math.min(...busy.map(([x_, y_]) => Math.hypot(x_ - left * box.clientWidth, y_ - top * box.clientHeight)));
    if (!this.corner || room(this.corner) < CLEAR * by("loupe").clientWidth) [this.corner] = [[0, 1], [1, 1], [0, 0], [1, 0]].sort((a, b) => room(b) - room(a));  // it stays until it is in the way
    const [left, top] = this.corner, edge = view.upright ? "13%" : "8px";  // beside an upright table it lies between two pockets
    Object.assign(style, { left: left ? "auto" : "8px", right: left ? "8px" : "auto", top: top ? "auto" : edge, bottom: top ? edge : "auto" });
    by("room").classList.toggle("up", Boolean(top));
    if (loupe.canvas.width < 2 || loupe.canvas.clientWidth * loupe.ratio !== loupe.canvas.width) loupe.resize();
    loupe.upright = view.upright;
    loupe.look(x, y, loupe.canvas.width / LOUPE);
    loupe.still ??= make("canvas", { width: loupe.canvas.width, height: loupe.canvas.height });
    const pen = loupe.still.getContext("2d");
    pen.fillStyle = loupe.ink.cloth;
    pen.fillRect(0, 0, loupe.still.width, loupe.still.height);
    const noses = scene.noses.map(points => ({ points, colour: scene.palette.nose, width: 0.006 }));
    loupe.draw({ ...frame, heat: [], cue: undefined, lines: [...noses, ...frame.lines], rings: frame.rings.map(one => ({ ...one, alpha: 0.5 })) });
  }

  draw(now) {
    const { moving } = this, labels = by("labels").checked;
    this.advisor.marks();
    if (moving) {
      const before = moving.at, { stroke } = moving;
      moving.at += (moving.now === null ? 0 : (now - moving.now) / 1000) * (before < 0 ? 1 : moving.rate);
      moving.now = now;
      this.sound.passed(stroke, before, moving.at, moving.rate ** 0.5);
      const t = Math.max(0, moving.at), frame = stroke.at(t);
      frame.labels = labels;
      frame.side = stroke.flies(t);
      frame.turns = Array.from({ length: stroke.n }, (_, ball) => (frame.on[ball] ? stroke.turn(ball, t) : undefined));
      if (t < 0.3 && stroke.cue) {
        const lead = Math.max(0, Math.min(1, moving.at / 0.4 + 1)), { cue } = stroke;
        const pull = t > 0 ? -Math.min(0.16, t * cue.speed * 0.4) : 0.02 + (0.02 + 0.02 * cue.speed) * Math.sin(Math.PI * lead);
        frame.cue = { x: stroke.first[0], y: stroke.first[1], aim: cue.aim, pull, elevation: cue.elevation, alpha: t > 0 ? 1 - t / 0.3 : 1 };
      }
      this.view.draw(frame);
      if (t >= stroke.duration + 0.3) this.skip();
      else this.redraw();
    } else if (this.setup.open) {
      const { balls, wrong } = this.setup, rings = wrong >= 0 && balls.on[wrong] ? [wrong] : [];
      const spots = this.scene.lines.spots.map(([x, y], k) => ({ x, y, ball: 16 + k, alpha: 0.12 }));
      this.view.draw({ x: balls.x, y: balls.y, on: balls.on, labels, highlight: rings, rings: spots });
    } else if (this.state) {
      const frame = { x: this.balls.x, y: this.balls.y, on: this.balls.on, labels, lines: [], rings: [], heat: [] };
      if (this.review.open) Object.assign(frame, this.review.overlay());
      if (this.aiming) {
        const own = this.aim.overlay(), asked = this.advisor.overlay();
        frame.heat = asked.heat;
        frame.lines = [...asked.lines, ...this.advisor.hover ? [] : own.lines];
        frame.rings = [...asked.rings, ...this.advisor.hover ? [] : own.rings];
        frame.cue = own.cue;
        this.contact(frame, own.met);
      } else by("loupe").hidden = true;
      this.view.draw(frame);
    }
    if (moving || this.setup.open) by("loupe").hidden = true;
  }
}

try {
  window.page = new Page(await ask("scene"));
  window.page.watch();
  window.page.share.fromAddress();
} catch (error) {
  by("asked").textContent = error.message;
}
