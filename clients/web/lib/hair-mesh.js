// hair-mesh.js: the strands between two frames as one mesh of ribbons; the points of both are textures (hair-shaders.js).
import * as THREE from 'three';
import { HAIR_FRAGMENT, HAIR_VERTEX, SHADOW_FRAGMENT, SHADOW_VERTEX } from './hair-shaders.js';

const WIDTHS = 17, ROW_POINTS = 1024; /* samples of the width along a strand; as in receiver-worker.js */
const SMOOTH_POINTS = 48;             /* along a strand: enough to look round */

/** Triangles between the vertices of each strand: two at each of its places, left and right. */
function ribbonGeometry(strands, stations) {
  const indices = new Uint32Array(6 * strands * (stations - 1));
  for (let s = 0, at = 0; s < strands; s++) {
    for (let i = 0, v = 2 * s * stations; i < stations - 1; i++, v += 2) {
      indices.set([v, v + 1, v + 2, v + 3, v + 2, v + 1], at);
      at += 6;
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  return geometry;
}

function resample(widths) {
  return Array.from({ length: WIDTHS }, (_, i) => {
    const at = i / (WIDTHS - 1) * (widths.length - 1), from = Math.min(Math.floor(at), widths.length - 2);
    return widths[from] + (widths[from + 1] - widths[from]) * (at - from);
  });
}

export class HairMesh extends THREE.Mesh {
  /** `light`: a Light (light.js), which the hair is lit by and throws shadows in. */
  constructor(light) {
    super(new THREE.BufferGeometry());
    this.light = light;
    this.frustumCulled = false; /* its points are not where three.js looks for them */
    const strand = { before: { value: null }, positions: { value: null }, weight: { value: 1 }, points: { value: 2 }, widths: { value: new Array(WIDTHS).fill(0) }, share: { value: 1 } };
    this.uniforms = {
      ...strand, ...light.uniforms, leastWidth: { value: 0.9 }, viewHeight: { value: 720 },
      pieces: { value: 1 }, headCentre: { value: new THREE.Vector3() }, hairColour: { value: new THREE.Color(0.13, 0.07, 0.035) },
    };
    this.material = new THREE.ShaderMaterial({ uniforms: this.uniforms, vertexShader: HAIR_VERTEX, fragmentShader: HAIR_FRAGMENT, side: THREE.DoubleSide });
    this.shadow = new THREE.ShaderMaterial({ uniforms: { ...strand, pieces: { value: 1 }, leastWidth: { value: 1 }, viewHeight: { value: 512 } },
      vertexShader: SHADOW_VERTEX, fragmentShader: SHADOW_FRAGMENT, side: THREE.DoubleSide });
    Object.assign(this, { strands: 0, points: 0, from: null, to: null, textures: [] });
    this.visible = false;
    light.addBlocker(this, this.shadow);
  }

  /** What is between two frames, as receiver-worker.js gives them; `weight`: of the second one. Both may be the same. */
  show(from, to, weight) {
    const { uniforms } = this;
    if (to.strands !== this.strands || to.points !== this.points) {
      this.makeRoom(to.strands, to.points, to.positions.length);
    }
    if (this.to !== to) {
      this.swap();
      this.fill(uniforms.positions.value, to);
      uniforms.widths.value = resample(to.widths);
      this.light.dirty = true;
    }
    if (this.from !== from && from !== to) { /* of one frame alone the weight is 1 */
      this.fill(uniforms.before.value, from);
    }
    Object.assign(this, { from, to, visible: true });
    uniforms.weight.value = from === to ? 1 : weight;
  }

  /** The second frame becomes the first. */
  swap() {
    const { before, positions } = this.uniforms;
    [before.value, positions.value] = [positions.value, before.value];
    this.from = this.to;
  }

  fill(texture, { positions }) {
    texture.image.data = positions;
    texture.needsUpdate = true;
  }

  makeRoom(strands, points, floats) {
    const pieces = Math.max(1, Math.round(SMOOTH_POINTS / points)), standIn = this.light.blockers.get(this);
    [this.geometry, standIn.geometry, ...this.textures].forEach((part) => part?.dispose());
    this.geometry = ribbonGeometry(strands, (points - 1) * pieces + 1);
    standIn.geometry = pieces > 1 ? ribbonGeometry(strands, points) : this.geometry; /* a shadow need not be round */
    this.textures = [0, 1].map(() => new THREE.DataTexture(new Float32Array(floats), ROW_POINTS, floats / 4 / ROW_POINTS, THREE.RGBAFormat, THREE.FloatType));
    this.textures.forEach((texture) => { texture.needsUpdate = true; });
    [this.uniforms.before.value, this.uniforms.positions.value] = this.textures;
    Object.assign(this, { strands, points, from: null, to: null });
    this.uniforms.points.value = points;
    this.uniforms.pieces.value = pieces;
  }

  hide() {
    this.visible = false;
    this.light.dirty = true;
  }

  onBeforeRender(renderer) {
    this.uniforms.headCentre.value.setFromMatrixPosition(this.matrixWorld);
    this.uniforms.viewHeight.value = renderer.getCurrentViewport(VIEWPORT).w;
    this.light.update(renderer, this.uniforms.headCentre.value);
  }

  dispose() {
    this.light.removeBlocker(this);
    [this.geometry, this.material, this.shadow, ...this.textures].forEach((part) => part?.dispose());
  }
}

const VIEWPORT = new THREE.Vector4();
