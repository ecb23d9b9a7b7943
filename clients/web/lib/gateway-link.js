// gateway-link.js: the way to the gateway, that comes back by itself; how things stand, as events; and what pages of one gateway
// tell each other through it: which forest is shown, how its time goes, who drives, where the body is.
import { Connection, LENIENT } from './connection.js';

const RETRY_MS = [300, 600, 1200, 2500, 5000];
const shortOf = (clock) => clock && { mode: clock.mode, rate: clock.rate };

/** What is built on it has: opened() (the connection stands), leave() (it is lost), heardShown(). */
export class GatewayLink extends EventTarget {
  constructor(url, token) {
    super();
    Object.assign(this, { url, token, state: null, reason: '', scope: null, viewToken: null, shown: null, attempts: 0, wasLive: false });
  }

  say(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  enter(state, reason = '', share = null) {
    this.wasLive ||= state === 'live';
    Object.assign(this, { state, reason });
    this.say('state', { state, reason, share });
  }

  connect() {
    this.enter(this.attempts === 0 ? 'connecting' : 'lost', this.reason);
    this.connection = new Connection(this.url, this.token, {
      open: (welcome) => {
        this.server = welcome.server;
        this.enter('empty');
        this.say('open', welcome);
        this.opened();
      },
      text: (text) => this.hearText(text), closed: (how) => this.closed(how),
      stray: (error, request) => (request === LENIENT && error.code === 'BAD_TIME') || this.say('refused', error),
    });
  }

  closed({ reason, wasOpen }) {
    this.leave();
    this.attempts = wasOpen && this.wasLive ? 1 : this.attempts + 1;
    this.wasLive = false;
    this.enter('lost', reason || (wasOpen ? 'the connection is lost' : 'the gateway does not answer, or the address has the wrong token'));
    this.retry = setTimeout(() => this.connect(), RETRY_MS[Math.min(this.attempts, RETRY_MS.length) - 1]);
  }

  hearText(text) {
    if ('shown' in text) {
      const { shown, scope, viewToken = null } = text;
      Object.assign(this, { shown, scope, viewToken });
      this.heardShown();
      this.say('shown', shown);
    } else if ('body' in text) {
      this.say('body', text.body);
    }
  }

  sayShown({ handle, driveToken: drive, viewToken: view }, about, clock) {
    this.connection.say({ show: { forest: String(handle), drive, view, about, clock: shortOf(clock) } });
  }

  sayClock({ handle }, clock) {
    this.connection.say({ clock: { forest: String(handle), ...shortOf(clock) } });
  }

  sayWheel() {
    this.connection.say({ wheel: true });
  }

  /** Where the body is that the forest's obstacles belong to, for those who look on. */
  sayBody({ position, orientation }) {
    this.connection.say({ body: [...position, ...orientation].map((number) => Math.round(number * 1e5) / 1e5) });
  }

  endLink() {
    clearTimeout(this.retry);
    this.connection.close();
  }
}
