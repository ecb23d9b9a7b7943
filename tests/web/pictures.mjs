// pictures.mjs BUILD [NAME]: the pictures of README.md, by the real daemon and the viewer in Chromium, into clients/web/pictures:
// each style at rest and in motion (the paper's figure 7), the wisp tree (figure 4), wisps that split in a bow (figure 5).
import { mkdirSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { writePng } from '../node/png.mjs';
import { drawLabel } from '../render/label.mjs';
import { openBrowser, View } from './browser.mjs';
import { finish, startAwtd, startGateway, top } from './harness.mjs';

const FOLDER = join(top, 'clients/web/pictures'), FINER = 2, STRANDS = 10000, COLOURS = 112;
const BACKGROUND = [226, 228, 232], INK = [70, 72, 80];

const { browser, why } = await openBrowser();
if (!browser) {
  console.error(`pictures: ${why}: sh tests/deps.sh test`);
  process.exit(1);
}
mkdirSync(FOLDER, { recursive: true });
const awtd = await startAwtd(), gateway = await startGateway(awtd.port);

/** A page with hair of that style, of pictures of width x height, FINER times as fine. */
async function openStyle(style, width, height, colour) {
  const more = `&style=${style}&strands=${STRANDS}&colour=${colour}&smooth=0&bare=1`;
  const view = await View.open(browser, gateway.drive, { width: FINER * width, height: FINER * height, more });
  await view.untilLive();
  await view.hold();
  return view;
}

/** The picture now, from a view of the stage, in the size that was asked for, on the background, with a text. */
async function take(view, from, text) {
  await view.page.evaluate((name) => viewer.stage.look(name, viewer.hair.object.position.toArray()), from);
  const fine = await view.picture(), width = fine.width / FINER, height = fine.height / FINER, rgb = new Uint8Array(3 * width * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const sum = [0, 0, 0];
      for (let k = 0; k < FINER * FINER; k++) {
        const at = 4 * ((FINER * y + Math.floor(k / FINER)) * fine.width + FINER * x + k % FINER), share = fine.rgba[at + 3] / 255;
        sum.forEach((_, c) => { sum[c] += fine.rgba[at + c] + (1 - share) * BACKGROUND[c]; });
      }
      rgb.set(sum.map((value) => Math.min(255, Math.round(value / FINER ** 2))), 3 * (y * width + x));
    }
  }
  drawLabel({ width, rgb }, text, 6, 6, INK);
  return { width, height, rgb };
}

/** Pictures of one size side by side, into a file. */
function write(name, pictures) {
  const [{ width, height }] = pictures, all = pictures.length * width, rgb = new Uint8Array(3 * all * height);
  pictures.forEach((picture, n) => {
    for (let y = 0; y < height; y++) {
      rgb.set(picture.rgb.subarray(3 * y * width, 3 * (y + 1) * width), 3 * (y * all + n * width));
    }
  });
  const file = join(FOLDER, `${name}.png`);
  writePng(file, all, height, rgb, COLOURS);
  console.log(`${file}: ${all} x ${height}, ${statSync(file).size} bytes`);
}

const wanted = (name) => !process.argv[3] || process.argv[3] === name;
const play = (view, motion) => view.page.evaluate((name) => viewer.changed('motion', name), motion);
const showTree = (view) => view.page.evaluate(() => viewer.changed('tree', true));

/* Each takes the forest that is there, and ends it for the next. */
async function close(view) {
  await view.page.evaluate(() => viewer.hair.destroy());
  await view.page.close();
}

for (const [style, colour] of [['short', 'black'], ['short-curly', 'chestnut'], ['long', 'brown'], ['long-curly', 'copper']].filter(([name]) => wanted(name))) {
  const view = await openStyle(style, 250, 280, colour), pictures = [await take(view, 'three-quarter', `${style}, at rest`)];
  await play(view, 'shake');
  await view.steps(124);
  pictures.push(await take(view, 'three-quarter', 'shaken'));
  await play(view, 'lean');
  await view.steps(150);
  pictures.push(await take(view, 'three-quarter', 'up from a bow'));
  write(style, pictures);
  await close(view);
}

if (wanted('tree')) {
  const view = await openStyle('long', 300, 320, 'brown');
  await play(view, 'lean');
  await view.steps(114);
  const pictures = [await take(view, 'side', 'the hair')];
  await showTree(view);
  await view.untilIt(({ frames }) => frames > 0, 'the tree');
  pictures.push(await take(view, 'side', 'its active nodes'));
  write('tree', pictures);
  await close(view);
}

if (wanted('split')) {
  const view = await openStyle('long', 200, 300, 'brown'), pictures = [];
  await showTree(view);
  await play(view, 'lean');
  for (const [steps, at] of [[60, '1.0 s'], [24, '1.4 s'], [21, '1.75 s'], [30, '2.25 s']]) {
    await view.steps(steps);
    pictures.push(await take(view, 'side', `${at}, ${(await view.knows()).active} nodes`));
  }
  write('split', pictures);
  await close(view);
}

await browser.close();
await finish();
