// decoder.js: the page's side of receiver-worker.js: questions with a promise each, answered in their order.

export class Decoder {
  constructor() {
    this.worker = new Worker(new URL('./receiver-worker.js', import.meta.url), { type: 'module' });
    this.waiting = new Map();
    this.last = 0;
    this.worker.onmessage = ({ data: { id, result, failure } }) => {
      const { resolve, reject } = this.waiting.get(id);
      this.waiting.delete(id);
      failure === undefined ? resolve(result) : reject(new Error(failure));
    };
    this.worker.onerror = (event) => {
      this.waiting.forEach(({ reject }) => reject(new Error(event.message || 'the receiver does not load')));
      this.waiting.clear();
    };
  }

  /** `values.bytes` stays whole with who asks. */
  ask(action, values = {}) {
    return new Promise((resolve, reject) => {
      this.waiting.set(++this.last, { resolve, reject });
      this.worker.postMessage({ id: this.last, action, values });
    });
  }

  dispose() {
    this.worker.terminate();
    this.waiting.forEach(({ reject }) => reject(new Error('the hair is disposed of')));
    this.waiting.clear();
  }
}
