// render.mjs: frames as pictures, for human eyes.
//
//   node render.mjs --out sheet.png --views front,side,back A.glb B.glb
//
// One row for each file, one column for each view, or with --labels one column for each file. The camera follows the head
// but does not turn with it, and sees all files of one view at one scale.
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { parseArgs } from 'node:util';
import { readFrame } from '../node/frame.mjs';
import { writePng } from '../node/png.mjs';
import { DEFAULT_COLLIDERS, drawBody, placeBody, surfacePoints } from './body.mjs';
import { Camera, VIEWS } from './camera.mjs';
import { Canvas, joinSheet, widenRibbons } from './canvas.mjs';
import { ambientOf, colourHair, gatherHair } from './hair.mjs';
import { drawLabel } from './label.mjs';
import { Shade } from './light.mjs';
import { add, dot, scale, unit } from './vector.mjs';

const HELP = `usage: node render.mjs [options] FILE.glb...
  --out FILE.png        the picture [hair.png]
  --views A,B           of ${Object.keys(VIEWS).join(' ')} [three-quarter]
  --size WxH            of one picture, in pixels [640x480]
  --supersample N       pixels of N x N samples [2]
  --colliders FILE      JSON: [{"frame": "head"|"body", "a": [x,y,z], "b": [x,y,z], "radius_a", "radius_b"}, ...] or
                        what awtctl play --json wrote: {"colliders": [...], "frames": [{"file": "....glb",
                        "body": {"position": [x,y,z], "orientation": [x,y,z,w]}}, ...]}. A file that stands in no frame
                        has its body upright under the head.
  --zoom S              1: head and hair of all files just fill the picture; 2: twice as near [1]
  --labels A,B          what stands above each file's column; the views are then below one another
  --colours N           of the picture at most, to 256 [160]
  --bald                no hair
  --help                this text`;

const SKY = [1.5, 1.55, 1.65];

function readOptions() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: {
      out: { type: 'string', default: 'hair.png' },
      views: { type: 'string', default: 'three-quarter' },
      size: { type: 'string', default: '640x480' },
      supersample: { type: 'string', default: '2' },
      colliders: { type: 'string' },
      zoom: { type: 'string', default: '1' },
      labels: { type: 'string' },
      colours: { type: 'string', default: '160' },
      bald: { type: 'boolean', default: false },
      help: { type: 'boolean', default: false },
    },
  });
  const size = /^(\d{1,4})x(\d{1,4})$/.exec(values.size);
  const views = values.views.split(',');
  if (values.help || positionals.length === 0 || !size || !views.every((view) => view in VIEWS) ||
      !(values.zoom > 0) || !(values.supersample >= 1 && values.supersample <= 4) ||
      !(values.colours >= 2 && values.colours <= 256)) {
    console.log(HELP);
    process.exit(values.help ? 0 : 2);
  }
  return { ...values, files: positionals, views, width: +size[1], height: +size[2], samples: Math.floor(values.supersample) };
}

/** { colliders, bodies }: bodies maps a GLB's name to the body's pose in that frame. */
function readColliders(file) {
  if (!file) {
    return { colliders: DEFAULT_COLLIDERS, bodies: new Map() };
  }
  const json = JSON.parse(readFileSync(file, 'utf8'));
  if (Array.isArray(json)) {
    return { colliders: json, bodies: new Map() };
  }
  const written = (json.frames ?? []).filter((frame) => frame.file);
  return {
    colliders: json.colliders ?? DEFAULT_COLLIDERS,
    bodies: new Map(written.map((frame) => [basename(frame.file), frame.body])),
  };
}

async function readScene(file, colliders, body, bald) {
  const frame = await readFrame(readFileSync(file));
  const head = { position: frame.node.translation ?? [0, 0, 0], orientation: frame.node.rotation ?? [0, 0, 0, 1] };
  const hair = gatherHair(bald ? { ...frame, primitives: [] } : frame);
  const person = placeBody(colliders, head, body ?? { position: head.position, orientation: [0, 0, 0, 1] });
  return { file, hair, person, strands: frame.node.extras.strands };
}

/** How far hair reaches from the head's centre, nearly all of it in every frame. */
function reachOf(scenes) {
  let reach = 0.2;
  for (const { hair } of scenes) {
    const far = new Float32Array(Math.ceil(hair.vertices.length / 33));
    for (let i = 0, n = 0; i + 2 < hair.vertices.length; i += 33) {
      far[n++] = Math.hypot(hair.vertices[i], hair.vertices[i + 1], hair.vertices[i + 2]);
    }
    reach = Math.max(reach, far.sort()[Math.floor(far.length * 0.995)] ?? 0);
  }
  return reach;
}

/** A camera that shows head, neck and nearly all hair of every frame, as near as that lets it. */
function placeCamera(view, scenes, reach, { zoom, width, height, samples }) {
  const size = [width * samples, height * samples], far = new Camera(view, [0, 0, 0], reach, ...size);
  const least = [Infinity, Infinity], greatest = [-Infinity, -Infinity];
  for (const { hair } of scenes) {
    const body = [0.13, 0, 0, -0.13, 0, 0, 0, 0.13, 0, 0, -0.2, 0, 0, 0, 0.13, 0, 0, -0.13];
    for (const [points, share] of [[body, 0], [far.project(hair.vertices.filter((_, i) => i % 33 < 3)), 0.001]]) {
      const screen = points === body ? far.project(body) : points;
      for (const axis of screen.length > 0 ? [0, 1] : []) {
        const places = screen.filter((_, i) => i % 3 === axis).sort(), last = places.length - 1;
        least[axis] = Math.min(least[axis], places[Math.floor(share * last)]);
        greatest[axis] = Math.max(greatest[axis], places[Math.ceil((1 - share) * last)]);
      }
    }
  }
  const metre = far.pixels / Math.hypot(...far.position); /* pixels, at the head */
  const [x, y] = [0, 1].map((axis) => (least[axis] + greatest[axis] - size[axis]) / 2 / metre);
  const fills = Math.max(...[0, 1].map((axis) => (greatest[axis] - least[axis]) / size[axis]));
  const target = add(scale(far.right, x), scale(far.up, -y));
  return new Camera(view, target, 1.12 * fills * reach / zoom, ...size);
}

/** Lights that go with the camera: key from above its left, fill from its right, rim from behind. */
function placeLights(camera, shade) {
  const { right, up, forward } = camera;
  const from = (r, u, b) => unit(add(add(scale(right, r), scale(up, u)), scale(forward, -b)));
  return [
    { direction: from(-0.6, 0.8, 0.75), colour: [3.3, 3.2, 3.0] },
    { direction: from(0.9, 0.25, 0.6), colour: [0.9, 0.95, 1.05] },
    { direction: from(0.5, 0.7, -0.9), colour: [1.6, 1.6, 1.6] },
  ].map((light) => ({ ...light, map: shade.key(light.direction) }));
}

function skinLight(shade, lights) {
  return (point, normal) => {
    const falls = scale(SKY, 0.42 * shade.ambientBefore(point, normal) * (0.75 + 0.25 * normal[1]));
    for (const { direction, colour, map } of lights) {
      const facing = Math.max(0, (dot(normal, direction) + 0.15) / 1.15);
      const share = 0.38 * facing * (facing > 0 ? Shade.keyAt(map, point, 0) : 0);
      for (let k = 0; k < 3; k++) {
        falls[k] += share * colour[k];
      }
    }
    return falls;
  };
}

function drawScene(scene, camera, options) {
  const canvas = new Canvas(camera.width, camera.height);
  const lights = placeLights(camera, scene.shade);
  canvas.fillBackground();
  const screen = camera.project(scene.hair.vertices);
  widenRibbons(screen, scene.hair.perStrand, 1.5);
  const colours = colourHair(scene.hair, scene.ambient, camera, lights, SKY);
  for (const indices of scene.hair.indices) {
    canvas.drawRibbons(indices, screen, colours, scene.hair.across, scene.hair.grain);
  }
  drawBody(canvas, camera, scene.person, skinLight(scene.hairShade, placeLights(camera, scene.hairShade)));
  return canvas.toBytes(options.samples);
}

const options = readOptions();
const { colliders, bodies } = readColliders(options.colliders);
const scenes = [];
for (const file of options.files) {
  scenes.push(await readScene(file, colliders, bodies.get(basename(file)), options.bald));
}
const reach = reachOf(scenes);
for (const scene of scenes) {
  /* hair is shaded by the head and by hair, skin by hair alone: its own folds are drawBody's */
  const skin = surfacePoints(scene.person, 1500), blockers = new Float32Array(skin.length + scene.hair.vertices.length);
  blockers.set(skin);
  blockers.set(scene.hair.vertices, skin.length);
  scene.shade = new Shade(blockers, 1.5 * reach);
  scene.hairShade = new Shade(scene.hair.vertices, 1.5 * reach);
  scene.ambient = ambientOf(scene.hair, scene.shade);
  console.log(`${basename(scene.file)}: ${scene.strands} strands`);
}
const rows = options.views.map((view) => {
  const camera = placeCamera(view, scenes, reach, options);
  return scenes.map((scene) => drawScene(scene, camera, options));
});
const labels = options.labels?.split(',');
labels?.forEach((label, n) => rows[0][n] && drawLabel(rows[0][n], label, 5, 5));
const sheet = joinSheet(labels ? rows : scenes.map((_, n) => rows.map((row) => row[n])));
const bytes = writePng(options.out, sheet.width, sheet.height, sheet.rgb, Number(options.colours));
console.log(`${options.out}: ${sheet.width} x ${sheet.height}, ${Math.ceil(bytes / 1000)} kB`);
