// mouse.js: a head that looks where the mouse is and sways there, smoothly, as a neck would.
import * as THREE from 'three';

const NECK = new THREE.Vector3(0, -0.09, -0.02), REST = new THREE.Vector3(0, 1.6, 0);
const YAW = 1.15, PITCH = 0.5, ROLL = 0.16, SWAY_M = 0.09, TAU_S = 0.09; /* of each of two followers, one behind the other */

export class MouseHead {
  constructor(element) {
    this.target = [0, 0];
    this.near = [0, 0];
    this.now = [0, 0];
    element.addEventListener('pointermove', (event) => {
      const { left, top, width, height } = element.getBoundingClientRect();
      this.point(2 * (event.clientX - left) / width - 1, 2 * (event.clientY - top) / height - 1);
    });
  }

  /** -1 to 1 from left to right and from top to bottom. */
  point(x, y) {
    this.target = [x, y];
  }

  /** { head, body } so many seconds later. */
  advance(seconds) {
    const share = 1 - Math.exp(-seconds / TAU_S);
    for (const k of [0, 1]) {
      this.near[k] += (this.target[k] - this.near[k]) * share;
      this.now[k] += (this.near[k] - this.now[k]) * share;
    }
    const [x, y] = this.now;
    const turn = new THREE.Quaternion().setFromEuler(new THREE.Euler(PITCH * y, YAW * x, -ROLL * x, 'YXZ'));
    const body = REST.clone().add(new THREE.Vector3(SWAY_M * x, -0.012 * x * x, 0));
    const head = body.clone().add(NECK).sub(NECK.clone().applyQuaternion(turn));
    const lean = new THREE.Quaternion().setFromEuler(new THREE.Euler(0, 0.25 * x, 0));
    return { head: { position: head.toArray(), orientation: turn.toArray() }, body: { position: body.toArray(), orientation: lean.toArray() } };
  }
}
