/**
 * Where does a first aim point? At the ball on with the widest pot, else at a reachable one, thinly while the pack is whole: no foul by Play alone.
 */

import { firstContact } from "./play_parts.js";

const OFFSETS = [0, 0.5, -0.5, 0.8, -0.8, 0.93, -0.93];
const PACK = 12;

/** The aim [rad] for a state, or `otherwise` if nothing is on. balls: as shown; names: of the balls by index. */
export function firstAim(state, balls, names, extent, R, otherwise) {
  const [cx, cy] = state.positions.cue, on = new Set(state.balls_on.map(name => names.indexOf(name)));
  const met = aim => firstContact(balls, 0, aim, extent, R).ball;
  const open = state.lines.filter(line => line.open && on.has(met(line.aim))).sort((a, b) => b.tolerance - a.tolerance)[0];
  if (open) return open.aim;
  const ways = [], packed = state.reds > PACK && on.size > PACK;
  for (const ball of on) {
    const x = balls.x[ball] - cx, y = balls.y[ball] - cy, far = Math.hypot(x, y), wide = Math.asin(Math.min(1, 2 * R / far));
    for (const offset of OFFSETS) {
      const aim = Math.atan2(y, x) + wide * offset, clear = met(aim) === ball;
      // a break off strikes an end red of the pack thinly; any other stroke the nearest ball, as full as it can
      const cost = packed ? 3 * (1 - Math.abs(offset)) - Math.abs(balls.x[ball]) : far + Math.abs(offset);
      ways.push({ aim, cost: cost + (clear ? 0 : 99) });
    }
  }
  return ways.sort((a, b) => a.cost - b.cost)[0]?.aim ?? otherwise;
}
