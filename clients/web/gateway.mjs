// gateway.mjs: between browsers and awtd. A browser has one WebSocket here and one TCP connection of its own behind it; see
// gateway/bridge.mjs for the way of the bytes, access.mjs for who may come in, shown.mjs for what viewers look at.
import { createServer } from 'node:http';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { WebSocketServer } from 'ws';
import { Access, SUBPROTOCOL } from './gateway/access.mjs';
import { Bridge } from './gateway/bridge.mjs';
import { readOptions } from './gateway/options.mjs';
import { loadPages, servePage } from './gateway/pages.mjs';
import { Shown } from './gateway/shown.mjs';
import { GREATEST_REQUEST, HEADER_SIZE, makeCodec } from './lib/codec.js';

const REQUEST_TIMEOUT_MS = 10000, HEARTBEAT_MS = 15000;

const options = readOptions();
const lists = await import(pathToFileURL(resolve(options.build, 'messages.mjs')));
const pages = loadPages(options.build), codec = makeCodec(lists), access = new Access(), shown = new Shown(access.tokens.view);
const daemon = { ...options.connect, readToken: options.readToken, codec };
const sockets = new WebSocketServer({ noServer: true, maxPayload: HEADER_SIZE + GREATEST_REQUEST, perMessageDeflate: false,
  handleProtocols: () => SUBPROTOCOL });

const server = createServer({ headersTimeout: REQUEST_TIMEOUT_MS, requestTimeout: REQUEST_TIMEOUT_MS, maxHeaderSize: 8192 },
  (request, response) => servePage(pages, access, () => ({ ok: true, browsers: sockets.clients.size }), request, response));

function refuse(socket, status, reason) {
  socket.end(`HTTP/1.1 ${status} ${reason}\r\nConnection: close\r\nContent-Length: 0\r\n\r\n`);
}

/* Who does not answer for two heartbeats is gone. */
function watch(browser) {
  let alive = true;
  browser.on('pong', () => { alive = true; });
  const timer = setInterval(() => {
    if (!alive) {
      browser.terminate();
    }
    alive = false;
    browser.ping();
  }, HEARTBEAT_MS);
  browser.on('close', () => clearInterval(timer));
}

server.on('upgrade', (request, socket, head) => {
  socket.on('error', () => socket.destroy());
  const { scope, status } = access.admit(request);
  if (request.url !== '/awt' || !scope || status !== 101) {
    refuse(socket, request.url !== '/awt' ? 404 : status, 'Refused');
  } else if (sockets.clients.size >= options.greatest) {
    refuse(socket, 503, 'Too many browsers');
  } else {
    sockets.handleUpgrade(request, socket, head, (browser) => {
      watch(browser);
      shown.add(new Bridge(browser, scope, { codec, errors: lists.ERRORS, daemon }));
    });
  }
});

server.on('error', (error) => {
  console.error(`gateway: cannot listen: ${error.message}`);
  process.exit(1);
});

server.listen(options.listen, () => {
  const { host } = options.listen, { port } = server.address(), own = `http://${host.includes(':') ? `[${host}]` : host}:${port}`;
  access.origins = new Set([own, `http://localhost:${port}`, ...options.origins]);
  const page = options.origins[0] ?? own;
  console.log(`listening on ${host}:${port}\ndrive: ${page}/#token=${access.tokens.drive}\nview: ${page}/#token=${access.tokens.view}`);
});

for (const signal of ['SIGINT', 'SIGTERM']) {
  process.on(signal, () => {
    sockets.clients.forEach((browser) => browser.close(1001, 'the gateway stops'));
    server.close(() => process.exit(0));
    server.closeAllConnections();
    setTimeout(() => process.exit(0), 500);
  });
}
