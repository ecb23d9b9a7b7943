// forest-clock.js: how a forest's simulated time goes (SET_CLOCK in proto/PROTOCOL.md): what is told of it, and what time it is.
//
// A clock is { mode, rate, time_us, clock_us }: it was simulated time `time_us` when the daemon's clock was `clock_us` (BigInt;
// null: how it goes is known, not since when). Clocks are never changed, only replaced.

/** In the order of their numbers on the wire. */
export const MODES = ['lockstep', 'free', 'paused'];

/** SET_CLOCK's fields. Throws where there is no such mode; whether the rate may be is for the daemon to say. */
export function clockWish(forest, { mode, rate, importance = 0 }) {
  if (!MODES.includes(mode)) {
    throw new Error(`mode is ${MODES.join(', ')}, not ${mode}`);
  }
  return { forest, mode: MODES.indexOf(mode), rate, importance };
}

/** The clock of a forest that was just made. */
export const newClock = (time_us) => ({ mode: 'lockstep', rate: 1, time_us, clock_us: null });

/** A clock that somebody else set, as the gateway tells of it; null: it tells nothing that makes sense. */
export function toldClock(told) {
  return MODES.includes(told?.mode) && Number.isFinite(told.rate) ? { mode: told.mode, rate: told.rate, time_us: null, clock_us: null } : null;
}

/** Simulated time when the daemon's clock is `daemon_us`; null: not known. */
export function simulatedAt({ mode, rate, time_us, clock_us }, daemon_us) {
  if (mode !== 'free' || time_us === null) {
    return time_us;
  }
  return daemon_us === null ? null : time_us + BigInt(Math.floor(Number(daemon_us - clock_us) * rate));
}
