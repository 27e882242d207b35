/** What of a table never moves? Frame, pockets, cloth, lines, cushions and the light, painted once for each size. */

/** Places along a board from the cloth outwards, and how light the wood is there. */
const BOARD = [[0, 0.5], [0.07, 1.1], [0.12, 1.4], [0.16, 1.1], [0.7, 1.2], [0.8, 1.6], [0.9, 1.2], [1, 0.4]];
/** Strokes of a pocket's leather, bright along its ridge: how far outside [m], width [m], light, shadow [m]. */
const LEATHER = [[0.01, 0.02, 0.7, 0.02], [0.01, 0.014, 1.2, 0], [0.0085, 0.006, 2.1, 0]];
/** The light on a cushion's nose: width [m], opacity. */
const NOSE = [[0.02, 0.3], [0.011, 0.7]];

/** The table of a `TableView` without balls, as a canvas. */
function painted(view) {
  const [still, pen] = sheet(view.canvas.width, view.canvas.height);
  pen.fillStyle = view.ink.floor;
  pen.fillRect(0, 0, still.width, still.height);
  view.metres(pen);
  const painter = new Painter(view, pen);
  if (painter.framed) painter.boards();
  painter.throats();
  pen.save();
  painter.rectangle(painter.bed);
  pen.clip();
  fill(pen, view.ink.hole);
  painter.cloth();
  painter.cushions();
  pen.restore();
  painter.leather();
  painter.lamps();
  return still;
}

class Painter {
  constructor(view, pen) {
    const { scene, colours, ink, scale } = view;
    Object.assign(this, { view, pen, scene, colours, ink, scale });
    this.pixel = 1 / scale; // [m]
    this.framed = scene.cushions.length > 0;
    this.bed = this.framed ? scene.cushion : 9; // how far the cloth reaches beyond the noses [m]
  }

  /** Begin a path around the table, so far outside its noses. */
  rectangle(out, corner = 0) {
    const [[x0, x1], [y0, y1]] = this.scene.extent;
    this.pen.beginPath();
    this.pen.roundRect(x0 - out, y0 - out, x1 - x0 + 2 * out, y1 - y0 + 2 * out, corner);
  }

  /** Fill with grain, stretched along y, or along x. */
  texture(strength, along, across, swap) {
    const pattern = this.pen.createPattern(grain(strength), "repeat");
    const a = along * this.pixel;
    const b = across * this.pixel;
    pattern.setTransform(new DOMMatrix(swap ? [a, 0, 0, b, 0, 0] : [0, a, b, 0, 0, 0]));
    fill(this.pen, pattern);
  }

  /** Four boards, mitred, round outside, with a groove inside. */
  boards() {
    const { pen, colours, ink, bed, scene } = this;
    const { rail } = scene;
    const [[x0, x1], [y0, y1]] = scene.extent;
    const corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    const at = ([x, y], out) => [x + sign(x) * out, y + sign(y) * out];
    this.rectangle(rail, 0.085);
    cast(pen, "#000c", 0.04 * this.scale, ink.wood_edge);
    this.rectangle(rail - 0.003, 0.082);
    pen.save();
    pen.clip();
    corners.forEach((one, k) => {
      const next = corners[(k + 1) % 4];
      const end = k % 2 === 0; // a short board
      const [ix, iy] = at(one, bed);
      const [ox, oy] = at(one, rail);
      polyline(pen, [one, at(one, rail), at(next, rail), next]);
      const across = pen.createLinearGradient(ix, iy, end ? ix : ox, end ? oy : iy);
      fill(pen, across, ...BOARD.map(([part, light]) => [part, css(lit(colours.wood, light))]));
      this.texture(0.07, 30, 1.6, end);
    });
    pen.restore();
  }

  /** Begin the path of a pocket's wall, from so far from its back to its mouth; returns a gradient around it. */
  pocket([x, y, u, v, half], rim, from = hypot(u - x, v - y)) {
    const { pen } = this;
    const turn = atan2(v - y, u - x);
    const ex = cos(turn);
    const ey = sin(turn);
    const wide = half + rim;
    const bx = u - ex * from;
    const by = v - ey * from;
    polyline(pen, [[bx - ey * wide, by + ex * wide]]);
    pen.arc(u, v, wide, turn + PI / 2, turn - PI / 2, true);
    pen.lineTo(bx + ey * wide, by - ex * wide);
    return pen.createRadialGradient(u, v, 0, u, v, half);
  }

  /** The inside of pockets, in the dark. */
  throats() {
    const { pen, scene, ink, colours } = this;
    for (const throat of scene.throats) {
      fill(pen, this.pocket(throat, 0), [0.6, ink.hole], [1, css(lit(colours.leather, 0.6))]);
    }
  }

  /** The cloth with its lines and spots, cut out where balls fall. */
  cloth() {
    const { pen, scene, ink, colours, pixel } = this;
    const { lines, falls } = scene;
    pen.save();
    this.rectangle(9);
    for (const [x, y, r] of falls) {
      pen.moveTo(x + r, y);
      pen.arc(x, y, r, 0, TURN);
    }
    pen.clip("evenodd");
    this.rectangle(this.bed);
    fill(pen, ink.cloth);
    this.texture(0.025, 3, 1);
    this.texture(0.018, 40, 5);
    const chalk = css(colours.line, 0.9);
    for (const points of lines ? [lines.baulk, lines.d] : []) polyline(pen, points, max(0.0035, 1.2 * pixel), chalk);
    for (const [x, y] of lines?.spots ?? []) disc(pen, x, y, max(0.006, 1.4 * pixel), chalk);
    for (const [x, y, r] of falls) {
      const reach = r + 0.014; // where the cloth bends down
      glow(pen, x, y, reach, [r / reach, ink.cloth_edge], [1, css(colours.cloth_edge, 0)]);
    }
    pen.restore();
  }

  /** The cushions, lighter at the nose, with the light on its edge. */
  cushions() {
    const { pen, scene, colours } = this;
    scene.cushions.forEach((points, k) => {
      const nose = scene.noses[k];
      const a = nose[(nose.length >> 1) - 1];
      const b = nose[nose.length >> 1];
      const [x, y] = points[0];
      const alongX = abs(a[0] - b[0]) > abs(a[1] - b[1]);
      const slope = alongX ? pen.createLinearGradient(0, a[1], 0, y) : pen.createLinearGradient(a[0], 0, x, 0);
      const stops = [[0, css(lit(colours.cushion, 1.2))], [1, css(lit(colours.cushion, 0.72))]];
      polyline(pen, points);
      cast(pen, css(colours.shadow, 0.9), 0.03 * this.scale, slope, ...stops);
      pen.save();
      pen.clip();
      for (const [wide, alpha] of NOSE) polyline(pen, nose, max(wide, 2 * this.pixel), css(colours.nose, alpha));
      pen.restore();
    });
  }

  /** The pockets' leather, cut off where both ends lie on the cushions. */
  leather() {
    const { pen, scene, colours, bed } = this;
    const [[, x1], [, y1]] = scene.extent;
    for (const throat of scene.throats) {
      const [x, y, u, v, half] = throat;
      const long = hypot(u - x, v - y);
      const dx = (x - u) / long;
      const dy = (y - v) / long;
      const over = (side, at) => {
        const wide = side * (half + 0.02);
        return max(abs(u + dx * at - dy * wide) - x1, abs(v + dy * at + dx * wide) - y1) > bed - 0.007;
      };
      let from = -0.05;
      while (from < long && (over(1, from) || over(-1, from))) from += 0.001;
      for (const [rim, wide, light, shadow] of LEATHER) {
        this.pocket(throat, rim, from);
        cast(nib(pen, css(lit(colours.leather, light)), wide), "#000c", shadow * this.scale);
      }
    }
  }

  /** The lamps: brightest in the middle. */
  lamps() {
    const { pen, view, scale, scene } = this;
    const [[x0, x1], [y0, y1]] = scene.extent;
    const middle = view.pixel((x0 + x1) / 2, (y0 + y1) / 2);
    const [wide, high] = view.way(scale * (y1 - y0), scale * (x1 - x0)).map(abs);
    pen.setTransform(wide, 0, 0, high, ...middle);
    glow(pen, 0, 0, 2, [0, "#ffffe008"], [0.17, "#0000"], [0.42, "#0003"]);
  }
}
