/** How did the chance to win go? As a graph of it over the time of a replay. */

const SVG = "http://www.w3.org/2000/svg";

/** The graph of a player's replay in an element; a click shows the stroke there. */
class ChanceGraph {
  constructor(element, player) {
    const { total, starts, strokes, replay } = player;
    const { win_chance: chances } = replay;
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
    this.now = draw("path", { class: "sn-moment" });
    picture.append(this.now);
    element.append(picture);
    element.setAttribute("role", "img");
    element.setAttribute("aria-label", "The chance to win, over the strokes. A click goes to a stroke.");
    const under = event => {
      const { left, width } = element.getBoundingClientRect();
      return player.strokeAt((event.clientX - left) / width * total);
    };
    element.onclick = event => player.skipTo(under(event));
    element.onpointermove = event => {
      const k = under(event);
      element.title = `${k + 1}: ${strokes[k].words} ${shares(chances[k + 1]).join(" : ")} %`;
    };
  }

  /** Mark a time of the whole replay [s]. */
  mark(sum) {
    this.now.setAttribute("d", `M${sum} 0V1`);
  }
}
