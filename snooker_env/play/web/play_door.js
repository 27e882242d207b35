/**
 * Who plays on other devices? The host's page has their addresses as QR codes; that of a friend, or of a watcher, says what it waits for.
 *
 * On a seat of the state, "person" is who sits at this page, and "friend" who sits at another.
 */

import { by, isPerson, make } from "./play_parts.js";

const FOR = {
  person: ["Your own phone", "can do everything that this page can"],
  friend: ["A friend", "plays seat 2 once you choose “a friend, on their device” as the opponent, under New game"],
  watcher: ["Watchers", "see everything and change nothing"],
};

export class Door {
  constructor(app, menu) {
    Object.assign(this, { app, host: app.me === "person" });
    if (app.players.includes("friend")) menu.friend = { short: "a friend, on their device", about: "" };
    by("undo").before(...this.host ? [] : [by("concede")]);
    by("invite-open").hidden = !app.invites.length;
    by("invite-open").onclick = () => by("invite").showModal();
    by("invites").replaceChildren(...app.invites.map(({ who, addresses, qr, drawn }) => {
      const [name, about] = FOR[who];
      const texts = addresses.map(address => make("code", { textContent: address }));
      return make("section", {}, make("h3", { textContent: name }), make("p", { textContent: about }),
        qr ? make("img", { src: qr, alt: `QR code of the address for: ${name}` }) : make("p", { textContent: drawn }), ...texts);
    }));
  }

  get seated() { return this.app.state.players.includes("person"); }

  /** Say what this page waits for while another one is to play; returns whether it does. */
  show() {
    const { host, app, app: { state, moving, me } } = this, mine = state.players[state.striker] === "person", over = state.phase === "over";
    document.body.dataset.me = host || this.seated ? me : "watcher";
    const other = isPerson(state.players[state.striker]) && !mine ? `${state.labels[state.striker]} is playing.` : "";
    const words = me === "watcher" ? `You are watching. ${over ? "" : other}` : !host && !this.seated ? "You are watching until your host chooses you as the opponent, under New game."
      : over ? host ? "" : "Your host begins the next frame." : other;
    by("seat").textContent = words;
    by("seat").hidden = !words || Boolean(moving) || app.setup.open;
    return Boolean(words);
  }
}
