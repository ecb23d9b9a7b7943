// body.mjs: head and body as one smooth surface: tapered capsules joined softly, found by sphere tracing.
import { colourAt, distance, faceParts, PAINT, shapeOf, SKIN } from '../../clients/web/page/body-shape.js';
import { add, dot, rotate, scale, sub, unit } from './vector.mjs';

export { DEFAULT_COLLIDERS } from '../../clients/web/page/body-shape.js';

function paintAt(face, point) {
  const [x, y, z] = rotate(face.toHead, point).map((v) => v / face.radius);
  let colour = null;
  for (const stroke of z > 0 ? PAINT : []) {
    const [ax, ay] = stroke.a, dx = stroke.b[0] - ax, dy = stroke.b[1] - ay;
    const t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
    if (Math.hypot(x - ax - t * dx, y - ay - t * dy) < stroke.radius) {
      colour = stroke.colour;
    }
  }
  return colour;
}

/** Head and body in world axes about the head: { parts, face }. `head` and `body` are { position, orientation }. */
export function placeBody(colliders, head, body) {
  const headParts = colliders.filter((part) => part.frame === 'head');
  const radius = Math.max(0, ...headParts.map((part) => Math.max(part.radius_a, part.radius_b)));
  const parts = [...colliders, ...(radius > 0 ? faceParts(radius) : [])].map((part) => {
    const pose = part.frame === 'head' ? head : body;
    const place = (p) => add(rotate(pose.orientation, p), sub(pose.position, head.position));
    const shape = shapeOf(part, place(part.a), place(part.b));
    return {
      ...shape, centre: add(shape.a, scale(shape.axis, shape.long / 2)),
      reach: shape.long / 2 + Math.max(part.radius_a, part.radius_b) + shape.join,
    };
  });
  const [x, y, z, w] = head.orientation;
  return { parts, face: radius > 0 ? { radius, toHead: [-x, -y, -z, w] } : null };
}

function normalAt(parts, [x, y, z]) {
  const e = 4e-4, d = distance(parts, x, y, z);
  return unit([distance(parts, x + e, y, z) - d, distance(parts, x, y + e, z) - d, distance(parts, x, y, z + e) - d]);
}

/** How open the surface is to the air around: less in its folds. */
function opennessAt(parts, [x, y, z], [nx, ny, nz]) {
  let open = 1;
  for (const far of [0.01, 0.03]) {
    open *= 0.5 + 0.5 * Math.max(0, Math.min(1, distance(parts, x + far * nx, y + far * ny, z + far * nz) / far));
  }
  return open;
}

/** Where the ray from `origin` along `direction` meets the surface: its depth, or Infinity. */
function trace(parts, [x, y, z], direction, near, far) {
  const [dx, dy, dz] = direction, speed = Math.hypot(dx, dy, dz);
  for (let depth = near, step = 0; depth < far; step++) {
    const d = distance(parts, x + depth * dx, y + depth * dy, z + depth * dz);
    if (d < (step < 48 ? 2e-4 : 2e-3)) { /* a grazing ray comes no nearer */
      return depth;
    }
    depth += Math.max(d, 2e-4) / speed;
  }
  return Infinity;
}

/** Points spread over the surface, to throw shadows from. */
export function surfacePoints({ parts }, count) {
  const points = [];
  for (let i = 0; i < count; i++) { /* golden spiral over three balls of each large part */
    const y = 1 - 2 * (i + 0.5) / count, ring = Math.sqrt(1 - y * y), turn = i * 2.399963;
    const direction = [ring * Math.cos(turn), y, ring * Math.sin(turn)];
    for (const part of parts.filter((each) => each.radius > 0.03)) {
      for (const at of [0, part.long / 2, part.long]) {
        points.push(...add(add(part.a, scale(part.axis, at)), scale(direction, part.radius + part.k * at)));
      }
    }
  }
  return points;
}

const BLOCK = 8; /* pixels; only the parts that a block of them may see are looked at */

/** Draws the surface. `light(point, normal)` gives the light that falls there as [r, g, b]. */
export function drawBody(canvas, camera, { parts, face }, light) {
  for (let by = 0; by < canvas.height; by += BLOCK) {
    for (let bx = 0; bx < canvas.width; bx += BLOCK) {
      const seen = { face, ...partsSeen(parts, camera, bx + BLOCK / 2, by + BLOCK / 2) };
      if (seen.parts.length === 0) {
        continue;
      }
      for (let y = by; y < Math.min(by + BLOCK, canvas.height); y++) {
        for (let x = bx; x < Math.min(bx + BLOCK, canvas.width); x++) {
          drawPixel(canvas, camera, seen, light, x, y);
        }
      }
    }
  }
}

/** The parts whose balls come near the rays of a block of pixels, and the depths between which they lie. */
function partsSeen(parts, camera, x, y) {
  const direction = camera.ray(x, y), square = dot(direction, direction);
  const seen = { parts: [], near: Infinity, far: 0 };
  for (const part of parts) {
    const to = sub(part.centre, camera.position), t = dot(to, direction) / square;
    if (t > 0 && Math.hypot(...sub(to, scale(direction, t))) < part.reach + BLOCK * t / camera.pixels) {
      seen.parts.push(part);
      seen.near = Math.min(seen.near, Math.max(0.01, t - part.reach));
      seen.far = Math.max(seen.far, t + part.reach);
    }
  }
  return seen;
}

function drawPixel(canvas, camera, { parts, face, near, far }, light, x, y) {
  const direction = camera.ray(x, y), at = y * canvas.width + x;
  const depth = trace(parts, camera.position, direction, near, Math.min(far, canvas.depth[at]));
  if (depth >= canvas.depth[at]) {
    return;
  }
  const point = add(camera.position, scale(direction, depth));
  const normal = normalAt(parts, point), falls = light(point, normal), open = opennessAt(parts, point, normal);
  const skin = colourAt(parts, point), colour = (face && skin === SKIN && paintAt(face, point)) || skin;
  canvas.depth[at] = depth;
  for (let k = 0; k < 3; k++) {
    canvas.colour[3 * at + k] = colour[k] * falls[k] * open;
  }
}
