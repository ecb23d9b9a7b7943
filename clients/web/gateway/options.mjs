// options.mjs: the gateway's command line.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { parseArgs } from 'node:util';

const HELP = `usage: node gateway.mjs [options]
Stands between browsers and awtd: serves the viewer, and carries the protocol over WebSockets.

  --listen HOST:PORT     where to listen; port 0: any [127.0.0.1:8080]
  --connect HOST:PORT    where awtd listens [127.0.0.1:4680]
  --token-file FILE      awtd's token; else where awtd keeps it ($AWTD_STATE_DIR, $XDG_STATE_HOME/awtd, ~/.local/state/awtd)
  --origin ORIGIN        a page from there may connect, e.g. https://hair.example.org; may be given again [the gateway's own]
  --build DIR            where make put messages.mjs, receiver.wasm and motion.wasm [build/release]
  --max-browsers N       that may be connected [64]
  --help                 this text
`;

function place(text, name) {
  const [, host, port] = /^\[?([^\]]+?)\]?:(\d{1,5})$/.exec(text) ?? [];
  if (!host || Number(port) > 65535) {
    throw new Error(`--${name} is HOST:PORT, not "${text}"`);
  }
  return { host, port: Number(port) };
}

function stateFolder({ AWTD_STATE_DIR, XDG_STATE_HOME, HOME = '/' }) {
  return AWTD_STATE_DIR || (XDG_STATE_HOME ? join(XDG_STATE_HOME, 'awtd') : join(HOME, '.local/state/awtd'));
}

function tokenReader(file) {
  return () => { /* anew for each browser: awtd may have made it after the gateway's start */
    const [digits] = /^[0-9a-fA-F]{32}/.exec(readFileSync(file, 'utf8')) ?? [];
    if (!digits) {
      throw new Error("awtd's token file holds no token");
    }
    return Buffer.from(digits, 'hex');
  };
}

/** Ends the program on --help and on what it does not understand. */
export function readOptions() {
  const text = { type: 'string' };
  try {
    const { values } = parseArgs({ options: { 'listen': text, 'connect': text, 'token-file': text, 'origin': { type: 'string', multiple: true },
      'build': text, 'max-browsers': text, 'help': { type: 'boolean' } } });
    if (values.help) {
      process.stdout.write(HELP);
      process.exit(0);
    }
    const greatest = Number(values['max-browsers'] ?? 64);
    if (!Number.isInteger(greatest) || greatest < 1) {
      throw new Error('--max-browsers is a whole number, 1 or more');
    }
    return {
      listen: place(values.listen ?? '127.0.0.1:8080', 'listen'), connect: place(values.connect ?? '127.0.0.1:4680', 'connect'),
      readToken: tokenReader(values['token-file'] ?? join(stateFolder(process.env), 'token')),
      origins: (values.origin ?? []).map((origin) => new URL(origin).origin), build: values.build ?? 'build/release', greatest,
    };
  } catch (error) {
    console.error(`gateway: ${error.message}\n(--help says what there is)`);
    process.exit(2);
  }
}
