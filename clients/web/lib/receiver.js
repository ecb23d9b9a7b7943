// receiver.js: frames to strand points and nodes, by receiver.c in WebAssembly, which keeps the frames that deltas are against.

const NODE_BYTES = 24, ROW_POINTS = 1024; /* as in hair-mesh.js */

export class Receiver {
  /** `wasm`: a Wasm (wasm.js) of receiver.wasm. For the frames of one forest. */
  constructor(wasm) {
    Object.assign(this, { wasm, handle: 0 });
    this.reset();
  }

  /** Forgets the forest before. */
  reset() {
    const { calls } = this.wasm;
    calls.receiver_destroy(this.handle);
    this.handle = calls.receiver_create();
    if (!this.handle) {
      throw new Error('not enough memory');
    }
    return {};
  }

  take(call, bytes, ...more) {
    const { wasm, handle } = this;
    if (!wasm.withBytes(bytes, (at, size) => wasm.calls[call](handle, at, size, ...more))) {
      throw new Error(wasm.text(wasm.calls.receiver_error(handle)));
    }
  }

  /** BINDING_REPLY's bytes: what guides are evaluated with. */
  bind({ bytes }) {
    this.take('receiver_bind', bytes);
    return {};
  }

  /** FRAME's fields, `bytes` its GLB, to strand points as rows of a texture, four floats each, the last one unused. `have`: what
   * CREDIT may say from now on. */
  frame({ bytes, kind, level, sequence, base }) {
    this.take('receiver_frame', bytes, kind, level, sequence, base);
    const { wasm: { calls }, handle } = this, memory = calls.memory.buffer;
    const strands = calls.receiver_strands(handle), points = calls.receiver_points(handle);
    const from = new Float32Array(memory, calls.receiver_positions(handle), 3 * strands * points);
    const positions = new Float32Array(4 * ROW_POINTS * Math.ceil(strands * points / ROW_POINTS));
    for (let i = 0, j = 0; i < from.length; i += 3, j += 4) {
      positions[j] = from[i];
      positions[j + 1] = from[i + 1];
      positions[j + 2] = from[i + 2];
    }
    return {
      strands, points, positions, widths: new Float32Array(memory, calls.receiver_widths(handle), points).slice(),
      head: [...new Float64Array(memory, calls.receiver_head(handle), 7)], have: BigInt.asUintN(64, calls.receiver_newest(handle)),
    };
  }

  nodes({ bytes }) {
    this.take('receiver_nodes', bytes);
    const { wasm, handle } = this, count = wasm.calls.receiver_node_count(handle);
    return { count, records: wasm.bytes(wasm.calls.receiver_node_list(handle), count * NODE_BYTES).slice().buffer };
  }
}
