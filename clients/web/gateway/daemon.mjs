// daemon.mjs: a connection to awtd that has been let in: HELLO, WELCOME, AUTH, AUTH_REPLY (proto/PROTOCOL.md).
import { createHmac, randomBytes, timingSafeEqual } from 'node:crypto';
import { connect } from 'node:net';
import { HEADER_SIZE } from '../lib/codec.js';

const GREETING_MAX = 512, GREETING_TIMEOUT_MS = 5000, VERSION = 1, KEY_OFFSET = 8;

const proof = (token, ...parts) => createHmac('sha256', token).update(Buffer.concat(parts.map((part) => Buffer.from(part)))).digest();

function hello(codec) {
  const values = { magic: Buffer.from('AWTD'), lowest_version: VERSION, highest_version: VERSION, routing_key: randomBytes(16), client: 'awt-gateway' };
  const length = codec.encode('hello', values).length - HEADER_SIZE;
  return codec.encode('hello', { ...values, length }, { request: 1n });
}

/** The next whole message, short as it must be before one is in; the rest stays with the socket. */
async function readMessage(socket) {
  let bytes = Buffer.alloc(0);
  for (;;) {
    const length = bytes.length >= HEADER_SIZE ? bytes.readUInt32LE(0) : 0;
    if (length > GREETING_MAX) {
      throw new Error('what answers there is not awtd');
    }
    if (bytes.length >= HEADER_SIZE + length) {
      const rest = bytes.subarray(HEADER_SIZE + length);
      if (rest.length > 0) {
        socket.unshift(rest);
      }
      return bytes.subarray(0, HEADER_SIZE + length);
    }
    const more = socket.read();
    if (more) {
      bytes = Buffer.concat([bytes, more]);
    } else {
      await new Promise((resolve, reject) => {
        const forget = (then) => (value) => {
          socket.off('readable', readable).off('end', ended).off('error', failed).off('close', ended);
          then(value);
        };
        const readable = forget(resolve), failed = forget(reject), ended = forget(() => reject(new Error('awtd closed the connection')));
        socket.on('readable', readable).on('end', ended).on('error', failed).on('close', ended);
      });
    }
  }
}

async function expect(socket, codec, name) {
  const message = codec.decode(await readMessage(socket));
  if (message.name === 'error') {
    throw new Error(`awtd says: ${message.values.text}`);
  }
  if (message.name !== name) {
    throw new Error('what answers there is not awtd');
  }
  return message.values;
}

async function greet(socket, codec, readToken) {
  socket.write(hello(codec));
  const welcome = await expect(socket, codec, 'welcome');
  if (welcome.version !== VERSION) {
    throw new Error(`awtd chose version ${welcome.version} of the protocol, not ${VERSION}`);
  }
  if (welcome.auth_required) {
    const token = readToken(), nonce = randomBytes(32);
    socket.write(codec.encode('auth', { nonce, proof: proof(token, 'awtd auth 1', welcome.nonce, nonce) }, { request: 2n }));
    const reply = await expect(socket, codec, 'auth_reply');
    if (!timingSafeEqual(proof(token, 'awtd server 1', nonce, welcome.nonce), reply.proof)) {
      throw new Error('what answers there does not know the token');
    }
  }
  return welcome;
}

/** { socket, welcome }; rejects in bounded time with what is wrong, for people. */
export async function openDaemon({ host, port, readToken, codec }) {
  const socket = connect({ host, port, noDelay: true });
  socket.on('error', () => {}); /* told by 'close' */
  let timer;
  try {
    const late = new Promise((_, reject) => {
      timer = setTimeout(() => reject(new Error('awtd does not answer')), GREETING_TIMEOUT_MS);
    });
    return { socket, welcome: await Promise.race([greet(socket, codec, readToken), late]) };
  } catch (error) {
    socket.destroy();
    throw error.code === 'ECONNREFUSED' ? new Error('awtd is not there') : error;
  } finally {
    clearTimeout(timer);
  }
}
