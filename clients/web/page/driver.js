// driver.js: moves the head by what is chosen and brings the forest to that time, step by step: one step is under way at most,
// and what the machine cannot keep up with is left out of simulated time, not made up for in a jerk.

const LONGEST_S = 0.1, SHORTEST_S = 0.004;

export class Driver {
  /** `hair`: an AwtHair; `mouse`: what moves the head while there is no clip. */
  constructor(hair, mouse) {
    Object.assign(this, { hair, mouse, clip: null, clipBegan_us: 0, time_us: 0, last_s: null, driving: false, paused: false, pose: mouse.advance(0) });
  }

  play(clip) {
    this.clip?.dispose();
    this.clip = clip;
    this.clipBegan_us = this.time_us;
    this.jump = true;
  }

  /** The forest is at that time. */
  begin(time_us) {
    this.time_us = Number(time_us);
    this.clipBegan_us = this.time_us;
    this.last_s = null;
    this.driving = true;
  }

  stop() {
    this.driving = false;
  }

  poseAfter(seconds) {
    const { clip } = this, within_us = this.time_us - this.clipBegan_us;
    if (clip && !clip.repeats && within_us > clip.length_us) {
      this.clipBegan_us = this.time_us; /* begins again; a jump where it does not end as it began */
      this.jump = this.jump || clip.name === null;
    }
    return clip ? clip.at(this.time_us - this.clipBegan_us) : this.mouse.advance(seconds);
  }

  /** Called before each picture. */
  tick(now_s) {
    const seconds = Math.min(now_s - (this.last_s ?? now_s), LONGEST_S);
    if (!this.driving || this.hair.stepping || this.hair.state !== 'live') {
      this.last_s ??= now_s;
      return;
    }
    if (this.last_s === null || this.paused || seconds < SHORTEST_S) {
      this.last_s = this.paused ? now_s : this.last_s ?? now_s;
      return;
    }
    this.last_s = now_s;
    this.advance(seconds);
  }

  /** A step of so many seconds; resolves when the hair is there. */
  async advance(seconds) {
    this.time_us += Math.round(seconds * 1e6);
    this.pose = this.poseAfter(seconds);
    const teleport = this.jump === true;
    this.jump = false;
    const done = await this.hair.step(this.time_us, this.pose.head, this.pose.body, teleport);
    if (done) {
      this.hair.sayBody(this.pose.body);
    }
    return done;
  }
}
