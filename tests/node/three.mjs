// three.mjs: three.js' own GLTFLoader and DRACOLoader outside a browser: what they miss there, a Worker and a place to fetch
// the decoder from, is made here of Node's.
import { resolveObjectURL } from 'node:buffer';
import { readFile } from 'node:fs/promises';
import { Worker as NodeWorker } from 'node:worker_threads';

/** A browser's Worker as far as DRACOLoader knows it. */
class BrowserWorker {
  constructor(url) {
    const prelude = `const { parentPort } = require('node:worker_threads');
      globalThis.self = globalThis;
      globalThis.postMessage = (message, transfer) => parentPort.postMessage(message, transfer);
      parentPort.on('message', (data) => globalThis.onmessage({ data }));\n`;
    this.ready = resolveObjectURL(url).text().then((code) => {
      this.worker = new NodeWorker(prelude + code, { eval: true });
      this.worker.on('message', (data) => this.onmessage({ data }));
      this.worker.on('error', (error) => { throw error; });
    });
  }

  postMessage(message, transfer) {
    this.ready.then(() => this.worker.postMessage(message, transfer));
  }

  terminate() {
    this.ready.then(() => this.worker.terminate());
  }
}

/** { read(bytes), close() }: read gives a loaded scene's geometries, primitive by primitive. */
export async function openThree() {
  globalThis.Worker = BrowserWorker;
  globalThis.self ??= globalThis;
  const { GLTFLoader } = await import('three/examples/jsm/loaders/GLTFLoader.js');
  const { DRACOLoader } = await import('three/examples/jsm/loaders/DRACOLoader.js');
  const draco = new DRACOLoader();
  draco._loadLibrary = async (name, type) => {
    const file = new URL(import.meta.resolve(`three/examples/jsm/libs/draco/gltf/${name}`));
    const bytes = await readFile(file);
    return type === 'text' ? bytes.toString() : bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  };
  const loader = new GLTFLoader().setDRACOLoader(draco);
  return {
    async read(bytes) {
      const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
      const { scene } = await loader.parseAsync(copy, '');
      const geometries = [];
      scene.traverse((object) => object.geometry && geometries.push(object.geometry));
      return { scene, geometries };
    },
    close: () => draco.dispose(),
  };
}
