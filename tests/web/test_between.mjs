// test_between.mjs BUILD [NAME]: the clock that goes between frames, with arrivals that are made up.
import { Between } from '../../clients/web/lib/between.js';
import { check, equal, finish, test } from './harness.mjs';

const STEP_US = 16667, SCREEN_MS = 1000 / 144;

/** Numbers from 0 to 1 that are the same in every run. */
function random(seed) {
  let x = seed;
  return () => (x = (x * 1103515245 + 12345) % 2147483648) / 2147483648;
}

/** Frames that were made every 1/60 s and came after ways of that length, ms, looked at 144 times a second: what was shown when. */
function watch(count, wayOf, { lost = () => false } = {}) {
  const between = new Between(), seen = [];
  let came_ms = 0;
  const arrivals = Array.from({ length: count }, (_, n) => {
    came_ms = Math.max(came_ms, n * STEP_US / 1000 + wayOf(n)); /* none overtakes another */
    return { n, came_ms };
  }).filter(({ n }) => !lost(n));
  for (let now_ms = 0; arrivals.length > 0 || now_ms < came_ms + 400; now_ms += SCREEN_MS) {
    while (arrivals.length > 0 && arrivals[0].came_ms <= now_ms) {
      const { n, came_ms: at } = arrivals.shift();
      between.add(n, n * STEP_US, at);
    }
    const shown = between.at(now_ms);
    shown && seen.push({ now_ms, ...shown, at_us: (shown.from + (shown.to - shown.from) * shown.weight) * STEP_US, clock_us: between.shown_us });
  }
  return seen;
}

const stepsOf = (seen) => seen.slice(1).map(({ at_us }, i) => at_us - seen[i].at_us);
const sound = (seen) => seen.every(({ from, to, weight }) => weight >= 0 && weight <= 1 && to >= from);
/** Without the beginning, in which the clock finds its place, and the end, where it stands. */
const middle = (seen, last) => seen.filter(({ now_ms }) => now_ms > 1500 && now_ms < last * STEP_US / 1000 - 100);

await test('between_even_frames_are_shown_evenly_at_any_rate_of_the_screen', () => {
  const seen = watch(240, () => 20), steps = stepsOf(middle(seen, 240)), even = SCREEN_MS * 1000;
  check(sound(seen), 'weights from 0 to 1');
  check(steps.every((step) => Math.abs(step - even) < 0.1 * even), `steps of ${Math.min(...steps)} to ${Math.max(...steps)} us, not ${even}`);
  equal(seen.at(-1).at_us, 239 * STEP_US, 'the last frame is reached');
});

await test('between_jitter_of_the_way_is_not_seen', () => {
  const next = random(7), seen = watch(400, () => 20 + 25 * next()), steps = stepsOf(middle(seen, 400)), even = SCREEN_MS * 1000;
  check(sound(seen), 'weights from 0 to 1');
  check(steps.every((step) => step > 0.4 * even && step < 1.6 * even), `steps of ${Math.min(...steps)} to ${Math.max(...steps)} us, not about ${even}`);
});

await test('between_lost_frames_are_bridged', () => {
  const seen = watch(300, () => 20, { lost: (n) => n % 9 === 4 }), steps = stepsOf(middle(seen, 300)), even = SCREEN_MS * 1000;
  check(steps.every((step) => step > 0.4 * even && step < 1.6 * even), `steps of ${Math.min(...steps)} to ${Math.max(...steps)} us, not about ${even}`);
});

await test('between_time_never_runs_backwards_nor_past_the_newest_frame', () => {
  const next = random(3), seen = watch(400, (n) => 10 + 60 * next() + (n > 150 && n < 180 ? 300 : 0)); /* and a stall */
  check(sound(seen), 'weights from 0 to 1');
  check(stepsOf(seen).every((step) => step >= -1e-6), 'it runs backwards');
  check(seen.every(({ clock_us, now_ms }) => clock_us <= now_ms * 1000), 'it is ahead of what was made');
});

await test('between_a_stall_is_made_up_for_without_a_leap', () => {
  const seen = watch(300, (n) => 20 + (n >= 120 && n < 135 ? 250 - (n - 120) * STEP_US / 1000 : 0));
  const steps = stepsOf(seen.filter(({ now_ms }) => now_ms > 1500));
  check(Math.max(...steps) < 1.6 * SCREEN_MS * 1000, `a step of ${Math.max(...steps)} us`);
  equal(seen.at(-1).at_us, 299 * STEP_US, 'the last frame is reached');
});

await test('between_begins_anew_where_simulated_time_does', () => {
  const between = new Between();
  between.add('old', 5e6, 0);
  between.add('older', 5.1e6, 100);
  between.at(120);
  between.add('new', 0, 200);
  const { from, to } = between.at(210);
  equal(from + to, 'newnew', 'what is shown');
  equal(between.moves, false, 'there is nothing to move to');
});

await test('between_keeps_a_bounded_number_of_frames_and_nothing_of_before', () => {
  const between = new Between();
  equal(between.at(5), null, 'nothing has come');
  for (let n = 0; n < 1000; n++) {
    between.add(n, n * STEP_US, n); /* nobody looks: the page lies in the background */
  }
  check(between.frames.length <= 24, `${between.frames.length} frames are kept`);
  const { from, to, weight } = between.at(30000);
  check(from >= 976 && to <= 999 && weight >= 0 && weight <= 1, `${from} to ${to}`);
});

/** Frames a number of ms apart, of simulated time at that rate, looked at each ms; what was shown of each ms. */
function run(between, { from_ms, to_ms, every_ms, rate, from_us }) {
  const shown = [];
  for (let now_ms = from_ms; now_ms < to_ms; now_ms++) {
    (now_ms - from_ms) % every_ms === 0 && between.add(now_ms, from_us + (now_ms - from_ms) * 1000 * rate, now_ms);
    between.at(now_ms);
    shown.push(between.shown_us);
  }
  return shown;
}

await test('between_goes_at_the_rate_of_simulated_time_and_learns_a_new_one', () => {
  const between = new Between(), slow = run(between, { from_ms: 0, to_ms: 2000, every_ms: 20, rate: 0.25, from_us: 0 });
  const speed = (shown, from, to) => (shown[to] - shown[from]) / (to - from) / 1000;
  check(Math.abs(speed(slow, 1000, 1999) - 0.25) < 0.01, `it goes at ${speed(slow, 1000, 1999)}, not 0.25`);
  between.forget();
  const fast = run(between, { from_ms: 2000, to_ms: 3000, every_ms: 20, rate: 2, from_us: 500000 });
  check(Math.abs(speed(fast, 500, 999) - 2) < 0.05, `it goes at ${speed(fast, 500, 999)}, not 2`);
  check(500000 + 999 * 2000 - fast[999] < 60 * 2000, `it is ${(500000 + 999 * 2000 - fast[999]) / 2000} ms behind`);
});

await test('between_stands_still_in_a_pause_and_goes_on_from_there', () => {
  const between = new Between();
  run(between, { from_ms: 0, to_ms: 1000, every_ms: 10, rate: 1, from_us: 0 });
  between.forget(); /* paused */
  between.at(1200);
  equal(between.moves, false, 'something moves');
  const stood_us = between.shown_us;
  between.at(11000);
  equal(between.shown_us, stood_us, 'the time shown');
  between.forget(); /* and on */
  const after = run(between, { from_ms: 11000, to_ms: 11500, every_ms: 10, rate: 1, from_us: 1000000 });
  check(after.every((us, i) => us >= (i > 0 ? after[i - 1] : stood_us)), 'it runs backwards');
  check(Math.max(...after.slice(1).map((us, i) => us - after[i])) < 11000, 'it leaps');
  check(1499000 - after.at(-1) < 30000, `it is ${(1499000 - after.at(-1)) / 1000} ms behind`);
});

await test('between_hair_that_wakes_is_shown_without_the_delay_of_rest', () => {
  const between = new Between();
  run(between, { from_ms: 0, to_ms: 5000, every_ms: 250, rate: 1, from_us: 0 }); /* as the daemon shows hair at rest */
  const awake = run(between, { from_ms: 5000, to_ms: 6000, every_ms: 10, rate: 1, from_us: 5000000 });
  check(5999000 - awake.at(-1) < 40000, `a second later it is ${(5999000 - awake.at(-1)) / 1000} ms behind`);
});

await test('between_newest_is_what_came_last', () => {
  const between = new Between();
  [0, 1, 2].forEach((n) => between.add(n, n * STEP_US, 10 * n));
  const { from, to, weight } = between.newest(25);
  equal(`${from} ${to} ${weight}`, '2 2 1', 'the newest frame');
  equal(between.at(26).to, 2, 'it does not go back');
});

await finish();
