// surface.js: a smooth mesh of where a distance function is zero, by surface nets: a vertex a cell that the surface crosses.

/** { positions, normals, indices } between `least` and `greatest` (three numbers each), cells of `size`. */
export function surfaceOf(distance, least, greatest, size) {
  const cells = least.map((from, k) => Math.ceil((greatest[k] - from) / size)), [nx, ny, nz] = cells.map((count) => count + 1);
  const field = new Float32Array(nx * ny * nz), at = (x, y, z) => x + nx * (y + ny * z);
  for (let z = 0; z < nz; z++) {
    for (let y = 0; y < ny; y++) {
      for (let x = 0; x < nx; x++) {
        field[at(x, y, z)] = distance(least[0] + x * size, least[1] + y * size, least[2] + z * size);
      }
    }
  }
  const positions = [], vertexOf = new Int32Array(field.length).fill(-1);
  for (let z = 0; z < nz - 1; z++) {
    for (let y = 0; y < ny - 1; y++) {
      for (let x = 0; x < nx - 1; x++) {
        const place = cellVertex(field, at, x, y, z);
        if (place) {
          vertexOf[at(x, y, z)] = positions.length / 3;
          positions.push(...place.map((value, k) => least[k] + value * size));
        }
      }
    }
  }
  return { positions: new Float32Array(positions), normals: normalsOf(distance, positions), indices: quadsOf(field, at, vertexOf, [nx, ny, nz]) };
}

/** Mean of where the surface crosses the cell's edges, in cells; null where it crosses none. */
function cellVertex(field, at, x, y, z) {
  const sum = [0, 0, 0];
  let crossings = 0;
  for (let axis = 0; axis < 3; axis++) {
    for (let corner = 0; corner < 4; corner++) {
      const from = [0, 0, 0];
      from[(axis + 1) % 3] = corner & 1;
      from[(axis + 2) % 3] = corner >> 1;
      const to = [...from];
      to[axis] = 1;
      const a = field[at(x + from[0], y + from[1], z + from[2])], b = field[at(x + to[0], y + to[1], z + to[2])];
      if (a < 0 !== b < 0) {
        from[axis] = a / (a - b);
        from.forEach((value, k) => { sum[k] += value; });
        crossings++;
      }
    }
  }
  return crossings ? [x, y, z].map((value, k) => value + sum[k] / crossings) : null;
}

/** Two triangles about every edge of the grid that the surface crosses, seen from outside. */
function quadsOf(field, at, vertexOf, counts) {
  const indices = [], steps = [1, counts[0], counts[0] * counts[1]];
  for (let z = 1; z < counts[2] - 1; z++) {
    for (let y = 1; y < counts[1] - 1; y++) {
      for (let x = 1; x < counts[0] - 1; x++) {
        const here = at(x, y, z), inside = field[here] < 0;
        for (let axis = 0; axis < 3; axis++) {
          if (inside !== field[here + steps[axis]] < 0) {
            const u = steps[(axis + 1) % 3], v = steps[(axis + 2) % 3];
            const [a, b, c, d] = [here - u - v, here - v, here, here - u].map((cell) => vertexOf[cell]);
            indices.push(...(inside ? [a, b, c, a, c, d] : [a, c, b, a, d, c]));
          }
        }
      }
    }
  }
  return indices;
}

function normalsOf(distance, positions) {
  const normals = new Float32Array(positions.length), step = 5e-4;
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = positions.slice(i, i + 3), d = distance(x, y, z);
    const way = [distance(x + step, y, z) - d, distance(x, y + step, z) - d, distance(x, y, z + step) - d], long = Math.hypot(...way) || 1;
    normals.set(way.map((value) => value / long), i);
  }
  return normals;
}
