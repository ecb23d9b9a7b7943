// moving-hair.js: hair and head at any time between the frames that came.
import * as THREE from 'three';
import { Between } from './between.js';

const to3 = new THREE.Vector3(), turns = [new THREE.Quaternion(), new THREE.Quaternion()];

export class MovingHair {
  /** `object`: gets the head's pose; `mesh`: a HairMesh. */
  constructor(object, mesh) {
    Object.assign(this, { object, mesh, between: new Between() });
  }

  reset() {
    this.between.reset();
  }

  /** Time goes otherwise from now on: what was learnt of how frames come is void. */
  reckonAnew() {
    this.between.forget();
  }

  /** A frame as receiver-worker.js gives it, of that simulated time. */
  take(frame, time_us, now_ms) {
    const last = this.between.frames.at(-1)?.frame;
    if (last && (last.strands !== frame.strands || last.points !== frame.points)) {
      this.between.reset(); /* of another level: nothing is between them */
    }
    this.between.add(frame, time_us, now_ms);
  }

  /** Shows how things are at that time; `newest`: the newest frame, however unevenly they come. */
  see(now_ms, newest) {
    const seen = newest ? this.between.newest(now_ms) : this.between.at(now_ms);
    if (!seen) {
      return;
    }
    const { from, to, weight } = seen;
    this.mesh.show(from, to, weight);
    turns[0].fromArray(from.head, 3);
    turns[1].fromArray(to.head, 3);
    this.object.quaternion.slerpQuaternions(...turns, weight);
    this.object.position.fromArray(from.head).lerp(to3.fromArray(to.head), weight);
    this.object.updateMatrixWorld(true);
  }

  /** Whether time alone changes what is to be seen. */
  get moves() {
    return this.between.moves;
  }
}
