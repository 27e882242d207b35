/**
 * How is a position or a stroke passed on? As text after the # of the page's address: the game as saved, or the last stroke as a replay has it, as
 * JSON, deflated, in base64url.
 */

import { ask, by, ServerError } from "./play_parts.js";

const KINDS = ["game", "stroke"];
const through = (bytes, stream) => new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer();

/** A text of JSON as "#kind=text". */
export async function packed(kind, json) {
  const bytes = new Uint8Array(await through(new TextEncoder().encode(json), new CompressionStream("deflate-raw")));
  const text = btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join(""));
  return `#${kind}=${text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "")}`;
}

/** [kind, text of JSON] of a link or its fragment; Error if it is none. */
export async function unpacked(link) {
  const [, kind, text] = /#(\w+)=([\w-]+)\s*$/.exec(link) ?? [];
  if (!KINDS.includes(kind)) throw new Error("This is not a link to a position or a stroke.");
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), one => one.charCodeAt(0));
    return [kind, new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw")))];
  } catch { throw new Error("The link is damaged: was it copied whole?"); }
}

export class Share {
  constructor(app) {
    this.app = app;
    by("share-game").onclick = () => this.offer("game", () => ask("save", {}));
    by("share-shot").onclick = () => this.offer("stroke", async () => JSON.stringify((await ask("strokes", undefined, `?from=${app.state.strokes - 1}`)).strokes[0]));
    const link = by("link"), open = () => { this.open(link.value); link.value = ""; };
    link.onpaste = () => setTimeout(open);
    link.onkeydown = event => event.key === "Enter" && open();
    window.addEventListener("hashchange", () => this.fromAddress());
  }

  /** Copy a link, and show it in the field: where a page may not write the clipboard, it can be copied there. */
  async offer(kind, what) {
    try {
      const link = await packed(kind, await what()), field = by("link");
      field.value = link;
      field.select();
      try { await navigator.clipboard.writeText(link); } catch { /* it is selected */ }
      by("last").textContent = "The link is copied: put it behind the page's address, or paste it into the field Link.";
    } catch (error) { this.app.trouble(error); }
  }

  async fromAddress() {
    await this.app.started;
    const { hash } = location;
    if (!hash) return;
    history.replaceState(null, "", location.pathname);
    await this.open(hash);
  }

  async open(link) {
    const { app } = this;
    try {
      const [kind, value] = await unpacked(link);
      if (kind === "game") app.sure("Leave this frame for the position of the link?", "Open", () => app.go("load", `{"saved": ${value}}`));
      else {
        while (app.behind) await new Promise(done => setTimeout(done, 200));
        await app.film(JSON.parse(value));
      }
    } catch (error) { app.trouble(error instanceof ServerError ? error : new Error(error.message)); }
  }
}
