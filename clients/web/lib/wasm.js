// wasm.js: a module of ours in WebAssembly: its functions, and bytes and texts in and out of its memory.

export async function loadWasm(url) {
  const { instance } = await WebAssembly.instantiateStreaming(fetch(url), { env: { emscripten_notify_memory_growth() {} } });
  instance.exports._initialize();
  return new Wasm(instance.exports);
}

/** `calls`: the exports of an instance that has been initialised. */
export class Wasm {
  constructor(calls) {
    this.calls = calls;
  }

  /** The bytes at an address; not to be kept, for the memory may move with any call. */
  bytes(address, length) {
    return new Uint8Array(this.calls.memory.buffer, address, length);
  }

  /** A text that ends with NUL, at most `most` bytes. */
  text(address, most = 256) {
    const bytes = this.bytes(address, Math.min(most, this.calls.memory.buffer.byteLength - address)), end = bytes.indexOf(0);
    return new TextDecoder().decode(bytes.subarray(0, end < 0 ? bytes.length : end));
  }

  /** What `use` returns of address and length of a copy of the bytes, which is freed behind it. */
  withBytes(bytes, use) {
    const address = this.calls.malloc(Math.max(1, bytes.length));
    if (!address) {
      throw new Error('not enough memory');
    }
    try {
      this.bytes(address, bytes.length).set(bytes);
      return use(address, bytes.length);
    } finally {
      this.calls.free(address);
    }
  }
}
