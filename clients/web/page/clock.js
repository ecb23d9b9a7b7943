// clock.js: the control for how time goes. It shows the clock as it is, not as it is wished: what is refused falls back to that. One
// wish is under way at a time, and of those that come meanwhile the newest counts.

const RATE = { least: 0.1, greatest: 2 }; /* by powers of ten, as places 0 to 1000 */
const toPlace = (rate) => 1000 * Math.log(rate / RATE.least) / Math.log(RATE.greatest / RATE.least);
const toRate = (place) => Number((RATE.least * (RATE.greatest / RATE.least) ** (place / 1000)).toPrecision(2));
const TEXTS = { lockstep: '', free: 'free-running', paused: 'paused' };

/** The clock in a few words, for those who look on; empty: a page moves the hair, as usual. */
export function clockText(clock) {
  const text = TEXTS[clock?.mode] ?? '';
  return clock?.mode === 'free' && clock.rate !== 1 ? `${text}, ${clock.rate} times as fast` : text;
}

export class ClockControl {
  /** `failed` is told what was refused, for people. */
  constructor(hair, failed) {
    const find = (id) => document.getElementById(id);
    Object.assign(this, { hair, failed, mode: find('clock'), rate: find('rate'), row: find('rate-row'), output: find('rate-shown'), asking: false, wish: null });
    this.mode.addEventListener('change', () => this.ask({ mode: this.mode.value }));
    this.rate.addEventListener('input', () => this.ask({ rate: toRate(Number(this.rate.value)) }));
    hair.addEventListener('clock', () => this.show());
    this.show();
  }

  show() {
    if (this.asking) {
      return; /* what is wished is being asked for */
    }
    const { mode = '', rate = 1 } = this.hair.clock ?? {};
    this.mode.value = mode;
    this.rate.value = toPlace(rate);
    this.output.textContent = `${rate.toFixed(2)} ×`;
    this.row.hidden = mode !== 'free';
  }

  /** { mode, rate }: what is not given stays. */
  async ask(change) {
    const { mode = 'lockstep', rate = 1 } = this.wish ?? this.hair.clock ?? {};
    this.wish = { mode, rate, ...change };
    this.output.textContent = `${this.wish.rate.toFixed(2)} ×`;
    if (this.asking) {
      return;
    }
    this.asking = true;
    try {
      while (this.wish) {
        const { wish } = this;
        this.wish = null;
        await this.hair.setClock(wish);
      }
    } catch (error) {
      this.wish = null;
      this.failed(error.message);
    } finally {
      this.asking = false;
      this.show();
    }
  }
}
