// between.js: what to show between frames that come unevenly: a clock that goes a little behind the newest of them, as far as
// their arrivals ask for, and the two frames around it. No clock of its own: who asks says what time it is.

const KEPT = 24;          /* frames at most: what a stall brings at once */
const LATEST_MS = 250;    /* behind the newest frame at most */
const CATCH_UP_MS = 400;  /* in which a difference to where the clock should be is made up for */
const FASTEST = 1.5, SLOWEST = 0.5;
const LEAP_MS = 1000;     /* a greater difference is not made up for but leapt over, forwards */
const MEMORY = 1 / 16;    /* what a new interval counts in the mean of the jitter */
const LONG_MEMORY = 1 / 64; /* and in that of the intervals: a stall and the burst behind it are to weigh each other out */
const NARROWING = 1 / 8;  /* of the space between frames, which widens at once: hair that wakes shows more of them than it did at rest */

export class Between {
  constructor() {
    this.reset();
  }

  reset() {
    Object.assign(this, { frames: [], shown_us: null, asked_ms: null });
    this.forget();
  }

  /** Time goes on otherwise from here, faster or slower or after a pause: how frames come is to be learnt anew. */
  forget() {
    Object.assign(this, { interval_ms: 0, interval_us: 0, jitter_ms: 0, space_ms: 0, learnt: 0, begun: false });
  }

  /** `frame`: anything; `time_us`: the simulated time that it shows; `now_ms`: when it came. */
  add(frame, time_us, now_ms) {
    const last = this.frames.at(-1);
    if (last && time_us < last.time_us) {
      this.reset(); /* time begins anew */
    } else if (last && time_us === last.time_us) {
      last.frame = frame;
      return;
    } else if (last && this.begun) {
      this.learn(Math.min(now_ms - last.came_ms, LATEST_MS), time_us - last.time_us);
    }
    this.begun = true;
    this.frames.push({ frame, time_us, came_ms: now_ms });
    this.frames.splice(0, this.frames.length - KEPT);
    this.shown_us ??= time_us;
  }

  learn(gap_ms, gap_us) {
    const share = Math.max(1 / ++this.learnt, LONG_MEMORY);
    this.interval_ms += share * (gap_ms - this.interval_ms);
    this.interval_us += share * (gap_us - this.interval_us);
    const even_ms = gap_us / this.rate; /* in which it would have come if all took the same way */
    this.jitter_ms += MEMORY * (Math.abs(gap_ms - even_ms) - this.jitter_ms);
    this.space_ms = Math.max(even_ms, this.space_ms + NARROWING * (even_ms - this.space_ms));
  }

  /** Simulated microseconds in a millisecond here. */
  get rate() {
    return this.interval_ms > 0 ? this.interval_us / this.interval_ms : 1000;
  }

  /** How far behind the newest frame is shown. */
  get delay_ms() {
    return Math.min(this.space_ms + 3 * this.jitter_ms, LATEST_MS);
  }

  advance(now_ms) {
    const { rate } = this, newest = this.frames.at(-1);
    const passed_ms = Math.min(Math.max(now_ms - (this.asked_ms ?? now_ms), 0), LATEST_MS);
    const wanted_us = newest.time_us + rate * (now_ms - newest.came_ms - this.delay_ms);
    const ahead_ms = (wanted_us - this.shown_us) / rate - passed_ms; /* of where the clock will be by itself */
    this.asked_ms = now_ms;
    if (ahead_ms > LEAP_MS) {
      this.shown_us = wanted_us;
    } else {
      this.shown_us += rate * passed_ms * Math.min(Math.max(1 + ahead_ms / CATCH_UP_MS, SLOWEST), FASTEST);
    }
    this.shown_us = Math.min(this.shown_us, newest.time_us);
  }

  /** The frames around the time that is shown now, and the second one's weight; null: there is no frame. */
  at(now_ms) {
    if (this.frames.length === 0) {
      return null;
    }
    this.advance(now_ms);
    const next = this.frames.findIndex(({ time_us }) => time_us >= this.shown_us);
    const [from, to] = [this.frames[Math.max(next - 1, 0)], this.frames[next]];
    this.frames.splice(0, next - 1); /* of before: never seen again */
    const span_us = to.time_us - from.time_us;
    return { from: from.frame, to: to.frame, weight: span_us > 0 ? Math.max(0, (this.shown_us - from.time_us) / span_us) : 1 };
  }

  /** Whether what is shown would change with time alone. */
  get moves() {
    return this.frames.length > 1 && this.shown_us < this.frames.at(-1).time_us;
  }

  /** The newest frame alone, and from here on. */
  newest(now_ms) {
    const last = this.frames.at(-1);
    if (!last) {
      return null;
    }
    Object.assign(this, { shown_us: last.time_us, asked_ms: now_ms });
    return { from: last.frame, to: last.frame, weight: 1 };
  }
}
