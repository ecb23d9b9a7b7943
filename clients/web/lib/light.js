// light.js: where light comes from, and maps of how near each light the first hair (or head) is: what lies deeper is dimmed with
// the depth of hair above it, softly, as in deep opacity maps.
import * as THREE from 'three';

const CELLS = 512, REACH_M = 0.62; /* of a map's half edge about the head */

/** Key light from the side, a sky, and a light from behind that shows the outline. Directions in the world's axes. */
export const DEFAULT_LIGHT = {
  key: { direction: [0.45, 0.65, 0.7], colour: [3.0, 2.8, 2.55] },
  rim: { direction: [-0.6, 0.5, -0.75], colour: [1.5, 1.75, 2.2] },
  sky: [0.85, 0.92, 1.05],
};

export const LIGHT_SHADER = /* glsl */ `
  uniform vec3 keyDirection, keyColour, rimDirection, rimColour, skyColour;
  uniform sampler2D keyMap, skyMap;
  uniform mat4 keyMatrix, skyMatrix;
  uniform float mapDepth; /* metres from a map's near to its far */

  /* Share of the light that comes through what lies above a place of the world; reach: metres that dim it to a third. */
  float lightThrough(sampler2D map, mat4 toMap, vec3 place, float reach, float bias) {
    vec3 at = (toMap * vec4(place, 1.0)).xyz * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.01))) || any(greaterThan(at.xy, vec2(0.99)))) {
      return 1.0;
    }
    vec2 cell = at.xy * ${CELLS}.0 - 0.5, between = fract(cell);
    float sum = 0.0;
    for (int i = 0; i < 4; i++) { /* the four cells around, each by how near it is */
      ivec2 corner = ivec2(i & 1, i >> 1);
      vec2 weight = mix(1.0 - between, between, vec2(corner));
      float above = (at.z - texelFetch(map, ivec2(floor(cell)) + corner, 0).r) * mapDepth - bias;
      sum += weight.x * weight.y * exp(-max(above, 0.0) / reach);
    }
    return sum;
  }`;

class LightMap {
  constructor(cells) {
    this.camera = new THREE.OrthographicCamera(-REACH_M, REACH_M, REACH_M, -REACH_M, 0, 4 * REACH_M);
    this.target = new THREE.WebGLRenderTarget(cells, cells, { minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter });
    this.target.depthTexture = new THREE.DepthTexture(cells, cells, THREE.UnsignedIntType);
    this.matrix = new THREE.Matrix4();
  }

  draw(renderer, scene, centre, direction) {
    const { camera } = this;
    camera.up.set(0, Math.abs(direction.y) > 0.9 ? 0 : 1, Math.abs(direction.y) > 0.9 ? 1 : 0);
    camera.position.copy(centre).addScaledVector(direction, 2 * REACH_M);
    camera.lookAt(centre);
    camera.updateMatrixWorld();
    this.matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    renderer.setRenderTarget(this.target);
    renderer.clear();
    renderer.render(scene, camera);
  }
}

/** The lights with their maps; `uniforms` go into every material with LIGHT_SHADER. */
export class Light {
  constructor(light = DEFAULT_LIGHT) {
    const vector = (numbers) => new THREE.Vector3(...numbers);
    this.key = new LightMap(CELLS);
    this.sky = new LightMap(CELLS);
    this.scene = new THREE.Scene();
    this.scene.matrixWorldAutoUpdate = false;
    this.blockers = new Map(); /* what throws shadows -> its stand-in */
    this.dirty = true;
    this.uniforms = {
      keyDirection: { value: vector(light.key.direction).normalize() }, keyColour: { value: vector(light.key.colour) },
      rimDirection: { value: vector(light.rim.direction).normalize() }, rimColour: { value: vector(light.rim.colour) },
      skyColour: { value: vector(light.sky) }, mapDepth: { value: 4 * REACH_M },
      keyMap: { value: this.key.target.depthTexture }, skyMap: { value: this.sky.target.depthTexture },
      keyMatrix: { value: this.key.matrix }, skyMatrix: { value: this.sky.matrix },
    };
  }

  /** `mesh` throws shadows, drawn with that material. */
  addBlocker(mesh, material = new THREE.MeshBasicMaterial()) {
    const standIn = new THREE.Mesh(mesh.geometry, material);
    standIn.frustumCulled = false;
    standIn.matrixWorld = mesh.matrixWorld;
    this.blockers.set(mesh, standIn);
    this.scene.add(standIn);
    this.dirty = true;
  }

  removeBlocker(mesh) {
    this.blockers.get(mesh)?.removeFromParent();
    this.blockers.delete(mesh);
    this.dirty = true;
  }

  /** Draws the maps about a place of the world, where something has changed; within a frame or before it. */
  update(renderer, centre) {
    if (!this.dirty) {
      return;
    }
    this.dirty = false;
    this.blockers.forEach((standIn, mesh) => { standIn.visible = mesh.visible; });
    const target = renderer.getRenderTarget(), { autoUpdate } = renderer.shadowMap;
    renderer.shadowMap.autoUpdate = false;
    this.key.draw(renderer, this.scene, centre, this.uniforms.keyDirection.value);
    this.sky.draw(renderer, this.scene, centre, new THREE.Vector3(0, 1, 0));
    renderer.shadowMap.autoUpdate = autoUpdate;
    renderer.setRenderTarget(target);
  }

  dispose() {
    [this.key, this.sky].forEach(({ target }) => target.dispose());
  }
}
