// figure.js: the person under the hair: a mesh of the head's obstacles and one of the body's, lit like the hair.
import * as THREE from 'three';
import { LIGHT_SHADER } from '/awt/awt-hair.js';
import { armParts, DEFAULT_COLLIDERS, distance, faceParts, PAINT, shapeOf, softColourAt } from './body-shape.js';
import { surfaceOf } from './surface.js';

const CELL_M = { head: 0.004, body: 0.008 }, COARSER = 2, MARGIN_M = 0.03, FRAMES = ['head', 'body'];

/** Obstacles as CREATE_REPLY lists them, as parts; the default ones where the list is none. */
function partsOf(colliders) {
  const sound = Array.isArray(colliders) && colliders.length <= 16 &&
    colliders.every((c) => ['frame', 'ax', 'ay', 'az', 'radius_a', 'bx', 'by', 'bz', 'radius_b'].every((name) => Number.isFinite(c?.[name]) && Math.abs(c[name]) < 2));
  if (!sound) {
    return DEFAULT_COLLIDERS;
  }
  return colliders.filter(({ frame }) => FRAMES[frame]).map((c) => (
    { frame: FRAMES[c.frame], a: [c.ax, c.ay, c.az], b: [c.bx, c.by, c.bz], radius_a: c.radius_a, radius_b: c.radius_b }));
}

function geometryOf(parts, cell) {
  const shapes = parts.map((part) => shapeOf(part));
  const reach = (pick, sign) => [0, 1, 2].map((k) => pick(...parts.flatMap((p) => [p.a[k] + sign * p.radius_a, p.b[k] + sign * p.radius_b])) + sign * MARGIN_M);
  const { positions, normals, indices } = surfaceOf((x, y, z) => distance(shapes, x, y, z), reach(Math.min, -1), reach(Math.max, 1), cell);
  const colours = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i += 3) {
    colours.set(softColourAt(shapes, positions.slice(i, i + 3)), i);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
  geometry.setIndex(indices);
  return geometry;
}

export class Figure {
  /** coarse: a quarter of the triangles, where drawing is slow. */
  constructor(scene, light, { coarse = false } = {}) {
    Object.assign(this, { scene, light, coarser: coarse ? COARSER : 1, meshes: {} });
    this.materials = Object.fromEntries(FRAMES.map((frame) => [frame, new THREE.ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, vertexColors: true, uniforms: {
        ...light.uniforms, faceRadius: { value: 0 }, strokes: { value: PAINT.map(({ a, b }) => new THREE.Vector4(...a, ...b)) },
        strokeColours: { value: PAINT.map(({ colour, radius }) => new THREE.Vector4(...colour, radius)) },
      } })]));
    this.shape(null);
  }

  /** Takes the shape of these obstacles. */
  shape(colliders) {
    const parts = partsOf(colliders), head = parts.filter(({ frame }) => frame === 'head');
    const radius = Math.max(0, ...head.map((part) => Math.max(part.radius_a, part.radius_b)));
    this.materials.head.uniforms.faceRadius.value = radius;
    for (const frame of FRAMES) {
      const own = parts.filter((part) => part.frame === frame);
      own.push(...(frame === 'body' ? armParts(own) : radius > 0 ? faceParts(radius) : []));
      this.replace(frame, own.length > 0 ? geometryOf(own, CELL_M[frame] * this.coarser) : null);
    }
  }

  replace(frame, geometry) {
    const before = this.meshes[frame];
    if (before) {
      this.light.removeBlocker(before);
      before.removeFromParent();
      before.geometry.dispose();
    }
    const mesh = geometry ? new THREE.Mesh(geometry, this.materials[frame]) : null;
    this.meshes[frame] = mesh;
    if (mesh) {
      this.scene.add(mesh);
      this.light.addBlocker(mesh);
    }
  }

  place(frame, { position, orientation }) {
    const mesh = this.meshes[frame];
    if (mesh) {
      mesh.position.set(...position);
      mesh.quaternion.set(...orientation);
      mesh.updateMatrixWorld(true);
      this.light.dirty = true;
    }
  }
}

const VERTEX = /* glsl */ `
  out vec3 worldPlace, worldNormal, ownPlace, ownColour;
  void main() {
    ownPlace = position;
    ownColour = color;
    worldPlace = (modelMatrix * vec4(position, 1.0)).xyz;
    worldNormal = mat3(modelMatrix) * normal;
    gl_Position = projectionMatrix * viewMatrix * vec4(worldPlace, 1.0);
  }`;

const FRAGMENT = /* glsl */ `
  ${LIGHT_SHADER}
  uniform float faceRadius;
  uniform vec4 strokes[${PAINT.length}], strokeColours[${PAINT.length}];
  in vec3 worldPlace, worldNormal, ownPlace, ownColour;

  vec3 painted(vec3 colour) {
    vec3 at = ownPlace / max(faceRadius, 1e-3);
    if (at.z < 0.0 || faceRadius <= 0.0) {
      return colour;
    }
    float edge = fwidth(at.x) + fwidth(at.y);
    for (int i = 0; i < ${PAINT.length}; i++) {
      vec2 a = strokes[i].xy, along = strokes[i].zw - a;
      float t = clamp(dot(at.xy - a, along) / max(dot(along, along), 1e-9), 0.0, 1.0);
      float far = length(at.xy - a - t * along) - strokeColours[i].a;
      colour = mix(colour, strokeColours[i].rgb, 1.0 - smoothstep(-edge, edge, far));
    }
    return colour;
  }

  void main() {
    vec3 normal = normalize(worldNormal), eye = normalize(cameraPosition - worldPlace), base = painted(ownColour);
    float skin = smoothstep(0.2, 0.5, ownColour.r);
    vec3 place = worldPlace + 0.004 * normal;
    float key = dot(normal, keyDirection), through = lightThrough(keyMap, keyMatrix, place, 0.012, 0.006);
    float sky = lightThrough(skyMap, skyMatrix, place, 0.03, 0.006);
    vec3 wrap = mix(vec3(0.05), vec3(0.28, 0.12, 0.08), skin); /* light that goes through skin comes out red */
    vec3 diffuse = max(vec3(0.0), (vec3(key) + wrap) / (1.0 + wrap)) * keyColour * through;
    diffuse += max(0.0, dot(normal, rimDirection)) * rimColour * 0.5 * sky;
    diffuse += skyColour * (0.62 + 0.24 * normal.y) * (0.5 + 0.5 * sky);
    float shine = pow(max(0.0, dot(normal, normalize(keyDirection + eye))), mix(10.0, 28.0, skin));
    float grazing = pow(1.0 - max(0.0, dot(normal, eye)), 4.0);
    vec3 sum = base * diffuse * 0.4 + keyColour * shine * through * mix(0.004, 0.04, skin) + skyColour * grazing * mix(0.02, 0.06, skin) * sky;
    gl_FragColor = vec4(sum, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;
