// socket.mjs: a browser as the gateway sees it, without a browser: a WebSocket with origin and token, messages in and out.
import { createRequire } from 'node:module';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { makeCodec } from '../../clients/web/lib/codec.js';
import { build, top, until } from './harness.mjs';

const require = createRequire(join(top, 'clients/web/gateway.mjs'));
export const WebSocket = require('ws');
export const lists = await import(pathToFileURL(resolve(top, build, 'messages.mjs')));
export const codec = makeCodec(lists);

/** Resolves to the status with which the gateway answers the request to connect: 101 where it lets one in. */
export function statusOf(gateway, { token = gateway.tokens.drive, origin = gateway.origin, path = '/awt' } = {}) {
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(`ws://127.0.0.1:${gateway.port}${path}`, ['awt.1', `awt.token.${token}`], origin ? { origin } : {});
    socket.on('unexpected-response', (request, response) => {
      request.destroy();
      resolve(response.statusCode);
    });
    socket.on('open', () => {
      socket.terminate();
      resolve(101);
    });
    socket.on('error', reject);
  });
}

/** A connection: messages and texts as they came, the closing code, `ask` for a request and its answer. */
export class Client {
  constructor(gateway, scope) {
    this.messages = [];
    this.texts = [];
    this.closed = null;
    this.request = 0n;
    this.socket = new WebSocket(`ws://127.0.0.1:${gateway.port}/awt`, ['awt.1', `awt.token.${gateway.tokens[scope]}`], { origin: gateway.origin });
    this.socket.on('message', (data, isBinary) => (isBinary ? this.messages.push(codec.decode(data)) : this.texts.push(JSON.parse(data))));
    this.socket.on('close', (code, reason) => { this.closed = { code, reason: String(reason) }; });
    this.socket.on('error', () => {});
  }

  welcome() {
    return until(() => this.messages.find(({ name }) => name === 'welcome') ?? this.closed, 'WELCOME');
  }

  async ask(name, values) {
    const request = ++this.request;
    this.socket.send(codec.encode(name, values, { request }));
    return until(() => this.messages.find((message) => message.request === request && message.name !== 'progress') ?? this.closed, `an answer to ${name}`);
  }
}
