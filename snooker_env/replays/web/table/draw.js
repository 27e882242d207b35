/**
 * How is a table drawn with its balls? By a `TableView` on a canvas, from its scene; each frame says where the balls are.
 *
 * On screen +y goes right and +x down; on a canvas that may stand and is higher than wide, +y goes up and +x right.
 * A frame has `x`, `y`, `on` of all balls; and, as it likes, `z` (heights), `side` (a view from the side), `depth` (0 on the cloth, 1 gone into a pocket),
 * `turns`, `labels`, `lines` (with `points`, or a `path`, a Path2D in metres), `rings`, `heat`, `highlight` and `cue`.
 */

/** How far a lamp is above the balls [m]. */
const LAMP_HEIGHT = 0.95;
/** How far the eye is above the bed [m]: a ball that flies looks larger. */
const EYE = 2;
/** The view from the side: how much is seen above the bed [m], and how far it lies inside the upper edge [m]. */
const SIDE = [0.3, 0.04];
/** How strong a map is where it is strongest, and what share of that is not drawn: it must not fog the table. */
const [HEAT, FAINT] = [220, 0.2];

/** Draws a table; its constant parts once for each size. `stands`: it may stand upright. */
export class TableView {
  constructor(canvas, scene, stands = false) {
    Object.assign(this, { canvas, scene, stands, R: scene.ball_radius, colours: scene.palette });
    this.pen = canvas.getContext("2d", { alpha: false });
    this.ink = Object.fromEntries(Object.entries(this.colours).map(([name, rgb]) => [name, css(rgb)]));
    const [lamp, pen] = sheet(32, 32);
    const stops = [[0, 1], [0.3, 0.8], [0.6, 0.2], [1, 0]];
    glow(pen, 16, 16, 16, ...stops.map(([at, alpha]) => [at, css(this.colours.lamp, alpha)]));
    this.lamp = lamp;
    this.resize();
  }

  /** Breadth, height [m]. */
  static size(scene) {
    const [[x0, x1], [y0, y1]] = scene.extent;
    const out = scene.cushions.length ? 2 * scene.rail + 0.04 : 0.1;
    return [y1 - y0 + out, x1 - x0 + out];
  }

  /** Fit the canvas to its layout. */
  resize() {
    const { canvas, scene } = this;
    const [[x0, x1], [y0, y1]] = scene.extent;
    const [wide, high] = TableView.size(scene);
    this.ratio = min(devicePixelRatio, 3);
    const w = (canvas.width = round(canvas.clientWidth * this.ratio) || canvas.width);
    const h = (canvas.height = round(canvas.clientHeight * this.ratio) || canvas.height);
    this.upright = this.stands && h > w;
    this.scale = this.upright ? min(w / high, h / wide) : min(w / wide, h / high);
    this.look((x0 + x1) / 2, (y0 + y1) / 2, this.scale);
    this.sprites = new Map();
    if (this.still?.width !== w || this.still?.height !== h) this.still = null;
  }

  /** Show a place [m] in the middle, at so many of the canvas's own pixels for a metre. */
  look(x, y, scale) {
    const [px, py] = this.way(y, x);
    Object.assign(this, { scale, left: this.canvas.width / 2 - scale * px, top: this.canvas.height / 2 - scale * py });
  }

  /** A direction on the screen, right and down: of one along and across the table. */
  way(along, across) {
    return this.upright ? [across, -along] : [along, across];
  }

  /** CSS pixels on the canvas of a place [m]. */
  toScreen(x, y) {
    return this.pixel(x, y).map(value => value / this.ratio);
  }

  /** The place [m] of CSS pixels on the canvas. */
  toTable(px, py) {
    const [right, down] = [(px * this.ratio - this.left) / this.scale, (py * this.ratio - this.top) / this.scale];
    return this.upright ? [right, -down] : [down, right];
  }

  /** The canvas's own pixels of a place [m]. */
  pixel(x, y) {
    const [right, down] = this.way(y, x);
    return [this.left + this.scale * right, this.top + this.scale * down];
  }

  /** Let a pen draw in metres. */
  metres(pen) {
    const { scale, left, top } = this;
    if (this.upright) pen.setTransform(scale, 0, 0, -scale, left, top);
    else pen.setTransform(0, scale, scale, 0, left, top);
  }

  /** Draw the table with a frame, of which only x, y and on are required. */
  draw(frame) {
    this.still ??= painted(this);
    const { pen, ratio } = this;
    pen.resetTransform();
    pen.drawImage(this.still, 0, 0);
    for (const heat of frame.heat ?? []) this.heat(heat);
    for (const line of frame.lines ?? []) this.line(line);
    for (const ring of frame.rings ?? []) this.ring(ring);
    this.balls(frame);
    nib(pen, this.ink.aim, 2 * ratio);
    const radius = this.R * this.scale + 3 * ratio;
    for (const i of frame.highlight ?? []) disc(pen, ...this.pixel(frame.x[i], frame.y[i]), radius);
    if (frame.cue) this.cue(frame.cue);
    if (frame.side) this.side(frame);
  }

  balls(frame) {
    const { scene } = this;
    const [[x0, x1], [y0, y1]] = scene.extent;
    const radius = this.R * this.scale;
    const depth = i => frame.depth?.[i] ?? 1 - frame.on[i];
    const z = i => frame.z?.[i] ?? 0;
    const seen = [...frame.x.keys()].filter(i => depth(i) < 1).sort((a, b) => depth(b) - depth(a) || z(a) - z(b));
    for (const i of seen.filter(i => !depth(i))) { // shadows fall away from the lamps
      const [px, py] = this.pixel(frame.x[i], frame.y[i]);
      const far = radius * (1 + 2 * z(i) / this.R);
      const [right, down] = this.way(frame.y[i] / (y1 - y0) / 2, 0.14 + frame.x[i] / (x1 - x0) / 2);
      this.stamp(null, px + far * right, py + far * down, radius);
    }
    for (const i of seen) {
      if (depth(i)) this.falling(frame.x[i], frame.y[i], depth(i), scene.balls[i].rgb);
      else this.ball(frame, i, radius * (1 + z(i) / EYE));
    }
  }

  /** The table from its yellow side, over the upper edge of the picture: how high the balls are. */
  side(frame) {
    const { pen, scene, R, ink, canvas } = this;
    const [[x0], [y0, y1]] = scene.extent;
    const [high, inside] = SIDE;
    const scale = this.upright ? canvas.width / (y1 - y0) : this.scale;
    const [left, floor] = this.upright ? [0, (inside + high) * scale] : this.pixel(x0 + inside + high, y0);
    const wide = (y1 - y0) * scale;
    pen.globalAlpha = 0.7;
    pen.fillStyle = ink.bar;
    pen.fillRect(left, floor - high * scale, wide, (high + 0.02) * scale);
    pen.globalAlpha = 1;
    pen.fillStyle = ink.cloth;
    pen.fillRect(left, floor, wide, 0.02 * scale);
    if (scene.cushions.length) {
      pen.fillStyle = ink.cushion;
      for (const at of [left, left + wide - 0.02 * scale]) pen.fillRect(at, floor - 1.4 * R * scale, 0.02 * scale, 1.4 * R * scale);
    }
    const seen = [...frame.x.keys()].filter(i => frame.on[i]).sort((a, b) => frame.x[a] - frame.x[b]);
    for (const i of seen) {
      const z = frame.z[i];
      if (z < high) this.stamp(scene.balls[i].rgb, left + (frame.y[i] - y0) * scale, floor - (R + z) * scale, R * scale);
    }
  }

  /** A ball's picture, or its shadow if rgb is null: [canvas, half its width]. */
  sprite(rgb, radius) {
    const key = `${rgb} ${radius}`;
    const known = this.sprites.get(key);
    if (known) return known;
    const reach = rgb ? radius : 1.7 * radius;
    const half = ceil(reach) + 1;
    const [canvas, pen] = sheet(2 * half, 2 * half);
    const shade = [[0.4, 0.65], [0.68, 0.3], [0.85, 0.1], [1, 0]];
    const stops = rgb ? this.shine(rgb, radius) : shade.map(([at, alpha]) => [at, css(this.colours.shadow, alpha)]);
    glow(pen, half, half, reach, ...stops);
    this.sprites.set(key, [canvas, half]);
    return [canvas, half];
  }

  /** The colours of a ball from its middle to its edge, lit from above and by the cloth; small ones keep their colour. */
  shine(rgb, radius) {
    const dark = min(0.56, 0.02 * radius);
    return [0, 0.3, 0.5, 0.7, 0.85, 0.95, 1].map(d => {
      const z = sqrt(1 - d * d);
      const edge = (1 - z) ** 2.5;
      const body = lit(rgb, (1.06 - dark * (1 - z)) * (1 - dark * edge));
      return [d, css(body.map((value, k) => min(255, value + 26 * z ** 6 + 0.22 * edge * this.colours.cloth[k])))];
    });
  }

  /** The four lamps over the table in the mirror of a ball at (x, y), the far ones faint; in a small ball one light. */
  lamps(x, y, px, py, radius) {
    const { pen, lamp, scene } = this;
    const [, [, y1]] = scene.extent;
    const clear = min(1, max(0, radius / 9 - 0.8));
    const shine = (along, across, size, alpha) => {
      const [u, v] = this.way(along, across);
      pen.globalAlpha = alpha;
      pen.drawImage(lamp, px + radius * (u - size), py + radius * (v - size), 2 * radius * size, 2 * radius * size);
    };
    let u = 0;
    let v = 0;
    let all = 0;
    for (let k = 0; k < 4; k++) {
      const dy = (k - 1.5) * y1 / 2 - y;
      const far = hypot(x, dy, LAMP_HEIGHT);
      const norm = hypot(x, dy, LAMP_HEIGHT + far);
      const light = (LAMP_HEIGHT / far) ** 2;
      if (clear) shine(dy / norm, -x / norm, 0.22, clear * min(1, 0.2 + light));
      u += light * dy / norm;
      v -= light * x / norm;
      all += light;
    }
    shine(u / all, v / all, 0.55, 0.8 - 0.5 * clear);
    pen.globalAlpha = 1;
  }

  /** Spots on a ball where its six half axes come out, turned with it. */
  spots([w, a, b, c], colour, px, py, radius) {
    const { pen } = this;
    const axes = [
      [1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)],
      [2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)],
      [2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)],
    ];
    const size = 0.27 * radius;
    pen.beginPath();
    for (const axis of axes) {
      const [x, y, z] = axis[2] < 0 ? axis.map(value => -value) : axis;
      const [right, down] = this.way(y, x);
      const u = px + 0.96 * radius * right;
      const v = py + 0.96 * radius * down;
      const turn = atan2(down, right);
      pen.moveTo(u + size * z * cos(turn), v + size * z * sin(turn));
      pen.ellipse(u, v, size * z, size, turn, 0, TURN);
    }
    fill(pen, colour);
  }

  stamp(rgb, px, py, radius, size = 1) {
    const [image, half] = this.sprite(rgb, radius);
    const wide = half * size;
    this.pen.drawImage(image, px - wide, py - wide, 2 * wide, 2 * wide);
  }

  /** A ball falling into the nearest pocket: darker, smaller, further in. */
  falling(x, y, depth, rgb) {
    const [u, v] = this.scene.falls.find(fall => hypot(fall[0] - x, fall[1] - y) < 0.2) ?? [x, y];
    const part = sqrt(depth) / 2;
    this.pen.globalAlpha = 1 - depth;
    this.stamp(rgb, ...this.pixel(x + (u - x) * part, y + (v - y) * part), this.R * this.scale, 1 - 0.3 * depth);
    this.pen.globalAlpha = 1;
  }

  /** A ball on the cloth, with its spots, the lamps in it and its letter. */
  ball(frame, i, radius) {
    const { rgb, letter } = this.scene.balls[i];
    const x = frame.x[i];
    const y = frame.y[i];
    const at = this.pixel(x, y);
    const turn = frame.turns?.[i];
    const pale = 0.3 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2] > 110;
    const [ink, edge] = pale ? [BLACK, WHITE] : [WHITE, BLACK];
    this.stamp(rgb, ...at, radius);
    if (turn) this.spots(turn, i ? css(ink, 0.32) : this.ink.bar_accent, ...at, radius);
    this.lamps(x, y, ...at, radius);
    if (frame.labels) this.label(letter.toUpperCase(), css(ink), css(edge, 0.75), ...at, radius);
  }

  label(letter, ink, edge, px, py, radius) {
    const { pen } = this;
    const size = max(1.25 * radius, 9 * this.ratio);
    const low = py + 0.36 * size; // half a capital letter
    pen.font = `700 ${size}px system-ui,sans-serif`;
    pen.textAlign = "center";
    pen.lineJoin = "round";
    nib(pen, edge, 0.3 * radius).strokeText(letter, px, low);
    pen.fillStyle = ink;
    pen.fillText(letter, px, low);
  }

  /** A circle where a ball was or would be, with the ball in it if it is named. */
  ring({ x, y, ball, alpha = 0.45 }) {
    const { pen, ink, ratio } = this;
    const [px, py] = this.pixel(x, y);
    const radius = this.R * this.scale;
    pen.globalAlpha = alpha;
    if (ball !== undefined) this.stamp(this.scene.balls[ball].rgb, px, py, radius);
    pen.globalAlpha = min(1, alpha + 0.3);
    nib(pen, ink.text, 1.5 * ratio);
    disc(pen, px, py, radius);
    pen.globalAlpha = 1;
  }

  /** A line through points, or a `path` in metres, at least 3 pixels wide, with a dark edge. */
  line({ points = [], path, colour = this.ink.text, width = 0.007, dash = [] }) {
    const { pen } = this;
    const px = max(this.ratio, this.canvas.height / 1000) / this.scale;
    const wide = max(width, 3 * px);
    const way = path ?? new Path2D();
    for (const point of points) way.lineTo(...point);
    this.metres(pen);
    pen.lineJoin = pen.lineCap = "round";
    pen.setLineDash(dash);
    nib(pen, css(this.colours.path_edge, 0.55), wide + 2 * px).stroke(way);
    nib(pen, css(colour), wide).stroke(way);
    pen.setLineDash([]);
    pen.resetTransform();
  }

  /** Cells, ny rows along y of nx along x, stronger for larger values. */
  heat({ x0, y0, cell, nx, ny, values, rgb }) {
    const [canvas, pen] = sheet(nx, ny);
    const image = pen.createImageData(nx, ny);
    const most = values.reduce((a, b) => max(a, b), 0) || 1;
    for (let k = 0; k < nx * ny; k++) image.data.set([...rgb, HEAT * max(0, sqrt(values[k] / most) - FAINT)], 4 * k);
    pen.putImageData(image, 0, 0);
    this.metres(this.pen);
    this.pen.drawImage(canvas, x0, y0, nx * cell, ny * cell);
    this.pen.resetTransform();
  }

  /** The cue, its tip `pull` [m] behind the ball at (x, y). */
  cue({ x, y, aim, pull = 0.05, elevation = 0, alpha = 1 }) {
    const { pen } = this;
    const ex = cos(aim);
    const ey = sin(aim);
    const part = (from, to, colour) => {
      const corners = [[from, 1], [to, 1], [to, -1], [from, -1]].map(([d, side]) => {
        const back = this.R + pull + d * cos(elevation);
        const half = side * (0.0048 + 0.0065 * d);
        return [x - ex * back - ey * half, y - ey * back + ex * half];
      });
      polyline(pen, corners);
      cast(pen, css(this.colours.shadow, 0.4), 0.02 * this.scale, colour);
    };
    this.metres(pen);
    pen.globalAlpha = alpha;
    part(0, 1.45, "#d9b27c");
    part(0.95, 1.45, "#20130d");
    part(0, 0.008, "#3c6a9c");
    pen.globalAlpha = 1;
    pen.resetTransform();
  }
}
