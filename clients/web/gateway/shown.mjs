// shown.mjs: the one forest that the viewers of a gateway look at. A page that drives says which (as text, beside the binary
// messages of the protocol); all others are told, with the token that their scope may have, and again when it changes.
//
// In: {"show": {"forest", "drive", "view", "about"}}, {"wheel": true} from who drives that forest from now on, {"body": [7 numbers]}.
// Out: {"shown": {"forest", "token", "driven", "about"} or null, "scope": "drive" or "view", "viewToken" for who drives},
// {"body": [7 numbers]}.

const TEXT_MAX = 8192;
const isToken = (token) => typeof token === 'string' && /^[0-9a-f]{32}$/.test(token);
const isForest = (forest) => typeof forest === 'string' && /^[0-9]{1,20}$/.test(forest);
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
    bridge.opened.then(() => this.tell(bridge));
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
      const { forest, drive, view, about = null } = said.show;
      this.now = { forest, drive, view, about };
      this.driver = bridge;
      this.tellOthers(bridge);
    } else if (bridge.scope === 'drive' && this.now && said?.wheel === true) {
      this.driver = bridge;
      this.tellOthers(bridge);
    } else if (bridge === this.driver && isPose(said?.body)) {
      this.others(bridge).filter((other) => other.browser.bufferedAmount === 0).forEach((other) => other.sendOwn(JSON.stringify({ body: said.body }), false));
    } else if (bridge.scope !== 'drive' || !isPose(said?.body)) { /* a page that has just lost the wheel may still send poses */
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
    const shown = now && { forest: now.forest, token: now[bridge.scope], driven: this.driver !== null, about: now.about };
    if (bridge.socket) {
      const more = bridge.scope === 'drive' ? { viewToken: this.viewToken } : {};
      bridge.sendOwn(JSON.stringify({ shown, scope: bridge.scope, ...more }), false);
    }
  }
}
