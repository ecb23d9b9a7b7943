// awt-hair.js: hair of awtd in a three.js scene: `new AwtHair(url, token, scene)` adds an object that follows a forest.
//
// It follows the forest that it made (create), that it was given (attach), or else the one that the gateway's other page drives.
// It connects by itself, again and again, and says how things stand: 'connecting', 'empty' (no forest), 'busy' (one is being
// made), 'live', 'lost' (trying again). Types: awt-hair.d.ts.
import * as THREE from 'three';
import { AwtError, Connection } from './connection.js';
import { Decoder } from './decoder.js';
import { HairMesh } from './hair-mesh.js';
import { Light } from './light.js';
import { MovingHair } from './moving-hair.js';
import { NodesMesh } from './nodes-mesh.js';
import { upload } from './upload.js';

export { AwtError } from './connection.js';
export { DEFAULT_LIGHT, LIGHT_SHADER } from './light.js';

const KINDS = { strands: 1, guides: 2, nodes: 3 }, LEVELS = { full: 0, fifth: 1, guides: 2 };
const CREDIT = 2, RETRY_MS = [300, 600, 1200, 2500, 5000], REST = { position: [0, 1.6, 0], orientation: [0, 0, 0, 1] };
const GONE = ['NO_FOREST', 'WRONG_TOKEN', 'NOT_ALLOWED'];
const hexOf = (bytes) => [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
const OWN_STEPS_MS = 1000; /* a page that moves the hair itself sees it as soon as it comes */
const bytesOf = (hex) => Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));

export class AwtHair extends EventTarget {
  constructor(url, token, scene, { kind = 'guides', level = 'full', nodes = false, light } = {}) {
    super();
    Object.assign(this, { url, token, kind, level, nodesWanted: nodes, state: null, scope: null, viewToken: null, reason: '', forest: null, wanted: null, shown: null, time_us: 0n });
    this.stats = { strands: 0, frames: 0 };
    this.light = light ?? new Light();
    this.object = new THREE.Group();
    this.hair = new HairMesh(this.light);
    this.nodes = new NodesMesh();
    this.object.add(this.hair, this.nodes);
    scene?.add(this.object);
    this.decoder = new Decoder();
    this.moving = new MovingHair(this.object, this.hair);
    this.subscriptions = [];
    this.attempts = 0;
    this.turn = 0; /* counts what the connection does about forests: what belongs to an earlier turn is over */
    this.connect();
    this.draws = requestAnimationFrame((now) => this.draw(now));
  }

  /* ---- how things stand */

  say(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  enter(state, reason = '', share = null) {
    Object.assign(this, { state, reason });
    this.say('state', { state, reason, share });
  }

  connect() {
    this.enter(this.attempts === 0 ? 'connecting' : 'lost', this.reason);
    this.connection = new Connection(this.url, this.token, {
      open: (welcome) => this.opened(welcome), text: (text) => this.hearText(text),
      stray: (error) => this.say('refused', error), closed: (how) => this.closed(how),
    });
  }

  async opened(welcome) {
    this.server = welcome.server;
    this.enter('empty');
    this.say('open', welcome);
    if (this.wanted?.followed) {
      this.wanted = null; /* the gateway will say what it shows now */
    } else if (this.wanted) {
      await this.take(this.wanted).catch(() => {}); /* told by state */
    }
  }

  closed({ reason, wasOpen }) {
    this.leave();
    this.attempts = wasOpen && this.wasLive ? 1 : this.attempts + 1;
    this.wasLive = false;
    this.enter('lost', reason || (wasOpen ? 'the connection is lost' : 'the gateway does not answer, or the address has the wrong token'));
    this.retry = setTimeout(() => this.connect(), RETRY_MS[Math.min(this.attempts, RETRY_MS.length) - 1]);
  }

  hearText(text) {
    if ('shown' in text) {
      const { shown, scope, viewToken = null } = text;
      Object.assign(this, { shown, scope, viewToken });
      this.followShown();
      this.say('shown', shown);
    } else if ('body' in text) {
      this.say('body', text.body);
    }
  }

  followShown() {
    const { forest, token } = this.shown ?? {};
    const free = !this.wanted || (this.wanted.followed && this.wanted.forest !== BigInt(forest ?? 0));
    if (forest && free && this.refused !== forest + token) { /* a token that was wrong would be wrong again */
      this.take({ forest: BigInt(forest), token, followed: true }).catch((error) => {
        this.refused = GONE.includes(error.code) ? forest + token : null;
      });
    }
  }

  /* ---- which forest */

  /** Makes a forest and follows it. `recipe`: CREATE's fields, or { file: Uint8Array } for strands of one's own. */
  create(recipe) {
    return this.take({ recipe });
  }

  /** Follows a forest made elsewhere; token as 32 hexadecimal digits. */
  attach(forest, token) {
    return this.take({ forest: BigInt(forest), token });
  }

  /** Follows whatever the gateway shows. */
  release() {
    this.wanted = null;
    this.followShown();
  }

  async take(wanted) {
    this.leave();
    this.wanted = wanted;
    const turn = this.turn;
    try {
      await this.decoder.ask('reset');
      const forest = wanted.recipe ? wanted.made = await this.makeOrReopen(wanted) : await this.open(wanted);
      if (turn !== this.turn) {
        return null;
      }
      this.forest = forest;
      this.time_us = forest.time_us;
      this.say('forest', forest);
      await this.follow();
      return forest;
    } catch (error) {
      if (turn === this.turn && this.connection.isIn) {
        this.wanted = null;
        this.enter('empty', error.message);
      } else if (GONE.includes(error.code)) { /* the daemon closes the connection after a wrong token */
        this.wanted = wanted.recipe ? { recipe: wanted.recipe } : null;
      }
      throw error;
    }
  }

  async make({ file, ...recipe }) {
    const head = recipe.head ?? REST, body = recipe.body ?? REST;
    const params = Object.entries(recipe.params ?? {}).map(([name, value]) => ({ name, value }));
    this.enter('busy', file ? 'sending the file' : 'growing hair', 0);
    const source = file ? { source: 1, upload: await upload(this.connection, file, (share) => this.enter('busy', 'sending the file', share)) } : {};
    const stages = ['waiting', 'reading the strands', 'building the wisps', 'preparing to draw'];
    const made = await this.connection.ask('create', { style: 'long', ...recipe, ...source, params, head, body, progress: 1 },
      { progress: ({ stage, share }) => this.enter('busy', stages[stage] ?? 'working', share || null) });
    return { ...made, handle: made.forest, mayDrive: true, time_us: BigInt(recipe.time_us ?? 0), driveToken: hexOf(made.drive_token), viewToken: hexOf(made.view_token) };
  }

  /** What was made before a connection was lost may live on. */
  async makeOrReopen({ recipe, made }) {
    try {
      return made ? { ...made, ...await this.open({ forest: made.handle, token: made.driveToken }), colliders: made.colliders } : await this.make(recipe);
    } catch (error) {
      if (made && error.code === 'NO_FOREST') {
        return this.make(recipe);
      }
      throw error;
    }
  }

  async open({ forest, token }) {
    const opened = await this.connection.ask('attach', { forest, token: bytesOf(token) });
    return { ...opened, handle: forest, mayDrive: opened.may_drive === 1, colliders: null };
  }

  leave() {
    this.turn++;
    this.subscriptions.forEach((subscription) => subscription.end());
    this.subscriptions = [];
    this.forest = null;
    this.moving.reset();
    this.hair.hide();
    this.nodes.visible = false;
    this.stats = { strands: 0, frames: 0 };
  }

  /* ---- frames */

  /** Subscribes to the forest's frames as kind, level and nodes say now. */
  async follow() {
    const { turn, forest: { handle } } = this;
    const kind = KINDS[this.kind], level = this.kind === 'strands' ? LEVELS[this.level] : 0;
    if (this.kind === 'guides') {
      const { binding } = await this.connection.ask('binding', { forest: handle, level: 0 });
      await this.decoder.ask('bind', { bytes: binding });
    }
    await this.watch({ forest: handle, kind, level, credit: CREDIT, deltas: 1 }, turn);
    if (this.nodesWanted) {
      await this.watch({ forest: handle, kind: KINDS.nodes, level: 0, credit: 1, greatest_rate: 30 }, turn);
    }
    for (const wanted of [kind, ...(this.nodesWanted ? [KINDS.nodes] : [])]) { /* it may stand still */
      const frame = await this.connection.ask('query', { forest: handle, latest: 1, kind: wanted, level: wanted === kind ? level : 0 });
      if (turn === this.turn && (wanted !== kind || this.stats.frames === 0)) {
        await this.takeFrame(frame, turn);
      }
    }
  }

  async watch(values, turn) {
    let subscription = null, acknowledge = Promise.resolve();
    const stream = {
      frame: (frame) => {
        acknowledge = acknowledge.then(() => this.takeFrame(frame, turn)).then((have) => subscription?.credit(have), (error) => {
          turn === this.turn && this.say('refused', error);
          subscription?.credit(0n); /* the next one comes whole */
        });
      },
      ended: (error) => {
        if (turn === this.turn) {
          this.leave();
          this.wanted = null;
          this.enter('empty', error.message);
        }
      },
    };
    subscription = await this.connection.subscribe(values, stream);
    turn === this.turn ? this.subscriptions.push(subscription) : subscription.end();
  }

  /** Resolves to what CREDIT may say: the newest frame of hair that is kept here. */
  async takeFrame(frame, turn) {
    const { glb: bytes, kind, level, sequence, base } = frame;
    const decoded = await this.decoder.ask(kind === KINDS.nodes ? 'nodes' : 'frame', { bytes, kind, level, sequence, base });
    const { have = 0n } = decoded;
    if (turn !== this.turn) {
      return have;
    }
    if (kind === KINDS.nodes) {
      this.nodes.show(decoded);
      this.nodes.visible = this.nodesWanted;
      this.say('nodes', decoded);
      return have;
    }
    const now_ms = performance.now();
    this.moving.take(decoded, Number(frame.time_us), now_ms);
    this.moving.see(now_ms, this.drivesItself(now_ms));
    if (this.state !== 'live') {
      this.wasLive = true;
      this.enter('live');
    }
    const age_ms = frame.age_us / 1000 + (Number.isFinite(this.connection.way_us) ? this.connection.way_us / 1000 : 0);
    this.stats = { strands: decoded.strands, points: decoded.points, frames: this.stats.frames + 1, bytes: bytes.length, active: frame.active_nodes,
      splits: frame.splits, merges: frame.merges, step_ms: frame.step_us / 1000, encode_ms: frame.encode_us / 1000, age_ms, delta: base !== 0n,
      time_us: frame.time_us, sequence, skipped: frame.skipped, energy: frame.kinetic_energy_j };
    this.say('frame', this.stats);
    return have;
  }

  drivesItself(now_ms) {
    return now_ms - (this.stepped_ms ?? -Infinity) < OWN_STEPS_MS;
  }

  /** Before each picture. */
  draw(now_ms) {
    this.draws = requestAnimationFrame((next) => this.draw(next));
    if (this.state === 'live' && this.moving.moves) {
      this.moving.see(now_ms, this.drivesItself(now_ms));
      this.say('between');
    }
  }

  /** Other kinds and levels from now on: { kind, level, nodes }. */
  async choose({ kind = this.kind, level = this.level, nodes = this.nodesWanted }) {
    Object.assign(this, { kind, level, nodesWanted: nodes });
    if (this.forest && this.state === 'live') {
      const { forest } = this;
      this.turn++;
      this.subscriptions.forEach((subscription) => subscription.end());
      this.subscriptions = [];
      this.stats.frames = 0;
      this.nodes.visible = false;
      await this.follow().catch((error) => this.forest === forest && this.say('refused', error));
    }
  }

  /* ---- driving */

  /** Moves head and body ({ position, orientation }) and brings the forest to that time. False: it is still at the step before. */
  async step(time_us, head, body = head, teleport = false) {
    if (!this.forest?.mayDrive || this.stepping || this.state !== 'live') {
      return false;
    }
    const { handle } = this.forest, time = BigInt(Math.round(Number(time_us)));
    if (time <= this.time_us) {
      return false;
    }
    this.epoch ??= Math.floor(Date.now() / 1000) >>> 0; /* later than that of whoever drove before */
    this.sequence = (this.sequence ?? 0) + 1;
    this.stepping = true;
    this.stepped_ms = performance.now();
    try {
      this.connection.send('motion', { forest: handle, epoch: this.epoch, sequence: this.sequence, teleport: teleport ? 1 : 0, time_us: time, head, body });
      this.time_us = time;
      await this.connection.ask('query', { forest: handle, time_us: time, kind: KINDS.nodes, level: 0 });
      return true;
    } catch (error) {
      error instanceof AwtError && this.say('refused', error);
      return false;
    } finally {
      this.stepping = false;
    }
  }

  setParams(params) {
    const list = Object.entries(params).map(([name, value]) => ({ name, value }));
    return this.connection.ask('set_params', { forest: this.forest?.handle ?? 0n, params: list });
  }

  /** Styles and parameters that the daemon has. */
  listStyles() {
    return this.connection.ask('list_styles');
  }

  /** Tells the gateway's other pages to follow this forest; `about` goes with it, at most 4 KiB as JSON. */
  show(about = null) {
    const { handle, driveToken: drive, viewToken: view } = this.forest;
    this.connection.say({ show: { forest: String(handle), drive, view, about } });
  }

  /** Tells them that this page drives the forest that they follow. */
  takeWheel() {
    this.connection.say({ wheel: true });
  }

  sayBody({ position, orientation }) {
    this.connection.say({ body: [...position, ...orientation].map((number) => Math.round(number * 1e5) / 1e5) });
  }

  destroy(handle = this.forest?.handle) {
    return this.connection.ask('destroy', { forest: handle });
  }

  /** Ends the connection and frees what the graphics card holds. The forest lives on. */
  dispose() {
    clearTimeout(this.retry);
    cancelAnimationFrame(this.draws);
    this.leave();
    this.connection.close();
    this.decoder.dispose();
    this.object.removeFromParent();
    [this.hair, this.nodes, this.light].forEach((part) => part.dispose());
  }
}
