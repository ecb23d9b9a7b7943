// test_stream.mjs BUILD [NAME]: the streams that the page decodes, without a browser: receiver.wasm behind the gateway and awtd.
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { Receiver } from '../../clients/web/lib/receiver.js';
import { Wasm } from '../../clients/web/lib/wasm.js';
import { build, check, equal, finish, startAwtd, startGateway, test, top, until } from './harness.mjs';
import { Client, codec } from './socket.mjs';

const POSE = { position: [0, 1.6, 0], orientation: [0, 0, 0, 1] }, KINDS = { strands: 1, guides: 2, nodes: 3 };
const STRANDS = 500, STEPS = 12, STEP_US = 20000;
const wasm = new WebAssembly.Module(readFileSync(join(resolve(top, build), 'receiver.wasm')));
const awtd = await startAwtd(), gateway = await startGateway(awtd.port), client = new Client(gateway, 'drive');
await client.welcome();
const { forest } = (await client.ask('create', { style: 'long', strands: STRANDS, head: POSE, body: POSE })).values;
let time_us = 0;

async function newReceiver() {
  const { exports } = await WebAssembly.instantiate(wasm, { env: { emscripten_notify_memory_growth() {} } });
  exports._initialize();
  return new Receiver(new Wasm(exports));
}

/** A subscription that decodes what comes; `acknowledges`: in CREDIT, so that deltas may come. */
class Stream {
  static async open(values, acknowledges) {
    const stream = Object.assign(new Stream(), { acknowledges, receiver: await newReceiver(), taken: 0, bytes: [], deltas: 0 });
    if (values.kind === KINDS.guides) {
      stream.receiver.bind({ bytes: (await client.ask('binding', { forest })).values.binding });
    }
    const { subscription } = (await client.ask('subscribe', { forest, credit: 2, ...values })).values;
    return Object.assign(stream, { subscription, request: client.request });
  }

  frames() {
    return client.messages.filter(({ name, request }) => name === 'frame' && request === this.request);
  }

  /** The next frame, decoded. */
  async next() {
    const { values } = await until(() => this.frames()[this.taken], 'a frame');
    const decoded = this.receiver.frame({ ...values, bytes: values.glb });
    this.taken++;
    this.bytes.push(values.glb.length);
    this.deltas += values.base === 0n ? 0 : 1;
    client.socket.send(codec.encode('credit', { subscription: this.subscription, frames: 1, have: this.acknowledges ? decoded.have : 0n }, { required: false }));
    return { ...decoded, sequence: values.sequence };
  }

  end() {
    client.socket.send(codec.encode('unsubscribe', { subscription: this.subscription }, { required: false }));
  }
}

/** Turns the head a little, and brings the hair there. */
async function step() {
  time_us += STEP_US;
  const turn = 0.3 * Math.sin(time_us * 4e-6), head = { position: POSE.position, orientation: [0, Math.sin(turn), 0, Math.cos(turn)] };
  client.socket.send(codec.encode('motion', { forest, epoch: 1, sequence: time_us / STEP_US, time_us, head, body: POSE }, { required: false }));
  equal((await client.ask('query', { forest, time_us, kind: KINDS.nodes })).name, 'frame', 'the step');
}

const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);

/** The same hair by both streams, to the bit. */
async function compare(whole, delta) {
  for (let i = 0; i < STEPS; i++) {
    await step();
    const [a, b] = [await whole.next(), await delta.next()];
    equal(b.sequence, a.sequence, 'the frame');
    equal(b.strands, STRANDS, 'strands');
    check(Buffer.compare(Buffer.from(a.positions.buffer), Buffer.from(b.positions.buffer)) === 0, `frame ${a.sequence}: other points by deltas`);
    equal(String(b.head), String(a.head), 'the head');
  }
  equal(whole.deltas, 0, 'deltas among the whole frames');
  equal(delta.deltas, STEPS - 1, 'deltas after the first frame');
  const share = sum(delta.bytes.slice(1)) / sum(whole.bytes.slice(1));
  console.log(`     deltas take ${(100 * share).toFixed(0)} % of the bytes of whole frames`);
  check(share < 0.8, `${sum(delta.bytes)} bytes, ${sum(whole.bytes)} without deltas`);
  [whole, delta].forEach((stream) => stream.end());
}

await test('stream_of_guides_is_the_same_hair_in_fewer_bytes_by_deltas', async () => {
  const watched = { kind: KINDS.guides, deltas: 1 };
  await compare(await Stream.open(watched, false), await Stream.open(watched, true));
});

await test('stream_of_strands_is_the_same_hair_in_fewer_bytes_by_deltas', async () => {
  await compare(await Stream.open({ kind: KINDS.strands, deltas: 0 }, true), await Stream.open({ kind: KINDS.strands, deltas: 1 }, true));
});

await test('stream_says_what_delta_it_cannot_read_and_goes_on', async () => {
  const stream = await Stream.open({ kind: KINDS.guides, deltas: 1 }, true);
  await step();
  await stream.next();
  stream.receiver.reset();
  stream.receiver.bind({ bytes: (await client.ask('binding', { forest })).values.binding });
  await step();
  let said = '';
  await stream.next().catch((error) => { said = error.message; });
  check(said.includes('which is not here'), said);
  client.socket.send(codec.encode('credit', { subscription: stream.subscription, frames: 1, have: 0n }, { required: false }));
  stream.taken++;
  await step();
  equal((await stream.next()).strands, STRANDS, 'strands of the next frame');
  equal(stream.deltas, 0, 'deltas read: it came whole');
  stream.end();
});

client.socket.close();
await finish();
