// check_nodes.mjs FILE.glb...: what gltf-validator, which reads uncompressed frames to the last byte, and a reader that shares
// no code with awtd make of frames of nodes. One line a file; exit 1 on any fault.
import { readFileSync } from 'node:fs';
import validator from 'gltf-validator';
import { splitGlb } from './frame.mjs';

const FLOAT = 5126, BYTE = 5121, LINES = 1;

/** An accessor's values as one flat array. */
function readAccessor(json, binary, index) {
  const accessor = json.accessors[index], view = json.bufferViews[accessor.bufferView];
  const read = { [FLOAT]: 'getFloat32', [BYTE]: 'getUint8', 5125: 'getUint32' }[accessor.componentType];
  const size = accessor.componentType === BYTE ? 1 : 4, components = accessor.type === 'VEC3' ? 3 : 1;
  const data = new DataView(binary.buffer, binary.byteOffset, binary.byteLength), values = [];
  for (let i = 0; i < accessor.count; i++) {
    const at = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0) + i * (view.byteStride ?? size * components);
    for (let k = 0; k < components; k++) {
      values.push(data[read](at + k * size, true));
    }
  }
  return values;
}

async function checkFile(file) {
  const faults = [], expect = (holds, text) => holds || faults.push(text);
  const bytes = readFileSync(file);
  const report = await validator.validateBytes(new Uint8Array(bytes), { maxIssues: 100 });
  for (const issue of report.issues.messages.filter(({ severity }) => severity < 2)) {
    faults.push(`${issue.code} at ${issue.pointer ?? issue.offset}: ${issue.message}`);
  }
  const { json, binary } = splitGlb(bytes);
  const node = json.nodes[0], primitive = json.meshes[0].primitives[0];
  const values = (name) => readAccessor(json, binary, primitive.attributes[name]);
  const radii = values('_RADIUS'), levels = values('_LEVEL'), parents = values('_PARENT');
  const lines = readAccessor(json, binary, primitive.indices);
  expect(node.name === 'hair' && node.extras.kind === 'nodes', 'the node is not hair of kind nodes');
  expect(primitive.mode === LINES && lines.length === 2 * radii.length, 'not a line for each node');
  expect(node.extras.nodes === radii.length, `${radii.length} nodes, not ${node.extras.nodes}`);
  for (let i = 0; i < radii.length; i++) {
    expect(lines[2 * i] === i && lines[2 * i + 1] === parents[i], `line ${i} does not go to the node's parent`);
    expect(parents[i] <= i && levels[i] >= levels[parents[i]] && radii[i] >= 0, `node ${i} is none`);
  }
  console.log(`${faults.length ? 'FAIL' : 'ok  '} ${file}: ${radii.length} nodes, ${bytes.length} bytes`);
  faults.slice(0, 10).forEach((fault) => console.log(`  ${fault}`));
  return faults.length === 0;
}

const files = process.argv.slice(2);
let failed = files.length ? 0 : 1;
for (const file of files) {
  failed += (await checkFile(file)) ? 0 : 1;
}
console.log(`${files.length - failed} passed, ${failed} failed, 0 skipped`);
process.exit(failed ? 1 : 0);
