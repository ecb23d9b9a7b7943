// receiver-worker.js: decodes frames beside the page, so that drawing never waits for it. One receiver (receiver.c) for the one
// forest that the page follows; answers come in the order of the questions.
import { loadWasm } from './wasm.js';

const NODE_BYTES = 24, ROW_POINTS = 1024; /* as in hair-mesh.js */
const wasm = loadWasm(new URL('./receiver.wasm', import.meta.url));
let receiver = 0;

function failed(calls, module) {
  return new Error(module.text(calls.receiver_error(receiver)));
}

const ACTIONS = {
  /** Forgets the forest before. */
  reset(module) {
    module.calls.receiver_destroy(receiver);
    receiver = module.calls.receiver_create();
    if (!receiver) {
      throw new Error('not enough memory');
    }
    return {};
  },

  bind(module, { bytes }) {
    if (!module.withBytes(bytes, (at, size) => module.calls.receiver_bind(receiver, at, size))) {
      throw failed(module.calls, module);
    }
    return {};
  },

  /** Strand points as rows of a texture, four floats each, the last one unused. */
  frame(module, { bytes, kind, level, sequence, base }) {
    const { calls } = module;
    if (!module.withBytes(bytes, (at, size) => calls.receiver_frame(receiver, at, size, kind, level, sequence, base))) {
      throw failed(calls, module);
    }
    const strands = calls.receiver_strands(receiver), points = calls.receiver_points(receiver), memory = calls.memory.buffer;
    const from = new Float32Array(memory, calls.receiver_positions(receiver), 3 * strands * points);
    const positions = new Float32Array(4 * ROW_POINTS * Math.ceil(strands * points / ROW_POINTS));
    for (let i = 0, j = 0; i < from.length; i += 3, j += 4) {
      positions[j] = from[i];
      positions[j + 1] = from[i + 1];
      positions[j + 2] = from[i + 2];
    }
    return {
      strands, points, positions, widths: new Float32Array(memory, calls.receiver_widths(receiver), points).slice(),
      head: [...new Float64Array(memory, calls.receiver_head(receiver), 7)],
    };
  },

  nodes(module, { bytes }) {
    const { calls } = module;
    if (!module.withBytes(bytes, (at, size) => calls.receiver_nodes(receiver, at, size))) {
      throw failed(calls, module);
    }
    const count = calls.receiver_node_count(receiver);
    return { count, records: module.bytes(calls.receiver_node_list(receiver), count * NODE_BYTES).slice().buffer };
  },
};

onmessage = async ({ data: { id, action, values } }) => {
  try {
    const result = ACTIONS[action](await wasm, values);
    postMessage({ id, result }, [result.positions?.buffer, result.records].filter(Boolean));
  } catch (error) {
    postMessage({ id, failure: error.message });
  }
};
