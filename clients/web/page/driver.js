// driver.js: moves the head by what is chosen, as the hair's clock goes. In lock-step it brings the forest to each time, step by step:
// one step is under way at most, and what the machine cannot keep up with is left out of simulated time, not made up for in a
// jerk. Free-running it says where the head is now. The head's own time is simulated time: it is slow where hair is slow.

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
    this.goOn(time_us);
    this.clipBegan_us = this.time_us;
    this.driving = true;
  }

  /** Time goes otherwise from now on; the head goes on where it is. */
  goOn(time_us) {
    this.clipBegan_us += Number(time_us) - this.time_us;
    this.time_us = Number(time_us);
    this.last_s = null;
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
    const { mode } = this.hair.clock ?? {}, is = this.driving && !this.paused && this.hair.state === 'live';
    if (is && mode === 'free') {
      this.follow();
    } else if (is && mode === 'lockstep') {
      this.lead(now_s);
    } else {
      this.last_s = now_s;
    }
  }

  lead(now_s) {
    this.last_s ??= now_s;
    const seconds = Math.min(now_s - this.last_s, LONGEST_S);
    if (!this.hair.stepping && seconds >= SHORTEST_S) {
      this.last_s = now_s;
      this.advance(seconds);
    }
  }

  /** By the daemon's clock: the head as it is now. */
  follow() {
    const passed_us = this.hair.now_us === null ? 0 : Number(this.hair.now_us) - this.time_us;
    const seconds = Math.min(passed_us * 1e-6, LONGEST_S);
    if (seconds < SHORTEST_S) {
      return;
    }
    this.clipBegan_us += passed_us - Math.round(seconds * 1e6); /* while nobody looked at this page the clip stood still */
    this.time_us += passed_us;
    this.pose = this.poseAfter(seconds);
    if (this.hair.move(this.pose.head, this.pose.body, this.takeJump()) !== null) {
      this.hair.sayBody(this.pose.body);
    }
  }

  /** A step of so many seconds; resolves when the hair is there. */
  async advance(seconds) {
    this.time_us += Math.round(seconds * 1e6);
    this.pose = this.poseAfter(seconds);
    const done = await this.hair.step(this.time_us, this.pose.head, this.pose.body, this.takeJump());
    if (done) {
      this.hair.sayBody(this.pose.body);
    }
    return done;
  }

  takeJump() {
    const is = this.jump === true;
    this.jump = false;
    return is;
  }
}
