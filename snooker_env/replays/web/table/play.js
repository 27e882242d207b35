/** How does a replay play? A `Player` fills an element with the table, a score bar, time and buttons, and has the page's keys. */

/** Words for events, by kind; a kind without is no stop for a step. */
const EVENTS = [
  "strikes",
  "meets a cushion",
  "meets the edge of a pocket",
  "is potted",
  "begins to roll",
  "comes to rest",
  "drops",
  "comes back",
];
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];
/** Seconds shown before a stroke and after it. */
const LEAD = 0.9;
const PAUSE = 1.4;
/** Key, what it does, its button's icon or word (none: no button), method, argument. */
const COMMANDS = [
  ["Shift+←", "previous stroke", "back", "skip", -1],
  ["←", "previous event", "last", "step", -1],
  ["Space", "play or pause", "play", "toggle"],
  ["→", "next event", "next", "step", 1],
  ["Shift+→", "next stroke", "on", "skip", 1],
  ["↓", "slower", "−", "faster", -1],
  ["↑", "faster", "+", "faster", 1],
  ["p", "paths, dashed where a ball slides", "paths", "flip", "paths"],
  ["g", "cue ball where it met others", "ghosts", "flip", "ghosts"],
  ["s", "spots that show spin", "spin", "flip", "spin"],
  ["l", "letters on balls", "labels", "flip", "labels"],
  ["Home", "first moment", "", "seekTotal", 0],
  ["End", "last moment", "", "seekTotal", Infinity],
  ["?", "help", "?", "help"],
  ["Esc", "close this", "", "help", true],
];
/** Names of keys above. */
const NAMES = { " ": "Space", Escape: "Esc", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓" };
const ICONS = {
  play: "M7 4v16l13-8z",
  pause: "M6 4h4v16H6zM14 4h4v16h-4z",
  on: "M4 5l8 7-8 7zM12 5l8 7-8 7z",
  next: "M9 5l8 7-8 7z",
  back: "M20 5l-8 7 8 7zM12 5l-8 7 8 7z",
  last: "M15 5l-8 7 8 7z",
};
/** The most dots of pots in a score bar, and marks of strokes on the bar of time. */
const MOST_DOTS = 12;
const MOST_MARKS = 200;

const put = (parent, tag) => parent.appendChild(document.createElement(tag));

const setAll = (element, attributes) => {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
};

/** The player's elements; `STYLE` is the text of player.css. */
const page = (players, total, judged) => {
  const who = '<div class="sn-who"><span></span><b></b></div>';
  const parts = [who, '<div class="sn-now"></div>', who].slice(0, players.length + 1);
  return `<style>${STYLE}</style>
    <div class="sn-stage"><canvas></canvas></div>
    ${players.length ? `<div class="sn-score">${parts.join("")}</div>` : ""}
    ${judged ? '<div class="sn-win"></div><div class="sn-graph"></div>' : ""}
    <div class="sn-bar" role="slider" tabindex="0" aria-label="time" aria-valuemin="0" aria-valuemax="${total}">
      <div></div><div></div><b></b></div>
    <div class="sn-foot">
      <div class="sn-about"><canvas></canvas><span></span></div>
      <div class="sn-keys"></div>
      <div class="sn-words" aria-live="polite"></div>
    </div>
    <table class="sn-help" hidden></table>`;
};

export class Player {
  constructor(element, replay) {
    const data = decode(replay);
    const { strokes } = data;
    if (!strokes.length) throw new Error("a replay must hold at least one stroke");
    const show = { paths: !data.players.length, ghosts: true, spin: "cue", labels: false };
    Object.assign(this, { replay: data, strokes, speed: 1, show, k: 0, playing: false });
    this.leads = strokes.map(stroke => (stroke.cue ? LEAD : 0));
    this.t = -this.leads[0]; // the time within the stroke [s], below 0 before it
    this.total = -PAUSE;
    this.starts = strokes.map((stroke, k) => { // on the scale of the whole replay
      this.total += this.leads[k] + stroke.duration + PAUSE;
      return this.total - stroke.duration;
    });
    this.build(element);
    this.tick = this.tick.bind(this);
    const watch = new ResizeObserver(() => {
      this.turn();
      this.view.resize();
      this.update();
    });
    watch.observe(this.canvas);
    watch.observe(this.root);
    this.update();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) this.play();
  }

  /** Let the table stand where the page does. */
  turn() {
    const { root: { clientWidth, clientHeight }, ratio } = this;
    const tall = clientHeight > 1.2 * clientWidth;
    this.canvas.parentElement.style.aspectRatio = tall ? 1 / ratio : ratio;
  }

  get isLast() {
    return this.k === this.strokes.length - 1;
  }

  build(element) {
    const { scene, players, title, win_chance } = this.replay;
    const root = (this.root = put(element, "div"));
    const [wide, high] = TableView.size(scene);
    setAll(root, { class: "sn", tabindex: 0, role: "group", "aria-label": title || "replay" });
    this.ratio = wide / high;
    root.innerHTML = page(players, this.total.toFixed(1), win_chance);
    [this.canvas, this.tip] = root.querySelectorAll("canvas");
    this.canvas.onclick = () => this.toggle();
    this.turn();
    this.view = new TableView(this.canvas, scene, true);
    for (const name in this.view.ink) root.style.setProperty(`--${name}`, this.view.ink[name]);
    this.who = [...root.querySelectorAll(".sn-who")];
    this.who.forEach((one, k) => {
      one.firstChild.textContent = players[k];
    });
    this.graph = win_chance && new ChanceGraph(this.part("graph"), this);
    this.buildBar();
    this.buildButtons();
    document.addEventListener("keydown", event => this.key(event));
  }

  /** The bar of time, with a mark for each stroke. */
  buildBar() {
    const bar = (this.bar = this.part("bar"));
    [, this.done, this.thumb] = bar.children;
    const every = ceil(this.strokes.length / MOST_MARKS);
    this.starts.forEach((start, k) => {
      if (k % every === 0) put(bar, "u").style.left = `${100 * (start - this.leads[k]) / this.total}%`;
    });
    const drag = event => {
      const share = (event.clientX - bar.getBoundingClientRect().left) / bar.clientWidth;
      this.seekTotal(share * this.total);
    };
    bar.onpointerdown = event => {
      this.pause();
      bar.setPointerCapture(event.pointerId);
      drag(event);
    };
    bar.onpointermove = event => {
      if (bar.hasPointerCapture(event.pointerId)) drag(event);
    };
  }

  /** A row of help for each command, and a button where it has one. */
  buildButtons() {
    const sheet = this.part("help");
    const keys = this.part("keys");
    let pace;
    sheet.onclick = () => this.help();
    this.buttons = {};
    for (const [key, what, shows, act, way] of COMMANDS) {
      const row = put(sheet, "tr");
      put(row, "td").textContent = key;
      put(row, "td").textContent = what;
      if (!shows) continue;
      if (shows === "−") pace = put(keys, "span"); // slower and faster stay on one row
      const button = (this.buttons[shows] = put(act === "faster" ? pace : keys, "button"));
      setAll(button, { type: "button", title: `${what} (${key})`, "aria-label": what });
      if (ICONS[shows]) this.icon(button, shows);
      else button.textContent = shows;
      if (shows === "−") this.pace = put(pace, "output");
      button.onclick = () => this[act](way);
    }
  }

  part(name) {
    return this.root.querySelector(`.sn-${name}`);
  }

  icon(button, name) {
    button.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${ICONS[name]}"/></svg>`;
  }

  key(event) {
    const { target, shiftKey, key } = event;
    const named = NAMES[key] ?? (key.length > 1 ? key : key.toLowerCase());
    const wanted = shiftKey && key.startsWith("Arrow") ? `Shift+${named}` : named;
    const command = COMMANDS.find(([one]) => one === wanted);
    if (!command || event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName)) return;
    if (named === "Space" && target.tagName === "BUTTON") return; // for that button
    if (named === "Esc" && this.part("help").hidden) return; // for others
    this[command[3]](command[4]);
    event.preventDefault();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  help(hide) {
    this.part("help").toggleAttribute("hidden", hide);
  }

  faster(way) {
    const next =
      way > 0 ? SPEEDS.find(speed => speed > this.speed) : SPEEDS.findLast(speed => speed < this.speed);
    this.speed = next ?? this.speed;
    this.update();
  }

  /** Switch paths, ghosts or labels, or go on to the next choice of spin. */
  flip(name) {
    const next = { cue: "all", all: "off", off: "cue" };
    this.show[name] = name === "spin" ? next[this.show.spin] : !this.show[name];
    this.update();
  }

  play() {
    if (this.isLast && this.t >= this.strokes[this.k].duration) this.seekTotal(0);
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
    this.k = min(this.strokes.length - 1, max(0, stroke));
    this.t = min(this.strokes[this.k].duration + (this.isLast ? 0 : PAUSE), max(-this.leads[this.k], t));
    this.update();
  }

  /** The stroke at a time of the whole replay [s]. */
  strokeAt(sum) {
    return max(0, this.starts.findLastIndex((start, j) => start - this.leads[j] <= sum));
  }

  /** Show a time of the whole replay [s]. */
  seekTotal(sum) {
    const k = this.strokeAt(sum);
    this.seek(k, sum - this.starts[k]);
  }

  /** Show the beginning of a stroke; past the last one the end. */
  skipTo(k) {
    this.seek(k, k < this.strokes.length ? -LEAD : Infinity);
  }

  /** On by a stroke, or back, first to the start of this one. */
  skip(way) {
    this.skipTo(this.k + (way < 0 && this.t > 0.5 ? 0 : way));
  }

  /** Stop at the next event (+1) or the one before (-1). */
  step(way) {
    this.pause();
    const { events, duration } = this.strokes[this.k];
    const times = events.filter(event => EVENTS[event[1]]).map(event => event[0]);
    const stops = [0, ...times, duration];
    const next =
      way > 0 ? stops.find(t => t > this.t + 1e-8) : stops.findLast(t => t < this.t - 1e-8);
    if (next !== undefined) this.seek(this.k, next);
    else if (this.strokes[this.k + way]) this.seek(this.k + way, way > 0 ? 0 : Infinity);
  }

  tick(now) {
    this.waiting = null;
    if (!this.playing) return;
    const { duration } = this.strokes[this.k];
    const end = duration + (this.isLast ? 0 : PAUSE);
    const rests = this.t < 0 || this.t >= duration;
    const passed = min(0.1, (now - (this.clock ?? now)) / 1000);
    const t = this.t + passed * (rests ? max(1, this.speed) : this.speed);
    this.clock = now;
    if (this.isLast && t >= end) this.playing = false;
    if (this.isLast || t < end) this.seek(this.k, t);
    else this.seek(this.k + 1, -LEAD);
    if (this.playing) this.waiting = requestAnimationFrame(this.tick);
  }

  /** What is drawn now, as `TableView.draw` takes it. */
  frame() {
    const { t, show } = this;
    const stroke = this.strokes[this.k];
    const over = t > stroke.duration + PAUSE / 2 && stroke.later; // balls are where the referee has put them
    const frame = over ? { ...stroke.later } : stroke.at(t);
    frame.labels = show.labels;
    frame.side = !over && stroke.flies(t);
    if (show.spin !== "off") {
      const length = show.spin === "cue" ? 1 : stroke.n;
      frame.turns = Array.from({ length }, (_, ball) => stroke.turn(ball, t));
    }
    if (over) return frame;
    if (show.paths && t > 0) frame.lines = this.paths(stroke);
    if (show.ghosts) frame.rings = this.ghosts(stroke);
    if (stroke.cue && t < 0.35) frame.cue = this.cue(stroke);
    return frame;
  }

  /** The balls' paths so far, dashed where they slide. */
  paths(stroke) {
    return stroke.logs.flatMap((log, ball) => {
      if (!log.length) return [];
      const slide = new Path2D();
      const roll = new Path2D();
      const colour = mix(this.replay.scene.balls[ball].rgb, WHITE, 1 / 3);
      stroke.trace(ball, this.t, slide, roll);
      return [{ path: roll, colour }, { path: slide, colour: mix(colour, WHITE, 0.3), dash: [0.012, 0.022] }];
    });
  }

  /** The cue ball where it met others. */
  ghosts(stroke) {
    stroke.met ??= stroke.events
      .filter(([, kind, i, j]) => kind === BALL_BALL && !(i && j))
      .map(([at]) => {
        const { x, y } = stroke.at(at);
        return { x: x[0], y: y[0], at, ball: 0, alpha: 0.3 };
      });
    return stroke.met.filter(ring => ring.at < this.t);
  }

  /** The cue: at the ball, drawn back, through the ball, away. */
  cue(stroke) {
    const { t } = this;
    const { speed, aim, elevation } = stroke.cue;
    const before = t < 0;
    const back = 0.02 + (0.06 + 0.02 * min(5, speed)) * sin(PI * (-t / LEAD) ** 0.6);
    const pull = before ? min(back, -t) : -min(0.16, 0.4 * t * speed);
    const alpha = before ? 1 : 1 - t / 0.35;
    return { x: stroke.first[0], y: stroke.first[1], aim, elevation, pull, alpha };
  }

  update() {
    const sum = this.starts[this.k] + this.t;
    this.shown = this.frame();
    this.view.draw(this.shown);
    this.done.style.width = this.thumb.style.left = `${100 * sum / this.total}%`;
    this.bar.setAttribute("aria-valuenow", sum.toFixed(1));
    this.graph?.mark(sum);
    this.write();
  }

  /** Update words and buttons if they have changed. */
  write() {
    const { k, playing, speed, show, t } = this;
    const { scene, title } = this.replay;
    const stroke = this.strokes[k];
    const { cue } = stroke;
    const over = t >= stroke.duration;
    const event = !playing && stroke.events.findLast(one => one[0] === t && EVENTS[one[1]]);
    const reds = this.shown.on.slice(1, 16).filter(Boolean).length;
    const key = JSON.stringify([k, over, playing, speed, show, reds, event, this.view.ratio]);
    if (key === this.written) return;
    this.written = key;
    this.icon(this.buttons.play, playing ? "pause" : "play");
    this.buttons.play.setAttribute("aria-label", playing ? "pause" : "play");
    this.pace.textContent = `${speed}×`;
    for (const name in show) this.buttons[name].setAttribute("aria-pressed", ![false, "off"].includes(show[name]));
    const about = [
      `${k + 1} of ${this.strokes.length}`,
      cue && `${cue.speed.toFixed(2)} m/s`,
      cue?.elevation > 0.1 && `raised ${round(cue.elevation * 360 / TURN)}°`,
    ];
    this.part("about").lastChild.textContent = about.filter(Boolean).join(" · ");
    const words = event && this.eventWords(event, scene.balls);
    this.part("words").textContent = (over && stroke.words) || words || title || "";
    this.drawTip(cue);
    if (this.who.length) this.score(stroke, over, reds);
  }

  /** An event as a sentence, with its time. */
  eventWords([t, kind, i, j], balls) {
    const name = ball => (ball ? balls[ball].name.replace(/^red \d+/, "red") : "cue ball");
    const both = kind === BALL_BALL;
    const a = both && j && /^red/.test(balls[j].name) && /^red/.test(balls[i].name) ? "another" : "the";
    return `After ${t.toFixed(2)} s the ${name(i)} ${EVENTS[kind]}${both ? ` ${a} ${name(j)}` : ""}.`;
  }

  /** The cue ball as the player sees it, and where the tip strikes it. */
  drawTip(cue) {
    const { tip, view } = this;
    const size = (tip.width = tip.height = round(50 * view.ratio));
    const pen = tip.getContext("2d");
    const R = size * 0.46;
    const c = size / 2;
    tip.hidden = !cue;
    if (!cue) return;
    disc(pen, c, c, R, css(this.replay.scene.balls[0].rgb));
    polyline(pen, [[c - R, c], [c + R, c], [c, c], [c, c - R], [c, c + R]], 1, "#0006");
    disc(pen, c + R * cue.side, c - R * cue.top, 0.17 * R, view.ink.bar_accent);
  }

  /** The score bar: as it was before the stroke until the balls rest. */
  score(stroke, over, reds) {
    const { strokes } = this;
    const { scene: { balls }, win_chance, players } = this.replay;
    const upTo = over ? this.k : this.k - 1;
    const last = strokes[upTo];
    const mine = stroke.player;
    if (win_chance) showChance(this.part("win"), win_chance[this.k + over], players);
    this.who.forEach((one, k) => {
      const before = stroke.score[k] - (k === mine ? stroke.points : stroke.penalty);
      one.lastChild.textContent = (last ? last.score[k] : before) ?? 0;
      one.classList.toggle("sn-turn", mine === k);
    });
    const pots = [];
    const run = last?.player === mine ? last?.break : 0;
    for (let k = upTo; run && strokes[k]?.player === mine && strokes[k].points; k--) pots.unshift(...strokes[k].pots);
    const now = this.part("now");
    now.textContent = "";
    const add = (what, dots, after = "") => {
      const one = put(now, "span");
      one.append(what);
      for (const ball of dots) put(one, "i").style.background = css(balls[ball].rgb);
      one.append(after);
    };
    add(`break ${run} `, pots.slice(-MOST_DOTS));
    if (stroke.n === 22) add(`reds ${reds}`, []);
    const next = over && stroke.points ? strokes[this.k + 1] : !over && stroke;
    const on = next?.player === mine && next.ball_on; // nothing after the visit
    const colours = [16, 17, 18, 19, 20, 21];
    const dots = on === "any colour" ? colours : [balls.findIndex(one => one.name.startsWith(on))];
    add(on ? "on " : "", dots[0] < 0 ? [] : dots, ` ${on || ""}`);
  }
}
