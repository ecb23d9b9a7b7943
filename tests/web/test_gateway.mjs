// test_gateway.mjs BUILD [NAME]: the gateway without a browser: who is let in, what may be sent, what goes through unchanged.
import { connect, createServer } from 'node:net';
import { check, equal, finish, startAwtd, startGateway, test, until } from './harness.mjs';
import { Client, codec, lists, statusOf } from './socket.mjs';

const awtd = await startAwtd(), gateway = await startGateway(awtd.port);
const POSE = { position: [0, 1.6, 0], orientation: [0, 0, 0, 1] };
const RECIPE = { style: 'long', strands: 500, head: POSE, body: POSE };
const hex = (bytes) => Buffer.from(bytes).toString('hex');

await test('gateway_wants_token_and_origin', async () => {
  equal(await statusOf(gateway), 101, 'with both');
  equal(await statusOf(gateway, { token: gateway.tokens.view }), 101, 'a token to view');
  equal(await statusOf(gateway, { token: '0'.repeat(32) }), 401, 'a wrong token');
  equal(await statusOf(gateway, { token: '' }), 401, 'no token');
  equal(await statusOf(gateway, { origin: 'http://elsewhere.example' }), 403, 'another origin');
  equal(await statusOf(gateway, { origin: null }), 403, 'no origin');
  equal(await statusOf(gateway, { path: '/other' }), 404, 'another path');
});

await test('gateway_serves_pages_under_strict_headers', async () => {
  const page = await fetch(`${gateway.origin}/`), policy = page.headers.get('content-security-policy');
  equal(page.status, 200, 'the page');
  check(policy.includes("default-src 'none'") && !policy.includes('unsafe-inline'), `the policy: ${policy}`);
  equal(page.headers.get('x-content-type-options'), 'nosniff', 'types are not guessed');
  check(!/<script(?![^>]*\bsrc=)|<style|\son\w+=|\sstyle=/.test(await page.text()), 'the page has something inline');
  equal((await fetch(`${gateway.origin}/../gateway.mjs`)).status, 404, 'a file of the gateway');
  equal((await fetch(`${gateway.origin}/awt/receiver.wasm`)).headers.get('content-type'), 'application/wasm', 'WebAssembly');
  equal((await fetch(`${gateway.origin}/`, { method: 'POST' })).status, 405, 'POST');
  equal((await (await fetch(`${gateway.origin}/healthz`)).json()).ok, true, 'its health');
});

await test('gateway_refuses_foreign_host_names', async () => {
  const socket = connect(gateway.port, '127.0.0.1');
  let answer = '';
  socket.on('data', (bytes) => { answer += bytes; });
  socket.write('GET / HTTP/1.1\r\nHost: rebound.example\r\nConnection: close\r\n\r\n');
  await until(() => answer.includes('\r\n\r\n'), 'an answer');
  check(answer.startsWith('HTTP/1.1 421'), answer.slice(0, 40));
});

await test('gateway_carries_the_protocol_both_ways', async () => {
  const driver = new Client(gateway, 'drive');
  equal((await driver.welcome()).values.auth_required, 0, 'nothing to prove to awtd');
  const made = await driver.ask('create', RECIPE);
  equal(made.name, 'create_reply', 'CREATE');
  equal(made.values.strands, 500, 'strands');
  const { forest } = made.values;
  driver.socket.send(codec.encode('motion', { forest, epoch: 1, sequence: 1, time_us: 20000n, head: POSE, body: POSE }, { required: false }));
  const frame = await driver.ask('query', { forest, time_us: 20000n, kind: 1 });
  equal(frame.name, 'frame', 'QUERY');
  equal(frame.values.time_us, 20000n, 'its time');
  equal(String.fromCharCode(...frame.values.glb.subarray(0, 4)), 'glTF', 'what came');
  driver.socket.close();
});

await test('gateway_lets_view_tokens_only_look', async () => {
  const driver = new Client(gateway, 'drive'), viewer = new Client(gateway, 'view');
  await driver.welcome();
  await viewer.welcome();
  const { forest, drive_token: token } = (await driver.ask('create', RECIPE)).values;
  equal((await viewer.ask('attach', { forest, token })).name, 'attach_reply', 'ATTACH, even with the token to drive');
  const NOT_ALLOWED = lists.ERRORS.NOT_ALLOWED;
  for (const [name, values] of [['set_params', { forest, params: [] }], ['query', { forest, time_us: 40000n }], ['destroy', { forest }], ['create', RECIPE],
    ['upload', { piece: new Uint8Array(4) }], ['hello', {}], ['snapshot', { forest }]]) {
    const answer = await viewer.ask(name, values);
    equal(answer.values?.code, NOT_ALLOWED, name);
    equal(answer.values?.about, codec.idOf(name), 'what it is about');
  }
  equal((await viewer.ask('query', { forest, latest: 1, kind: 1 })).name, 'frame', 'QUERY of the latest');
  driver.socket.close();
  viewer.socket.close();
});

await test('gateway_ends_what_is_no_message', async () => {
  for (const bytes of [new Uint8Array(3), new Uint8Array([9, 0, 0, 0, 5, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]), Buffer.alloc((2 << 20) + 100)]) {
    const client = new Client(gateway, 'drive');
    await client.welcome();
    client.socket.send(bytes);
    check([1002, 1009].includes((await until(() => client.closed, 'the end')).code), `code ${client.closed.code}`);
  }
});

await test('gateway_tells_viewers_what_is_shown', async () => {
  const driver = new Client(gateway, 'drive'), viewer = new Client(gateway, 'view');
  await driver.welcome();
  await viewer.welcome();
  const { forest, drive_token: drive, view_token: view } = (await driver.ask('create', RECIPE)).values;
  driver.socket.send(JSON.stringify({ show: { forest: String(forest), drive: hex(drive), view: hex(view), about: { name: 'long' } } }));
  const { shown } = await until(() => viewer.texts.find((text) => text.shown?.forest === String(forest)), 'what is shown');
  equal(shown.token, hex(view), 'the token that it is told');
  equal(shown.driven, true, 'somebody drives');
  driver.socket.send(JSON.stringify({ body: [0, 1.6, 0, 0, 0, 0, 1] }));
  await until(() => viewer.texts.some((text) => text.body?.length === 7), 'the body');
  const late = new Client(gateway, 'view');
  await until(() => late.texts.some((text) => text.body?.length === 7), 'the body, told to who comes later');
  late.socket.close();
  driver.socket.close();
  await until(() => viewer.texts.at(-1).shown?.driven === false, 'that nobody drives any more');
  viewer.socket.send(JSON.stringify({ show: { forest: '1', drive: hex(drive), view: hex(view) } }));
  equal((await until(() => viewer.closed, 'the end')).code, 1008, 'a viewer that wants to show');
});

await test('gateway_tells_viewers_how_time_goes', async () => {
  const driver = new Client(gateway, 'drive'), viewer = new Client(gateway, 'view'), other = new Client(gateway, 'drive');
  await Promise.all([driver, viewer, other].map((client) => client.welcome()));
  const { forest, drive_token: drive, view_token: view } = (await driver.ask('create', RECIPE)).values, handle = String(forest);
  const say = (client, text) => client.socket.send(JSON.stringify(text)), clock = () => viewer.texts.at(-1).shown?.clock;
  say(driver, { show: { forest: handle, drive: hex(drive), view: hex(view), clock: { mode: 'lockstep', rate: 1, more: 'than is told' } } });
  await until(() => JSON.stringify(clock()) === '{"mode":"lockstep","rate":1}', () => JSON.stringify(viewer.texts.at(-1)));
  say(other, { clock: { forest: handle, mode: 'paused', rate: 1 } }); /* it does not drive */
  say(driver, { clock: { forest: '77', mode: 'paused', rate: 1 } }); /* not of what is shown */
  await Promise.all([driver, other].map((client) => client.ask('list_styles', {}))); /* what was sent before has been heard */
  say(driver, { clock: { forest: handle, mode: 'free', rate: 0.5 } });
  await until(() => clock()?.mode === 'free' && clock().rate === 0.5, () => JSON.stringify(viewer.texts.at(-1)));
  check(!viewer.texts.some(({ shown }) => shown?.clock?.mode === 'paused'), 'a clock of who does not drive');
  const late = new Client(gateway, 'view');
  await until(() => late.texts.some(({ shown }) => shown?.clock?.rate === 0.5), 'the clock, told to who comes later');
  say(driver, { clock: { forest: handle, mode: 'fast', rate: 1 } });
  equal((await until(() => driver.closed, 'the end')).code, 1008, 'a mode that there is not');
  say(viewer, { clock: { forest: handle, mode: 'paused', rate: 1 } });
  equal((await until(() => viewer.closed, 'the end')).code, 1008, 'a viewer that sets a clock');
  [late, other].forEach((client) => client.socket.close());
});

/** A gateway before a daemon that answers each connection with these bytes. */
async function beforeLiar(answer) {
  const liar = createServer((socket) => {
    socket.on('error', () => {});
    socket.write(answer);
  });
  await new Promise((resolve) => liar.listen(0, '127.0.0.1', resolve));
  return { liar, gateway: await startGateway(liar.address().port) };
}

const welcome = (values) => codec.encode('welcome', { version: 1, auth_required: 0, greatest_payload: 1 << 21, server: 'liar', ...values });

await test('gateway_tells_of_daemons_that_lie', async () => {
  const lies = [[Buffer.from('HTTP/1.1 400 Bad Request\r\n\r\n'), 'not awtd'], [welcome({ version: 9 }), 'version'], [welcome({ auth_required: 1 }), 'does not answer']];
  await Promise.all(lies.map(async ([answer, reason]) => {
    const { liar, gateway: before } = await beforeLiar(answer), client = new Client(before, 'drive');
    await until(() => client.closed, 'the end');
    equal(client.closed.code, 1013, 'code');
    check(client.closed.reason.includes(reason), `"${client.closed.reason}" says nothing of "${reason}"`);
    liar.close();
    await before.stop();
  }));
});

await test('gateway_ends_messages_longer_than_any', async () => {
  const header = Buffer.alloc(16);
  header.writeUInt32LE(0xfffffff0);
  const { liar, gateway: before } = await beforeLiar(Buffer.concat([welcome({}), header])), client = new Client(before, 'drive');
  equal((await until(() => client.closed, 'the end')).code, 1002, 'code');
  liar.close();
  await before.stop();
});

await test('gateway_does_not_gather_for_a_browser_that_takes_nothing', async () => {
  let sent = 0, full = false;
  const huge = Buffer.alloc(1 << 20), liar = createServer((socket) => {
    const header = Buffer.alloc(16);
    header.writeUInt32LE(64 << 20);
    header.writeUInt16LE(65535, 4); /* of a type that the browser does not know, and does not read */
    socket.on('error', () => {});
    socket.write(Buffer.concat([welcome({}), header]));
    const more = () => {
      for (full = false; !full && sent < 64 << 20; sent += huge.length) {
        full = !socket.write(huge);
      }
    };
    socket.on('drain', more);
    more();
  });
  await new Promise((resolve) => liar.listen(0, '127.0.0.1', resolve));
  const before = await startGateway(liar.address().port), client = new Client(before, 'drive');
  client.socket.on('open', () => client.socket.pause());
  let last = -1;
  await until(async () => {
    const still = sent > 0 && sent === last;
    last = sent;
    await new Promise((resolve) => setTimeout(resolve, 300));
    return still && sent === last;
  }, 'the daemon being held up');
  check(full && sent < 32 << 20, `${sent} bytes were taken from the daemon`);
  client.socket.resume();
  await until(() => sent >= 64 << 20, 'the rest');
  client.socket.terminate();
  liar.close();
  await before.stop();
});

await finish();
