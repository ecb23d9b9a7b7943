// check_glb.mjs FILE.glb...: what readers that share no code with awtd make of its frames.
//
// gltf-validator must find no error. It does not look inside the Draco data, so draco3d then decodes each primitive:
// counts, triangles, bounds and, where FILE.glb.f32 stands beside the file (raw little-endian floats of the vertices before
// quantisation), every position within half a quantisation step; where FILE.glb.i16 does, every whole number of the other
// attributes, in the order of their ids. One line a file; exit 1 on any fault.
import { existsSync, readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import { readFrame } from './frame.mjs';

/** What a frame of each kind has: bits of quantisation, vertices a strand point, and the indices of one strand. */
const KINDS = {
  ribbon: {
    bits: 14,
    verticesAPoint: 2,
    indices: (points) => Array.from({ length: points - 1 }, (_, i) => [0, 1, 2, 3, 2, 1].map((k) => 2 * i + k)).flat(),
  },
  strands: {
    bits: 12,
    verticesAPoint: 1,
    indices: (points) => Array.from({ length: Math.ceil(points / 3) * 3 }, (_, i) => Math.min(i, points - 1)),
  },
};
KINDS.guides = { ...KINDS.strands, bits: null, names: { strands: 'wisps', points: 'sections', first: 'first_wisp' } };
const NAMES = { strands: 'strands', points: 'points_per_strand', first: 'first_strand' };
const SEVERITY = ['error', 'warning', 'information', 'hint'];

async function validate(bytes, faults) {
  const report = await validator.validateBytes(new Uint8Array(bytes), { maxIssues: 100 });
  for (const issue of report.issues.messages) {
    const line = `${SEVERITY[issue.severity]} ${issue.code} at ${issue.pointer ?? issue.offset}: ${issue.message}`;
    if (issue.severity === 0) {
      faults.push(line);
    } else if (issue.severity === 1) {
      console.log(`  ${line}`);
    }
  }
  return report.issues;
}

/** What the glTF JSON says that a frame of awtd must say. */
function checkFrame({ json, node }, faults) {
  const expect = (holds, text) => holds || faults.push(text);
  const draco = 'KHR_draco_mesh_compression';
  expect(json.asset.generator === 'awtd', 'asset.generator is not awtd');
  expect(Number.isSafeInteger(json.asset.extras?.time_us), 'asset.extras.time_us is no whole number');
  expect(json.extensionsUsed?.includes(draco) && json.extensionsRequired?.includes(draco), `${draco} is not required`);
  expect(node.name === 'hair', 'the node is not named hair');
  expect(node.extras?.kind in KINDS, `no kind is called ${node.extras?.kind}`);
  if (node.extras?.kind === 'guides') {
    expect(/^[0-9a-f]{16}$/.test(node.extras.binding), 'no binding is named');
    expect(node.extras.turn_bits >= 10 && node.extras.turn_bits <= 14, `turns of ${node.extras.turn_bits} bits`);
  } else {
    expect(['full', 'fifth', 'guides'].includes(node.extras?.level), `no level is called ${node.extras?.level}`);
    expect(node.extras?.strands <= node.extras?.full_strands, 'it has more strands than the hair');
    expect(node.extras?.widths?.length === node.extras?.points_per_strand, 'no width for each point of a strand');
    const material = json.materials[0];
    expect(material.name === 'hair' && material.doubleSided, 'the material is not a doubleSided one named hair');
  }
  expect(node.translation?.length === 3 && node.rotation?.length === 4, 'the node has no head pose');
  expect(json.accessors.every((accessor) => accessor.bufferView === undefined), 'an accessor has a bufferView');
}

function checkNumbers(primitive, faults) {
  for (const [name, numbers] of Object.entries(primitive.numbers)) {
    const accessor = primitive.accessors[name];
    if (accessor.componentType !== 5122 || accessor.type !== 'VEC3' || accessor.count * 3 !== numbers.length) {
      faults.push(`${name} is no accessor of ${numbers.length / 3} triples of shorts`);
    }
  }
}

function checkBounds(primitive, faults) {
  const { position, indices } = primitive.accessors;
  if (indices.count !== primitive.indices.length || indices.componentType !== 5123 || primitive.mode !== 4) {
    faults.push('not TRIANGLES of unsigned shorts');
  }
  const least = [Infinity, Infinity, Infinity], greatest = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < primitive.positions.length; i++) {
    least[i % 3] = Math.min(least[i % 3], primitive.positions[i]);
    greatest[i % 3] = Math.max(greatest[i % 3], primitive.positions[i]);
  }
  if (position.count * 3 !== primitive.positions.length || indices.count !== primitive.indices.length) {
    faults.push(`counts ${position.count}, ${indices.count} are not those of the data`);
  }
  if (position.componentType !== 5126) {
    faults.push('not TRIANGLES over floats');
  }
  for (let k = 0; k < 3; k++) {
    if (position.min[k] !== least[k] || position.max[k] !== greatest[k]) {
      faults.push(`min ${position.min[k]}, max ${position.max[k]} are not the decoded ${least[k]}, ${greatest[k]}`);
    }
  }
}

/** Every strand's triangles over its own vertices. */
function checkTriangles(primitive, kind, strands, pointsPerStrand, faults) {
  const indices = kind.indices(pointsPerStrand);
  let at = 0;
  for (let s = 0; s < strands; s++) {
    const first = s * pointsPerStrand * kind.verticesAPoint;
    for (const index of indices) {
      if (primitive.indices[at++] !== first + index) {
        faults.push(`triangle ${Math.floor((at - 1) / 3)} is not strand ${s}'s`);
        return;
      }
    }
  }
  if (at !== primitive.indices.length) {
    faults.push('triangles beyond the last strand');
  }
}

/** Greatest distance along an axis from the expected vertices, in quantisation steps; null where none are given. */
function compareWithSidecar(file, frame, faults) {
  if (!existsSync(`${file}.f32`)) {
    return null;
  }
  const raw = readFileSync(`${file}.f32`);
  const expected = new Float32Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.byteLength));
  const decoded = frame.primitives.map((primitive) => primitive.positions);
  const total = decoded.reduce((sum, positions) => sum + positions.length, 0);
  if (total !== expected.length) {
    faults.push(`${total / 3} vertices decoded, ${expected.length / 3} expected`);
    return null;
  }
  const { step } = frame.primitives[0].box;
  let at = 0, worst = 0;
  for (const positions of decoded) {
    for (const value of positions) {
      worst = Math.max(worst, Math.abs(value - expected[at++]) / step);
    }
  }
  if (!(worst <= 0.51)) {
    faults.push(`a position is ${worst.toFixed(2)} quantisation steps from the simulation's`);
  }
  return worst;
}

/** Whether the whole numbers are those that went in; null where none are given. */
function compareNumbers(file, frame, faults) {
  if (!existsSync(`${file}.i16`)) {
    return;
  }
  const raw = readFileSync(`${file}.i16`);
  const expected = new Int16Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.byteLength));
  const decoded = frame.primitives.flatMap((primitive) => Object.values(primitive.numbers).flatMap((list) => [...list]));
  if (decoded.length !== expected.length || decoded.some((number, i) => number !== expected[i])) {
    faults.push(`${decoded.length} whole numbers are not the ${expected.length} that went in`);
  }
}

/** One box for all patches, or the patches' edges would not meet from frame to frame. */
function checkBox(frame, kind, faults) {
  const boxes = new Set(frame.primitives.map((primitive) => JSON.stringify(primitive.box)));
  if (boxes.size !== 1 || (kind.bits && frame.primitives[0].box.bits !== kind.bits)) {
    faults.push(`quantisation boxes ${[...boxes].join(' ')}`);
  }
}

async function checkFile(file) {
  const faults = [];
  const bytes = readFileSync(file);
  const issues = await validate(bytes, faults);
  const frame = await readFrame(bytes);
  checkFrame(frame, faults);
  const kind = KINDS[frame.node.extras.kind], names = kind.names ?? NAMES;
  const strands = frame.node.extras[names.strands], points = frame.node.extras[names.points];
  const floatsAStrand = points * kind.verticesAPoint * 3;
  let next = 0;
  for (const primitive of frame.primitives) {
    const here = primitive.extras[names.strands];
    checkBounds(primitive, faults);
    checkNumbers(primitive, faults);
    checkTriangles(primitive, kind, here, points, faults);
    const values = primitive.positions;
    if (primitive.extras[names.first] !== next || values.length !== here * floatsAStrand) {
      faults.push(`the patch at strand ${primitive.extras[names.first]} does not follow strand ${next}`);
    }
    next += here;
  }
  if (next !== strands) {
    faults.push(`${next} strands in patches, ${strands} in the node`);
  }
  checkBox(frame, kind, faults);
  compareNumbers(file, frame, faults);
  const worst = compareWithSidecar(file, frame, faults);
  const compared = worst === null ? 'no positions to compare' : `positions within ${worst.toFixed(2)} steps`;
  console.log(`${faults.length ? 'FAIL' : 'ok  '} ${file}: ${frame.node.extras.kind}, ${strands} strands of ${points}, ` +
    `${frame.primitives.length} patches, ${bytes.length} bytes, ${issues.numWarnings} warnings, ${compared}`);
  faults.forEach((fault) => console.log(`  ${fault}`));
  return faults.length === 0;
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node check_glb.mjs FILE.glb...');
  process.exit(2);
}
let failed = 0;
for (const file of files) {
  try {
    failed += (await checkFile(file)) ? 0 : 1;
  } catch (error) {
    console.log(`FAIL ${file}: ${error.message}`);
    failed++;
  }
}
console.log(`${files.length - failed} passed, ${failed} failed, 0 skipped`);
process.exit(failed ? 1 : 0);
