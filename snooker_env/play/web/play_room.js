/**
 * Has the cue room for the stroke? What the server says of it as the aim moves, in words and from the side.
 *
 * `found`: the answer of `api/room` for the last stroke that was asked about, or null.
 */

import { by, firstContact, Latest } from "./play_parts.js";

const SVG = "http://www.w3.org/2000/svg";
const STEEP = Math.PI / 36;  // a cue raised less is not worth a word
const ASPECT = 3, LEAST = 0.2, PAST = 0.07;  // of the view from the side: width over height, how wide it is at least and past what is in the way [m]

export class Room {
  constructor(app) {
    this.app = app;
    this.found = null;
    this.wait = new Latest("room", (found, about) => this.take(found, about), (error, about) => this.take(null, about, error));
  }

  changed() {
    const { app } = this;
    if (!app.aiming) { this.wait.drop(); this.found = null; this.show(); return; }
    const { speed, side, top, aim, elevation } = app.aim.wish, { revision } = app.state;
    this.wait.ask({ speed, side, top, aim, elevation, revision }, { revision, aim });
  }

  /** How far a ball's way is turned from the line of centres [rad], by throw and swerve, with the last stroke that was asked about. */
  thrown(ball) { return this.found?.first === this.app.names[ball] ? this.found.turned : 0; }

  take(found, { revision, aim }, error) {
    const { app } = this;
    if (found?.stale || revision !== app.state.revision || !app.aiming) return;
    this.found = found;
    if (found?.first) {
      const { balls, scene, R } = app, { x, y, ball } = firstContact(balls, 0, aim, scene.extent, R);
      found.turned = ball < 0 ? 0 : found.heads - Math.atan2(balls.y[ball] - y, balls.x[ball] - x);
    }
    this.show(error);
    app.redraw();
  }

  show(error) {
    const { found } = this;
    const said = found?.words && (found.moved || found.unplayable || found.elevation > STEEP);
    by("room").textContent = error ? error.message : said ? `${found.words[0].toUpperCase()}${found.words.slice(1)}.` : "";
    by("room").className = found?.unplayable ? "trouble" : "";
    if (found) this.draw();
    else by("side").replaceChildren();
    this.app.aim.show();
  }

  /** The cue ball on the right, the cue, and what it passes over, from the side; a ball beside the cue's line is drawn in it. */
  draw() {
    const { found: { elevation, side, top, over, behind }, app: { R, cue, scene, names } } = this, wide = Math.max(LEAST, behind + PAST), high = wide / ASPECT, edge = 1.5 * R;
    const c = Math.cos(elevation), s = Math.sin(elevation), q = Math.sqrt(Math.max(0, 1 - side * side - top * top));
    const [px, py] = [R * (top * s - q * c), R * (1 + top * c + q * s)];  // the middle of the tip
    const at = (far, up) => `${px - far * c + up * s},${-(py + far * s + up * c)}`;
    by("side").replaceChildren();
    const part = (name, kind, values) => {
      const made = document.createElementNS(SVG, kind);
      for (const [key, value] of Object.entries({ class: name, ...values })) made.setAttribute(key, value);
      by("side").append(made);
    };
    part("cloth", "rect", { x: -wide, y: 0, width: wide + edge, height: high });
    if (over === "rail") part("wood", "rect", { x: -behind - wide, y: -cue.rail, width: wide, height: cue.rail + high });
    else if (over) part("ball", "circle", { cx: -behind, cy: -R, r: R, fill: `rgb(${scene.balls[names.indexOf(over)].rgb})` });
    part("cue-ball", "circle", { cx: 0, cy: -R, r: R });
    part("cue", "polygon", { points: [at(0, cue.tip), at(cue.length, cue.butt), at(cue.length, -cue.butt), at(0, -cue.tip)] });
    part("tip", "polygon", { points: [at(-cue.tip, cue.tip), at(cue.tip, cue.tip), at(cue.tip, -cue.tip), at(-cue.tip, -cue.tip)] });
    by("side").setAttribute("viewBox", `${-wide} ${0.1 * high - high} ${wide + edge} ${high}`);
    by("side").setAttribute("aria-label", `The cue from the side, ${Math.round(elevation * 180 / Math.PI)} degrees${over ? ` over the ${over}` : ""}`);
  }
}
