/** How does one see who is likely to win? As a bar of both shares; over the time of a replay as a graph, with the luck of both. */

const SVG = "http://www.w3.org/2000/svg";

/** The first player's share and the other's in whole per cent: 100 and 0 only once a frame is over. */
const shares = chance => {
  const first = chance > 0 && chance < 1 ? min(99, max(1, round(100 * chance))) : 100 * chance;
  return [first, 100 - first];
};

/** Words side by side in an element, and what they are said to mean. */
const say = (element, words, meaning) => {
  element.setAttribute("role", "img");
  element.setAttribute("aria-label", meaning);
  element.title = meaning;
  element.replaceChildren(...words.map(text => Object.assign(document.createElement("span"), { textContent: text })));
};

/** Show in an element how likely the first of two players wins; null: nobody says it. `how`: more words. */
export function showChance(element, chance, names, how = "") {
  element.toggleAttribute("hidden", chance === null);
  if (chance === null) return;
  const both = shares(chance).map(share => `${share} %`);
  const meaning = `chance to win${how}: ${names.map((name, k) => `${name} ${both[k]}`).join(", ")}`;
  element.style.setProperty("--share", `${100 * chance}%`);
  say(element, [both[0], `chance to win${how}`, both[1]], meaning);
}

/** A share of the chance to win in whole per cent, with its sign. */
const signed = share => {
  const whole = round(100 * share);
  return `${whole < 0 ? "-" : "+"}${abs(whole)} %`;
};

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
      const all = who => strokes.reduce((sum, stroke, k) => sum + (stroke.player === who ? luck[k] : 0), 0);
      const [one, other] = [0, 1].map(who => signed(all(who)));
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
