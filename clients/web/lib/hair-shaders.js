// hair-shaders.js: strands as ribbons that face the camera, shaded as Kajiya and Kay have it: light along the strand, a highlight
// of the light's own colour shifted to the root, a second one of the hair's colour shifted to the tip.
import { LIGHT_SHADER } from './light.js';

/* There are no attributes: a vertex's number says strand, place along it and side, and the points are in a texture. Between two
 * points goes a curve (Catmull-Rom) through them and their neighbours, in straight pieces. */
const STRAND = /* glsl */ `
  uniform highp sampler2D before, positions; /* of two frames; 1024 points a row */
  uniform float weight;      /* of the second one */
  uniform int points;        /* of a strand */
  uniform int pieces;        /* between two of them */
  uniform float widths[17];  /* metres, from root to tip */
  uniform float share;       /* of the strands that are drawn */
  uniform float leastWidth;  /* pixels */
  uniform float viewHeight;  /* pixels */

  vec3 pointAt(int n) {
    ivec2 place = ivec2(n & 1023, n >> 10);
    return mix(texelFetch(before, place, 0).xyz, texelFetch(positions, place, 0).xyz, weight);
  }

  float randomOf(int n) {
    uint x = uint(n) * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return float((x >> 22u) ^ x) / 4294967295.0;
  }

  float sideOf() {
    return (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  }

  float widthAt(float along) {
    float at = clamp(along, 0.0, 1.0) * 16.0;
    int i = min(int(at), 15);
    return mix(widths[i], widths[i + 1], at - float(i));
  }

  /* The place in view space, and direction and place of the centre line in the world. False: there is no piece here. */
  bool placeStrand(out vec3 place, out vec3 centre, out vec3 tangent, out float along, out float grain) {
    int stations = (points - 1) * pieces + 1, station = (gl_VertexID >> 1) % stations, strand = (gl_VertexID >> 1) / stations;
    grain = randomOf(strand);
    if (randomOf(strand + 7919) > share) {
      return false;
    }
    int i = min(station / pieces, points - 2), n = strand * points + i;
    float t = float(station - i * pieces) / float(pieces);
    vec3 from = pointAt(n), to = pointAt(n + 1);
    vec3 p = i == 0 ? 2.0 * from - to : pointAt(n - 1), q = i == points - 2 ? 2.0 * to - from : pointAt(n + 2);
    vec3 a = -p + 3.0 * from - 3.0 * to + q, b = 2.0 * p - 5.0 * from + 4.0 * to - q, c = to - p;
    vec3 at = 0.5 * (((a * t + b) * t + c) * t + 2.0 * from);
    vec3 way = (3.0 * a * t + 2.0 * b) * t + c;
    along = (float(i) + t) / float(points - 1);
    centre = (modelMatrix * vec4(at, 1.0)).xyz;
    tangent = normalize(mat3(modelMatrix) * (dot(way, way) > 1e-14 ? way : vec3(0.0, -1.0, 0.0)));
    vec3 view = (viewMatrix * vec4(centre, 1.0)).xyz, along3 = mat3(viewMatrix) * tangent;
    bool flatView = projectionMatrix[3][3] == 1.0;
    vec3 side = cross(along3, flatView ? vec3(0.0, 0.0, -1.0) : normalize(view));
    float long3 = length(side);
    side = long3 > 1e-4 ? side / long3 : vec3(1.0, 0.0, 0.0);
    float pixel = 2.0 / (projectionMatrix[1][1] * viewHeight) * (flatView ? 1.0 : max(-view.z, 0.01));
    float wide = max(widthAt(along) * (0.75 + 0.5 * grain), leastWidth * pixel);
    place = view + side * (0.5 * wide * sideOf());
    return true;
  }`;

const NOWHERE = 'gl_Position = vec4(2.0, 2.0, 2.0, 1.0);';

/** What the lights' maps see of the hair. */
export const SHADOW_VERTEX = /* glsl */ `
  ${STRAND}
  void main() {
    vec3 place, centre, tangent;
    float along, grain;
    ${NOWHERE}
    if (placeStrand(place, centre, tangent, along, grain)) {
      gl_Position = projectionMatrix * vec4(place, 1.0);
    }
  }`;
export const SHADOW_FRAGMENT = 'void main() { gl_FragColor = vec4(1.0); }';

/* Depth of hair above a point dims it; found for each vertex, of which there are plenty. */
export const HAIR_VERTEX = /* glsl */ `
  ${STRAND}
  ${LIGHT_SHADER}
  uniform vec3 headCentre;
  out vec3 worldPlace, worldTangent, outward;
  out float across, alongStrand, grainOfStrand, keyReaches, skyReaches, loose;
  void main() {
    vec3 place, centre, tangent;
    float along, grain;
    ${NOWHERE}
    if (!placeStrand(place, centre, tangent, along, grain)) {
      return;
    }
    gl_Position = projectionMatrix * vec4(place, 1.0);
    worldPlace = centre;
    worldTangent = tangent;
    vec3 away = centre - headCentre;
    outward = away - dot(away, tangent) * tangent;
    loose = smoothstep(0.18, 0.4, length(away));
    across = sideOf();
    alongStrand = along;
    grainOfStrand = grain;
    keyReaches = lightThrough(keyMap, keyMatrix, centre, 0.02, 0.003);
    skyReaches = lightThrough(skyMap, skyMatrix, centre, 0.035, 0.003);
  }`;

export const HAIR_FRAGMENT = /* glsl */ `
  uniform vec3 keyDirection, keyColour, rimDirection, rimColour, skyColour, hairColour;
  in vec3 worldPlace, worldTangent, outward;
  in float across, alongStrand, grainOfStrand, keyReaches, skyReaches, loose;

  /* Cone of light about the strand, tilted by shift towards the tip. */
  float lobe(float sinLight, float sinEye, float shift, float power) {
    float cosLight = sqrt(max(0.0, 1.0 - sinLight * sinLight)), cosEye = sqrt(max(0.0, 1.0 - sinEye * sinEye));
    float near = cosLight * cosEye * sqrt(1.0 - shift * shift) - sinLight * sinEye + shift * (sinLight + sinEye);
    return pow(clamp(near, 0.0, 1.0), power);
  }

  vec3 lit(vec3 direction, vec3 light, vec3 tangent, vec3 normal, vec3 eye, vec3 base, float reaches) {
    float sinLight = dot(tangent, direction), sinEye = dot(tangent, eye);
    float side = max(0.0, (dot(normal, direction) + 0.35) / 1.35);
    float facing = side + 0.6 * loose * max(0.0, 0.6 - side); /* what hangs free has no side of its own */
    float wobble = 0.06 * (grainOfStrand - 0.5);
    float diffuse = 0.5 * sqrt(max(0.0, 1.0 - sinLight * sinLight));
    float glint = 0.075 * lobe(sinLight, sinEye, -0.09 + wobble, 110.0);
    float glow = 0.7 * lobe(sinLight, sinEye, 0.13 + wobble, 24.0);
    float through = pow(max(0.0, -dot(direction, eye)), 4.0) * (0.3 + 0.7 * alongStrand); /* tips let light pass */
    return light * reaches * (facing * (vec3(glint) + base * (diffuse + glow)) + 0.9 * through * base);
  }

  void main() {
    vec3 tangent = normalize(worldTangent), eye = normalize(cameraPosition - worldPlace);
    vec3 normal = normalize(outward + 1e-5 * eye);
    float root = smoothstep(0.0, 0.3, alongStrand), tone = 0.72 + 0.56 * grainOfStrand;
    float warm = 0.94 + 0.12 * fract(grainOfStrand * 7.0);
    vec3 base = hairColour * tone * vec3(warm, 1.0, 1.0 / warm) * (0.7 + 0.3 * root + 0.25 * alongStrand * alongStrand);
    float round3 = 1.0 - 0.35 * across * across; /* a strand is round */
    vec3 sum = lit(keyDirection, keyColour, tangent, normal, eye, base, keyReaches);
    sum += lit(rimDirection, rimColour, tangent, normal, eye, base, skyReaches);
    sum += skyColour * base * (0.2 + 0.5 * skyReaches) * (0.65 + 0.35 * normal.y) * (0.45 + 0.55 * root);
    gl_FragColor = vec4(sum * round3, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;
