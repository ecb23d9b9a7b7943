// nodes-mesh.js: the Adaptive Wisp Tree as in the paper's figure 4: active nodes as spheres, segments as cylinders, a colour a level.
import * as THREE from 'three';

const RECORD_FLOATS = 6; /* f32 position[3], f32 radius, u32 level, u32 parent */
const LEVEL_COLOURS = [0xff5a3c, 0xffc53a, 0x4fd07a, 0x4aa8ff].map((colour) => new THREE.Color(colour));
const SPHERE_SHARE = 0.4, SPHERE_M = [0.0022, 0.006], CYLINDER_SHARE = 0.45; /* of a wisp's radius; least and most; of the sphere's radius */

export class NodesMesh extends THREE.Group {
  constructor() {
    super();
    this.count = 0;
    this.visible = false;
    const material = () => new THREE.ShaderMaterial({ vertexShader: NODE_VERTEX, fragmentShader: NODE_FRAGMENT });
    this.shapes = [new THREE.SphereGeometry(1, 14, 10), new THREE.CylinderGeometry(1, 1, 1, 8, 1, true)];
    this.materials = [material(), material()];
    this.room(1024);
  }

  room(count) {
    this.meshes?.forEach((mesh) => {
      this.remove(mesh);
      mesh.dispose();
    });
    this.meshes = this.shapes.map((shape, i) => {
      const mesh = new THREE.InstancedMesh(shape, this.materials[i], count);
      mesh.instanceColor = new THREE.InstancedBufferAttribute(new Float32Array(3 * count), 3);
      mesh.frustumCulled = false;
      this.add(mesh);
      return mesh;
    });
    this.capacity = count;
  }

  /** A frame as receiver-worker.js gives it. */
  show({ count, records }) {
    if (count > this.capacity) {
      this.room(2 * count);
    }
    const floats = new Float32Array(records), numbers = new Uint32Array(records), [spheres, cylinders] = this.meshes;
    const place = (n) => new THREE.Vector3().fromArray(floats, RECORD_FLOATS * n);
    const sizeOf = (n) => THREE.MathUtils.clamp(floats[RECORD_FLOATS * n + 3] * SPHERE_SHARE, ...SPHERE_M);
    const matrix = new THREE.Matrix4(), turn = new THREE.Quaternion(), up = new THREE.Vector3(0, 1, 0), none = new THREE.Quaternion();
    this.levels = [0, 0, 0, 0];
    for (let n = 0; n < count; n++) {
      const at = place(n), size = sizeOf(n), level = numbers[RECORD_FLOATS * n + 4], parent = place(numbers[RECORD_FLOATS * n + 5]);
      const way = at.clone().sub(parent), length = way.length();
      this.levels[level]++;
      spheres.setMatrixAt(n, matrix.compose(at, none, new THREE.Vector3(size, size, size)));
      spheres.setColorAt(n, LEVEL_COLOURS[level]);
      turn.setFromUnitVectors(up, length > 1e-6 ? way.divideScalar(length) : up);
      cylinders.setMatrixAt(n, matrix.compose(at.add(parent).multiplyScalar(0.5), turn, new THREE.Vector3(size * CYLINDER_SHARE, length, size * CYLINDER_SHARE)));
      cylinders.setColorAt(n, LEVEL_COLOURS[level]);
    }
    this.meshes.forEach((mesh) => {
      mesh.count = count;
      mesh.instanceMatrix.needsUpdate = true;
      mesh.instanceColor.needsUpdate = true;
    });
    this.count = count;
  }

  dispose() {
    [...this.meshes, ...this.shapes, ...this.materials].forEach((part) => part.dispose());
  }
}

const NODE_VERTEX = /* glsl */ `
  varying vec3 shade, normalOfView;
  void main() {
    vec4 place = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
    shade = instanceColor;
    normalOfView = normalize(mat3(modelViewMatrix * instanceMatrix) * normal);
    gl_Position = projectionMatrix * place;
  }`;
const NODE_FRAGMENT = /* glsl */ `
  varying vec3 shade, normalOfView;
  void main() {
    float light = 0.45 + 0.55 * max(0.0, dot(normalize(normalOfView), normalize(vec3(0.4, 0.6, 0.7))));
    gl_FragColor = vec4(shade * light, 1.0);
    #include <colorspace_fragment>
  }`;
