// light.mjs: how much light comes through the hair: depth maps from the lights and from all around.
//
// A map holds for each cell how near the light the first hair is. What lies deeper is dimmed with the depth of hair
// above it, softly, as in deep opacity maps; the mean over directions all around serves as ambient occlusion.
import { cross, dot, unit } from './vector.mjs';

const CELLS = 192;
const NEIGHBOURS = [0, 1, -1, CELLS, -CELLS, 2 * CELLS, -2 * CELLS, 2, -2];
/* metres of hair that dim the light to a third */
const KEY_REACH = 0.012, AMBIENT_REACH = 0.022;

class DepthMap {
  constructor(direction, radius, points) {
    this.toLight = unit(direction);
    this.x = unit(cross(this.toLight, Math.abs(this.toLight[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));
    this.y = cross(this.x, this.toLight);
    this.perMetre = CELLS / (2 * radius);
    this.nearest = new Float32Array(CELLS * CELLS).fill(-Infinity);
    for (let i = 0; i < points.length; i += 3) {
      const at = this.cell(points, i);
      this.nearest[at] = Math.max(this.nearest[at], this.height(points, i));
    }
  }

  height(points, i) {
    return points[i] * this.toLight[0] + points[i + 1] * this.toLight[1] + points[i + 2] * this.toLight[2];
  }

  cell(points, i) {
    const { x, y, perMetre } = this, px = points[i], py = points[i + 1], pz = points[i + 2];
    const column = Math.floor(CELLS / 2 + (px * x[0] + py * x[1] + pz * x[2]) * perMetre);
    const row = Math.floor(CELLS / 2 + (px * y[0] + py * y[1] + pz * y[2]) * perMetre);
    return Math.max(0, Math.min(CELLS - 1, row)) * CELLS + Math.max(0, Math.min(CELLS - 1, column));
  }

  /** Share of the light that reaches point i, taken over the cells around it to soften the edges. */
  through(points, i, reach) {
    const at = this.cell(points, i), height = this.height(points, i) + 0.002;
    let sum = 0;
    for (let k = 0; k < NEIGHBOURS.length; k++) {
      const above = this.nearest[at + NEIGHBOURS[k]];
      sum += above > height ? Math.exp((height - above) / reach) : 1; /* nothing, or beyond the map: all of it */
    }
    return sum / NEIGHBOURS.length;
  }
}

const AROUND = [[0, 1, 0], [0.8, 0.5, 0.3], [-0.8, 0.5, 0.3], [0.3, 0.5, 0.9], [-0.3, 0.5, -0.9], [0.9, -0.2, -0.4],
  [-0.9, -0.2, -0.4], [0, -0.3, 1], [0, -0.8, -0.3]];

/** Light that arrives at points, given all the points that stand in its way. */
export class Shade {
  constructor(blockers, radius) {
    this.blockers = blockers;
    this.radius = radius;
    this.around = AROUND.map((direction) => new DepthMap(direction, radius, blockers));
  }

  key(direction) {
    return new DepthMap(direction, this.radius, this.blockers);
  }

  static keyAt(map, points, i) {
    return map.through(points, i, KEY_REACH);
  }

  ambientAt(points, i) {
    let sum = 0;
    for (const map of this.around) {
      sum += map.through(points, i, AMBIENT_REACH);
    }
    return sum / this.around.length;
  }

  /** The same for a surface, which sees only what is before it. */
  ambientBefore(point, normal) {
    let sum = 0, weights = 0.1;
    for (const map of this.around) {
      const weight = Math.max(0, dot(normal, map.toLight) + 0.2);
      sum += weight && weight * map.through(point, 0, AMBIENT_REACH);
      weights += weight;
    }
    return sum / weights;
  }
}
