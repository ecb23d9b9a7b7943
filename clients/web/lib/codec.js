// codec.js: the protocol's messages to bytes and back (proto/PROTOCOL.md), by the lists that make_messages.mjs takes from
// messages.def. u64 and i64 are BigInt; a pose is { position: [3], orientation: [4] }; raw and blob are Uint8Array.

export const HEADER_SIZE = 16, FLAG_REQUIRED = 1;
export const GREATEST_REQUEST = 2 << 20, GREATEST_REPLY = (64 << 20) + 512;

const NUMBERS = {
  u8: ['Uint8', 1], u16: ['Uint16', 2], u32: ['Uint32', 4], u64: ['BigUint64', 8], i64: ['BigInt64', 8], f32: ['Float32', 4], f64: ['Float64', 8],
};
const LENGTH_KIND = { str: 'u16', blob: 'u32', list: 'u16' };

class Writer {
  constructor() {
    this.bytes = new Uint8Array(256);
    this.view = new DataView(this.bytes.buffer);
    this.size = 0;
  }

  room(count) {
    if (this.size + count > this.bytes.length) {
      const larger = new Uint8Array(Math.max(2 * this.bytes.length, this.size + count));
      larger.set(this.bytes.subarray(0, this.size));
      this.bytes = larger;
      this.view = new DataView(larger.buffer);
    }
    this.size += count;
    return this.size - count;
  }

  number(kind, value) {
    const [name, size] = NUMBERS[kind], at = this.room(size);
    this.view[`set${name}`](at, size === 8 && kind !== 'f64' ? BigInt(value) : Number(value), true);
  }

  raw(bytes) {
    const at = this.room(bytes.length); /* makes `bytes` anew where it is too short */
    this.bytes.set(bytes, at);
  }
}

class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    this.at = 0;
  }

  take(count) {
    if (count > this.bytes.length - this.at) {
      throw new Error('a message ends inside of a field');
    }
    this.at += count;
    return this.at - count;
  }

  number(kind) {
    const [name, size] = NUMBERS[kind], value = this.view[`get${name}`](this.take(size), true);
    if (typeof value === 'number' && !Number.isFinite(value)) {
      throw new Error('a number that is not finite');
    }
    return value;
  }

  raw(count) {
    const at = this.take(count);
    return this.bytes.subarray(at, at + count);
  }
}

/** { encode, decode } by the lists of messages.mjs. */
export function makeCodec({ MESSAGES, RECORDS }) {
  const byName = new Map(MESSAGES.map((message) => [message.name, message]));
  const byId = new Map(MESSAGES.map((message) => [message.id, message]));

  function writeField(out, value, [kind, name, argument, most]) {
    if (kind in NUMBERS) {
      out.number(kind, value ?? 0);
    } else if (kind === 'raw') {
      out.raw(value ?? new Uint8Array(argument));
    } else if (kind === 'pose') {
      [...value.position, ...value.orientation].forEach((number) => out.number('f64', number));
    } else {
      const content = kind === 'str' ? new TextEncoder().encode(value ?? '') : value ?? [];
      if (content.length > (kind === 'list' ? most : argument)) {
        throw new Error(`${name} is longer than the protocol allows`);
      }
      out.number(LENGTH_KIND[kind], content.length);
      if (kind === 'list') {
        content.forEach((item) => writeFields(out, item, RECORDS[argument]));
      } else {
        out.raw(content);
      }
    }
  }

  function writeFields(out, values, fields) {
    fields.forEach((field) => writeField(out, values[field[1]], field));
  }

  function readField(from, [kind, name, argument, most]) {
    if (kind in NUMBERS) {
      return from.number(kind);
    }
    if (kind === 'raw') {
      return from.raw(argument);
    }
    if (kind === 'pose') {
      const numbers = Array.from({ length: 7 }, () => from.number('f64'));
      return { position: numbers.slice(0, 3), orientation: numbers.slice(3) };
    }
    const length = from.number(LENGTH_KIND[kind]);
    if (length > (kind === 'list' ? most : argument)) {
      throw new Error(`${name} is longer than the protocol allows`);
    }
    if (kind === 'list') {
      return Array.from({ length }, () => readFields(from, RECORDS[argument]));
    }
    return kind === 'str' ? new TextDecoder('utf-8', { fatal: true }).decode(from.raw(length)) : from.raw(length);
  }

  const readFields = (from, fields) => Object.fromEntries(fields.map((field) => [field[1], readField(from, field)]));

  return {
    /** A whole message. Fields left out are 0 or empty. */
    encode(name, values = {}, { request = 0n, required = true } = {}) {
      const { id, fields } = byName.get(name), out = new Writer();
      out.number('u32', 0);
      out.number('u16', id);
      out.number('u16', required ? FLAG_REQUIRED : 0);
      out.number('u64', request);
      writeFields(out, values, fields);
      out.view.setUint32(0, out.size - HEADER_SIZE, true);
      return out.bytes.subarray(0, out.size);
    },

    /** { name, type, request, values } of one whole message; `name` null where it is not known. Throws on what is none. */
    decode(bytes) {
      const from = new Reader(bytes);
      const length = from.number('u32'), type = from.number('u16');
      from.number('u16');
      const request = from.number('u64'), message = byId.get(type);
      if (length !== bytes.length - HEADER_SIZE) {
        throw new Error('a message does not have the length that it names');
      }
      if (!message) {
        return { name: null, type, request, values: {} };
      }
      const values = readFields(from, message.fields);
      if (from.at !== bytes.length && message.name !== 'hello') {
        throw new Error('a message goes on behind its last field');
      }
      return { name: message.name, type, request, values };
    },

    idOf: (name) => byName.get(name).id,
    nameOf: (type) => byId.get(type)?.name ?? null,
  };
}
