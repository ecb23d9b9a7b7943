// shown.mjs: the one forest that the viewers of a gateway look at. A page that drives says which (as text, beside the binary
// messages of the protocol); all others are told, with the token that their scope may have, and again when it changes.
//
// In: {"show": {"forest", "drive", "view", "about", "clock"}}, {"wheel": true} from who drives that forest from now on,
// {"clock": {"forest", "mode", "rate"}} when its time goes otherwise (the daemon does not tell that), {"body": [7 numbers]}.
// Out: {"shown": {"forest", "token", "driven", "about", "clock"} or null, "scope": "drive" or "view", "viewToken" for who drives},
// {"body": [7 numbers]}.
import { MODES } from '../lib/forest-clock.js';

const TEXT_MAX = 8192;
const isToken = (token) => typeof token === 'string' && /^[0-9a-f]{32}$/.test(token);
const isForest = (forest) => typeof forest === 'string' && /^[0-9]{1,20}$/.test(forest);
const isClock = (clock) => MODES.includes(clock?.mode) && Number.isFinite(clock.rate);
const isPose = (pose) => Array.isArray(pose) && pose.length === 7 && pose.every(Number.isFinite);

export class Shown {
  /** `viewToken`: the gateway's, for links that a driving page gives away. */
  constructor(viewToken) {
    this.viewToken = viewToken;
    this.bridges = new Set();
    this.now = null;
    this.driver = null;
  }

  add(bridge) {
    this.bridges.add(bridge);
    bridge.onText = (text) => this.hear(bridge, text);
    bridge.opened.then(() => {
      this.tell(bridge);
      bridge.socket && this.now?.body && bridge.sendOwn(JSON.stringify({ body: this.now.body }), false); /* it may not move any more */
    });
    bridge.browser.on('close', () => this.remove(bridge));
  }

  remove(bridge) {
    this.bridges.delete(bridge);
    if (this.driver === bridge) {
      this.driver = null;
      this.tellOthers(bridge);
    }
  }

  hear(bridge, text) {
    let said = null;
    try {
      said = text.length <= TEXT_MAX ? JSON.parse(text) : null;
    } catch {
      /* not ours: below */
    }
    if (bridge.scope === 'drive' && isForest(said?.show?.forest) && isToken(said.show.drive) && isToken(said.show.view)) {
      const { forest, drive, view, about = null, clock } = said.show;
      this.now = { forest, drive, view, about, clock: isClock(clock) ? { mode: clock.mode, rate: clock.rate } : null };
      this.driver = bridge;
      this.tellOthers(bridge);
    } else if (bridge.scope === 'drive' && this.now && said?.wheel === true) {
      this.driver = bridge;
      this.tellOthers(bridge);
    } else if (bridge === this.driver && isClock(said?.clock) && said.clock.forest === this.now?.forest) {
      this.now.clock = { mode: said.clock.mode, rate: said.clock.rate };
      this.tellOthers(bridge);
    } else if (bridge === this.driver && isPose(said?.body)) {
      this.now.body = said.body;
      this.others(bridge).filter((other) => other.browser.bufferedAmount === 0).forEach((other) => other.sendOwn(JSON.stringify({ body: said.body }), false));
    } else if (bridge.scope !== 'drive' || !(isPose(said?.body) || isClock(said?.clock))) { /* who has just lost the wheel may still send these */
      bridge.end(1008, 'that message is not for this page to send');
    }
  }

  others(bridge) {
    return [...this.bridges].filter((other) => other !== bridge);
  }

  tellOthers(bridge) {
    this.others(bridge).forEach((other) => this.tell(other));
  }

  tell(bridge) {
    const { now } = this;
    const shown = now && { forest: now.forest, token: now[bridge.scope], driven: this.driver !== null, about: now.about, clock: now.clock };
    if (bridge.socket) {
      const more = bridge.scope === 'drive' ? { viewToken: this.viewToken } : {};
      bridge.sendOwn(JSON.stringify({ shown, scope: bridge.scope, ...more }), false);
    }
  }
}
