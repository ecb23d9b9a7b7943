// access.mjs: who may come in, and what for: origins, the gateway's own tokens, and what each scope may send.
import { randomBytes, timingSafeEqual } from 'node:crypto';

const TOKEN_PROTOCOL = 'awt.token.';
export const SUBPROTOCOL = 'awt.1';

/* A browser that may only look sends nothing else, whatever tokens of forests it has. The gateway itself greets the daemon. */
const VIEW_TYPES = new Set(['ping', 'pong', 'bye', 'list_styles', 'attach', 'detach', 'list', 'query', 'subscribe', 'unsubscribe',
  'credit', 'binding', 'stats']);
const GATEWAY_TYPES = new Set(['hello', 'auth', 'resume']);

const same = (a, b) => a.length === b.length && timingSafeEqual(Buffer.from(a), Buffer.from(b));

export class Access {
  constructor() {
    this.origins = new Set();
    this.tokens = { drive: randomBytes(16).toString('hex'), view: randomBytes(16).toString('hex') };
  }

  allowsHost(host) {
    return [...this.origins].some((origin) => new URL(origin).host === host);
  }

  /** 'drive', 'view', or null with the status to refuse with. A browser brings its token as a WebSocket subprotocol, for
   * addresses end up in logs. */
  admit(request) {
    if (!this.origins.has(request.headers.origin)) {
      return { scope: null, status: 403 };
    }
    const offered = (request.headers['sec-websocket-protocol'] ?? '').split(',').map((name) => name.trim());
    const token = offered.find((name) => name.startsWith(TOKEN_PROTOCOL))?.slice(TOKEN_PROTOCOL.length) ?? '';
    const scope = same(token, this.tokens.drive) ? 'drive' : same(token, this.tokens.view) ? 'view' : null;
    return { scope, status: scope && offered.includes(SUBPROTOCOL) ? 101 : 401 };
  }
}

/** May a browser of that scope send this message? `name` null: of a type that this version does not know. */
export function maySend(scope, name, decode) {
  if (name === null || GATEWAY_TYPES.has(name)) {
    return false;
  }
  if (scope === 'drive') {
    return true;
  }
  return VIEW_TYPES.has(name) && (name !== 'query' || decode().values.latest === 1);
}
