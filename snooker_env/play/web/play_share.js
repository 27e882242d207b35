/** How is a game kept and passed on? As the server's link to all that was played: in a file, or after the # of the page's address. */

import { ask, by } from "./play_parts.js";

/** Characters of the longest link. */
const MOST = 30_000;

export class Share {
  constructor(app) {
    this.app = app;
    by("share").onclick = () => this.offer();
    const link = by("link"), open = () => { this.open(link.value); link.value = ""; };
    link.onpaste = () => setTimeout(open);
    link.onkeydown = event => {
      if (event.key !== "Enter") return;
      event.preventDefault();  // it would press a button of the dialogue that opens
      open();
    };
    window.onhashchange = () => this.fromAddress();
  }

  async link() {
    const { link } = await ask("link", {});
    if (link.length > MOST) throw new Error(`A game can have ${MOST / 1000} kB, but this one needs ${Math.ceil(link.length / 1000)} kB: use Replay file instead.`);
    return `#replay=${link}`;
  }

  /** Copy a link, and show it in the field: where a page may not write the clipboard, it can be copied there. */
  async offer() {
    try {
      const field = by("link");
      field.value = await this.link();
      field.select();
      let where = "copied";
      try { await navigator.clipboard.writeText(field.value); field.blur(); } catch { where = "in the field Link"; }
      by("last").textContent = `The link is ${where}: add it to the end of the page's address.`;
    } catch (error) { this.app.trouble(error); }
  }

  async fromAddress() {
    await this.app.started;
    const { hash } = location;
    if (!hash) return;
    history.replaceState(null, "", location.pathname);
    this.open(hash);
  }

  open(text) {
    const { app } = this, [, kind, link] = /#(replay|friend)=([\w-]+)\s*$/.exec(text) ?? [];
    if (kind === "friend") app.friend.open(link);
    else if (kind) app.sure("Discard this frame and open this game?", "Open", () => app.go("load", { link }));
    else app.trouble(new Error("This is not a game: a link ends with #replay= and its text."));
  }
}
