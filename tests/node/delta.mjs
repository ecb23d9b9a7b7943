// delta.mjs: frames of guides as numbers, whole and against a base, written from proto/DELTAS.md with nothing of awtd's own
// code; their point clouds by draco3d.
import { readCloud, splitGlb } from './frame.mjs';

const HEADER_BYTES = 72, ENTRY_BYTES = 16, PLAIN = 5;
const KIND_GUIDES = 2, COMPONENTS = 6;

/** CRC-32C of bytes, a bit at a time. */
function checksum(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) {
      crc = (crc >>> 1) ^ (crc & 1 ? 0x82f63b78 : 0);
    }
  }
  return ~crc >>> 0;
}

function checksumOf(numbers, tail) {
  const bytes = new Uint8Array(2 * numbers.length + tail.length);
  numbers.forEach((number, i) => {
    bytes[2 * i] = number & 0xff;
    bytes[2 * i + 1] = number >> 8;
  });
  bytes.set(tail, 2 * numbers.length);
  return checksum(bytes);
}

function readHeader(block) {
  const view = new DataView(block.buffer, block.byteOffset, block.byteLength);
  const u8 = (at) => view.getUint8(at), u32 = (at) => view.getUint32(at, true), u64 = (at) => view.getBigUint64(at, true);
  if (u32(0) !== 0x44545741 || u8(4) !== 1 || u8(5) !== KIND_GUIDES || u8(6) !== COMPONENTS) {
    throw new Error('no numbers of guides');
  }
  return {
    bits: u8(7), baseSequence: Number(u64(8)), sequence: Number(u64(16)), baseChecksum: u32(24), checksum: u32(28),
    wisps: u32(32), sections: u32(36), patches: u32(56), binding: u64(64).toString(16).padStart(16, '0'),
    tail: new Uint8Array([...block.subarray(40, 56), u8(7), ...block.subarray(64, 72)]), // behind the numbers
  };
}

/** { sequence, binding, wisps, sections, numbers } of a frame; `frames` has its base by its sequence. */
export async function readNumbers(bytes, frames) {
  const { json, binary } = splitGlb(bytes);
  const view = json.bufferViews[json.nodes[0].extensions.AWT_delta.bufferView];
  const block = binary.subarray(0, view.byteLength), header = readHeader(block);
  const entries = new DataView(block.buffer, block.byteOffset + HEADER_BYTES, header.patches * ENTRY_BYTES);
  const count = header.wisps * header.sections * COMPONENTS;
  const base = header.baseSequence ? frames.get(header.baseSequence).numbers : new Uint16Array(count);
  if (header.baseSequence && checksumOf(base, header.tail) !== header.baseChecksum) {
    throw new Error('the base is another one');
  }
  const numbers = base.slice(), mask = 2 ** header.bits - 1, aWisp = header.sections * COMPONENTS;
  let cloud = HEADER_BYTES + entries.byteLength;
  for (let at = 0; at < entries.byteLength; at += ENTRY_BYTES) {
    const first = entries.getUint32(at, true) * aWisp, size = entries.getUint32(at + 8, true);
    if (entries.getUint8(at + 12) !== PLAIN) {
      throw new Error('guides are plain');
    }
    const against = entries.getUint8(at + 13) ? 0 : 1;
    const data = new Int8Array(block.buffer, block.byteOffset + cloud, size);
    (await readCloud(data)).forEach((r, i) => numbers[first + i] = (against * base[first + i] + r) & mask);
    cloud += size;
  }
  if (cloud !== block.byteLength || checksumOf(numbers, header.tail) !== header.checksum) {
    throw new Error('the numbers are not those of the checksum');
  }
  return { ...header, numbers };
}
