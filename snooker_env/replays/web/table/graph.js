/** How did the chance to win go, and how much of it was luck? As a graph over the time of a replay. */

const SVG = "http://www.w3.org/2000/svg";

/** A share of the chance to win in whole per cent, with its sign. */
const signed = share => {
  const whole = round(100 * share);
  return `${whole < 0 ? "-" : "+"}${abs(whole)} %`;
};

/** The luck of both players over all strokes. */
const sumLuck = (strokes, luck) =>
  [0, 1].map(who => strokes.reduce((sum, stroke, k) => sum + (stroke.player === who ? luck[k] : 0), 0));

/** The graph of a player's replay in an element; a click shows the stroke there. */
export class ChanceGraph {
  constructor(element, player) {
    const { total, starts, strokes, replay } = player;
    const { win_chance: chances, luck, players } = replay;
    const ends = strokes.map((stroke, k) => starts[k] + stroke.duration);
    const steps = ends.map((end, k) => `H${end}V${1 - chances[k + 1]}`);
    const draw = (kind, values) => {
      const made = document.createElementNS(SVG, kind);
      for (const [name, value] of Object.entries(values)) made.setAttribute(name, value);
      return made;
    };
    const picture = draw("svg", { viewBox: `0 0 ${total} 1`, preserveAspectRatio: "none" });
    picture.append(
      draw("rect", { class: "sn-other", width: total, height: 1 }),
      draw("path", { class: "sn-first", d: `M0 1V${1 - chances[0]}${steps.join("")}H${total}V1Z` }),
      draw("path", { class: "sn-even", d: `M0 0.5H${total}` }),
    );
    strokes.forEach((stroke, k) => { // from the middle, up if the luck was good for the first player
      const first = luck && (stroke.player ? -luck[k] : luck[k]);
      const place = { x: starts[k], y: 0.5 - max(0, first), width: stroke.duration, height: abs(first) };
      if (first) picture.append(draw("rect", { class: "sn-lucky", ...place }));
    });
    this.now = draw("path", { class: "sn-moment" });
    picture.append(this.now);
    element.append(picture);
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", "The chance to win, over the strokes. A click goes to a stroke.");
    if (luck) {
      const caption = Object.assign(document.createElement("div"), { className: "sn-luck" });
      const [one, other] = sumLuck(strokes, luck).map(signed);
      say(caption, [one, "luck", other], `luck: ${players[0]} ${one}, ${players[1]} ${other}`);
      element.after(caption);
    }
    const under = event => {
      const { left, width } = element.getBoundingClientRect();
      return player.strokeAt((event.clientX - left) / width * total);
    };
    element.onclick = event => player.skipTo(under(event));
    element.onpointermove = event => {
      const k = under(event);
      const lucky = luck?.[k] ? `, luck ${signed(luck[k])}` : "";
      element.title = `${k + 1}: ${strokes[k].words} ${shares(chances[k + 1]).join(" : ")} %${lucky}`;
    };
  }

  /** Mark a time of the whole replay [s]. */
  mark(sum) {
    this.now.setAttribute("d", `M${sum} 0V1`);
  }
}
