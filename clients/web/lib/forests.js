// forests.js: forests made and opened on a connection: the recipe, the file that goes before it, what comes back.
import { upload } from './upload.js';

const REST = { position: [0, 1.6, 0], orientation: [0, 0, 0, 1] };
const STAGES = ['waiting', 'reading the strands', 'building the wisps', 'preparing to draw'];
const hexOf = (bytes) => [...bytes].map((byte) => byte.toString(16).padStart(2, '0')).join('');
const bytesOf = (hex) => Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));

/** A new forest. `busy(what, share)`: how far that has come; share null: not known. */
async function make(connection, { file, clock, ...recipe }, busy) {
  const head = recipe.head ?? REST, body = recipe.body ?? REST;
  const params = Object.entries(recipe.params ?? {}).map(([name, value]) => ({ name, value }));
  busy(file ? 'sending the file' : 'growing hair', 0);
  const source = file ? { source: 1, upload: await upload(connection, file, (share) => busy('sending the file', share)) } : {};
  const made = await connection.ask('create', { style: 'long', ...recipe, ...source, params, head, body, progress: 1 },
    { progress: ({ stage, share }) => busy(STAGES[stage] ?? 'working', share || null) });
  return { ...made, handle: made.forest, isNew: true, mayDrive: true, time_us: BigInt(recipe.time_us ?? 0), driveToken: hexOf(made.drive_token), viewToken: hexOf(made.view_token) };
}

async function open(connection, { forest, token }) {
  const opened = await connection.ask('attach', { forest, token: bytesOf(token) });
  return { ...opened, handle: forest, isNew: false, mayDrive: opened.may_drive === 1, colliders: null };
}

/** The forest that is wanted: { forest, token }, or { recipe, made }: what was made before a connection was lost may live on. */
export async function makeOrOpen(connection, { recipe, made, ...where }, busy) {
  if (!recipe) {
    return open(connection, where);
  }
  try {
    return made ? { ...made, ...await open(connection, { forest: made.handle, token: made.driveToken }), colliders: made.colliders } : await make(connection, recipe, busy);
  } catch (error) {
    if (made && error.code === 'NO_FOREST') {
      return make(connection, recipe, busy);
    }
    throw error;
  }
}
