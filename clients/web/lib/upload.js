// upload.js: a file to awtd in pieces, each when the one before has come (UPLOAD in proto/PROTOCOL.md).

const PIECE = 1 << 18, MOST = 256 << 20;
let last = 0;

/** The upload's number. `progress` is told the share that has come; `stopped` may say that nobody wants it any more. */
export async function upload(connection, bytes, progress = () => {}) {
  if (bytes.length === 0 || bytes.length > MOST) {
    throw new Error(bytes.length ? 'the file is longer than 256 MiB' : 'the file is empty');
  }
  const number = ++last, sha256 = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
  for (let offset = 0; offset < bytes.length; offset += PIECE) {
    const piece = bytes.subarray(offset, offset + PIECE);
    await connection.ask('upload', { upload: number, total: BigInt(bytes.length), offset: BigInt(offset), sha256, piece });
    progress((offset + piece.length) / bytes.length);
  }
  return number;
}
