/**
 * How does one play with a friend by link? After each visit a link holds the whole frame; who opens it plays the other seat. This browser keeps the last
 * link of each game, and which seat is one's own.
 */

import { ask, by, fill, kept } from "./play_parts.js";

/** What all links of a game begin with: the constants, and the random stream. */
const NAME = 20, MOST = 12;
/** What the link has agreed. */
const FIXED = ["level", "practice", "cue", "who-0", "who-1", "noise-0", "noise-1"];

export class Friend {
  constructor(app) {
    Object.assign(this, { app, link: "", words: "" });
    by("friend-new").onclick = () => app.sure("Discard this frame and begin one with a friend by link?", "Begin", () => this.begin());
    by("friend-copy").onclick = () => this.copy();
    by("friend-share").hidden = !navigator.share;
    by("friend-share").onclick = () => navigator.share({ text: this.text }).catch(() => {});
    by("friend-games").onchange = event => this.open(event.target.value);
    this.list();
  }

  /** {name: [seat, strokes, words, link]}, the last one played last. */
  get games() { return kept.get("friend", {}); }

  get text() { return `${this.words} Paste this message into Link, under “Save, share”, on your page of snooker_env: #friend=${this.link}`; }

  list() {
    const games = Object.values(this.games).reverse(), words = Object.fromEntries(games.map(([, , said, link]) => [link, said]));
    by("friend-list").hidden = !games.length;
    fill(by("friend-games"), ["", ...games.map(([, , , link]) => link)], "", link => words[link] ?? "choose one");
  }

  begin() {
    const { app } = this;
    app.go("new", { layout: by("layout").value, game: by("rules").value, seed: Math.floor(Math.random() * 2 ** 48), by_link: true });
    by("start").open = false;
    app.compact();
  }

  /** Go on with the game of a link; the seat is one's own of before, else that of whose turn it is. */
  open(link) {
    const { app } = this, [seat = null] = this.games[link.slice(0, NAME)] ?? [];
    const then = () => {
      for (const id of ["files", "start"]) by(id).open = false;
      app.compact();
      app.go("load", { link, seat });
    };
    if (app.state.by_link && link.startsWith(this.link.slice(0, NAME) || "#")) then();
    else app.sure("Discard this frame and open the game by link?", "Open", then);
  }

  /** Keep the game as it stands, and offer its link in the friend's turn. */
  async settled() {
    const { state } = this.app, { by_link: mine, revision } = state, over = state.phase === "over";
    for (const id of FIXED) by(id).disabled = Boolean(mine);
    if (!mine) { by("friend").hidden = true; return; }
    const theirs = !over && state.striker !== mine.seat, { link } = await ask("link", {});
    if (this.app.state.revision !== revision) return;
    const stroke = `stroke ${state.strokes + 1}`;
    this.words = over ? `The frame is over, ${state.scores.join(" : ")}.` : `Your move, ${stroke}.`;
    this.link = link;
    by("friend").hidden = !theirs && !over;
    by("friend-words").textContent = over ? "Send the link: it shows your friend the end." : `Send your friend the link: “${this.words}”`;
    const { games } = this, name = link.slice(0, NAME), now = `${over ? "over" : stroke}, ${over ? state.scores.join(" : ") : theirs ? "friend’s move" : "your move"}`;
    if (games[name]?.[1] > state.strokes) {
      this.app.trouble(new Error(`This link is older than your game, which is at stroke ${games[name][1] + 1}. Open that one under New game, Games by link.`));
      return;
    }
    delete games[name];
    kept.set("friend", Object.fromEntries([...Object.entries(games), [name, [mine.seat, state.strokes, now, link]]].slice(-MOST)));
    this.list();
  }

  async copy() {
    let where = "The link is copied";
    try { await navigator.clipboard.writeText(this.text); } catch {
      by("files").open = true;
      by("link").value = this.text;
      by("link").select();
      where = "Copy the link from the field Link";
    }
    by("friend-words").textContent = `${where}: your friend pastes it into the field Link, under “Save, share”.`;
  }
}
