// receiver-worker.js: decodes frames beside the page, so that drawing never waits for it. One receiver for the one forest that the
// page follows; answers come in the order of the questions.
import { Receiver } from './receiver.js';
import { loadWasm } from './wasm.js';

const receiver = loadWasm(new URL('./receiver.wasm', import.meta.url)).then((wasm) => new Receiver(wasm));

/* `action`: a method of Receiver. */
onmessage = async ({ data: { id, action, values } }) => {
  try {
    const result = (await receiver)[action](values);
    postMessage({ id, result }, [result.positions?.buffer, result.records].filter(Boolean));
  } catch (error) {
    postMessage({ id, failure: error.message });
  }
};
