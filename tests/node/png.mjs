// png.mjs: an image of 8-bit RGB to a PNG file.
import { writeFileSync } from 'node:fs';
import { PNG } from 'pngjs';

/** `rgb` holds width * height * 3 bytes, rows from the top. */
export function writePng(file, width, height, rgb) {
  const png = new PNG({ width, height, colorType: 2 });
  for (let i = 0; i < width * height; i++) {
    png.data.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
    png.data[4 * i + 3] = 255;
  }
  writeFileSync(file, PNG.sync.write(png, { colorType: 2 }));
}
