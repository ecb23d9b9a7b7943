// check_others.mjs FILE.glb...: what the loaders that people use make of awtd's frames: three.js (GLTFLoader, DRACOLoader),
// gltf-transform, tinygltf with Draco, where read_tinygltf has left FILE.glb.tinygltf, and the command line of gltf-transform,
// where suite.sh has left in FILE.glb.cli what it inspected and what it decoded.
//
// All must give the same positions to the bit, as many indices, the same pose; where FILE.glb.f32 stands beside the file (the
// vertices before quantisation), each within half a quantisation step of it; where FILE.glb.extra.f32 does, the attributes
// _STRAND, TEXCOORD_0 and _WIDTH of every vertex, within half a step of 14 bits. One line a file; exit 1 on any fault.
import { existsSync, readFileSync } from 'node:fs';
import { NodeIO } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import draco3d from 'draco3d';
import { readFrame, splitGlb } from './frame.mjs';
import { openThree } from './three.mjs';

function floatsOf(file) {
  const raw = readFileSync(file);
  return new Float32Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.byteLength));
}

/** Arrays of floats, one after the other. */
function joined(arrays) {
  const all = new Float32Array(arrays.reduce((sum, array) => sum + array.length, 0));
  let at = 0;
  for (const array of arrays) {
    all.set(array, at);
    at += array.length;
  }
  return all;
}

function greatestDifference(a, b) {
  let greatest = a.length === b.length ? 0 : Infinity;
  for (let i = 0; i < a.length && greatest < Infinity; i++) {
    greatest = Math.max(greatest, Math.abs(a[i] - b[i]));
  }
  return greatest;
}

/** three's attribute as an array of its own, though others lie between its values. */
function valuesOf(attribute) {
  return attribute.isInterleavedBufferAttribute
    ? Float32Array.from({ length: 3 * attribute.count }, (_, i) => attribute.getComponent(Math.floor(i / 3), i % 3))
    : attribute.array;
}

const EXTRA = ['_STRAND', 'TEXCOORD_0', '_WIDTH'];

/** Strand, u, v and width of every vertex, from each primitive's [strand, uv, width]; null where a primitive lacks any. */
function extraOf(primitives) {
  return primitives.some((arrays) => arrays.some((array) => !array)) ? null
    : joined(primitives.map(([strand, uv, width]) => Float32Array.from({ length: 4 * strand.length }, (_, i) =>
      [strand[i >> 2], uv[2 * (i >> 2)], uv[2 * (i >> 2) + 1], width[i >> 2]][i % 4])));
}

/** Whether the attributes are those that went in, in steps of what each is quantised to. */
function checkExtra(file, found, faults) {
  const expected = floatsOf(`${file}.extra.f32`);
  const widest = expected.reduce((most, value, i) => (i % 4 === 3 ? Math.max(most, value) : most), 0);
  const step = [1, 1 / 16383, 1 / 16383, widest / 16383];
  for (const name of ['three', 'gltf-transform']) {
    const { extra } = found[name];
    const off = extra?.findIndex((value, i) => !(Math.abs(value - expected[i]) <= (i % 4 ? 0.51 * step[i % 4] : 0)));
    if (extra?.length !== expected.length || off !== -1) {
      faults.push(`${name}: attribute ${off} is ${extra?.[off]}, not ${expected[off]}`);
    }
  }
}

async function withThree(three, bytes) {
  const { scene, geometries } = await three.read(bytes);
  const hair = scene.getObjectByName('hair');
  return {
    positions: joined(geometries.map((geometry) => valuesOf(geometry.getAttribute('position')))),
    indices: geometries.reduce((sum, geometry) => sum + geometry.getIndex().count, 0),
    pose: [...hair.position.toArray(), ...hair.quaternion.toArray()],
    extra: extraOf(geometries.map(({ attributes }) => [attributes._strand, attributes.uv, attributes._width].map((one) => one?.array))),
  };
}

async function withTransform(io, bytes) {
  const root = (await io.readBinary(new Uint8Array(bytes))).getRoot();
  const node = root.listNodes().find((one) => one.getName() === 'hair');
  const primitives = node.getMesh().listPrimitives();
  return {
    positions: joined(primitives.map((primitive) => primitive.getAttribute('POSITION').getArray())),
    indices: primitives.reduce((sum, primitive) => sum + primitive.getIndices().getCount(), 0),
    pose: [...node.getTranslation(), ...node.getRotation()],
    extra: extraOf(primitives.map((primitive) => EXTRA.map((name) => primitive.getAttribute(name)?.getArray()))),
  };
}

/** What gltf-transform's table of meshes says otherwise. */
function inspected(file, { positions }) {
  const lines = readFileSync(`${file}.cli/inspect.csv`, 'utf8').split('\n');
  const names = lines.find((line) => line.startsWith('#,name,mode,'))?.split(',') ?? [];
  const mesh = lines.find((line) => /^0,hair,(TRIANGLES|LINES),/.test(line))?.split(',') ?? [];
  const vertices = Number(mesh[names.indexOf('vertices')]);
  return vertices === positions.length / 3 ? [] : [`gltf-transform CLI finds ${vertices} vertices`];
}

async function checkFile(file, { three, io }) {
  const faults = [], bytes = readFileSync(file), { json } = splitGlb(bytes);
  const kind = json.nodes[0].extras.kind;
  const found = { three: await withThree(three, bytes), 'gltf-transform': await withTransform(io, bytes) };
  if (existsSync(`${file}.tinygltf`)) {
    found.tinygltf = { ...found.three, positions: floatsOf(`${file}.tinygltf`) };
  }
  if (existsSync(`${file}.cli`)) {
    found['gltf-transform CLI'] = await withTransform(io, readFileSync(`${file}.cli/hair.glb`));
    faults.push(...inspected(file, found.three));
  }
  const indices = json.meshes[0].primitives.reduce((sum, one) => sum + json.accessors[one.indices].count, 0);
  const pose = [...json.nodes[0].translation, ...json.nodes[0].rotation];
  for (const [name, one] of Object.entries(found)) {
    if (greatestDifference(one.positions, found.three.positions) !== 0) {
      faults.push(`${name} gives other positions than three`);
    }
    if (one.indices !== indices || greatestDifference(one.pose, pose) > 1e-12) {
      faults.push(`${name}: ${one.indices} indices, pose ${one.pose}`);
    }
  }
  if (existsSync(`${file}.extra.f32`)) {
    checkExtra(file, found, faults);
  }
  let worst = null;
  if (existsSync(`${file}.f32`)) {
    const { step } = (await readFrame(bytes, 1)).primitives[0].box;
    worst = greatestDifference(found.three.positions, floatsOf(`${file}.f32`)) / step;
    if (!(worst <= 0.51)) {
      faults.push(`a position is ${worst.toFixed(2)} quantisation steps from the simulation's`);
    }
  }
  console.log(`${faults.length ? 'FAIL' : 'ok  '} ${file}: ${kind}, ${found.three.positions.length / 3} vertices, ` +
    `${Object.keys(found).join(', ')}${worst === null ? '' : `, within ${worst.toFixed(2)} steps`}`);
  faults.forEach((fault) => console.log(`  ${fault}`));
  return faults.length === 0;
}

const files = process.argv.slice(2);
const io = new NodeIO().registerExtensions([KHRDracoMeshCompression])
  .registerDependencies({ 'draco3d.decoder': await draco3d.createDecoderModule() });
const three = await openThree();
let failed = files.length ? 0 : 1;
for (const file of files) {
  try {
    failed += (await checkFile(file, { three, io })) ? 0 : 1;
  } catch (error) {
    console.log(`FAIL ${file}: ${error.stack}`);
    failed++;
  }
}
three.close();
console.log(`${files.length - failed} passed, ${failed} failed, 0 skipped`);
process.exit(failed ? 1 : 0);
