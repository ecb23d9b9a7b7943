// body-shape.js: the shape of head and body: tapered capsules joined softly, as distances from their surface. Metres.

export const JOIN = 0.02; /* metres over which parts melt into each other: more, and the body swells through hair that lies on it */
export const SKIN = [0.55, 0.33, 0.23], SHIRT = [0.1, 0.12, 0.17];
const EYE = [0.85, 0.83, 0.8], IRIS = [0.05, 0.035, 0.03], LIP = [0.42, 0.16, 0.13], BROW = [0.1, 0.06, 0.04];

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
export function faceParts(r) {
  const scaled = (v) => v.map((x) => x * r);
  const part = (a, b, radius_a, radius_b) => (
    { frame: 'head', a: scaled(a), b: scaled(b), radius_a: radius_a * r, radius_b: radius_b * r, join: 0.1 * r });
  return [
    part([0, -0.05, 0.95], [0, -0.3, 1.14], 0.07, 0.12),
    part([0.97, -0.05, -0.05], [0.97, -0.3, 0.0], 0.16, 0.1),
    part([-0.97, -0.05, -0.05], [-0.97, -0.3, 0.0], 0.16, 0.1),
  ];
}

/** Upper arms at the ends of the shoulders, where a body has these: only to be seen, hair passes through them. */
export function armParts(body) {
  const shoulders = body.find(({ a, b }) => Math.abs(a[0] - b[0]) > 0.2);
  return [shoulders?.a, shoulders?.b].filter(Boolean).map(([x, y, z]) => (
    { frame: 'body', a: [x, y, z], b: [x * 1.22, y - 0.34, z], radius_a: shoulders.radius_a * 0.92, radius_b: shoulders.radius_a * 0.68, join: 0.04 }));
}

/** What is painted on the face: strokes from a to b seen from the front, in head radii, the last on top. */
export const PAINT = [-1, 1].flatMap((side) => [
  { a: [side * 0.27, -0.06], b: [side * 0.42, -0.055], radius: 0.05, colour: EYE },
  { a: [side * 0.345, -0.055], b: [side * 0.345, -0.055], radius: 0.048, colour: IRIS },
  { a: [side * 0.2, 0.135], b: [side * 0.47, 0.125], radius: 0.024, colour: BROW },
  { a: [0, -0.665], b: [side * 0.19, -0.635], radius: 0.035, colour: LIP },
]);

/** What `distance` wants of a capsule whose centres are a and b. */
export function shapeOf(part, a = part.a, b = part.b) {
  const along = b.map((x, k) => x - a[k]), long = Math.hypot(...along), growth = long > 0 ? (part.radius_b - part.radius_a) / long : 0;
  return { a, axis: along.map((x) => x / (long || 1)), long, join: part.join ?? JOIN, k: Math.max(-0.99, Math.min(0.99, growth)), radius: part.radius_a,
    colour: part.frame === 'body' && part.a[1] < -0.21 ? SHIRT : SKIN };
}

/** Distance to a tapered capsule: that to the nearest of the balls that roll along it (k: their growth a metre). */
export function distanceTo(part, px, py, pz) {
  const { a, axis, long, k } = part;
  const x = px - a[0], y = py - a[1], z = pz - a[2];
  const along = x * axis[0] + y * axis[1] + z * axis[2];
  const aside = Math.sqrt(Math.max(0, x * x + y * y + z * z - along * along));
  const at = Math.max(0, Math.min(long, along + k * aside / Math.sqrt(1 - k * k)));
  return Math.sqrt(aside * aside + (along - at) * (along - at)) - part.radius - k * at;
}

/** Distance to the whole surface: each part joined softly to those before it. */
export function distance(parts, x, y, z) {
  let d = distanceTo(parts[0], x, y, z);
  for (let i = 1; i < parts.length; i++) {
    const e = distanceTo(parts[i], x, y, z), k = parts[i].join;
    const h = Math.max(k - Math.abs(d - e), 0) / k;
    d = Math.min(d, e) - h * h * k * 0.25;
  }
  return d;
}

/** Colour of the nearest part. */
export function colourAt(parts, [x, y, z]) {
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

/** The same without an edge between two parts. */
export function softColourAt(parts, [x, y, z]) {
  const weights = parts.map((part) => Math.exp(-Math.max(0, distanceTo(part, x, y, z)) / 0.003) + 1e-30), sum = weights.reduce((a, b) => a + b);
  return [0, 1, 2].map((k) => parts.reduce((colour, part, i) => colour + part.colour[k] * weights[i], 0) / sum);
}
