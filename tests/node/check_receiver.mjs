// check_receiver.mjs RECEIVER.wasm FOLDER: the receiver as WebAssembly makes strands of frames that the C program simulated.
//
// FOLDER holds NAME.awtb (bindings) and NAME-N.glb (guides for any viewer), NAME-N.whole and NAME-N.delta (as numbers, the
// latter against those of NAME-(N-1)) with FILE.strands.f32 beside each: the server's strand points (raw little-endian
// floats). Every point must be within 0.2 mm of the server's, and where FILE.received.f32 is there, what the receiver makes
// of the frame in C, every bit the same. A reader written from proto/GEOMETRY.md and DELTAS.md alone (guides.mjs, delta.mjs)
// must come within two micrometres of it, too. One line a file; exit 1 on any fault.
import { readFileSync, readdirSync, existsSync } from 'node:fs';
import { join } from 'node:path';
import { readNumbers } from './delta.mjs';
import { Wasm } from '../../clients/web/lib/wasm.js';
import * as document from './guides.mjs';

const ALLOWED_M = 0.2e-3, ROUNDING_M = 2e-6;
const GUIDES = 2; /* as in QUERY */
const [wasm, folder] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node check_receiver.mjs RECEIVER.wasm FOLDER');
  process.exit(2);
}

const { exports: receiver } = new WebAssembly.Instance(new WebAssembly.Module(readFileSync(wasm)), {
  env: { emscripten_notify_memory_growth() {} },
});
receiver._initialize();
const module = new Wasm(receiver);

/** A receiver for the frames of that binding. */
function receiverOf(file) {
  const handle = receiver.receiver_create();
  if (!module.withBytes(readFileSync(file), (address, length) => receiver.receiver_bind(handle, address, length))) {
    throw new Error(`${file}: ${module.text(receiver.receiver_error(handle))}`);
  }
  return handle;
}

function readFloats(file) {
  const raw = readFileSync(file);
  return new Float32Array(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.byteLength));
}

/** `numbers`: what readNumbers makes of a frame of numbers; null: it is one for any viewer. */
function receive(handle, bytes, numbers) {
  const { sequence = 0, baseSequence = 0 } = numbers ?? {};
  if (!module.withBytes(bytes, (address, length) => receiver.receiver_frame(handle, address, length, GUIDES, 0, BigInt(sequence), BigInt(baseSequence)))) {
    throw new Error(module.text(receiver.receiver_error(handle)));
  }
  const floats = receiver.receiver_strands(handle) * receiver.receiver_points(handle) * 3;
  return new Float32Array(receiver.memory.buffer, receiver.receiver_positions(handle), floats).slice();
}

function distances(points, expected) {
  let worst = 0, sum = 0;
  for (let i = 0; i < points.length; i += 3) {
    const way = Math.hypot(points[i] - expected[i], points[i + 1] - expected[i + 1], points[i + 2] - expected[i + 2]);
    worst = Math.max(worst, way);
    sum += way;
  }
  return { worst, mean: sum / (points.length / 3) };
}

/** What to say of a frame; throws what is wrong with it. `frames`: those of numbers so far, by their sequence. */
async function check(handle, described, frames, file) {
  const bytes = readFileSync(file), expected = readFloats(`${file}.strands.f32`);
  const numbers = file.endsWith('.glb') ? null : await readNumbers(bytes, frames);
  const begin = performance.now(), points = receive(handle, bytes, numbers), took = performance.now() - begin;
  if (points.length !== expected.length) {
    throw new Error(`${points.length} numbers, not ${expected.length}`);
  }
  const { worst, mean } = distances(points, expected);
  if (!(worst <= ALLOWED_M)) {
    throw new Error(`a point is ${(worst * 1e3).toFixed(3)} mm from the server's`);
  }
  if (existsSync(`${file}.received.f32`)) {
    const native = readFloats(`${file}.received.f32`);
    if (Buffer.compare(Buffer.from(native.buffer), Buffer.from(points.buffer)) !== 0) {
      throw new Error('the strands are not those of the receiver in C, bit by bit');
    }
  }
  const said = numbers ? document.strandsOfNumbers(described, numbers) : await document.strandsOfGuides(described, bytes);
  const { worst: apart } = distances(said, points);
  if (!(apart <= ROUNDING_M)) {
    throw new Error(`a point is ${(apart * 1e6).toFixed(1)} micrometres from what GEOMETRY.md says`);
  }
  if (numbers) {
    frames.set(numbers.sequence, numbers);
  }
  const strands = receiver.receiver_strands(handle), each = receiver.receiver_points(handle);
  return `${strands} strands of ${each} from ${bytes.length} bytes in ${took.toFixed(1)} ms, ` +
    `worst ${(worst * 1e3).toFixed(3)} mm, mean ${(mean * 1e3).toFixed(3)} mm`;
}

let passed = 0, failed = 0;
for (const name of readdirSync(folder).filter((file) => file.endsWith('.awtb'))) {
  const stem = name.slice(0, -'.awtb'.length), handle = receiverOf(join(folder, name));
  const described = document.readBinding(readFileSync(join(folder, name))), frames = new Map();
  const files = readdirSync(folder).filter((other) => other.startsWith(`${stem}-`) && /\.(glb|whole|delta)$/.test(other));
  for (const file of files.sort()) { /* of each number the delta first, for which the frame before is still kept */
    try {
      console.log(`ok   ${file}: ${await check(handle, described, frames, join(folder, file))}`);
      passed++;
    } catch (error) {
      console.log(`FAIL ${file}: ${error.message}`);
      failed++;
    }
  }
}
console.log(`${passed} passed, ${failed} failed, 0 skipped`);
process.exit(failed || !passed ? 1 : 0);
