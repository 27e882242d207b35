/**
 * Against whom does one play, with what help, and how did it end? The five opponents, what helped a person, and breaks as snooker says them.
 */

export const many = (n, one) => `${n} ${one}${n === 1 ? "" : "s"}`;

/** The opponents of the menu, in words: {name: {short, about}}. levels: of the server; names: all that the menu offers; noise: errors in words. */
export function opponents(levels, names, noise) {
  return Object.fromEntries([...names.map(name => {
    const { style = "", noise: errors } = levels.find(one => one.name === name) ?? {}, [kind] = style.split(":");
    return [name, style ? { short: `${name} – ${kind}, ${noise[errors].replace(/'s$/, "")}`, about: `${name} is ${style}.` } : { short: name.replaceAll("_", " "), about: "" }];
  }), ["person", { short: "nobody: two play here", about: "" }]]);
}

/** What helped the persons at the table, beside their own hands. */
export function helped({ players, noise, hints, undone, practice }) {
  const people = [0, 1].filter(seat => players[seat] === "person" && !(practice && seat)), asked = people.reduce((sum, seat) => sum + hints[seat], 0);
  return [people.some(seat => noise[seat] === "none") && "no mistakes", asked && many(asked, "hint"), undone && `${undone} undone`].filter(Boolean);
}

/** "an 87 break". */
export const breakWords = points => `${/^(8|11$|18$)/.test(points) ? "an" : "a"} ${points} break`;

/** How the frame ended, in a sentence or two: what was done last unless the score says it, breaks, and help. */
export function ending(state, last, me) {
  const { labels, breaks: runs } = state, highest = runs.map(own => Math.max(0, ...own)), called = seat => labels[seat].replace("You", "you"), sides = [me, 1 - me].filter(seat => highest[seat]);
  const breaks = sides.map(seat => `${called(seat)} ${highest[seat]}`).join(", "), help = helped(state).map(one => (one === "no mistakes" ? 'with "no mistakes"' : one)).join(", ");
  return [/ (conceded|claimed) /.test(last) ? last : "", breaks && `Highest break${sides.length > 1 ? "s" : ""}: ${breaks}.`, help && `${help[0].toUpperCase()}${help.slice(1)}.`].filter(Boolean).join(" ");
}
