// guides.mjs: strands from frames of guides and their binding, written from proto/GEOMETRY.md with nothing of awtd's own code
// (and in doubles, so that it agrees to rounding, not to the bit).
import { readFrame } from './frame.mjs';

const HEAD_BYTES = 48, PIECE_SECTIONS = 16384;

/** { id, strands, points, wisps, sections, turnBits, positionStep, strandAfter, tree, restCentre, restFrame, offsets }. */
export function readBinding(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (new TextDecoder().decode(bytes.subarray(0, 4)) !== 'AWTB' || view.getUint32(4, true) !== 1) {
    throw new Error('not a binding of version 1');
  }
  const [strands, points, wisps, sections, , turnBits] = [0, 1, 2, 3, 4, 5].map((k) => view.getUint32(16 + 4 * k, true));
  const positionStep = view.getFloat32(40, true), offsetStep = view.getFloat32(44, true);
  let at = HEAD_BYTES + 4 * points;
  const take = (count, size, read) => {
    const values = Array.from({ length: count }, (_, i) => view[read](at + size * i, true));
    at += size * count;
    return values;
  };
  const strandAfter = take(wisps, 4, 'getUint32'), tree = take(wisps, 4, 'getUint32');
  const restCentre = take(3 * wisps * sections, 4, 'getFloat32'), restFrame = take(4 * wisps * sections, 4, 'getFloat32');
  const offsets = take(3 * strands * points, 2, 'getInt16').map((steps) => steps * offsetStep);
  if (Math.ceil(at / 4) * 4 !== bytes.byteLength) {
    throw new Error(`the binding has ${bytes.byteLength} bytes, not ${at}`);
  }
  const id = view.getBigUint64(8, true).toString(16).padStart(16, '0');
  return { id, strands, points, wisps, sections, turnBits, positionStep, strandAfter, tree, restCentre, restFrame, offsets };
}

const three = (list, index) => list.slice(3 * index, 3 * index + 3);
const product = ([ax, ay, az, aw], [bx, by, bz, bw]) => [
  aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
  aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];

function rotate(q, v) {
  const [x, y, z] = product(product(q, [...v, 0]), [-q[0], -q[1], -q[2], q[3]]);
  return [x, y, z];
}

function turnOf(numbers, bits) {
  const m = numbers.map((n) => n / (2 ** (bits - 1) - 1)), s = m[0] ** 2 + m[1] ** 2 + m[2] ** 2;
  return [2 * m[0] / (1 + s), 2 * m[1] / (1 + s), 2 * m[2] / (1 + s), (1 - s) / (1 + s)];
}

/** Centres and frames of the wisps of one primitive, pushed onto the lists. */
function readSections(binding, primitive, centres, frames) {
  const { sections, turnBits } = binding, first = primitive.extras.first_wisp * sections;
  for (let n = 0; n < primitive.extras.wisps * sections; n++) {
    const turn = turnOf([...three(primitive.numbers._TURN, n)], turnBits);
    centres.push([...three(primitive.positions, n)]);
    frames.push(product(turn, binding.restFrame.slice(4 * (first + n), 4 * (first + n) + 4)));
  }
}

const signed = (number) => (number << 17) >> 17; // of 15 bits

/** The same of the numbers of all wisps. */
function sectionsOfNumbers(binding, kept, centres, frames) {
  const { sections, tree, positionStep, turnBits } = binding, room = Math.floor(PIECE_SECTIONS / sections);
  const turns = [];
  for (let n = 0, ofTree = 0; n < binding.wisps * sections; n++) {
    const w = Math.floor(n / sections), i = n % sections, rest = three(binding.restCentre, n);
    if (i === 0) {
      ofTree = w > 0 && tree[w] === tree[w - 1] ? ofTree + 1 : 0;
    }
    const sibling = ofTree % room > 0, back = sibling ? sections : i > 0 ? 1 : 0;
    const offset = [0, 1, 2].map((k) => signed(kept[6 * n + k]) * positionStep);
    let numbers = [3, 4, 5].map((k) => signed(kept[6 * n + k])), centre = rest;
    if (back) {
      numbers = numbers.map((number, k) => (number + turns[n - back][k]) << 16 >> 16);
      const before = centres[n - back], restBefore = three(binding.restCentre, n - back);
      const turn = turnOf(sibling ? turns[n - back] : numbers, turnBits);
      centre = rotate(turn, rest.map((x, k) => x - restBefore[k])).map((x, k) => x + before[k]);
    }
    turns.push(numbers);
    centres.push(centre.map((x, k) => x + offset[k]));
    frames.push(product(turnOf(numbers, turnBits), binding.restFrame.slice(4 * n, 4 * n + 4)));
  }
}

/** Point and frame of station i of the wisp whose sections begin at `base`. */
function station(binding, centres, frames, base, i) {
  const { sections, points } = binding, place = i * (sections - 1), last = points - 1;
  const from = Math.min(Math.floor(place / last), sections - 2), t = (place - from * last) / last;
  let a = (-(t ** 3) + 2 * t * t - t) / 2, b = (3 * t ** 3 - 5 * t * t + 2) / 2;
  let c = (-3 * t ** 3 + 4 * t * t + t) / 2, d = (t ** 3 - t * t) / 2;
  if (from === 0) {
    b += 2 * a, c -= a, a = 0;
  }
  if (from === sections - 2) {
    c += 2 * d, b -= d, d = 0;
  }
  const point = [0, 0, 0];
  [a, b, c, d].forEach((weight, k) => weight && centres[base + from - 1 + k].forEach((x, axis) => point[axis] += weight * x));
  const p = frames[base + from], q = frames[base + from + 1];
  const sign = p.reduce((sum, x, k) => sum + x * q[k], 0) < 0 ? -1 : 1;
  const blend = p.map((x, k) => x * (1 - t) + sign * q[k] * t), length = Math.hypot(...blend);
  return { point, frame: blend.map((x) => x / length) };
}

/** Strand points [strands][points][3], flat. */
function strandsOfSections(binding, centres, frames) {
  const out = new Float32Array(3 * binding.strands * binding.points);
  for (let w = 0, s = 0; w < binding.wisps; w++) {
    const stations = Array.from({ length: binding.points }, (_, i) =>
      station(binding, centres, frames, w * binding.sections, i));
    for (; s < binding.strandAfter[w]; s++) {
      stations.forEach((at, i) => {
        const offset = [0, 1, 2].map((axis) => binding.offsets[(3 * s + axis) * binding.points + i]);
        rotate(at.frame, offset).forEach((x, axis) => out[3 * (s * binding.points + i) + axis] = x + at.point[axis]);
      });
    }
  }
  return out;
}

function checkBinding(binding, id) {
  if (id !== binding.id) {
    throw new Error(`the guides belong to ${id}, not to ${binding.id}`);
  }
}

/** Strands of a frame for any viewer. */
export async function strandsOfGuides(binding, bytes) {
  const frame = await readFrame(bytes), centres = [], frames = [];
  checkBinding(binding, frame.node.extras.binding);
  frame.primitives.forEach((primitive) => readSections(binding, primitive, centres, frames));
  return strandsOfSections(binding, centres, frames);
}

/** Strands of a frame of numbers (delta.mjs). */
export function strandsOfNumbers(binding, frame) {
  const centres = [], frames = [];
  checkBinding(binding, frame.binding);
  sectionsOfNumbers(binding, frame.numbers, centres, frames);
  return strandsOfSections(binding, centres, frames);
}
