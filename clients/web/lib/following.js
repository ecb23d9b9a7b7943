// following.js: the frames of one forest in one form, decoded, until it is ended; who wants another form makes another.

const KINDS = { strands: 1, guides: 2, nodes: 3 }, LEVELS = { full: 0, fifth: 1, guides: 2 };
const CREDIT = 2, NODES_RATE = 30;

export class Following {
  /** `form`: { kind, level, nodes } as AwtHair has them. `heard`: { hair(decoded, frame), nodes(decoded), refused(error),
   * ended(error) }; nothing is heard any more once this is ended. */
  constructor(connection, decoder, forest, { kind, level, nodes }, heard) {
    Object.assign(this, { connection, decoder, forest, nodes, heard });
    Object.assign(this, { kind: KINDS[kind], level: kind === 'strands' ? LEVELS[level] : 0 });
    this.subscriptions = [];
    this.frames = 0; /* of hair */
    this.over = false;
  }

  /** Subscribes, and takes the frame that is there: the forest may stand still. */
  async begin() {
    const { connection, forest, kind, level } = this;
    if (kind === KINDS.guides) {
      const { binding } = await connection.ask('binding', { forest, level: 0 });
      await this.decoder.ask('bind', { bytes: binding });
    }
    await this.watch({ forest, kind, level, credit: CREDIT, deltas: 1 });
    if (this.nodes) {
      await this.watch({ forest, kind: KINDS.nodes, level: 0, credit: 1, greatest_rate: NODES_RATE });
    }
    for (const wanted of [kind, ...(this.nodes ? [KINDS.nodes] : [])]) {
      const frame = await connection.ask('query', { forest, latest: 1, kind: wanted, level: wanted === kind ? level : 0 });
      if (!this.over && (wanted !== kind || this.frames === 0)) {
        await this.take(frame);
      }
    }
  }

  async watch(values) {
    let subscription = null, acknowledge = Promise.resolve();
    const stream = {
      frame: (frame) => {
        acknowledge = acknowledge.then(() => this.take(frame)).then((have) => subscription?.credit(have), (error) => {
          this.over || this.heard.refused(error);
          subscription?.credit(0n); /* the next one comes whole */
        });
      },
      ended: (error) => this.over || this.heard.ended(error),
    };
    subscription = await this.connection.subscribe(values, stream);
    this.over ? subscription.end() : this.subscriptions.push(subscription);
  }

  /** Resolves to what CREDIT may say: the newest frame of hair that is kept here. */
  async take(frame) {
    const { glb: bytes, kind, level, sequence, base } = frame, isNodes = kind === KINDS.nodes;
    const decoded = await this.decoder.ask(isNodes ? 'nodes' : 'frame', { bytes, kind, level, sequence, base });
    if (!this.over) {
      this.frames += isNodes ? 0 : 1;
      isNodes ? this.heard.nodes(decoded) : this.heard.hair(decoded, frame);
    }
    return decoded.have ?? 0n;
  }

  end() {
    this.over = true;
    this.subscriptions.forEach((subscription) => subscription.end());
  }
}
