// stage.js: canvas, camera and the loop that draws.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const HEAD = [0, 1.6, 0], BELOW_M = 0.07, FOLLOW_S = 0.25; /* what is looked at lies below the head's centre, and follows it */
/* Where cameras stand, from what they look at. */
export const VIEWS = { 'three-quarter': [0.5, 0.1, 0.92], 'front': [0, 0.06, 1.05], 'side': [1.05, 0.06, 0], 'back-quarter': [-0.55, 0.16, -0.9] };

export class Stage {
  constructor(canvas, { antialias = true, pixelRatio = Math.min(globalThis.devicePixelRatio, 2) } = {}) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.0;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(34, 1, 0.05, 20);
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableDamping: true, dampingFactor: 0.12, minDistance: 0.35, maxDistance: 4 });
    this.changed = true; /* something is to be seen that the last picture does not have */
    this.controls.addEventListener('change', () => { this.changed = true; });
    this.look('three-quarter');
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  /** From one of VIEWS at a head that is there. */
  look(view, [x, y, z] = HEAD) {
    this.followed = new THREE.Vector3(x, y, z);
    this.controls.target.set(x, y - BELOW_M, z);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(...VIEWS[view]));
    this.controls.update();
  }

  /** The camera goes with the head, a little late. */
  follow(head, seconds) {
    const move = head.clone().sub(this.followed).multiplyScalar(1 - Math.exp(-seconds / FOLLOW_S));
    [this.followed, this.controls.target, this.camera.position].forEach((place) => place.add(move));
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width > 0 && height > 0) {
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.changed = true;
    }
  }

  /** Calls `each` with the page's time in seconds at every turn of the screen, and draws where `changed` says so. */
  run(each) {
    this.renderer.setAnimationLoop((ms) => {
      each(ms / 1000);
      this.controls.update();
      if (this.changed) {
        this.draw();
      }
    });
  }

  draw() {
    this.changed = false;
    this.renderer.render(this.scene, this.camera);
  }
}
