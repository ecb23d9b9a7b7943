// test_viewer_clock.mjs BUILD [NAME]: how time goes in the viewer: free-running, at a rate, paused; who drives and who looks on;
// daemons that come back. What must hold of simulated times and the daemon's clock, never how long a thing takes.
import { countDifferent, openBrowser, View } from './browser.mjs';
import { check, equal, finish, skip, startAwtd, startGateway, test, until } from './harness.mjs';
import { Client } from './socket.mjs';

const { browser, why } = await openBrowser();
if (!browser) {
  skip(12, why);
  await finish();
}
const FEW = '&strands=300&smooth=0&coarse=1';
let awtd = await startAwtd();
const gateway = await startGateway(awtd.port), view = await View.open(browser, gateway.drive, { more: FEW });
await view.untilLive();

/** What the page knows of time, and what it shows of it. */
function timeOf({ page }) {
  return page.evaluate(() => {
    const { hair } = viewer, find = (id) => document.getElementById(id), text = (select) => select.selectedOptions[0]?.textContent ?? '';
    return { mode: hair.clock?.mode ?? null, rate: hair.clock?.rate, time_us: Number(hair.clock?.time_us), clock_us: Number(hair.clock?.clock_us), isSure: typeof hair.clock?.time_us === 'bigint', isNew: hair.clock !== globalThis.clockBefore,
      shown: text(find('clock')), shownRate: find('rate-shown').textContent, rateIsShown: !find('rate-row').hidden, summary: find('summary').textContent,
      isThere: find('clock').offsetParent !== null };
  });
}

async function untilTime(of, matches, text) {
  return until(async () => {
    const time = await timeOf(of);
    return matches(time) && time;
  }, async () => `${text}; it is ${JSON.stringify(await timeOf(of))}`);
}

/** As somebody would at the panel; until it is so by this wish, whatever was before. */
async function choose(mode) {
  await view.page.evaluate(() => { globalThis.clockBefore = viewer.hair.clock; });
  await view.page.selectOption('#clock', mode);
  return untilTime(view, (time) => time.isNew && time.mode === mode, mode);
}

async function slide(rate) {
  await view.page.evaluate((value) => {
    const slider = document.getElementById('rate');
    slider.value = 1000 * Math.log(value / 0.1) / Math.log(20);
    slider.dispatchEvent(new Event('input'));
  }, rate);
  return untilTime(view, (time) => time.rate === rate && time.isSure, `the rate ${rate}`);
}

async function untilMore(of, frames) {
  const { sequence } = await of.knows();
  return of.untilIt((known) => known.sequence >= sequence + frames, `${frames} more frames`);
}

/** The forest as it stands, asked of the daemon. */
const latest = ({ page }) => page.evaluate(async () => {
  const { time_us, sequence } = await viewer.hair.connection.ask('query', { forest: viewer.hair.forest.handle, latest: 1, kind: 3 });
  return { time_us: Number(time_us), sequence: Number(sequence) };
});
const still = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

await test('clock_of_new_hair_is_lock_step', async () => {
  const time = await timeOf(view);
  equal(time.mode, 'lockstep', 'the mode');
  equal(time.shown, 'driven by this page', 'what is shown');
  equal(time.rateIsShown, false, 'a rate that means nothing is shown');
  equal(await view.page.evaluate(() => viewer.hair.move(viewer.driver.pose.head)), null, 'a pose by a clock that does not run');
});

await test('clock_that_runs_free_moves_frames_on_without_anybody_driving', async () => {
  await view.page.evaluate(() => {
    viewer.driver.paused = true;
    const { connection } = viewer.hair, send = connection.send.bind(connection);
    globalThis.sent = [];
    connection.send = (name, ...more) => {
      sent.push(name);
      return send(name, ...more);
    };
  });
  const before = await choose('free');
  equal(before.shown, 'free-running', 'what is shown');
  equal(before.rateIsShown, true, 'the rate can be chosen');
  await view.page.evaluate(() => { sent.length = 0; });
  const { time_us } = await view.knows(), after = await untilMore(view, 5);
  check(after.time_us > time_us, `simulated time is ${after.time_us}, and was ${time_us}`);
  const driven = await view.page.evaluate(() => sent.filter((name) => ['motion', 'query', 'set_clock'].includes(name)));
  equal(driven.join(' '), '', 'what was sent to move it');
  const refused = await view.page.evaluate(async () => {
    const { hair, driver } = viewer, done = await hair.step(hair.now_us + 100000n, driver.pose.head);
    return [done, sent.includes('query')];
  });
  equal(String(refused), 'false,false', 'a step in free-running time: done, asked for');
});

await test('clock_goes_at_its_rate', async () => {
  await view.page.evaluate(() => {
    globalThis.early = [];
    globalThis.frames = 0;
    viewer.hair.addEventListener('frame', ({ detail }) => {
      const { hair } = viewer, { peer } = hair.connection, slack_us = (peer.way_us + 2) * hair.clock.rate;
      frames++;
      Number(detail.time_us - hair.now_us) > slack_us && early.push(Number(detail.time_us - hair.now_us));
    });
  });
  await choose('free');
  const begin = await slide(0.5);
  equal(begin.shownRate, '0.50 ×', 'what is shown');
  await view.untilIt(({ time_us }) => time_us > begin.time_us + 400000, '0.4 s of simulated time');
  await untilMore(view, 5);
  const end = await view.page.evaluate(async () => {
    const { time_us, clock_us } = await viewer.hair.setClock({ mode: 'free' }); /* at the rate that it has */
    return { time_us: Number(time_us), clock_us: Number(clock_us) };
  });
  const simulated = end.time_us - begin.time_us, daemon = end.clock_us - begin.clock_us;
  check(daemon > 0 && simulated >= 0.5 * daemon - 2 && simulated <= 0.5 * daemon + 10002, /* a clock that is set anew begins at a whole step */
    `${simulated} us in ${daemon} us at half speed`);
  const { early, frames } = await view.page.evaluate(() => ({ early, frames }));
  check(frames >= 5, `${frames} frames`);
  equal(early.join(' '), '', 'frames that came before it was their time');
  const faster = await slide(2);
  await view.untilIt(({ time_us }) => time_us > faster.time_us + 400000, '0.4 s of simulated time');
  equal(await view.page.evaluate(() => early.join(' ')), '', 'frames before their time at double speed');
  await slide(1);
});

await test('clock_poses_are_of_the_present_and_each_later_than_the_last', async () => {
  await choose('free');
  const { before, poses, after } = await view.page.evaluate(() => {
    const { hair, driver: { pose } } = viewer, begin = hair.now_us;
    return { before: Number(begin), poses: Array.from({ length: 40 }, () => Number(hair.move(pose.head))), after: Number(hair.now_us) }; /* more than the page's clock has ticks */
  });
  check(before > 0 && poses[0] >= before && poses.every((pose, i) => i === 0 || pose > poses[i - 1]) && poses[39] <= after + 40, `${before}, ${poses.join(' ')}, ${after}`);
});

await test('clock_that_is_set_anew_takes_no_offence_at_poses_of_before', async () => {
  await choose('free');
  const complaints = await view.page.evaluate(async () => {
    const { hair, driver: { pose } } = viewer, heard = [];
    hair.addEventListener('refused', ({ detail }) => heard.push(detail.message));
    hair.move(pose.head);
    const { driving } = hair;
    hair.connection.send('motion', { forest: hair.forest.handle, epoch: driving.epoch, sequence: ++driving.sequence, time_us: hair.now_us + 250000n, ...pose });
    await hair.setClock({ mode: 'free' });
    const early = hair.move(pose.head);
    await hair.listStyles(); /* an error would have come before this */
    return early === null ? 'no pose was sent' : heard.join('; ');
  });
  equal(complaints, '', 'complaints');
});

await test('clock_that_runs_free_takes_the_head_along', async () => {
  const hairOf = () => view.page.evaluate(() => [...viewer.hair.hair.uniforms.positions.value.image.data.filter((_, i) => i % 64 < 3)]);
  await choose('free');
  await view.page.mouse.move(188, 180);
  await view.page.evaluate(() => { viewer.driver.paused = false; });
  const before = await view.picture(), rest = await hairOf(), complaints = await view.text('messages');
  await view.page.mouse.move(340, 120);
  await view.page.evaluate(() => { globalThis.far = 0; });
  await until(async () => {
    const now = await hairOf();
    await view.page.evaluate((moved) => { far = Math.max(far, moved); }, Math.max(...now.map((x, i) => Math.abs(x - rest[i]))));
    return view.page.evaluate(() => viewer.hair.object.quaternion.y > 0.2 && far > 0.005);
  }, async () => `that head and hair move; ${await view.page.evaluate(() => [viewer.hair.object.quaternion.y, far])}`);
  const apart = countDifferent(before, await view.picture());
  check(apart > 1000, `${apart} pixels changed`);
  equal(await view.text('messages'), complaints, 'complaints');
});

await test('clock_that_is_paused_stands_still', async () => {
  await choose('free');
  await view.page.evaluate(() => viewer.changed('motion', 'shake'));
  await untilMore(view, 10);
  await choose('paused');
  equal((await timeOf(view)).rateIsShown, false, 'a rate that means nothing is shown');
  const before = await latest(view);
  await view.untilIt(({ sequence }) => sequence >= before.sequence, 'the last frame');
  await until(() => view.page.evaluate(() => !viewer.hair.moving.moves), 'that the picture has come there');
  await view.page.evaluate(() => { viewer.stage.followed.x += 0.05; }); /* a camera that has not come to the head yet */
  const picture = await view.picture(), now = await view.page.evaluate(() => Number(viewer.hair.now_us));
  await still(400);
  const after = await latest(view);
  equal(JSON.stringify(after), JSON.stringify(before), 'the forest');
  equal(await view.page.evaluate(() => Number(viewer.hair.now_us)), now, 'simulated time');
  equal(countDifferent(picture, await view.picture()), 0, 'pixels that changed');
  await choose('free');
  const { time_us } = await untilMore(view, 10);
  check(time_us > before.time_us, `it goes on at ${time_us}, after ${before.time_us}`);
  equal((await view.text('messages')), '', 'complaints');
});

await test('clock_that_is_refused_is_told_and_what_is_so_is_shown', async () => {
  await choose('free');
  await view.page.evaluate(() => viewer.clock.ask({ rate: 50 }));
  await until(async () => (await view.text('messages')).includes('0.01 to 10'), () => view.text('messages'));
  const time = await timeOf(view);
  equal(`${time.mode} ${time.rate} ${time.shown} ${time.shownRate}`, 'free 1 free-running 1.00 ×', 'what is so');
  const wrong = await view.page.evaluate(() => viewer.hair.setClock({ mode: 'fast' }).catch(({ message }) => message));
  check(String(wrong).includes('lockstep, free, paused'), String(wrong));
});

await test('clock_in_a_second_browser_is_the_same', async () => {
  await choose('free');
  const second = await View.open(browser, gateway.view, { more: FEW, width: 240, height: 135 });
  await second.untilLive();
  const seen = await untilTime(second, ({ mode }) => mode === 'free', 'free');
  equal(seen.isThere, false, 'a control that may not be used');
  check(seen.summary.startsWith('free-running · 300 strands'), seen.summary);
  await untilMore(second, 5);
  await slide(0.5);
  await untilTime(second, ({ rate, summary }) => rate === 0.5 && summary.startsWith('free-running, 0.5 times as fast · '), 'half speed');
  const refused = await second.page.evaluate(() => viewer.hair.setClock({ mode: 'paused' }).catch(({ code }) => code));
  equal(refused, 'NOT_ALLOWED', 'a viewer that sets the clock');
  equal((await timeOf(second)).mode, 'free', 'what it sees then');
  await choose('paused');
  await untilTime(second, ({ mode, summary }) => mode === 'paused' && summary.startsWith('paused · '), 'the pause');
  await choose('lockstep');
  await untilTime(second, ({ mode, summary }) => mode === 'lockstep' && !/paused|free/.test(summary), 'lock-step');
  const { time_us } = await view.knows();
  await second.untilIt((known) => known.time_us > time_us, 'what the page drives');
  equal(second.errors.join('; '), '', 'the browser complains');
  await second.page.close();
});

await test('clock_that_somebody_else_sets_is_told_once', async () => {
  const other = new Client(gateway, 'drive');
  await other.welcome();
  const { handle, token } = await view.page.evaluate(() => ({ handle: String(viewer.hair.forest.handle), token: viewer.hair.forest.driveToken }));
  const forest = BigInt(handle);
  equal((await other.ask('attach', { forest, token: Buffer.from(token, 'hex') })).name, 'attach_reply', 'ATTACH');
  await view.page.evaluate(() => {
    globalThis.complaints = 0;
    viewer.hair.addEventListener('refused', () => { complaints++; });
  });
  equal((await other.ask('set_clock', { forest, mode: 1, rate: 1 })).name, 'set_clock_reply', 'SET_CLOCK');
  await untilTime(view, ({ mode, shown }) => mode === null && shown === 'set by somebody else', 'that it is not known');
  await untilMore(view, 3);
  equal(await view.page.evaluate(() => complaints), 1, 'complaints');
  await choose('lockstep');
  const { time_us } = await view.knows();
  await view.untilIt((known) => known.time_us > time_us + 100000, 'that the page drives again');
  other.socket.close();
});

await test('clock_is_so_again_after_a_restart_of_awtd', async () => {
  await choose('free');
  await slide(0.5);
  const second = await View.open(browser, gateway.view, { more: FEW, width: 240, height: 135 });
  await second.untilLive();
  for (const [what, ...more] of [['killed'], ['without what it kept', '--no-save']]) {
    const { port } = awtd;
    awtd.child.kill('SIGKILL');
    await awtd.ended;
    await view.untilIt(({ state }) => state === 'lost', 'that it is lost');
    awtd = await startAwtd(port, ...more);
    await view.untilIt((known) => known.state === 'live' && known.driving && known.frames > 0, `the hair again, ${what}`);
    for (const page of [view, second]) {
      await page.untilLive();
      const time = await untilTime(page, ({ mode, rate }) => mode === 'free' && rate === 0.5, `the clock again, ${what}`);
      page === view ? equal(`${time.shown} ${time.shownRate} ${time.isSure}`, 'free-running 0.50 × true', `shown, ${what}`) : check(time.summary.startsWith('free-running, 0.5 times as fast · '), time.summary);
      await untilMore(page, 5);
    }
  }
  await second.page.close();
});

await test('clock_goes_on_when_the_drivers_page_is_closed', async () => {
  await choose('free');
  await slide(0.5);
  const second = await View.open(browser, gateway.view, { more: FEW, width: 240, height: 135 });
  await second.untilLive();
  await view.page.close();
  await until(() => second.page.evaluate(() => viewer.hair.shown.driven === false), 'that nobody drives');
  const { time_us } = await second.knows();
  check((await untilMore(second, 5)).time_us > time_us, 'simulated time goes on');
  const next = await View.open(browser, gateway.drive, { more: FEW });
  await next.untilIt((known) => known.state === 'live' && known.driving, 'the next driver');
  const time = await untilTime(next, ({ isSure }) => isSure, 'the clock');
  equal(`${time.mode} ${time.rate} ${time.shown}`, 'free 0.5 free-running', 'as the next driver finds it');
  await next.page.mouse.move(340, 120);
  await until(() => second.page.evaluate(() => viewer.hair.object.quaternion.y > 0.3), 'the head, moved by the next driver');
  equal(next.errors.concat(second.errors).join('; '), '', 'the browser complains');
  await Promise.all([next, second].map(({ page }) => page.close()));
});

await browser.close();
await finish();
