// bridge.mjs: one browser and its connection to awtd. A WebSocket message is a message of the protocol; what comes from awtd
// goes on in pieces as it comes, so that nothing is gathered here; who is slow makes the other side wait.
import { GREATEST_REPLY, GREATEST_REQUEST, HEADER_SIZE } from '../lib/codec.js';
import { maySend } from './access.mjs';
import { openDaemon } from './daemon.mjs';

const HIGH_WATER = 1 << 20, LOW_WATER = 1 << 18; /* bytes that wait for the browser */
const OWN_MAX = 64;                              /* messages of the gateway's own that wait for the end of one of awtd's */
const REASON_MAX = 120;                          /* bytes of a WebSocket's closing reason: 123 at most */
const TRY_AGAIN = 1013, REFUSED = 1008, PROTOCOL_ERROR = 1002;

export class Bridge {
  constructor(browser, scope, { codec, errors, daemon }) {
    Object.assign(this, { browser, scope, codec, errors, socket: null, onText: () => {} });
    this.header = Buffer.alloc(0); /* of awtd's message that begins */
    this.left = 0;                 /* bytes of it still to come */
    this.own = [];
    browser.pause(); /* nothing is read before there is somebody to send it to */
    browser.on('message', (data, isBinary) => (isBinary ? this.fromBrowser(data) : this.onText(data)));
    browser.on('close', () => this.socket?.end(codec.encode('bye', { reason: 'the browser is gone' }, { required: false })));
    browser.on('error', () => this.socket?.destroy());
    this.opened = this.open(daemon);
  }

  async open(daemon) {
    try {
      const { socket, welcome } = await openDaemon(daemon);
      if (this.browser.readyState !== this.browser.OPEN) {
        socket.destroy();
        return;
      }
      this.socket = socket;
      this.sendOwn(this.codec.encode('welcome', { ...welcome, auth_required: 0, nonce: undefined, session: undefined }), true);
      socket.on('data', (bytes) => this.fromDaemon(bytes));
      socket.on('drain', () => this.browser.resume());
      socket.on('close', () => this.end(TRY_AGAIN, 'awtd ended the connection'));
      socket.resume();
      this.browser.resume();
    } catch (error) {
      this.end(TRY_AGAIN, error.message);
    }
  }

  end(code, reason) {
    this.socket?.destroy();
    this.browser.resume(); /* or the answer to the close would not be read */
    this.browser.close(code, Buffer.from(reason).subarray(0, REASON_MAX).toString());
  }

  fromBrowser(message) {
    if (!this.socket || message.length < HEADER_SIZE || message.readUInt32LE(0) !== message.length - HEADER_SIZE ||
        message.length > HEADER_SIZE + GREATEST_REQUEST) {
      this.end(PROTOCOL_ERROR, 'that is no message of the protocol');
      return;
    }
    const type = message.readUInt16LE(4), name = this.codec.nameOf(type);
    let allowed;
    try {
      allowed = maySend(this.scope, name, () => this.codec.decode(message));
    } catch (error) {
      this.end(PROTOCOL_ERROR, error.message);
      return;
    }
    if (!allowed) {
      const values = { code: this.errors.NOT_ALLOWED, about: type, text: 'this token may only look on' };
      this.sendOwn(this.codec.encode('error', values, { request: message.readBigUInt64LE(8) }), true);
    } else if (!this.socket.write(message)) {
      this.browser.pause();
    }
  }

  /** A message of the gateway's own; they may not come between the pieces of another. */
  sendOwn(message, binary) {
    if (this.own.length >= OWN_MAX) {
      this.end(REFUSED, 'the browser takes nothing');
      return;
    }
    this.own.push({ message, binary });
    this.flushOwn();
  }

  flushOwn() {
    while (this.left === 0 && this.own.length > 0 && this.browser.bufferedAmount < HIGH_WATER) {
      const { message, binary } = this.own.shift();
      this.send(message, { binary, fin: true });
    }
  }

  send(bytes, options) {
    this.browser.send(bytes, options, () => {
      if (this.browser.bufferedAmount < LOW_WATER) {
        this.socket?.resume();
        this.flushOwn();
      }
    });
    if (this.browser.bufferedAmount > HIGH_WATER) {
      this.socket?.pause();
    }
  }

  fromDaemon(bytes) {
    while (bytes.length > 0) {
      if (this.left === 0) {
        const missing = HEADER_SIZE - this.header.length;
        this.header = Buffer.concat([this.header, bytes.subarray(0, missing)]);
        bytes = bytes.subarray(missing);
        if (this.header.length < HEADER_SIZE) {
          return;
        }
        this.left = this.header.readUInt32LE(0);
        if (this.left > GREATEST_REPLY) {
          this.end(PROTOCOL_ERROR, 'what answers there is not awtd');
          return;
        }
        this.send(this.header, { binary: true, fin: this.left === 0 });
        this.header = Buffer.alloc(0);
      } else {
        const piece = bytes.subarray(0, this.left);
        this.left -= piece.length;
        bytes = bytes.subarray(piece.length);
        this.send(piece, { binary: true, fin: this.left === 0 });
      }
      this.flushOwn();
    }
  }
}
