// frame.mjs: reads a GLB with Draco-compressed primitives, with nothing of awtd's own code: container and JSON by hand,
// geometry by draco3d (Google's decoder compiled to WebAssembly).
import draco3d from 'draco3d';

const GLB_MAGIC = 0x46546c67, CHUNK_JSON = 0x4e4f534a, CHUNK_BINARY = 0x004e4942;

let dracoModule;

/** The JSON and the binary chunk of a GLB. */
export function splitGlb(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.byteLength < 12 || view.getUint32(0, true) !== GLB_MAGIC || view.getUint32(4, true) !== 2) {
    throw new Error('not a GLB 2.0 file');
  }
  if (view.getUint32(8, true) !== bytes.byteLength) {
    throw new Error(`announces ${view.getUint32(8, true)} bytes and has ${bytes.byteLength}`);
  }
  const chunks = {};
  for (let at = 12; at < bytes.byteLength;) {
    const length = view.getUint32(at, true);
    chunks[view.getUint32(at + 4, true)] = bytes.subarray(at + 8, at + 8 + length);
    at += 8 + length;
  }
  const json = JSON.parse(new TextDecoder().decode(chunks[CHUNK_JSON]));
  return { json, binary: chunks[CHUNK_BINARY] ?? new Uint8Array() };
}

/** Draco's own view of one primitive's data, given to `use`; freed afterwards. */
function withMesh(draco, data, prepare, use) {
  const decoder = new draco.Decoder();
  const mesh = new draco.Mesh();
  try {
    prepare(decoder);
    const status = decoder.DecodeArrayToMesh(data, data.byteLength, mesh);
    if (!status.ok()) {
      throw new Error(`draco3d: ${status.error_msg()}`);
    }
    return use(decoder, mesh);
  } finally {
    draco.destroy(mesh);
    draco.destroy(decoder);
  }
}

function readPositions(draco, decoder, mesh, attribute) {
  const values = new draco.DracoFloat32Array();
  decoder.GetAttributeFloatForAllPoints(mesh, attribute, values);
  const positions = Float32Array.from({ length: values.size() }, (_, i) => values.GetValue(i));
  draco.destroy(values);
  return positions;
}

/** Whole numbers of an attribute, as they are. */
function readNumbers(draco, decoder, mesh, attribute) {
  const values = new draco.DracoInt16Array();
  if (attribute.data_type() !== draco.DT_INT16 || !decoder.GetAttributeInt16ForAllPoints(mesh, attribute, values)) {
    throw new Error('draco3d: an attribute is not of 16-bit numbers');
  }
  const numbers = Int16Array.from({ length: values.size() }, (_, i) => values.GetValue(i));
  draco.destroy(values);
  return numbers;
}

function readIndices(draco, decoder, mesh) {
  const count = mesh.num_faces() * 3;
  const pointer = draco._malloc(count * 4);
  decoder.GetTrianglesUInt32Array(mesh, count * 4, pointer);
  const indices = new Uint32Array(draco.HEAPF32.buffer, pointer, count).slice();
  draco._free(pointer);
  return indices;
}

/** The box that the positions were quantised in: { origin, range, bits, step }. */
function readBox(draco, decoder, mesh, attribute) {
  const transform = new draco.AttributeQuantizationTransform();
  transform.InitFromAttribute(attribute);
  const bits = transform.quantization_bits(), range = transform.range();
  const origin = [0, 1, 2].map((axis) => transform.min_value(axis));
  draco.destroy(transform);
  return { origin, range, bits, step: range / (2 ** bits - 1) };
}

function decodePrimitive(draco, json, binary, primitive) {
  const extension = primitive.extensions.KHR_draco_mesh_compression;
  const view = json.bufferViews[extension.bufferView];
  const data = new Int8Array(binary.buffer, binary.byteOffset + (view.byteOffset ?? 0), view.byteLength);
  const { POSITION: position, _STRAND, TEXCOORD_0, _WIDTH, ...others } = extension.attributes; // three are check_others.mjs'
  const attribute = (decoder, mesh, id) => decoder.GetAttributeByUniqueId(mesh, id);
  const decoded = withMesh(draco, data, () => {}, (decoder, mesh) => ({
    positions: readPositions(draco, decoder, mesh, attribute(decoder, mesh, position)),
    numbers: Object.fromEntries(Object.entries(others).map(([name, id]) =>
      [name, readNumbers(draco, decoder, mesh, attribute(decoder, mesh, id))])),
    indices: readIndices(draco, decoder, mesh),
  }));
  const box = withMesh(draco, data, (decoder) => decoder.SkipAttributeTransform(draco.POSITION),
    (decoder, mesh) => readBox(draco, decoder, mesh, attribute(decoder, mesh, position)));
  return { ...decoded, box };
}

/** The whole numbers [points][components] of a point cloud with one attribute. */
export async function readCloud(data) {
  const draco = dracoModule ??= await draco3d.createDecoderModule({});
  const decoder = new draco.Decoder(), cloud = new draco.PointCloud();
  try {
    const status = decoder.DecodeArrayToPointCloud(data, data.byteLength, cloud);
    if (!status.ok() || cloud.num_attributes() !== 1) {
      throw new Error(`draco3d: ${status.error_msg()}`);
    }
    return readNumbers(draco, decoder, cloud, decoder.GetAttribute(cloud, 0));
  } finally {
    draco.destroy(cloud);
    draco.destroy(decoder);
  }
}

/** { json, node, primitives: [{ positions, numbers, indices, box, mode, extras, accessors }] } of a frame:
 * numbers and accessors go by the attribute's name (and accessors.indices). `most`: primitives to
 * read. */
export async function readFrame(bytes, most = Infinity) {
  dracoModule ??= await draco3d.createDecoderModule({});
  const { json, binary } = splitGlb(bytes);
  const node = json.nodes[json.scenes[json.scene].nodes[0]];
  const primitives = json.meshes[node.mesh].primitives.slice(0, most).map((primitive) => ({
    ...decodePrimitive(dracoModule, json, binary, primitive),
    mode: primitive.mode,
    extras: primitive.extras ?? {},
    accessors: {
      position: json.accessors[primitive.attributes.POSITION],
      indices: json.accessors[primitive.indices],
      ...Object.fromEntries(Object.entries(primitive.attributes).map(([name, index]) => [name, json.accessors[index]])),
    },
  }));
  return { json, node, primitives };
}
