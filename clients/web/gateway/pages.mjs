// pages.mjs: the files of the page, read once, each with strict headers. Nothing else of the disk is served.
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = join(dirname(fileURLToPath(import.meta.url)), '..');
const three = join(here, 'node_modules/three');
const TYPES = {
  '.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
  '.mjs': 'text/javascript; charset=utf-8', '.wasm': 'application/wasm', '.svg': 'image/svg+xml',
};
const HEADERS = {
  'Content-Security-Policy': "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; " +
    "connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
  'X-Content-Type-Options': 'nosniff', 'Referrer-Policy': 'no-referrer', 'Cross-Origin-Opener-Policy': 'same-origin',
  'Cross-Origin-Resource-Policy': 'same-origin', 'Cache-Control': 'no-cache',
};

/* Modules of scenes name three.js as their bundler knows it. A browser wants an address, or a map written into the page,
 * which the headers forbid. */
const NAMES = { 'three': '/three/three.module.min.js', 'three/addons/controls/OrbitControls.js': '/three/OrbitControls.js' };
const withAddresses = (code) => code.replace(/(from\s*')(three(?:\/[^']*)?)(')/g, (all, before, name, after) => before + (NAMES[name] ?? name) + after);

function folder(path, prefix) {
  return readdirSync(path).filter((name) => extname(name) in TYPES).map((name) => [prefix + name, join(path, name)]);
}

/** address -> { type, body }. `build`: where make puts messages.mjs and the WebAssembly. */
export function loadPages(build) {
  const files = [
    ...folder(join(here, 'page'), '/'), ...folder(join(here, 'lib'), '/awt/'),
    ['/three/three.module.min.js', join(three, 'build/three.module.min.js')],
    ['/three/OrbitControls.js', join(three, 'examples/jsm/controls/OrbitControls.js')],
    ...['messages.mjs', 'receiver.wasm', 'motion.wasm'].map((name) => [`/awt/${name}`, join(build, name)]),
  ];
  const pages = new Map(files.map(([address, path]) => {
    const type = TYPES[extname(path)], bytes = readFileSync(path);
    return [address, { type, body: type.startsWith('text/javascript') ? Buffer.from(withAddresses(bytes.toString())) : bytes }];
  }));
  pages.set('/', pages.get('/index.html'));
  return pages;
}

function answer(response, status, type, body, withBody) {
  response.writeHead(status, { ...HEADERS, 'Content-Type': type, 'Content-Length': body.length });
  response.end(withBody ? body : undefined);
}

/** Answers a request for a page, or for how the gateway is. */
export function servePage(pages, access, health, request, response) {
  const path = request.url.split('?', 1)[0], page = pages.get(path), reads = request.method === 'GET';
  if (!reads && request.method !== 'HEAD') {
    answer(response, 405, 'text/plain', Buffer.from('only to be read\n'), true);
  } else if (path === '/healthz') {
    answer(response, 200, 'application/json', Buffer.from(`${JSON.stringify(health())}\n`), reads);
  } else if (!access.allowsHost(request.headers.host)) {
    answer(response, 421, 'text/plain', Buffer.from('this gateway does not go by that name (--origin)\n'), reads);
  } else if (!page) {
    answer(response, 404, 'text/plain', Buffer.from('no such page\n'), reads);
  } else {
    answer(response, 200, page.type, page.body, reads);
  }
}
