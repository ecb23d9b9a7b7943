// hair.mjs: ribbons coloured as hair: Kajiya and Kay's two highlights along the strand, light through the hair above.
import { Shade } from './light.mjs';
import { turnVertices } from './camera.mjs';

/** A random number in [0, 1) for each whole number, always the same. */
function randomOf(n) {
  let x = Math.imul(n ^ 0x9e3779b9, 0x85ebca6b);
  x = Math.imul(x ^ (x >>> 13), 0xc2b2ae35);
  return ((x ^ (x >>> 16)) >>> 0) / 2 ** 32;
}

/** All patches of a frame in one set of arrays, in world axes about the head. */
export function gatherHair(frame) {
  const { points_per_strand: perStrand } = frame.node.extras;
  const orientation = frame.node.rotation ?? [0, 0, 0, 1];
  const total = frame.primitives.reduce((sum, primitive) => sum + primitive.positions.length / 3, 0);
  const hair = {
    vertices: new Float32Array(total * 3), across: new Float32Array(total), grain: new Float32Array(total),
    tangents: new Float32Array(total * 3), indices: [], perStrand,
    base: frame.json.materials?.[0]?.pbrMetallicRoughness?.baseColorFactor ?? [0.13, 0.07, 0.035, 1],
  };
  let first = 0;
  for (const primitive of frame.primitives) {
    hair.vertices.set(turnVertices(primitive.positions, orientation), first * 3);
    hair.indices.push(primitive.indices.map((index) => index + first));
    first += primitive.positions.length / 3;
  }
  for (let v = 0; v < total; v++) {
    hair.across[v] = v % 2 ? 1 : -1;
    hair.grain[v] = randomOf(Math.floor(v / (2 * perStrand)));
  }
  fillTangents(hair, perStrand);
  return hair;
}

/** Direction of the strand at each of its points, the same for both edges. */
function fillTangents({ vertices, tangents }, perStrand) {
  const centre = (point, k) => (vertices[6 * point + k] + vertices[6 * point + 3 + k]) / 2;
  for (let point = 0; point < vertices.length / 6; point++) {
    const i = point % perStrand;
    const before = i > 0 ? point - 1 : point, after = i + 1 < perStrand ? point + 1 : point;
    const t = [0, 1, 2].map((k) => centre(after, k) - centre(before, k));
    const size = Math.hypot(...t) || 1;
    for (let k = 0; k < 3; k++) {
      tangents[6 * point + k] = tangents[6 * point + 3 + k] = t[k] / size;
    }
  }
}

/** How open each vertex is to the light from all around. */
export function ambientOf(hair, shade) {
  const ambient = new Float32Array(hair.across.length);
  for (let v = 0; v < ambient.length; v += 2) {
    ambient[v] = ambient[v + 1] = shade.ambientAt(hair.vertices, 3 * v);
  }
  return ambient;
}

const lobe = (sinLight, cosLight, sinEye, cosEye, shift, power) => {
  /* highlight cone around the strand, tilted by `shift` towards the tip */
  const along = sinLight * sinEye * -1 + cosLight * cosEye * Math.sqrt(1 - shift * shift) + shift * (sinLight + sinEye);
  return Math.max(0, along) ** power;
};

/** Colours of all vertices as the camera sees them under `lights` [{ direction, colour, map }]. */
export function colourHair(hair, ambient, camera, lights, sky) {
  const { vertices, tangents, base, grain } = hair;
  const colours = new Float32Array(vertices.length);
  for (let v = 0; v < ambient.length; v++) {
    const i = 3 * v, x = vertices[i], y = vertices[i + 1], z = vertices[i + 2];
    const tx = tangents[i], ty = tangents[i + 1], tz = tangents[i + 2];
    /* away from the head, square to the strand: the side that the hair as a body shows */
    const along = x * tx + y * ty + z * tz;
    let nx = x - along * tx, ny = y - along * ty, nz = z - along * tz;
    const size = Math.hypot(nx, ny, nz) || 1;
    nx /= size, ny /= size, nz /= size;
    let ex = camera.position[0] - x, ey = camera.position[1] - y, ez = camera.position[2] - z;
    const far = Math.hypot(ex, ey, ez);
    const loose = Math.max(0, Math.min(1, (Math.hypot(x, y, z) - 0.2) / 0.2)); /* no body with a side of its own here */
    ex /= far, ey /= far, ez /= far;
    const sinEye = tx * ex + ty * ey + tz * ez, cosEye = Math.sqrt(Math.max(0, 1 - sinEye * sinEye));
    const tone = 0.75 + 0.5 * grain[v], warm = 0.94 + 0.12 * ((grain[v] * 7) % 1);
    let r = 0, g = 0, b = 0;
    for (const { direction: d, colour, map } of lights) {
      const sinLight = tx * d[0] + ty * d[1] + tz * d[2], cosLight = Math.sqrt(Math.max(0, 1 - sinLight * sinLight));
      const side = Math.max(0, (nx * d[0] + ny * d[1] + nz * d[2] + 0.35) / 1.35);
      const facing = side + 0.6 * loose * Math.max(0, 0.6 - side);
      const reaches = Shade.keyAt(map, vertices, i) * facing;
      const diffuse = 0.55 * cosLight * tone;
      const glint = 0.035 * lobe(sinLight, cosLight, sinEye, cosEye, -0.08, 90);
      const glow = 0.5 * lobe(sinLight, cosLight, sinEye, cosEye, 0.12, 22) * tone;
      r += reaches * colour[0] * (glint + base[0] * warm * (diffuse + glow));
      g += reaches * colour[1] * (glint + base[1] * (diffuse + glow));
      b += reaches * colour[2] * (glint + base[2] / warm * (diffuse + glow));
    }
    const open = 0.7 * ambient[v] * ambient[v] * (0.7 + 0.3 * ny) * tone;
    colours[i] = r + sky[0] * open * base[0] * warm;
    colours[i + 1] = g + sky[1] * open * base[1];
    colours[i + 2] = b + sky[2] * open * base[2] / warm;
  }
  return colours;
}
