// camera.mjs: where one looks from. Everything is relative to the head's centre, in world axes, so that the camera
// follows the head wherever it goes but does not turn with it.
import { cross, dot, rotate, scale, sub, unit } from './vector.mjs';

const FIELD_OF_VIEW = 28 * Math.PI / 180; /* vertical */

/** Directions from the head towards the camera, by name. */
export const VIEWS = {
  front: [0, 0.08, 1],
  'three-quarter': [0.72, 0.16, 0.8],
  side: [1, 0.05, 0],
  'other-side': [-1, 0.05, 0],
  back: [0, 0.1, -1],
  'back-quarter': [0.72, 0.2, -0.8],
  top: [0, 1, 0.02],
};

export class Camera {
  /** Looks at `target` so that a ball of `radius` about it fits a picture of width x height pixels. */
  constructor(view, target, radius, width, height) {
    this.forward = scale(unit(VIEWS[view]), -1);
    this.right = unit(cross(this.forward, [0, 1, 0]));
    this.up = cross(this.right, this.forward);
    const narrow = Math.min(1, width / height);
    const distance = radius / (Math.sin(FIELD_OF_VIEW / 2) * narrow);
    this.position = sub(target, scale(this.forward, distance));
    this.pixels = height / (2 * Math.tan(FIELD_OF_VIEW / 2));
    this.width = width;
    this.height = height;
  }

  /** [x, y, depth] for each of `points` [x, y, z]. */
  project(points) {
    const screen = new Float32Array(points.length);
    const { position, right, up, forward } = this;
    for (let i = 0; i < points.length; i += 3) {
      const p = [points[i] - position[0], points[i + 1] - position[1], points[i + 2] - position[2]];
      const depth = dot(p, forward);
      const zoom = this.pixels / depth;
      screen[i] = this.width / 2 + zoom * dot(p, right);
      screen[i + 1] = this.height / 2 - zoom * dot(p, up);
      screen[i + 2] = depth;
    }
    return screen;
  }

  /** Direction through the middle of pixel x, y; a point at depth d lies at position + d * direction. */
  ray(x, y) {
    const a = (x + 0.5 - this.width / 2) / this.pixels, b = (this.height / 2 - y - 0.5) / this.pixels;
    const { right, up, forward } = this;
    return [forward[0] + a * right[0] + b * up[0], forward[1] + a * right[1] + b * up[1],
      forward[2] + a * right[2] + b * up[2]];
  }
}

/** Ribbon vertices of a frame, turned into world axes about the head. */
export function turnVertices(positions, orientation) {
  const turned = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    turned.set(rotate(orientation, [positions[i], positions[i + 1], positions[i + 2]]), i);
  }
  return turned;
}
