// test_viewer.mjs BUILD [NAME]: the viewer in a real browser: counts and pixels, never frame rates.
import { readFileSync } from 'node:fs';
import { createServer as createHttpServer } from 'node:http';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { countDifferent, countPixels, openBrowser, View } from './browser.mjs';
import { check, equal, finish, skip, startAwtd, startGateway, test, top, until } from './harness.mjs';
import { codec } from './socket.mjs';

const STRANDS = 600, { browser, why } = await openBrowser();
if (!browser) {
  skip(20, why);
  await finish();
}
let awtd = await startAwtd();
const gateway = await startGateway(awtd.port), view = await View.open(browser, gateway.drive);
await view.untilLive();
await view.hold();

/** Dark, warm, and there: hair of the brown style; skin is lighter, the shirt blue. */
const hairColour = (r, g, b, a) => a > 200 && r > b + 8 && r > g && r < 150 && b < 80;

await test('viewer_loads_without_a_complaint', async () => {
  equal(view.errors.join('; '), '', 'the browser complains');
  equal((await view.knows()).driving, true, 'it drives');
  equal(await view.page.evaluate(() => getComputedStyle(document.getElementById('face')).display), 'none', 'no card over the hair');
});

await test('viewer_draws_hair_where_the_head_is', async () => {
  const bald = await view.picture(false), haired = await view.picture(true), { width, height } = bald;
  const head = (x, y) => Math.abs(x - width / 2) < 0.16 * width && y < 0.62 * height;
  const before = countPixels(bald, (r, g, b, a, x, y) => head(x, y) && hairColour(r, g, b, a));
  const after = countPixels(haired, (r, g, b, a, x, y) => head(x, y) && hairColour(r, g, b, a));
  check(after > before + 1500, `${after} pixels of hair colour with hair, ${before} without`);
  const sides = countPixels(haired, (r, g, b, a, x) => a > 0 && (x < 0.2 * width || x > 0.8 * width));
  check(sides < 0.3 * width * height, `${sides} pixels are drawn far from the head`);
});

await test('viewer_has_all_the_strands_of_the_forest', async () => {
  const known = await view.knows(), asked = await view.page.evaluate(() => viewer.hair.forest.strands);
  equal(known.strands, STRANDS, 'strands on the page');
  equal(asked, STRANDS, 'strands of the forest');
  const triangles = await view.page.evaluate(() => {
    const { hair } = viewer.hair;
    return { drawn: hair.geometry.index.count / 3, pieces: hair.uniforms.pieces.value, points: hair.points };
  });
  equal(triangles.drawn, 2 * STRANDS * (triangles.points - 1) * triangles.pieces, 'triangles');
});

await test('viewer_draws_strands_as_it_draws_guides', async () => {
  const guides = await view.picture();
  for (const [level, strands] of [['strands full', STRANDS], ['strands fifth', STRANDS / 5]]) {
    await view.page.evaluate((name) => viewer.changed('level', name), level);
    await view.untilIt((known) => known.frames > 0 && known.strands === strands, level);
    const apart = countDifferent(guides, await view.picture()), drawn = countPixels(guides, hairColour);
    check(level === 'strands fifth' || apart < 0.15 * drawn, `${level}: ${apart} pixels of ${drawn} differ`);
  }
  await view.steps(3);
  await view.page.evaluate(() => viewer.changed('level', 'strands full'));
  await view.untilIt((known) => known.frames > 0 && known.strands === STRANDS, 'all strands again');
  await view.page.mouse.move(200, 200);
  await until(async () => {
    await view.steps(1);
    return (await view.knows()).delta;
  }, 'strands as deltas');
  await view.page.evaluate(() => viewer.changed('level', 'guides'));
  await view.untilIt((known) => known.frames > 0, 'guides again');
});

await test('viewer_head_follows_the_mouse', async () => {
  const before = await view.picture(), turn = () => view.page.evaluate(() => viewer.hair.object.quaternion.y);
  await view.page.mouse.move(600, 180);
  await view.steps(30);
  check(await turn() > 0.2, `the head is turned by ${await turn()}`);
  const apart = countDifferent(before, await view.picture());
  check(apart > 1500, `${apart} pixels changed`);
});

await test('viewer_splits_more_below_a_lower_threshold', async () => {
  const shaken = async (threshold) => {
    await view.page.evaluate(async (value) => {
      const slider = document.getElementById('split_threshold');
      slider.value = 1000 * Math.log(value / 0.01) / Math.log(1000);
      slider.dispatchEvent(new Event('input'));
      await viewer.changed('motion', 'shake');
    }, threshold);
    await view.steps(90);
    return (await view.knows()).active;
  };
  const rarely = await shaken(10), often = await shaken(0.01);
  check(often > 1.5 * rarely, `${often} active nodes at 0.01, ${rarely} at 10`);
});

await test('viewer_shows_the_wisp_tree', async () => {
  await view.page.evaluate(() => viewer.changed('tree', true));
  await until(() => view.page.evaluate(() => viewer.hair.nodes.visible && viewer.hair.nodes.count > 0), 'the tree');
  const { nodes, active } = await view.page.evaluate(() => ({ nodes: viewer.hair.nodes.count, active: viewer.hair.stats.active }));
  equal(nodes, active, 'nodes that are drawn');
  const bright = countPixels(await view.picture(), (r, g, b) => r > 200 && g > 60 && g < 130 && b < 100);
  check(bright > 150, `${bright} pixels of the first level's colour`);
  await view.page.evaluate(() => viewer.changed('tree', false));
  equal(view.errors.join('; '), '', 'the browser complains');
});

await test('viewer_on_a_second_page_shows_the_same_hair', async () => {
  const second = await View.open(browser, gateway.view, { more: '&smooth=0&coarse=1&bare=1' });
  await second.untilLive();
  const [driver, viewer] = [await view.knows(), await second.knows()];
  equal(viewer.forest, driver.forest, 'the forest');
  equal(viewer.strands, STRANDS, 'its strands');
  equal(viewer.driving, false, 'it drives');
  await view.steps(5);
  const { sequence } = await view.knows();
  await second.untilIt((known) => known.sequence === sequence, 'the step of the other page');
  equal(second.errors.join('; '), '', 'the browser complains');
  await second.page.close();
});

await test('viewer_that_only_looks_shows_hair_between_the_frames', async () => {
  const second = await View.open(browser, gateway.view, { more: '&smooth=0&coarse=1&bare=1' });
  await second.untilLive();
  await second.page.evaluate(() => {
    globalThis.weights = [];
    viewer.hair.addEventListener('between', () => weights.push(viewer.hair.hair.uniforms.weight.value));
  });
  await view.page.mouse.move(100, 120);
  await view.steps(30);
  const { sequence } = await view.knows();
  await second.untilIt((known) => known.sequence === sequence, 'the last step');
  await until(() => second.page.evaluate(() => !viewer.hair.moving.moves), 'that the hair has come there');
  const weights = await second.page.evaluate(() => weights);
  check(weights.some((weight) => weight > 0 && weight < 1), `${weights.length} pictures between frames, none of them of both`);
  await second.hold();
  const at = async (weight) => {
    await second.page.evaluate((w) => {
      const { uniforms } = viewer.hair.hair, [before, now] = [uniforms.before, uniforms.positions].map(({ value }) => value);
      before.image.data = now.image.data.map((x, i) => (i % 4 === 0 ? x + 0.04 : x)); /* 4 cm aside */
      before.needsUpdate = true;
      uniforms.weight.value = w;
    }, weight);
    return second.picture();
  };
  const [from, half, to] = [await at(0), await at(0.5), await at(1)];
  for (const [name, apart] of [['first and half', countDifferent(from, half)], ['half and second', countDifferent(half, to)], ['first and second', countDifferent(from, to)]]) {
    check(apart > 1000, `${name}: ${apart} pixels differ`);
  }
  equal(second.errors.join('; '), '', 'the browser complains');
  await second.page.close();
});

await test('viewer_saves_its_settings_and_takes_them_again', async () => {
  const settings = () => view.page.evaluate(() => ({ params: viewer.settings.params, slider: document.getElementById('wind_x').value }));
  await view.page.evaluate(() => viewer.changed('wind_x', 2.5));
  const [download] = await Promise.all([view.page.waitForEvent('download'), view.page.evaluate(() => document.getElementById('save').click())]);
  const saved = readFileSync(await download.path());
  equal(JSON.parse(saved).params.wind_x, 2.5, 'saved');
  await view.page.evaluate(() => viewer.changed('wind_x', -1));
  equal((await settings()).params.wind_x, -1, 'changed');
  await view.drop('hair-settings.json', saved);
  await until(async () => (await settings()).params.wind_x === 2.5 && Number((await settings()).slider) > 600, async () => `the saved settings; there are ${JSON.stringify(await settings())}`);
  await view.untilLive();
  await view.drop('broken.json', Buffer.from('{"params": '));
  await until(async () => (await view.text('messages')).includes('broken.json: '), () => view.text('messages'));
  await view.page.evaluate(() => viewer.changed('wind_x', 0));
});

await test('viewer_explains_files_that_it_cannot_use', async () => {
  const said = async (name, bytes, words) => {
    await view.drop(name, bytes);
    await until(async () => (await view.text('messages')).includes(words), `"${words}" about ${name}; it says: ${await view.text('messages')}`);
  };
  await said('cat.png', Buffer.from('\x89PNG'), 'cat.png: it is neither hair');
  await said('walk.bvh', Buffer.from('HIERARCHY\nROOT Hips {'), 'walk.bvh: ');
  await said('short.hair', Buffer.from('HAIR\x01\x00\x00\x00'), 'short.hair: ');
  await view.untilLive(); /* of the style again */
});

await test('viewer_simulates_a_dropped_file', async () => {
  await view.drop('grown.hair', grownHair(400, 12));
  await until(async () => (await view.text('messages')).includes('grown.hair: 400 strands'), () => view.text('messages'));
  await view.untilIt((known) => known.state === 'live' && known.strands === 400, 'the hair of the file');
  await view.drop('still.csv', Buffer.from('Timestamp,x,y,z,qx,qy,qz,qw\n0.0,0,0,0,0,0,0,1\n0.5,0.1,0,0,0,0.6,0,0.8\n1.0,0,0,0,0,0,0,1\n'));
  await until(async () => (await view.text('messages')).includes('head-pose log'), () => view.text('messages'));
});

await test('viewer_survives_a_restart_of_awtd', async () => {
  const { port } = awtd, before = await view.knows();
  await awtd.stop();
  await view.untilIt(({ state }) => state === 'lost', 'that it is lost');
  check((await view.text('face-title')).includes('lost'), await view.text('face-title'));
  awtd = await startAwtd(port);
  await view.untilIt((known) => known.state === 'live' && known.driving && known.strands === 400, 'the hair again');
  check((await view.knows()).time_us >= before.time_us, 'the hair goes on where it was, for awtd keeps forests');
  await view.steps(2);
});

await test('viewer_that_finds_only_ended_hair_makes_its_own', async () => {
  const before = await view.knows();
  await view.page.evaluate(() => viewer.hair.destroy());
  await view.page.close();
  const next = await View.open(browser, gateway.drive);
  await next.untilIt((known) => known.state === 'live' && known.driving && known.forest !== before.forest, 'hair of its own');
  await next.page.close();
});

await test('viewer_has_a_face_while_hair_is_made', async () => {
  const next = await View.open(browser, gateway.drive);
  await next.untilLive();
  const faces = await next.page.evaluate(() => new Promise((resolve) => {
    const seen = [], look = () => seen.push([document.body.dataset.state, document.getElementById('face-title').textContent, document.getElementById('face-text').textContent, document.getElementById('face').hidden]);
    viewer.hair.addEventListener('state', ({ detail }) => {
      look();
      detail.state === 'live' && resolve(seen);
    });
    viewer.changed('strands', 900);
  }));
  check(faces.some(([state, title, text, hidden]) => state === 'busy' && title === 'Making hair' && text.length > 0 && !hidden), JSON.stringify(faces));
  check(faces.at(-1)[3], 'the card is gone when there is hair');
  await next.page.close();
});

await test('viewer_has_faces_for_no_daemon_yet_no_hair_and_no_room', async () => {
  const silent = createServer((socket) => socket.on('error', () => {}));
  await new Promise((resolve) => silent.listen(0, '127.0.0.1', resolve));
  const waits = await startGateway(silent.address().port), early = await View.open(browser, waits.drive);
  await until(async () => await early.text('face-title') === 'Connecting', () => early.text('face-title'));
  await early.page.close();
  await waits.stop();
  silent.close();

  const small = await startAwtd(0, '--no-save', '--max-forests', '1'), fresh = await startGateway(small.port);
  const looks = await View.open(browser, fresh.view);
  await looks.untilIt(({ state }) => state === 'empty', 'that there is no hair');
  check((await looks.text('face-text')).includes('as soon as somebody does'), await looks.text('face-text'));
  const first = await View.open(browser, fresh.drive);
  await first.untilLive();
  await looks.untilLive(); /* there it is */
  const other = await startGateway(small.port), second = await View.open(browser, other.drive);
  await second.untilIt(({ state, reason }) => state === 'empty' && reason.includes('limit'), 'that there is no room');
  check((await second.text('face-text')).includes('limit'), await second.text('face-text'));
  await Promise.all([looks, first, second].map(({ page }) => page.close()));
  await Promise.all([other, fresh].map((server) => server.stop()));
  await small.stop();
});

await test('viewer_without_the_token_says_so', async () => {
  const stranger = await View.open(browser, `${gateway.origin}/#token=${'0'.repeat(32)}`);
  await stranger.untilIt(({ state }) => state === 'lost', 'that it is refused');
  check((await stranger.text('face-text')).includes('wrong token'), await stranger.text('face-text'));
  await stranger.page.close();
});

/** Pages of somebody else's server, on another port: path -> text. What it does not have it takes from the gateway that `behind` names. */
async function serveElsewhere(pages, behind = () => null) {
  const server = createHttpServer(async (request, response) => {
    const page = pages[request.url], from = page === undefined && behind() ? await fetch(`http://127.0.0.1:${behind().port}${request.url}`) : null;
    response.setHeader('Content-Type', from?.headers.get('content-type') ?? (request.url.endsWith('js') ? 'text/javascript' : 'text/html'));
    response.end(from ? Buffer.from(await from.arrayBuffer()) : page ?? '');
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { origin: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

await test('viewer_of_another_origin_is_refused', async () => {
  const elsewhere = await serveElsewhere({ '/': '<title>elsewhere</title>' }), page = await browser.newPage(), open = ({ port, token }) => new Promise((resolve) => {
    const socket = new WebSocket(`ws://127.0.0.1:${port}/awt`, ['awt.1', `awt.token.${token}`]);
    socket.onopen = () => resolve(true);
    socket.onerror = () => resolve(false);
  });
  const friendly = await startGateway(awtd.port, '--origin', elsewhere.origin);
  await page.goto(elsewhere.origin);
  equal(await page.evaluate(open, { port: gateway.port, token: gateway.tokens.drive }), false, 'it got in');
  equal(await page.evaluate(open, { port: friendly.port, token: friendly.tokens.drive }), true, 'it got in where its origin is listed');
  await page.close();
  await friendly.stop();
  elsewhere.close();
});

await test('viewer_says_that_a_server_lies', async () => {
  const nonsense = codec.encode('list_styles_reply', {}, { request: 1n });
  nonsense[16] = 9; /* styles that do not come */
  const liar = createServer((socket) => {
    socket.on('error', () => {});
    socket.write(codec.encode('welcome', { version: 1, greatest_payload: 1 << 21, server: 'liar' }));
    socket.on('data', () => socket.write(nonsense));
  });
  await new Promise((resolve) => liar.listen(0, '127.0.0.1', resolve));
  const before = await startGateway(liar.address().port), lied = await View.open(browser, before.drive);
  await lied.untilIt(({ state, reason }) => state === 'lost' && reason.includes('does not make sense'), 'that it makes no sense');
  await lied.page.close();
  liar.close();
});

await test('viewer_example_of_the_readme_runs', async () => {
  const pages = {}, elsewhere = await serveElsewhere(pages, () => listed), listed = await startGateway(awtd.port, '--origin', elsewhere.origin);
  const [, code] = /\n((?: {4}.*\n)*? {4}.*AwtHair[^]*?\n)\n/.exec(readFileSync(join(top, 'README.md'), 'utf8')), page = await browser.newPage();
  const names = JSON.stringify({ imports: { three: '/three/three.module.min.js' } }); /* as a bundler would: the code stays as it is given */
  Object.assign(pages, { '/example.html': `<script type="importmap">${names}</script><body><script type="module" src="/example.js"></script>`,
    '/example.js': `${code}\nglobalThis.hair = hair;` });
  const heard = [];
  page.on('console', (message) => heard.push(message.text()));
  page.on('pageerror', (error) => heard.push(error.message));
  await page.goto(`${elsewhere.origin}/example.html#ws://127.0.0.1:${listed.port}/awt%20${listed.tokens.drive}`);
  await until(() => page.evaluate(() => globalThis.hair?.stats.frames > 3 && hair.stats.strands > 0 && Math.abs(hair.object.quaternion.y) > 0.01), () => `hair that turns: ${heard.join('; ')}`);
  await page.close();
  await listed.stop();
  elsewhere.close();
});

/** A cyHair file: strands on a ball of 10 cm, each hanging from its root. */
function grownHair(strands, points) {
  const bytes = Buffer.alloc(128 + 12 * strands * points);
  bytes.write('HAIR');
  [strands, strands * points, 2, points - 1].forEach((number, i) => bytes.writeUInt32LE(number, 4 + 4 * i));
  for (let s = 0, at = 128; s < strands; s++) {
    const y = 0.95 - 1.1 * s / strands, ring = Math.sqrt(1 - y * y), turn = s * 2.399963;
    for (let i = 0; i < points; i++, at += 12) {
      const out = 10 + 0.12 * i;
      [ring * Math.cos(turn) * out, y * 10 - 1.2 * i * (i / points), ring * Math.sin(turn) * out].forEach((value, k) => bytes.writeFloatLE(value, at + 4 * k));
    }
  }
  return bytes;
}

await browser.close();
await finish();
