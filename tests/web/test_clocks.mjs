// test_clocks.mjs BUILD [NAME]: the arithmetic of clocks in the browser, without a clock: the daemon's by PING and PONG, a forest's by
// SET_CLOCK_REPLY.
import { MODES, clockWish, newClock, simulatedAt, toldClock } from '../../clients/web/lib/forest-clock.js';
import { PeerClock } from '../../clients/web/lib/peer-clock.js';
import { check, equal, finish, test } from './harness.mjs';

/** An exchange with a clock that is ahead by `offset`, over ways of that length. */
function exchange(clock, sent, offset, there, back, answering = 5) {
  const received = sent + there + offset;
  clock.add(BigInt(sent), BigInt(received), BigInt(received + answering), BigInt(sent + there + answering + back));
}

await test('clocks_of_two_machines_are_compared_by_the_quickest_exchange', () => {
  const clock = new PeerClock();
  equal(clock.offset_us, null, 'before anything has come');
  exchange(clock, 1000, 5000000, 900, 100);
  equal(Number(clock.offset_us), 5000400, 'of an uneven way');
  exchange(clock, 2000, 5000000, 60, 60);
  exchange(clock, 3000, 5000000, 20000, 100);
  equal(Number(clock.offset_us), 5000000, 'of the quickest');
  equal(clock.way_us, 60, 'half of its way');
});

await test('clocks_that_drift_apart_are_followed', () => {
  const clock = new PeerClock();
  exchange(clock, 0, -700, 10, 10);
  Array.from({ length: 16 }, (_, n) => exchange(clock, 1000 * (n + 1), -900, 50, 50));
  equal(Number(clock.offset_us), -900, 'offset');
  equal(clock.way_us, 50, 'half of the way');
});

await test('clocks_that_cannot_be_are_not_taken', () => {
  const clock = new PeerClock();
  clock.add(100n, 50n, 40n, 200n); /* answered before it came */
  clock.add(100n, 50n, 60n, 90n);  /* arrived before it was sent */
  clock.add(100n, 0n, 500n, 200n); /* answering took longer than all of it */
  equal(clock.offset_us, null, 'offset');
});

await test('clock_of_a_forest_goes_as_it_is_set', () => {
  const free = { mode: 'free', rate: 0.5, time_us: 2000000n, clock_us: 77000000n };
  equal(simulatedAt(free, 77000000n), 2000000n, 'as it was set');
  equal(simulatedAt(free, 79000000n), 3000000n, 'two seconds later');
  equal(simulatedAt(free, null), null, 'where the daemon\'s clock is not known');
  equal(simulatedAt({ ...free, mode: 'paused' }, 79000000n), 2000000n, 'paused');
  equal(simulatedAt(newClock(30n), 79000000n), 30n, 'of a new forest');
  equal(simulatedAt(toldClock({ mode: 'free', rate: 2 }), 79000000n), null, 'of a clock that is only told of');
});

await test('clock_that_is_told_is_checked', () => {
  for (const told of [null, {}, { mode: 'fast', rate: 1 }, { mode: 'free', rate: 'half' }, { mode: 'free', rate: Infinity }]) {
    equal(toldClock(told), null, JSON.stringify(told));
  }
  equal(MODES.map((mode) => clockWish(1n, { mode, rate: 1 }).mode).join(), '0,1,2', 'numbers on the wire');
  let said = '';
  try {
    clockWish(1n, { mode: 'fast', rate: 1 });
  } catch ({ message }) {
    said = message;
  }
  check(said.includes('lockstep, free, paused'), said);
});

await finish();
