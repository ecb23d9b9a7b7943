// canvas.mjs: what is drawn on: linear colour and depth, triangles with a z-buffer, and the way to 8 bits.

export class Canvas {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.colour = new Float32Array(width * height * 3);
    this.depth = new Float32Array(width * height).fill(Infinity);
  }

  /** A soft grey, lighter towards the middle. */
  fillBackground() {
    const { width, height, colour } = this;
    for (let y = 0, i = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        const fx = x / width - 0.5, fy = y / height - 0.45;
        const grey = 0.42 - 0.3 * (fx * fx + fy * fy);
        colour[i++] = grey * 0.97;
        colour[i++] = grey;
        colour[i++] = grey * 1.03;
      }
    }
  }

  /**
   * Draws triangles `indices` over vertices: `screen` [x, y, depth] in pixels, `colours` [r, g, b], `across` from -1 at
   * a ribbon's left edge to 1 at its right one, `grain` a random number for each ribbon. Each ribbon shows finer hairs
   * along it: a strand of the simulation stands for several.
   */
  drawRibbons(indices, screen, colours, across, grain) {
    for (let i = 0; i < indices.length; i += 3) {
      this.drawTriangle(indices[i], indices[i + 1], indices[i + 2], screen, colours, across, grain);
    }
  }

  drawTriangle(a, b, c, screen, colours, across, grain) {
    const { width, height, colour, depth } = this;
    const ax = screen[3 * a], ay = screen[3 * a + 1], az = screen[3 * a + 2];
    const bx = screen[3 * b], by = screen[3 * b + 1], bz = screen[3 * b + 2];
    const cx = screen[3 * c], cy = screen[3 * c + 1], cz = screen[3 * c + 2];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    const left = Math.max(0, Math.floor(Math.min(ax, bx, cx))), right = Math.min(width - 1, Math.ceil(Math.max(ax, bx, cx)));
    const top = Math.max(0, Math.floor(Math.min(ay, by, cy))), bottom = Math.min(height - 1, Math.ceil(Math.max(ay, by, cy)));
    if (!area || left > right || top > bottom || !(az > 0 && bz > 0 && cz > 0)) {
      return;
    }
    const inverse = 1 / area;
    for (let y = top; y <= bottom; y++) {
      for (let x = left; x <= right; x++) {
        const px = x + 0.5, py = y + 0.5;
        const wb = ((px - ax) * (cy - ay) - (py - ay) * (cx - ax)) * inverse;
        const wc = ((bx - ax) * (py - ay) - (by - ay) * (px - ax)) * inverse;
        const wa = 1 - wb - wc;
        const at = y * width + x;
        const z = wa * az + wb * bz + wc * cz;
        if (wa < 0 || wb < 0 || wc < 0 || z >= depth[at]) {
          continue;
        }
        depth[at] = z;
        const u = wa * across[a] + wb * across[b] + wc * across[c];
        const hair = 1 + 0.16 * Math.sin(u * 7 + grain[a] * 40) + 0.1 * Math.sin(u * 17 + grain[a] * 90);
        for (let k = 0; k < 3; k++) {
          colour[3 * at + k] = hair * (wa * colours[3 * a + k] + wb * colours[3 * b + k] + wc * colours[3 * c + k]);
        }
      }
    }
  }

  /** Averages `factor` x `factor` pixels into one and turns linear light into 8-bit sRGB. */
  toBytes(factor) {
    const width = Math.floor(this.width / factor), height = Math.floor(this.height / factor);
    const rgb = new Uint8Array(width * height * 3);
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        for (let k = 0; k < 3; k++) {
          let sum = 0;
          for (let j = 0; j < factor * factor; j++) {
            const sx = x * factor + (j % factor), sy = y * factor + Math.floor(j / factor);
            sum += Math.min(1.2, this.colour[3 * (sy * this.width + sx) + k]);
          }
          rgb[3 * (y * width + x) + k] = encodeSrgb(sum / (factor * factor));
        }
      }
    }
    return { width, height, rgb };
  }
}

/**
 * Pushes the edges of ribbons that are seen from their side apart, to `least` pixels: a hair shows from every side.
 * `screen` holds [x, y, depth] of the left and the right edge in turn.
 */
export function widenRibbons(screen, perStrand, least) {
  let lastX = 1, lastY = 0;
  for (let point = 0; point < screen.length / 6; point++) {
    const left = 6 * point, right = left + 3, i = point % perStrand;
    const before = i > 0 ? left - 6 : left, after = i + 1 < perStrand ? left + 6 : left;
    let x = screen[right] - screen[left], y = screen[right + 1] - screen[left + 1];
    const width = Math.hypot(x, y);
    if (width < least) {
      /* across the strand on the picture, on the side that the ribbon last showed */
      x = screen[before + 1] - screen[after + 1];
      y = screen[after] - screen[before];
      const size = Math.hypot(x, y) || 1, side = x * lastX + y * lastY < 0 ? -1 : 1;
      const push = side * (least - width) / (2 * size);
      screen[left] -= push * x;
      screen[left + 1] -= push * y;
      screen[right] += push * x;
      screen[right + 1] += push * y;
    }
    lastX = screen[right] - screen[left];
    lastY = screen[right + 1] - screen[left + 1];
  }
}

function encodeSrgb(linear) {
  const v = Math.max(0, Math.min(1, linear));
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
}

/** Pictures beside and below one another: `rows` of equal pictures { width, height, rgb }. */
export function joinSheet(rows) {
  const { width, height } = rows[0][0];
  const columns = Math.max(...rows.map((row) => row.length));
  const sheet = { width: width * columns, height: height * rows.length };
  sheet.rgb = new Uint8Array(sheet.width * sheet.height * 3).fill(128);
  rows.forEach((row, r) => row.forEach((picture, c) => {
    for (let y = 0; y < height; y++) {
      const line = picture.rgb.subarray(3 * y * width, 3 * (y + 1) * width);
      sheet.rgb.set(line, 3 * ((r * height + y) * sheet.width + c * width));
    }
  }));
  return sheet;
}
