/** How does one see who is likely to win? As a bar of both shares. */

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
