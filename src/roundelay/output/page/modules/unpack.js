// The page's data: deflated, its arrays as differences (see packing.py).

export async function unpack(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const head = new TextDecoder().decode(bytes.subarray(4, 4 + length));
  return JSON.parse(head, (_, value) => (isReference(value) ? table(value, bytes, 4 + length) : value));
}

function isReference(value) {
  return value !== null && typeof value === "object" && "at" in value && "rows" in value;
}

// Rows of numbers, one after the other, as {values, rows, columns}.
function table({ at, rows, planes, low, step }, bytes, start) {
  const columns = low.length;
  const count = rows * columns;
  const values = new Float32Array(count);
  const mask = 2 ** (8 * planes) - 1;
  for (let column = 0, next = start + at; column < columns; column++) {
    let level = 0;
    for (let row = 0; row < rows; row++, next++) {
      let code = 0;
      for (let plane = 0; plane < planes; plane++) code |= bytes[next + plane * count] << (8 * plane);
      level = (level + (code & 1 ? -(code + 1) / 2 : code / 2)) & mask;
      values[row * columns + column] = low[column] + level * step[column];
    }
  }
  return { values, rows, columns };
}
