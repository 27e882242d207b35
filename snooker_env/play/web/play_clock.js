/** How long may a person think? As long as the shot clock says: when it has run down, the stroke is played as it is aimed. */

import { by, setting } from "./play_parts.js";

const LIMITS = { off: "none", "15 s": "15 s", "25 s": "25 s", "40 s": "40 s" };

export class Clock {
  constructor(app) {
    this.app = app;
    this.at = performance.now();
    setting("limit", LIMITS, "off", () => { this.from = this.spent; this.show(); });
    setInterval(() => this.show(), 200);
  }

  /** A stroke is asked of a person, or no longer; on another table the clock begins anew. */
  turn(asked) {
    const { aimed } = this.app;
    if (asked && aimed !== this.key) { this.key = aimed; this.spent = this.from = 0; }
    this.asked = asked;
    this.show();
  }

  /** Show the time left since the limit was chosen. */
  show() {
    const limit = parseInt(by("limit").value), clock = by("clock"), now = performance.now();
    if (this.asked && !document.querySelector("dialog[open], #tour:not([hidden])")) this.spent += (now - this.at) / 1000;
    this.at = now;
    clock.hidden = !limit || !this.asked || document.hidden;
    if (clock.hidden) return;
    const left = limit - this.spent + this.from;
    clock.textContent = Math.max(0, Math.ceil(left));
    clock.classList.toggle("late", left < 5);
    if (left <= 0) { this.app.aim.up(false); this.app.play(); }
  }
}
