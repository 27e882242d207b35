/**
 * How is a position, a stroke or a replay passed on? As text after the # of the page's address: the game as it is saved, or the last stroke as the server
 * tells it, both JSON, deflated, in base64url; or the server's own link to all that was played.
 */

import { numbers } from "./table.js";
import { ask, by } from "./play_parts.js";

/** Each kind of link, after so many strokes. */
const KINDS = {
  game: async () => packed("game", await ask("save", {})),
  stroke: async n => packed("stroke", JSON.stringify((await ask("strokes", undefined, `?from=${n - 1}`)).strokes[0])),
  replay: async () => short(`#replay=${(await ask("link", {})).link}`),
};
/** Characters of the longest link. */
const MOST = 30_000;

function deflate(Stream) {
  try { return new window[Stream]("deflate-raw"); } catch { throw new Error("This browser is too old for links: use Save or Replay file instead."); }
}
const through = (bytes, stream) => new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer();

function short(link) {
  if (link.length > MOST) throw new Error(`A link can hold ${MOST / 1000} kB, but this one needs ${Math.ceil(link.length / 1000)} kB: use Save or Replay file instead.`);
  return link;
}

/** A text of JSON as "#kind=text". */
export async function packed(kind, json) {
  const bytes = new Uint8Array(await through(json, deflate("CompressionStream")));
  const text = btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join(""));
  return short(`#${kind}=${text.replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "")}`);
}

/** [kind, text: JSON unless the server reads it] of a link or its fragment; Error if it is none. */
export async function unpacked(link) {
  const [, kind, text] = /#(\w+)=([\w-]+)\s*$/.exec(short(link)) ?? [];
  if (kind === "replay" || kind === "friend") return [kind, text];
  if (!Object.hasOwn(KINDS, kind)) throw new Error("This is not a link to a position, a stroke, a replay or a game.");
  const stream = deflate("DecompressionStream");
  try {
    const bytes = numbers(text.replaceAll("-", "+").replaceAll("_", "/"), Uint8Array);
    return [kind, new TextDecoder().decode(await through(bytes, stream))];
  } catch { throw new Error("The link is damaged: was it copied whole?"); }
}

export class Share {
  constructor(app) {
    this.app = app;
    for (const kind in KINDS) by(`share-${kind}`).onclick = () => this.offer(kind);
    const link = by("link"), open = () => { this.open(link.value); link.value = ""; };
    link.onpaste = () => setTimeout(open);
    link.onkeydown = event => {
      if (event.key !== "Enter") return;
      event.preventDefault();  // it would press a button of the dialogue that opens
      open();
    };
    window.onhashchange = () => this.fromAddress();
  }

  /** Copy a link, and show it in the field: where a page may not write the clipboard, it can be copied there. */
  async offer(kind) {
    try {
      const link = await KINDS[kind](this.app.state.strokes), field = by("link");
      field.value = link;
      field.select();
      let where = "copied";
      try { await navigator.clipboard.writeText(link); field.blur(); } catch { where = "in the field Link"; }
      by("last").textContent = `The link is ${where}: add it to the end of the page's address.`;
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
      const [kind, text] = await unpacked(link);
      if (kind === "friend") app.friend.open(text);
      else if (kind !== "stroke") app.sure(`Discard this frame and open the ${kind === "game" ? "position" : kind} from the link?`, "Open", () => app.go("load", kind === "game" ? `{"saved": ${text}}` : { link: text }));
      else {
        while (app.behind) await new Promise(done => setTimeout(done, 200));
        await app.film(JSON.parse(text));
      }
    } catch (error) { app.trouble(error); }
  }
}
