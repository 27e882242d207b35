/**
 * How does the table sound? Cue, balls, cushions and pockets, each a short sum of dying tones and noise, made here.
 */

import { by, kept } from "./play_parts.js";

const BALL = 0, CUSHION = 1, JAW = 2, POCKET = 3, CUE = 8;
/** Of each sound: length [s], share of noise, [frequency [Hz], time in which it dies [s], strength] of its tones. */
const TONES = {
  [BALL]: [0.06, 0.15, [2350, 0.007, 0.6], [4100, 0.004, 0.4], [6700, 0.002, 0.2]],
  [CUSHION]: [0.16, 0.1, [95, 0.04, 0.8], [210, 0.02, 0.4]],
  [POCKET]: [0.45, 0.25, [72, 0.11, 0.9], [160, 0.06, 0.5], [390, 0.03, 0.2]],
  [CUE]: [0.07, 0.2, [780, 0.012, 0.7], [1500, 0.006, 0.4]],
};
TONES[JAW] = TONES[CUSHION];
/** The speed of a meeting that is as loud as can be [m/s], and the one that is not heard. */
const LOUD = 4, SILENT = 0.02;

export class Sound {
  constructor() {
    this.on = kept.get("sound", true);
    this.made = {};
    by("sound").onclick = () => this.flip();
    this.show();
  }

  flip() {
    this.on = !this.on;
    kept.set("sound", this.on);
    this.show();
  }

  show() { by("sound").setAttribute("aria-pressed", String(this.on)); }

  /** A browser allows sound once the player has touched the page. */
  wake() {
    if (!this.on || !window.AudioContext) return;
    this.context ??= new AudioContext();
    if (this.context.state === "suspended") this.context.resume();
  }

  buffer(kind) {
    const [long, noise, ...tones] = TONES[kind], { sampleRate } = this.context, n = Math.ceil(long * sampleRate), made = this.context.createBuffer(1, n, sampleRate);
    const out = made.getChannelData(0);
    for (let k = 0; k < n; k++) {
      const t = k / sampleRate, end = Math.min(1, 20 * (1 - k / n));
      out[k] = tones.reduce((sum, [f, dies, strong]) => sum + strong * Math.exp(-t / dies) * Math.sin(2 * Math.PI * f * t), noise * Math.exp(-t / tones[0][1]) * (2 * Math.random() - 1)) * end;
    }
    return made;
  }

  play(kind, speed, rate = 1) {
    if (!this.on || this.context?.state !== "running" || !TONES[kind] || speed < SILENT) return;
    const source = this.context.createBufferSource(), gain = this.context.createGain();
    source.buffer = this.made[kind] ??= this.buffer(kind);
    source.playbackRate.value = rate;
    gain.gain.value = 0.7 * Math.min(1, speed / LOUD) ** 0.8;
    source.connect(gain).connect(this.context.destination);
    source.start();
  }

  /** What happened in a stroke after time `from`, up to `until`; `rate`: of slow motion. */
  passed(stroke, from, until, rate) {
    if (!this.on || !this.context) return;
    if (from < 0 && until >= 0 && stroke.cue) this.play(CUE, stroke.cue.speed, rate);
    for (const [t, kind, i, j] of stroke.events) {
      if (t <= from || t > until || !TONES[kind]) continue;
      const before = stroke.at(t - 1e-5), part = name => before[name][i] - (kind === BALL ? before[name][j] : 0);
      this.play(kind, Math.hypot(part("vx"), part("vy")) * (kind === CUSHION || kind === JAW ? 0.6 : 1), rate);
    }
  }
}
