// viewer.js: the page. Hair (awt-hair.js) on a figure, moved by a driver, told what to be by the panel; or looked at only, where
// another page drives.
import * as THREE from 'three';
import { AwtHair } from '/awt/awt-hair.js';
import { builtInClip, fileClip } from './clips.js';
import { ClockControl, clockText } from './clock.js';
import { Driver } from './driver.js';
import { Faces } from './faces.js';
import { Figure } from './figure.js';
import { acceptFiles, saveFile } from './files.js';
import { Graph } from './graph.js';
import { MouseHead } from './mouse.js';
import { Panel } from './panel.js';
import { COLOURS, readAddress, takeSettings } from './settings.js';
import { Stage } from './stage.js';

const address = readAddress(location.hash);
let settings = address.settings, file = null; /* strands of one's own: { name, bytes } */
let made = null, making = false;              /* the forest made last; another is on its way */
document.body.classList.toggle('bare', address.bare);

const kindOf = (level) => ({ kind: level.split(' ')[0], level: level.split(' ')[1] ?? 'full' });
const stage = new Stage(document.getElementById('canvas'), address.smooth ? {} : { antialias: false, pixelRatio: 1 });
const hair = new AwtHair(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/awt`, address.token, stage.scene, kindOf(settings.level));
const figure = new Figure(stage.scene, hair.light, address), mouse = new MouseHead(stage.canvas), driver = new Driver(hair, mouse);
const faces = new Faces(), graph = new Graph(document.getElementById('graph')), panel = new Panel(changed, pressed);
const failed = (text) => faces.say(text, 'error');
const clock = new ClockControl(hair, failed);

/* ---- what is shown */

function stand() {
  const role = driver.driving ? 'drives' : hair.scope === 'drive' && hair.state === 'live' ? 'may' : 'looks';
  const about = made ? (file?.name ?? settings.style) : String(hair.shown?.about?.name ?? 'hair').slice(0, 64);
  const { strands, points } = hair.stats;
  const hairs = strands ? `${strands.toLocaleString('en')} strands of ${points} points` : '', time = role === 'drives' ? '' : clockText(hair.clock);
  panel.stand(role, about, [time, hairs, hair.server].filter(Boolean).join(' · ') || '…');
}

function paint() {
  hair.hair.uniforms.hairColour.value = new THREE.Color(...COLOURS[settings.colour]);
  stage.changed = true;
}

function placeHead() {
  const { position, quaternion } = hair.object;
  figure.place('head', { position: position.toArray(), orientation: quaternion.toArray() });
  stage.changed = true;
}

hair.addEventListener('frame', ({ detail }) => {
  placeHead();
  if (driver.driving) {
    figure.place('body', driver.pose.body);
  }
  graph.add(detail);
});
hair.addEventListener('between', placeHead);
hair.addEventListener('clock', () => {
  driver.goOn(hair.time_us);
  stand();
});
let toldBody = driver.pose.body; /* of who drives elsewhere */
hair.addEventListener('body', ({ detail: [x, y, z, ...orientation] }) => {
  toldBody = { position: [x, y, z], orientation };
  figure.place('body', toldBody);
  stage.changed = true;
});
hair.addEventListener('nodes', () => {
  panel.legend(hair.nodesWanted ? hair.nodes.levels : null);
  stage.changed = true;
});
hair.addEventListener('refused', ({ detail }) => failed(detail.message));
hair.addEventListener('state', ({ detail }) => {
  stage.changed = true;
  faces.show(detail);
  if (detail.state === 'lost' || detail.state === 'empty') {
    driver.stop();
  }
  if (detail.state === 'empty' && toldOnce && !making && !hair.wanted && !hair.shown?.driven) { /* what was shown is gone */
    makeFirst();
  }
  stand();
});

/* ---- who drives */

let toldOnce = false, mayMake = false; /* once a connection: what cannot be made is not tried again and again */
hair.addEventListener('open', async () => {
  toldOnce = false;
  mayMake = true;
  panel.list(await hair.listStyles().catch(() => ({ styles: [], params: [] })));
  panel.put(settings);
});

hair.addEventListener('shown', ({ detail: shown }) => {
  const first = !toldOnce;
  toldOnce = true;
  if (first && !shown && !hair.wanted) {
    makeFirst();
  } else if (!first && shown?.driven && driver.driving) { /* another page has taken the wheel */
    driver.stop();
    made = null;
    hair.release();
    faces.say('Another page drives now.');
  }
  stand();
});

hair.addEventListener('forest', ({ detail: forest }) => {
  figure.shape(forest.colliders ?? hair.shown?.about?.colliders ?? null);
  figure.place('head', driver.pose.head);
  figure.place('body', forest.driveToken ? driver.pose.body : toldBody);
  if (forest.driveToken) {
    made = forest;
    driver.begin(hair.time_us);
    hair.show({ name: file?.name ?? settings.style, colliders: forest.colliders });
  } else {
    made = null;
    if (forest.mayDrive && hair.shown && !hair.shown.driven) {
      takeWheel();
    }
  }
  stand();
});

async function takeWheel() {
  try {
    await hair.takeWheel();
    driver.begin(hair.time_us);
    stand();
  } catch (error) {
    failed(error.message);
  }
}

function makeFirst() {
  if (mayMake && hair.scope === 'drive') {
    mayMake = false;
    makeHair();
  }
}

async function makeHair() {
  making = true;
  try {
    await destroyAndMake();
  } finally {
    making = false;
  }
}

async function destroyAndMake() {
  const before = hair.forest?.mayDrive ? hair.forest.handle : null, time = driver.driving ? hair.clock : null; /* as it went, it goes on */
  driver.stop();
  const { head, body } = driver.poseAfter(0);
  try {
    before && await hair.destroy(before).catch(() => {});
    await hair.create({ style: settings.style, strands: settings.strands, params: settings.params, head, body, clock: time, ...(file ? { file: file.bytes, name: file.name.slice(-40) } : {}) });
    file && faces.say(`${file.name}: ${made.strands.toLocaleString('en')} strands, ${made.skipped_strands} left out; rebuilt within ${(made.rebuilt_max_m * 1000).toFixed(1)} mm.`);
  } catch (error) {
    failed(file ? `${file.name}: ${error.message}` : error.message);
    if (file && hair.connection.isIn) {
      file = null;
      await destroyAndMake();
    }
  }
}

/* ---- what is chosen */

async function chooseMotion(name) {
  driver.play(name === 'mouse' ? null : await builtInClip(name));
}

async function changed(name, value) {
  try {
    if (name === 'tree') {
      hair.hair.uniforms.share.value = value ? 0.05 : 1;
      hair.light.dirty = stage.changed = true;
      panel.legend(null);
      await hair.choose({ nodes: value });
    } else if (name in settings) {
      settings = takeSettings(settings, { [name]: value });
      await ({ motion: () => chooseMotion(value), colour: paint, level: () => hair.choose(kindOf(value)) }[name] ?? ((file = name === 'style' ? null : file), makeHair))();
    } else {
      settings.params = { ...settings.params, [name]: value };
      hair.wanted?.recipe && (hair.wanted.recipe.params = settings.params);
      await hair.setParams({ [name]: value });
    }
  } catch (error) {
    failed(error.message);
  }
}

function pressed(name) {
  if (name === 'save') {
    saveFile('hair-settings.json', `${JSON.stringify(settings, null, 2)}\n`);
  } else if (name === 'wheel') {
    takeWheel();
  } else {
    const link = `${location.origin}/#token=${hair.viewToken}`;
    navigator.clipboard.writeText(link).then(() => faces.say('The link for viewers is copied.'), () => faces.say(link));
  }
}

acceptFiles(document.getElementById('stage'), panel.picker, {
  async hair(name, bytes) {
    file = { name, bytes };
    await makeHair();
  },
  async motion(name, bytes) {
    const clip = await fileClip(bytes);
    driver.play(clip);
    faces.say(`${name}: ${clip.description}`);
  },
  async settings(name, bytes) {
    settings = takeSettings(settings, JSON.parse(new TextDecoder().decode(bytes)));
    file = null;
    panel.put(settings);
    paint();
    await chooseMotion(settings.motion);
    await hair.choose(kindOf(settings.level));
    await makeHair();
  },
}, failed);

paint();
figure.place('head', driver.pose.head);
figure.place('body', driver.pose.body);
if (settings.motion !== 'mouse') {
  chooseMotion(settings.motion);
}
let graphDrawn = 0, drawn = 0;
stage.run((seconds) => {
  driver.tick(seconds);
  if (hair.state === 'live' && hair.clock?.mode !== 'paused') { /* a picture that stands still does so altogether */
    stage.follow(hair.object.position, Math.min(seconds - drawn, 0.1));
  }
  drawn = seconds;
  if (seconds - graphDrawn > 0.1) {
    graphDrawn = seconds;
    graph.draw();
  }
});

/** For the console, and the tests in a browser. */
globalThis.viewer = { hair, driver, stage, mouse, figure, clock, changed, get settings() { return settings; } };
