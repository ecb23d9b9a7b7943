// png.mjs: an image of 8-bit RGB to a PNG file of at most 256 colours, which are chosen from the image by median cut:
// pictures of hair are nearly all brown and grey, and take a third of the bytes so.
import { writeFileSync } from 'node:fs';
import { deflateSync } from 'node:zlib';

const FINE = 5; /* bits of a channel that tell colours apart while they are counted */

/** Colours of the image that are alike to FINE bits, as { r, g, b (means), count }, by their common bits. */
function countColours(rgb) {
  const cells = new Map();
  for (let i = 0; i < rgb.length; i += 3) {
    const key = keyOf(rgb, i);
    const cell = cells.get(key) ?? { key, r: 0, g: 0, b: 0, count: 0 };
    cell.r += rgb[i], cell.g += rgb[i + 1], cell.b += rgb[i + 2], cell.count++;
    cells.set(key, cell);
  }
  for (const cell of cells.values()) {
    cell.r /= cell.count, cell.g /= cell.count, cell.b /= cell.count;
  }
  return [...cells.values()];
}

function keyOf(rgb, i) {
  const shift = 8 - FINE;
  return (rgb[i] >> shift) << (2 * FINE) | (rgb[i + 1] >> shift) << FINE | rgb[i + 2] >> shift;
}

/** Mean and spread of a box of colours: { mean: [r, g, b], axis, spread }: the axis along which it spreads most. */
function measure(box) {
  const total = box.reduce((sum, cell) => sum + cell.count, 0);
  const axes = ['r', 'g', 'b'].map((axis) => {
    const mean = box.reduce((sum, cell) => sum + cell[axis] * cell.count, 0) / total;
    return { axis, mean, spread: box.reduce((sum, cell) => sum + (cell[axis] - mean) ** 2 * cell.count, 0) };
  });
  const widest = axes.reduce((a, b) => (b.spread > a.spread ? b : a));
  return { ...widest, at: widest.mean, mean: axes.map(({ mean }) => Math.round(mean)) };
}

/** { colours: [[r, g, b]], indexOf: key -> colour }: the box that spreads most is cut at its mean until there are `most`. */
function choosePalette(rgb, most) {
  const boxes = [countColours(rgb)].map((cells) => ({ cells, ...measure(cells) }));
  while (boxes.length < most) {
    const widest = boxes.reduce((a, b) => (b.spread > a.spread ? b : a));
    const halves = [0, 1].map((side) => widest.cells.filter((cell) => (cell[widest.axis] > widest.at) === (side === 1)));
    if (halves.some((half) => half.length === 0)) {
      break;
    }
    boxes.splice(boxes.indexOf(widest), 1, ...halves.map((cells) => ({ cells, ...measure(cells) })));
  }
  const indexOf = new Map(boxes.flatMap(({ cells }, index) => cells.map((cell) => [cell.key, index])));
  return { colours: boxes.map(({ mean }) => mean), indexOf };
}

/** PNG's checksum (ISO 3309). */
function crc32(bytes) {
  let crc = -1;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) {
      crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
  }
  return ~crc >>> 0;
}

function chunk(type, data) {
  const bytes = Buffer.alloc(data.length + 12);
  bytes.writeUInt32BE(data.length, 0);
  bytes.write(type, 4, 'latin1');
  bytes.set(data, 8);
  bytes.writeUInt32BE(crc32(bytes.subarray(4, data.length + 8)), data.length + 8);
  return bytes;
}

/** `rgb` holds width * height * 3 bytes, rows from the top. The bytes written. */
export function writePng(file, width, height, rgb, colours = 256) {
  const palette = choosePalette(rgb, colours);
  const head = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 3, 0, 0, 0]); /* 8 bits, palette */
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  const rows = Buffer.alloc((width + 1) * height); /* each row behind a 0: no filter */
  for (let y = 0, i = 0; y < height; y++) {
    for (let x = 0; x < width; x++, i += 3) {
      rows[y * (width + 1) + 1 + x] = palette.indexOf.get(keyOf(rgb, i));
    }
  }
  const bytes = Buffer.concat([Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]), chunk('IHDR', head),
    chunk('PLTE', Buffer.from(palette.colours.flat())), chunk('IDAT', deflateSync(rows, { level: 9 })),
    chunk('IEND', Buffer.alloc(0))]);
  writeFileSync(file, bytes);
  return bytes.length;
}
