/** What must a new player know? Six sentences beside what they are about, shown once; the tutorial button shows them again. */

import { by, kept } from "./play_parts.js";

const finger = matchMedia("(pointer: coarse)").matches;
const STEPS = [
  ["table", `Welcome. ${finger ? "Drag" : "Drag with the mouse"} on the table to aim: the white ball goes towards your ${finger ? "finger" : "pointer"}. The ring shows where it meets the first ball.`],
  ["fine", "This strip aims finely: drag along it, or tap the arrows beside it. It says how full you strike the ball."],
  ["dial", "Here you choose where the tip strikes the white: high to follow, low to screw back, left or right for side."],
  ["table", "Take the cue behind the white ball, pull it back, and let go: the further, the harder. Push it back to cancel."],
  ["play", "Or set the power with the slider and press Play. Undo takes back any stroke."],
  ["advise", "Don't know what to play? Press Hint. Opponents of every strength are under New game, exercises under Drills. Good luck!"],
];

export class Tour {
  constructor(app) {
    this.app = app;
    by("tour-open").onclick = () => this.go(0);
    by("tour-next").onclick = () => this.go(this.step + 1);
    by("tour-skip").onclick = () => this.go(STEPS.length);
    new ResizeObserver(() => this.aside()).observe(by("stage"));
    app.started.then(() => this.aside());
    if (app.me !== "person") STEPS.splice(4);  // the host alone has what comes then
    if (!kept.get("toured", false) && app.me !== "watcher") this.go(0);
  }

  go(step) {
    this.step = step;
    for (const one of document.querySelectorAll(".shown-now")) one.classList.remove("shown-now");
    by("tour").hidden = step >= STEPS.length;
    if (step >= STEPS.length) { kept.set("toured", true); return; }
    const [id, words] = STEPS[step];
    this.app.compact();
    if (id !== "table") by(id).classList.add("shown-now");
    by(id).scrollIntoView({ block: "nearest" });
    by("tour-words").textContent = words;
    this.aside();
    by("tour-step").textContent = `${step + 1} of ${STEPS.length}`;
    by("tour-next").textContent = step + 1 < STEPS.length ? "Next" : "Play";
  }

  /** Put the card above, in the middle or below: where it is farthest from the cue, the cue ball and what it meets. */
  aside() {
    const card = by("tour"), { view, aim, balls } = this.app, { clientWidth, clientHeight } = by("stage"), { style } = card;
    const { met, cue } = aim.overlay(), points = [[cue.x, cue.y], [met.x, met.y], [cue.x - 0.4 * Math.cos(cue.aim), cue.y - 0.4 * Math.sin(cue.aim)]].map(place => view.toScreen(...place));
    const beside = Math.max(0, (clientWidth - card.offsetWidth) / 2), high = card.offsetHeight, least = top => Math.min(...points.map(([x, y]) => Math.hypot(Math.max(beside - x, x - clientWidth + beside, 0), Math.max(top - y, y - top - high, 0))));
    const [top] = [0.98, 0.5, 0.02].map(share => share * (clientHeight - high)).sort((a, b) => least(b) - least(a));
    style.top = `${top}px`;
  }
}
