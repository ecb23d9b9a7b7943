// awt-hair.js: hair of awtd in a three.js scene: `new AwtHair(url, token, scene)` adds an object that follows a forest.
//
// It follows the forest that it made (create), that it was given (attach), or else the one that the gateway's other page drives.
// It connects by itself, again and again, and says how things stand: 'connecting', 'empty' (no forest), 'busy' (one is being
// made), 'live', 'lost' (trying again). Types: awt-hair.d.ts.
//
// The daemon does not tell how a forest's time goes, so this says it again (SET_CLOCK) of a forest that it opens anew, and the
// gateway tells it to those who look on.
import * as THREE from 'three';
import { Decoder } from './decoder.js';
import { Driving } from './driving.js';
import { Following } from './following.js';
import { toldClock } from './forest-clock.js';
import { makeOrOpen } from './forests.js';
import { GatewayLink } from './gateway-link.js';
import { HairMesh } from './hair-mesh.js';
import { Light } from './light.js';
import { MovingHair } from './moving-hair.js';
import { NodesMesh } from './nodes-mesh.js';

export { AwtError } from './connection.js';
export { DEFAULT_LIGHT, LIGHT_SHADER } from './light.js';

const GONE = ['NO_FOREST', 'WRONG_TOKEN', 'NOT_ALLOWED'];

export class AwtHair extends GatewayLink {
  constructor(url, token, scene, { kind = 'guides', level = 'full', nodes = false, light } = {}) {
    super(url, token);
    Object.assign(this, { kind, level, nodesWanted: nodes, forest: null, driving: null, following: null, wanted: null });
    this.stats = { strands: 0, frames: 0 };
    this.light = light ?? new Light();
    this.object = new THREE.Group();
    this.hair = new HairMesh(this.light);
    this.nodes = new NodesMesh();
    this.object.add(this.hair, this.nodes);
    scene?.add(this.object);
    this.decoder = new Decoder();
    this.moving = new MovingHair(this.object, this.hair);
    this.turn = 0; /* counts what the connection does about forests: what belongs to an earlier turn is over */
    this.connect();
    this.draws = requestAnimationFrame((now) => this.draw(now));
  }

  /** The connection stands: what was followed before is so again. */
  async opened() {
    if (this.wanted?.followed) {
      this.wanted = null; /* the gateway will say what it shows now */
    } else if (this.wanted) {
      await this.take(this.wanted).catch(() => {}); /* told by state */
    }
  }

  /* ---- which forest */

  heardShown() {
    this.hearClock();
    this.followShown();
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
      const forest = await makeOrOpen(this.connection, wanted, (what, share) => this.enter('busy', what, share));
      wanted.made = wanted.recipe && forest;
      if (turn !== this.turn) {
        return null;
      }
      this.forest = forest;
      this.driving = new Driving(this.connection, forest, (error) => this.say('refused', error));
      await this.beginClock(wanted, forest);
      if (turn !== this.turn) {
        return null;
      }
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

  leave() {
    this.turn++;
    this.following?.end();
    this.forest = this.driving = this.following = null;
    this.moving.reset();
    this.hair.hide();
    this.nodes.visible = false;
    this.stats = { strands: 0, frames: 0 };
  }

  /* ---- frames */

  /** Subscribes to the forest's frames as kind, level and nodes say now. */
  follow() {
    this.following?.end();
    this.following = new Following(this.connection, this.decoder, this.forest.handle, { kind: this.kind, level: this.level, nodes: this.nodesWanted }, {
      hair: (decoded, frame) => this.showHair(decoded, frame), nodes: (decoded) => this.showNodes(decoded),
      refused: (error) => this.say('refused', error),
      ended: (error) => {
        this.leave();
        this.wanted = null;
        this.enter('empty', error.message);
      },
    });
    return this.following.begin();
  }

  showNodes(decoded) {
    this.nodes.show(decoded);
    this.nodes.visible = this.nodesWanted;
    this.say('nodes', decoded);
  }

  showHair(decoded, frame) {
    const now_ms = performance.now(), { strands, points } = decoded;
    this.moving.take(decoded, Number(frame.time_us), now_ms);
    this.moving.see(now_ms, this.driving.stepsNow(now_ms));
    this.stats = { strands, points, frames: this.stats.frames + 1, bytes: frame.glb.length, active: frame.active_nodes,
      splits: frame.splits, merges: frame.merges, step_ms: frame.step_us / 1000, encode_ms: frame.encode_us / 1000,
      age_ms: (frame.age_us + (this.connection.peer.way_us ?? 0)) / 1000, delta: frame.base !== 0n,
      time_us: frame.time_us, sequence: frame.sequence, skipped: frame.skipped, energy: frame.kinetic_energy_j };
    if (this.state !== 'live') {
      this.enter('live');
    }
    this.say('frame', this.stats);
  }

  /** Before each picture. */
  draw(now_ms) {
    this.draws = requestAnimationFrame((next) => this.draw(next));
    if (this.state === 'live' && this.moving.moves) {
      this.moving.see(now_ms, this.driving.stepsNow(now_ms));
      this.say('between');
    }
  }

  /** Other kinds and levels from now on: { kind, level, nodes }. */
  async choose({ kind = this.kind, level = this.level, nodes = this.nodesWanted }) {
    Object.assign(this, { kind, level, nodesWanted: nodes });
    if (this.forest && this.state === 'live') {
      const { forest } = this;
      this.turn++;
      this.stats.frames = 0;
      this.nodes.visible = false;
      await this.follow().catch((error) => this.forest === forest && this.say('refused', error));
    }
  }

  /* ---- time */

  /** { mode, rate, time_us, clock_us } as in forest-clock.js; null: nobody has said how time goes. */
  get clock() {
    return this.driving?.clock ?? null;
  }

  get now_us() {
    return this.driving?.now_us ?? null;
  }

  /** Simulated time that the forest was brought to from here. */
  get time_us() {
    return this.driving?.time_us ?? 0n;
  }

  get stepping() {
    return this.driving?.stepping ?? false;
  }

  /** Time goes so from now on: { mode: 'lockstep', 'free' or 'paused', rate, importance }. Resolves to the clock. */
  async setClock(wish) {
    const { driving, wanted } = this;
    if (!driving) {
      throw new Error('there is no hair whose time could be set');
    }
    const clock = await driving.setClock(wish), { mode, rate } = clock;
    if (driving === this.driving) {
      wanted && (wanted.clock = { mode, rate });
      this.sayClock(driving.forest, clock);
      this.clockChanged();
    }
    return clock;
  }

  /** Of a forest opened just now: as the gateway says it went last, or as it was wanted here. */
  async beginClock(wanted, forest) {
    const told = this.shownClock, wish = told ?? wanted.clock ?? wanted.recipe?.clock ?? null;
    if (forest.isNew) {
      this.driving.begin();
    }
    if (wanted.followed) {
      this.driving.clock = told;
    } else if (wish && (!forest.isNew || wish.mode !== 'lockstep')) {
      await this.setClock(wish).catch((error) => this.say('refused', error));
    }
    this.clockChanged();
  }

  /** The clock that the gateway tells of the forest that is followed, or null. */
  get shownClock() {
    return this.forest && this.shown?.forest === String(this.forest.handle) ? toldClock(this.shown.clock) : null;
  }

  hearClock() {
    const told = this.shownClock, now = this.clock;
    if (told && !(now?.mode === told.mode && now.rate === told.rate)) {
      this.driving.clock = told;
      this.clockChanged();
    }
  }

  clockChanged() {
    this.moving.reckonAnew();
    this.say('clock', this.clock);
  }

  /* ---- driving */

  /** Lock-step: moves head and body ({ position, orientation }) and brings the forest to that time. False: it is still at the
   * step before, or time does not go in lock-step. */
  async step(time_us, head, body = head, teleport = false) {
    const { driving } = this, before = this.clock;
    const done = this.state === 'live' && driving !== null && await driving.step(time_us, head, body, teleport);
    if (driving === this.driving && before !== null && this.clock === null) {
      this.clockChanged();
    }
    return done;
  }

  /** Free-running: head and body are so now. The pose's simulated time, or null: time does not go by the daemon's clock, or it is
   * not known what time that is (setClock tells). */
  move(head, body = head, teleport = false) {
    return this.state === 'live' ? this.driving?.move(head, body, teleport) ?? null : null;
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
    this.sayShown(this.forest, about, this.clock);
  }

  /** Tells them that this page drives the forest that they follow. Resolves to how its time goes, when that is certain. */
  takeWheel() {
    this.sayWheel();
    return this.setClock(this.clock ?? { mode: 'lockstep' });
  }

  destroy(handle = this.forest?.handle) {
    return this.connection.ask('destroy', { forest: handle });
  }

  /** Ends the connection and frees what the graphics card holds. The forest lives on. */
  dispose() {
    cancelAnimationFrame(this.draws);
    this.leave();
    this.endLink();
    this.decoder.dispose();
    this.object.removeFromParent();
    [this.hair, this.nodes, this.light].forEach((part) => part.dispose());
  }
}
