// driving.js: one forest that is driven: how its time goes, and poses for it, in lock-step or by the daemon's clock.
import { AwtError, LENIENT, now_us } from './connection.js';
import { clockWish, newClock, simulatedAt } from './forest-clock.js';

const OWN_STEPS_MS = 1000;    /* a page that moves the hair itself sees it as soon as it comes */
const LENIENCE_US = 300000n;  /* the daemon may have taken poses of before so much later than they were given for, and errors of clocks */
const QUICKEST = { kind: 3, level: 0 }; /* a step's answer is waited for, not looked at: nodes are the shortest */

export class Driving {
  /** `forest`: AwtHair's. `refused(error)`: of what nobody waits for. */
  constructor(connection, forest, refused) {
    Object.assign(this, { connection, forest, refused, clock: null, time_us: forest.time_us, stepping: false, setting: 0 });
    this.sequence = 0;
    this.stepped_ms = -Infinity;
    this.posed_us = this.lenient_us = null; /* of the last pose by move; until then poses may come too early */
  }

  /** It was made just now. */
  begin() {
    this.clock = newClock(this.time_us);
  }

  /** The clock as it is then. While this is under way nothing moves the forest. */
  async setClock({ mode, rate = this.clock?.rate ?? 1, importance }) {
    this.setting++;
    try {
      const { time_us, clock_us } = await this.connection.ask('set_clock', clockWish(this.forest.handle, { mode, rate, importance }));
      this.time_us = time_us;
      this.posed_us = null;
      this.lenient_us = time_us + LENIENCE_US;
      this.clock = { mode, rate, time_us, clock_us };
      return this.clock;
    } finally {
      this.setting--;
    }
  }

  /** Simulated time now, BigInt microseconds; null: not known. */
  get now_us() {
    const { offset_us } = this.connection.peer;
    return this.clock?.mode === 'lockstep' ? this.time_us : this.clock && simulatedAt(this.clock, offset_us === null ? null : now_us() + offset_us);
  }

  pose(time_us, head, body, teleport) {
    this.epoch ??= Math.floor(Date.now() / 1000) >>> 0; /* later than that of whoever drove before */
    const values = { forest: this.forest.handle, epoch: this.epoch, sequence: ++this.sequence, teleport: teleport ? 1 : 0, time_us, head, body };
    this.connection.send('motion', values, this.lenient_us !== null && time_us < this.lenient_us ? LENIENT : 0n);
  }

  /** See AwtHair.step. */
  async step(time_us, head, body, teleport) {
    const time = BigInt(Math.round(Number(time_us)));
    if (!this.forest.mayDrive || this.stepping || this.setting || (this.clock && this.clock.mode !== 'lockstep') || time <= this.time_us) {
      return false;
    }
    this.stepping = true;
    this.stepped_ms = performance.now();
    try {
      this.pose(time, head, body, teleport);
      this.time_us = time;
      await this.connection.ask('query', { forest: this.forest.handle, time_us: time, ...QUICKEST });
      return true;
    } catch (error) {
      if (error.code === 'BAD_TIME') {
        this.clock = null; /* somebody else has set it */
      }
      error instanceof AwtError && this.refused(error);
      return false;
    } finally {
      this.stepping = false;
    }
  }

  /** See AwtHair.move. */
  move(head, body, teleport) {
    const now = this.forest.mayDrive && !this.setting && this.clock?.mode === 'free' ? this.now_us : null;
    if (now === null) {
      return null;
    }
    this.posed_us = this.posed_us === null || now > this.posed_us ? now : this.posed_us + 1n;
    this.pose(this.posed_us, head, body, teleport);
    return this.posed_us;
  }

  /** Whether frames are answers to this page's own steps. */
  stepsNow(now_ms) {
    return now_ms - this.stepped_ms < OWN_STEPS_MS && (!this.clock || this.clock.mode === 'lockstep');
  }
}
