/**
 * How does a person play over many frames? One screen of the person's own file: rating, levels, breaks, pots by distance, and what the coach says.
 */

import { ask, by, confirmed, keep, make } from "./play_parts.js";

/** A rating before the first frame: mean, standard deviation; in steps of so much Elo. */
const PRIOR = [1700, 600], STEP = 5;
/** Pots by the way of cue ball and ball [m]. */
const WAYS = [[0, 1, "up to 1 m"], [1, 2, "1 to 2 m"], [2, 9, "over 2 m"]];
const LAST = 30, W = 360;

/** The quantile 2.5 %, the median and the quantile 97.5 % of a person's Elo: levels are {elo, won, lost}; strengths as of Bradley and Terry. */
export function rate(levels) {
  const at = [], weight = [], unit = Math.LN10 / 400;
  for (let elo = -500; elo < 3500; elo += STEP) {
    at.push(elo);
    weight.push(levels.reduce((sum, { elo: other, won, lost }) => sum - won * Math.log1p(Math.exp((other - elo) * unit)) - lost * Math.log1p(Math.exp((elo - other) * unit)), -0.5 * ((elo - PRIOR[0]) / PRIOR[1]) ** 2));
  }
  const most = Math.max(...weight), shares = weight.map(one => Math.exp(one - most)), all = shares.reduce((a, b) => a + b);
  return [0.025, 0.5, 0.975].map(part => { let sum = 0; return at[shares.findIndex(one => (sum += one / all) >= part)]; });
}

/** The 95 % interval of a share of made in tries (Wilson). */
export function wilson(made, tries) {
  const share = made / tries, z = 3.8415 / tries, middle = share + z / 2, half = Math.sqrt(3.8415 * share * (1 - share) / tries + z * z / 4);
  return [Math.max(0, (middle - half) / (1 + z)), Math.min(1, (middle + half) / (1 + z))];
}

const svg = (high, label, inside) => `<svg viewBox="0 0 ${W} ${high}" role="img" aria-label="${label}">${inside}</svg>`;
const text = (x, y, words, more = "") => `<text x="${x}" y="${y}" ${more}>${words}</text>`;

export class Person {
  constructor(app) {
    this.app = app;
    const act = (id, what) => { by(id).onclick = () => this.try(what); };
    by("mine-open").onclick = async () => { by("mine-coach-says").textContent = ""; await this.try(() => ask("person", {})); by("mine").showModal(); };
    by("mine-name").onchange = () => this.try(() => ask("person", { name: by("mine-name").value.trim() }));
    act("mine-export", async () => { keep("snooker-person.json", JSON.stringify(await ask("person", {})), "application/json"); });
    act("mine-delete", async () => ((await confirmed("Delete your file, with all frames? This cannot be undone.", "Delete")) ? ask("person", { delete: true }) : undefined));
    act("mine-coach", () => this.coach());
  }

  async try(what) {
    by("mine-wrong").textContent = "";
    try {
      const found = await what();
      if (found) this.show(found);
    } catch (error) { by("mine-wrong").textContent = error.message; }
  }

  async coach() {
    const button = by("mine-coach");
    button.disabled = true;
    button.textContent = "The coach reads your strokes …";
    try { by("mine-coach-says").textContent = (await ask("coach", {})).text; } catch (error) {
      if (error.field !== "strokes") throw error;
      by("mine-coach-says").textContent = "Not enough strokes yet: play another frame against one of the five.";
    } finally { button.disabled = false; button.textContent = "Ask the coach"; }
  }

  show({ path, name, frames, strokes }) {
    by("mine-name").value = name;
    const won = frames.filter(one => one.won).length, breaks = frames.flatMap(one => one.breaks).sort((a, b) => b - a);
    const levels = this.app.levels.map(level => {
      const rated = frames.filter(one => one.rated && one.opponent === level.name);
      return { ...level, won: rated.filter(one => one.won).length, lost: rated.filter(one => !one.won).length };
    });
    by("mine-path").textContent = path;
    by("mine-frames").textContent = frames.length ? `${frames.length} frame${frames.length > 1 ? "s" : ""}, ${won} won. ${breaks.length ? `Highest break: ${breaks[0]}. ` : ""}Breaks of 20 and more: ${breaks.filter(one => one >= 20).slice(0, 12).join(", ") || "none yet"}.`
      : "No frames yet. Each frame that you finish against an agent is kept, unless its balls were set up or loaded.";
    by("mine-rating").innerHTML = this.rating(levels);
    by("mine-breaks").innerHTML = this.bars(frames.slice(-LAST).map(one => Math.max(0, ...one.breaks)));
    by("mine-pots").innerHTML = this.pots(strokes);
    by("mine-coach").disabled = !strokes.length;
  }

  rating(levels) {
    const played = levels.reduce((sum, { won, lost }) => sum + won + lost, 0), [low, value, high] = rate(levels), elos = levels.map(({ elo }) => elo);
    const least = Math.min(...elos, played ? low : Infinity) - 60, most = Math.max(...elos, played ? high : -Infinity) + 60, at = elo => 30 + (W - 60) * (elo - least) / (most - least);
    const marks = levels.map(({ name, elo, won, lost }, k) => {
      const x = at(elo), y = k % 2 ? 84 : 62;
      return `<path class="tick" d="M${x} 40V${y - 12}"/>${text(x, y, `${won ? "✓ " : ""}${name}${won + lost ? ` ${won}:${lost}` : ""}`, `text-anchor="middle"${won ? ' class="beaten"' : ""}`)}`;
    });
    const own = played ? `<path class="whisker" d="M${at(low)} 30H${at(high)}"/><circle cx="${at(value)}" cy="30" r="6"/>${text(at(value), 17, `you, ${value}`, 'text-anchor="middle" class="own"')}` : "";
    const said = played ? `Rating ${value} (95 % interval ${low} to ${high}), from ${played} rated frame${played > 1 ? "s" : ""}.` : "No rated frame yet.";
    return `<p>${said}${levels.some(({ won }) => won) ? " ✓: beaten." : ""}</p>${svg(92, said, `<path class="tick" d="M20 40H${W - 20}"/>${marks.join("")}${own}`)}`;
  }

  bars(values) {
    if (!values.length) return "";
    const most = Math.max(20, ...values), wide = Math.min(34, (W - 40) / values.length), high = value => 70 * value / most;
    const bars = values.map((value, k) => `<rect x="${20 + k * wide}" y="${90 - high(value)}" width="${wide - 2}" height="${high(value) + 1}"/>${wide > 20 ? text(20 + (k + 0.5) * wide - 1, 85 - high(value), value, 'text-anchor="middle"') : ""}`);
    return `<p>Highest break of ${values.length > 1 ? `each of your last ${values.length} frames` : "your last frame"}${wide > 20 ? "" : `, up to ${most}`}:</p>${svg(96, `highest breaks, the last first: ${[...values].reverse().join(", ")}`, bars.join(""))}`;
  }

  pots(strokes) {
    const { names, pockets } = this.app, sums = WAYS.map(() => [0, 0]), sign = (words, one, other) => (words.includes(one) ? 1 : words.includes(other) ? -1 : 0);
    for (const { ball, pocket, potted, position } of strokes) {
      if (potted === undefined) continue;
      const [bx, by_] = ball < 16 ? position.reds[ball - 1] : position[names[ball]], [cx, cy] = position.cue;
      const into = pockets.find(({ x, y }) => Math.sign(x) === sign(pocket, "right", "left") && (Math.abs(y) < 1 ? 0 : Math.sign(y)) === sign(pocket, "top", "bottom"));
      const way = Math.hypot(bx - cx, by_ - cy) + Math.hypot(into.x - bx, into.y - by_), sum = sums[WAYS.findIndex(([low, high]) => way >= low && way < high)];
      sum[0]++;
      sum[1] += potted;
    }
    if (!sums.some(([tries]) => tries)) return "";
    const rows = sums.map(([tries, made], k) => {
      const y = 12 + 30 * k, at = share => 84 + 170 * share, [low, high] = tries ? wilson(made, tries) : [0, 0];
      return `${text(0, y + 12, WAYS[k][2])}<path class="tick" d="M84 ${y}V${y + 18}"/>${tries ? `<rect x="84" y="${y}" width="${170 * made / tries}" height="18"/><path class="whisker" d="M${at(low)} ${y + 9}H${at(high)}"/>` : ""}`
        + text(262, y + 13, tries ? `${Math.round(100 * made / tries)} %, ${made} of ${tries}` : "none");
    });
    return `<p>Pots by distance, cue ball to ball to pocket, with 95 % intervals:</p>${svg(100, `pots by distance: ${sums.map(([tries, made], k) => `${WAYS[k][2]}: ${made} of ${tries}`).join("; ")}`, rows.join(""))}`;
  }
}
