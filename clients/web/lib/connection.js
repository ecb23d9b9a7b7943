// connection.js: one WebSocket to the gateway: requests with a promise each, streams by their request id, texts, clocks. It ends
// once; who wants another makes another.
import { makeCodec } from './codec.js';
import * as lists from './messages.mjs';
import { PeerClock } from './peer-clock.js';

const codec = makeCodec(lists), NUMBER_OF_ERROR = lists.ERRORS;
const ANSWER_MS = 60000, PING_MS = 2000;
/** This page's monotonic clock, BigInt microseconds. */
export const now_us = () => BigInt(Math.round(performance.now() * 1000));
/** Request id of what has no reply and may be refused without harm: `stray` is told it with the error. */
export const LENIENT = 1n << 63n;

/** An ERROR of the daemon; `code` is a name of errors.def. */
export class AwtError extends Error {
  constructor({ code, text, retry, retry_after_ms: retryAfter }) {
    super(text);
    this.code = Object.keys(NUMBER_OF_ERROR).find((name) => NUMBER_OF_ERROR[name] === code) ?? String(code);
    this.retry = retry === 1;
    this.retryAfterMs = retryAfter;
  }
}

export class Connection {
  /** `heard`: { open(welcome), text(value), stray(error, request), closed({ reason, wasOpen }) }. */
  constructor(url, token, heard) {
    this.heard = heard;
    this.waiting = new Map(); /* request -> { resolve, reject, timer, progress } */
    this.streams = new Map(); /* request -> { frame, ended } */
    this.last = 0n;
    this.isIn = false;
    this.peer = new PeerClock(); /* the daemon's clock */
    this.broken = null;
    this.socket = new WebSocket(url, ['awt.1', `awt.token.${token}`]);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = ({ data }) => this.hear(data);
    this.socket.onclose = ({ reason }) => this.end(reason);
    this.pings = setInterval(() => this.isIn && this.ping(), PING_MS);
  }

  hear(data) {
    try {
      if (typeof data === 'string') {
        this.heard.text(JSON.parse(data));
      } else {
        this.take(codec.decode(new Uint8Array(data)));
      }
    } catch (error) {
      this.fail(`the server does not make sense: ${error.message}`);
    }
  }

  take({ name, request, values }) {
    if (!this.isIn) {
      if (name !== 'welcome' || values.version !== 1) {
        throw new Error('it does not say WELCOME');
      }
      this.isIn = true;
      this.ping();
      this.heard.open(values);
    } else if (name === 'ping') {
      this.send('pong', { sent_us: values.sent_us, received_us: now_us(), answered_us: now_us() }, request);
    } else if (name === 'pong') {
      this.peer.add(values.sent_us, values.received_us, values.answered_us, now_us());
    } else if (name === 'bye') {
      this.fail(`the server says: ${values.reason || 'goodbye'}`);
    } else if (this.streams.has(request)) {
      this.takeOfStream(this.streams.get(request), name, request, values);
    } else if (this.waiting.has(request)) {
      this.answer(this.waiting.get(request), name, request, values);
    } else if (name === 'error') {
      this.heard.stray(new AwtError(values), request);
    }
  }

  takeOfStream(stream, name, request, values) {
    if (name === 'frame') {
      stream.frame(values);
    } else if (name === 'error') {
      this.streams.delete(request);
      stream.ended(new AwtError(values));
      this.waiting.has(request) && this.answer(this.waiting.get(request), name, request, values);
    } else {
      this.waiting.has(request) && this.answer(this.waiting.get(request), name, request, values);
    }
  }

  answer({ resolve, reject, timer, progress }, name, request, values) {
    if (name === 'progress') {
      progress?.(values);
      return;
    }
    clearTimeout(timer);
    this.waiting.delete(request);
    name === 'error' ? reject(new AwtError(values)) : resolve(values);
  }

  send(name, values, request = 0n) {
    this.socket.send(codec.encode(name, values, { request, required: request !== 0n }));
  }

  /** The answer's fields. Rejects with AwtError, or Error where nothing came. */
  ask(name, values = {}, { progress, stream } = {}) {
    return new Promise((resolve, reject) => {
      if (this.socket.readyState !== WebSocket.OPEN) {
        reject(new Error('there is no connection'));
        return;
      }
      const request = ++this.last;
      const timer = setTimeout(() => this.fail('the server does not answer'), ANSWER_MS);
      this.waiting.set(request, { resolve, reject, timer, progress });
      stream && this.streams.set(request, stream);
      this.send(name, values, request);
    });
  }

  /** `stream`: { frame(values), ended(error) }. Resolves to what ends it. */
  async subscribe(values, stream) {
    const { subscription } = await this.ask('subscribe', values, { stream });
    const [request] = [...this.streams].find(([, other]) => other === stream) ?? [];
    const stands = () => this.isIn && this.streams.has(request);
    return {
      credit: (have) => stands() && this.send('credit', { subscription, frames: 1, have }),
      end: () => {
        if (stands()) {
          this.streams.delete(request);
          this.send('unsubscribe', { subscription });
        }
      },
    };
  }

  ping() {
    this.send('ping', { sent_us: now_us() }, ++this.last);
  }

  say(text) {
    this.isIn && this.socket.send(JSON.stringify(text));
  }

  fail(reason) {
    this.broken ??= reason;
    this.socket.close();
    this.end(reason); /* the other side may be slow to agree */
  }

  end(reason) {
    if (this.ended) {
      return;
    }
    this.ended = true;
    clearInterval(this.pings);
    const why = this.broken ?? reason, wasOpen = this.isIn;
    this.isIn = false;
    this.waiting.forEach(({ reject, timer }) => {
      clearTimeout(timer);
      reject(new Error(why || 'the connection is lost'));
    });
    this.waiting.clear();
    this.streams.clear();
    this.heard.closed({ reason: why, wasOpen });
  }

  close() {
    this.heard = { open() {}, text() {}, stray() {}, closed() {} };
    this.socket.close();
    this.end('closed');
  }
}
