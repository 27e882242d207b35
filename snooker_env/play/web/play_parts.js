/**
 * What do the parts of the page share? Requests to the server, elements by id, and the straight lines of an aim.
 *
 * Frame as in `table.js`: metres, origin at the table's centre, +x to the yellow side, +y to the black end; directions anticlockwise from +x.
 */

export const DOWN = "The server does not answer. Is it still running?";

export const by = id => document.getElementById(id);

export function make(tag, properties = {}, ...inside) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...inside);
  return made;
}

/** Fill a list of choices, and keep the selection if it is still there. */
export function fill(select, values, chosen = select.value, words = value => value.replaceAll("_", " ")) {
  const wanted = values.join("\n");
  if (select.dataset.values !== wanted) {
    select.replaceChildren(...values.map(value => make("option", { value, textContent: words(value) })));
    select.dataset.values = wanted;
  }
  if (values.includes(chosen)) select.value = chosen;
}

/** Is this who sits on a seat: a person, at this page or another? */
export const isPerson = who => ["person", "friend", "friend_by_link"].includes(who);

/** What this browser keeps of the player, by name. Without storage it lasts as long as the page. */
export const kept = {
  all: (() => { try { return JSON.parse(localStorage.getItem("snooker")) ?? {}; } catch { return {}; } })(),
  get(name, otherwise) { return this.all[name] ?? otherwise; },
  set(name, value) {
    this.all[name] = value;
    try { localStorage.setItem("snooker", JSON.stringify(this.all)); } catch { /* private browsing */ }
  },
};

/** A list of choices whose selection is kept. `words`: {value: text}. */
export function setting(id, words, otherwise, changed) {
  const select = by(id), values = Object.keys(words), known = kept.get(id, otherwise);
  fill(select, values, values.includes(known) ? known : otherwise, value => words[value]);
  select.onchange = event => { kept.set(id, select.value); changed(event); };
}

export function confirmed(question, yes) {
  const box = by("confirm");
  by("confirm-words").textContent = question;
  by("confirm-yes").textContent = yes;
  box.returnValue = "";
  box.showModal();
  return new Promise(done => { box.onclose = () => done(box.returnValue === "yes"); });
}

export class ServerError extends Error {
  constructor(error) {
    super(error.field ? `${error.field}${error.value === null || String(error.value).length > 60 ? "" : ` = ${error.value}`}: ${error.message}` : error.message);
    Object.assign(this, { field: error.field, value: error.value, said: error.message });
  }
}

/** Send a request: POST with a body, else GET. */
export async function ask(name, body, query = "") {
  const options = body === undefined ? {} : { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
  const reply = await fetch(`api/${name}${query}`, options).catch(() => { throw new Error(DOWN); });
  const found = await reply.json();
  if (!reply.ok) throw new ServerError(found.error);
  return found;
}

/** Sends one request at a time; of those made meanwhile, only the latest is sent next. */
export class Latest {
  constructor(name, then, wrong = () => {}) {
    Object.assign(this, { name, then, wrong, busy: false, next: null, waiting: [] });
  }

  /** Send a request with this body; `about` is passed on with the answer. */
  async ask(body, about) {
    if (this.busy) { this.next = [body, about]; return; }
    this.busy = true;
    try {
      this.then(await ask(this.name, body), about);
    } catch (error) {
      if (!this.next) this.wrong(error, about);
    }
    this.busy = false;
    if (this.next) { const next = this.next; this.next = null; this.ask(...next); }
    else for (const done of this.waiting.splice(0)) done();
  }

  drop() { this.next = null; }

  /** Resolves when every request has been answered. */
  quiet() { return this.busy ? new Promise(done => this.waiting.push(done)) : Promise.resolve(); }
}

/** Place of ball `which`, sent in the direction `aim`, when it first meets a ball or a cushion: {x, y, ball (-1: cushion), run}. */
export function firstContact(balls, which, aim, [[x0, x1], [y0, y1]], R) {
  const ux = Math.cos(aim), uy = Math.sin(aim), cx = balls.x[which], cy = balls.y[which];
  const until = (from, way, low, high) => (way > 1e-12 ? (high - R - from) / way : way < -1e-12 ? (low + R - from) / way : Infinity);
  let run = Math.max(0, Math.min(until(cx, ux, x0, x1), until(cy, uy, y0, y1))), ball = -1;
  for (let i = 0; i < balls.x.length; i++) {
    if (!balls.on[i] || i === which) continue;
    const bx = balls.x[i] - cx, by_ = balls.y[i] - cy, along = bx * ux + by_ * uy, across = bx * uy - by_ * ux;
    if (along <= 0 || Math.abs(across) >= 2 * R) continue;
    const met = Math.max(0, along - Math.sqrt(4 * R * R - across * across));
    if (met < run) { run = met; ball = i; }
  }
  return { x: cx + run * ux, y: cy + run * uy, ball, run };
}

/** The nearest place [x, y] of the D: circle and baulk line as the scene draws them. */
export function intoD(x, y, lines) {
  const [[ax, ay], [bx]] = [lines.d[0], lines.d[lines.d.length - 1]], radius = Math.abs(ax - bx) / 2, depth = Math.max(0, ay - y);
  const far = Math.hypot(x, depth);
  return far <= radius ? [x, ay - depth] : depth === 0 ? [Math.max(-radius, Math.min(radius, x)), ay] : [x * radius / far, ay - depth * radius / far];
}

export function keep(name, text, type) {
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 5000);
}
