// body.mjs: head and body as one smooth surface: tapered capsules joined softly, found by sphere tracing.
import { add, dot, rotate, scale, sub, unit } from './vector.mjs';

const JOIN = 0.02; /* metres over which parts melt into each other: more, and the body swells through hair that lies on it */
const SKIN = [0.55, 0.33, 0.23], SHIRT = [0.1, 0.12, 0.17], EYE = [0.85, 0.83, 0.8], IRIS = [0.05, 0.035, 0.03],
  LIP = [0.42, 0.16, 0.13], BROW = [0.1, 0.06, 0.04];

/** The head and body that are drawn where no colliders are given: awtd's own default obstacles. */
export const DEFAULT_COLLIDERS = [
  { frame: 'head', a: [0, 0, 0], b: [0, 0, 0], radius_a: 0.095, radius_b: 0.095 },
  { frame: 'head', a: [0, -0.03, 0.035], b: [0, -0.075, 0.045], radius_a: 0.07, radius_b: 0.045 },
  { frame: 'body', a: [0, -0.09, -0.015], b: [0, -0.2, -0.02], radius_a: 0.055, radius_b: 0.055 },
  { frame: 'body', a: [-0.16, -0.27, -0.03], b: [0.16, -0.27, -0.03], radius_a: 0.07, radius_b: 0.07 },
  { frame: 'body', a: [0, -0.36, -0.02], b: [0, -0.62, -0.02], radius_a: 0.13, radius_b: 0.13 },
  { frame: 'body', a: [0, -0.25, -0.025], b: [0, -0.36, -0.02], radius_a: 0.08, radius_b: 0.13 },
];

/** Nose and ears for a head of radius r, so that one sees where the front is. */
function faceParts(r) {
  const part = (a, b, radius_a, radius_b) => (
    { frame: 'head', a: scale(a, r), b: scale(b, r), radius_a: radius_a * r, radius_b: radius_b * r, join: 0.1 * r });
  return [
    part([0, -0.05, 0.95], [0, -0.3, 1.14], 0.07, 0.12),
    part([0.97, -0.05, -0.05], [0.97, -0.3, 0.0], 0.16, 0.1),
    part([-0.97, -0.05, -0.05], [-0.97, -0.3, 0.0], 0.16, 0.1),
  ];
}

/** What is painted on the face: strokes from a to b seen from the front, in head radii, the last on top. */
const PAINT = [-1, 1].flatMap((side) => [
  { a: [side * 0.27, -0.06], b: [side * 0.42, -0.055], radius: 0.05, colour: EYE },
  { a: [side * 0.345, -0.055], b: [side * 0.345, -0.055], radius: 0.048, colour: IRIS },
  { a: [side * 0.2, 0.135], b: [side * 0.47, 0.125], radius: 0.024, colour: BROW },
  { a: [0, -0.665], b: [side * 0.19, -0.635], radius: 0.035, colour: LIP },
]);

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
    const a = place(part.a), along = sub(place(part.b), a), long = Math.hypot(...along);
    const growth = long > 0 ? (part.radius_b - part.radius_a) / long : 0;
    const colour = part.frame === 'body' && part.a[1] < -0.21 ? SHIRT : SKIN;
    const join = part.join ?? JOIN;
    return {
      a, axis: unit(along), long, colour, join, k: Math.max(-0.99, Math.min(0.99, growth)), radius: part.radius_a,
      centre: add(a, scale(along, 0.5)), reach: long / 2 + Math.max(part.radius_a, part.radius_b) + join,
    };
  });
  const [x, y, z, w] = head.orientation;
  return { parts, face: radius > 0 ? { radius, toHead: [-x, -y, -z, w] } : null };
}

/** Distance to a tapered capsule: that to the nearest of the balls that roll along it (k: their growth a metre). */
function distanceTo(part, px, py, pz) {
  const { a, axis, long, k } = part;
  const x = px - a[0], y = py - a[1], z = pz - a[2];
  const along = x * axis[0] + y * axis[1] + z * axis[2];
  const aside = Math.sqrt(Math.max(0, x * x + y * y + z * z - along * along));
  const at = Math.max(0, Math.min(long, along + k * aside / Math.sqrt(1 - k * k)));
  return Math.sqrt(aside * aside + (along - at) * (along - at)) - part.radius - k * at;
}

/** Distance to the whole surface: each part joined softly to those before it. */
function distance(parts, x, y, z) {
  let d = distanceTo(parts[0], x, y, z);
  for (let i = 1; i < parts.length; i++) {
    const e = distanceTo(parts[i], x, y, z), k = parts[i].join;
    const h = Math.max(k - Math.abs(d - e), 0) / k;
    d = Math.min(d, e) - h * h * k * 0.25;
  }
  return d;
}

function normalAt(parts, [x, y, z]) {
  const e = 4e-4, d = distance(parts, x, y, z);
  return unit([distance(parts, x + e, y, z) - d, distance(parts, x, y + e, z) - d, distance(parts, x, y, z + e) - d]);
}

function colourAt(parts, [x, y, z]) {
  let nearest = Infinity, colour = SKIN;
  for (const part of parts) {
    const d = distanceTo(part, x, y, z);
    if (d < nearest) {
      nearest = d;
      colour = part.colour;
    }
  }
  return colour;
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
