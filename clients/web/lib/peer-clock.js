// peer-clock.js: the daemon's clock as PING and PONG tell it, by the exchange that was least delayed of the latest. Numbers only.

const KEPT = 16;

export class PeerClock {
  constructor() {
    this.exchanges = [];
  }

  /** PONG's three times and when it arrived, BigInt microseconds; `sent` and `arrived` by one clock. What cannot be is not taken. */
  add(sent, received, answered, arrived) {
    const round = Number((arrived - sent) - (answered - received));
    if (round >= 0 && answered >= received && arrived >= sent) {
      this.exchanges.push({ round, offset: ((received - sent) + (answered - arrived)) / 2n });
      this.exchanges.splice(0, this.exchanges.length - KEPT);
    }
  }

  get best() {
    return this.exchanges.reduce((best, exchange) => (best && best.round <= exchange.round ? best : exchange), null);
  }

  /** The other clock minus ours, BigInt microseconds; null: nothing has come yet. */
  get offset_us() {
    return this.best?.offset ?? null;
  }

  /** Half of the least way there and back; null: nothing has come yet. */
  get way_us() {
    return this.best ? this.best.round / 2 : null;
  }
}
