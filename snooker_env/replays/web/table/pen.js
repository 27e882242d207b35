/** How does a 2-D canvas draw what tables are made of? Colours, fills with gradients, discs, lines, soft shadows. */

const WHITE = [255, 255, 255];
const BLACK = [0, 0, 0];

/** A colour as CSS; text stays as it is. */
const css = (rgb, alpha = 1) => (rgb.map ? `rgba(${rgb.map(round)},${alpha})` : rgb);
/** A colour, darker or lighter. */
const lit = (rgb, light) => rgb.map(value => min(255, value * light));
/** A colour between two. */
const mix = (a, b, share) => a.map((value, k) => value + (b[k] - value) * share);

/** A new canvas and its pen. */
function sheet(width, height) {
  const canvas = Object.assign(document.createElement("canvas"), { width: ceil(width), height: ceil(height) });
  return [canvas, canvas.getContext("2d")];
}

/** Grain for cloth and wood, reproducible. */
function grain(strength) {
  const [canvas, pen] = sheet(256, 256);
  const image = pen.createImageData(256, 256);
  let seed = 1;
  for (let k = 0; k < 65536; k++) {
    seed = (Math.imul(seed, 1664525) + 1013904223) | 0;
    image.data.set([...(seed > 0 ? WHITE : BLACK), abs(seed) / 2 ** 23 * strength], 4 * k);
  }
  pen.putImageData(image, 0, 0);
  return canvas;
}

/** Fill what a pen has drawn, with a gradient by its stops [place, colour]. */
function fill(pen, filling, ...stops) {
  for (const [at, colour] of stops) filling.addColorStop(at, colour);
  pen.fillStyle = filling;
  pen.fill();
}

/** The same, or a line, with a soft shadow around it. */
function cast(pen, colour, blur, ...filling) {
  pen.shadowColor = colour;
  pen.shadowBlur = blur;
  if (filling.length) fill(pen, ...filling);
  else pen.stroke();
  pen.shadowColor = "#0000";
}

export function disc(pen, x, y, radius, filling, ...stops) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, TURN);
  if (filling) fill(pen, filling, ...stops);
  else pen.stroke();
}

/** A disc with a gradient from its middle to its edge. */
function glow(pen, x, y, radius, ...stops) {
  disc(pen, x, y, radius, pen.createRadialGradient(x, y, 0, x, y, radius), ...stops);
}

/** Set a pen's line style. */
export const nib = (pen, strokeStyle, lineWidth) => Object.assign(pen, { strokeStyle, lineWidth });

/** A path through points, drawn if it has a width. */
function polyline(pen, points, width, colour) {
  pen.beginPath();
  for (const point of points) pen.lineTo(...point);
  if (width) nib(pen, colour, width).stroke();
}
