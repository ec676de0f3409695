// The page's data: deflated, its arrays as 16-bit differences (see packing.py).

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
function table({ at, rows, low, step }, bytes, start) {
  const columns = low.length;
  const values = new Float32Array(rows * columns);
  const lows = start + at;
  const highs = lows + rows * columns;
  for (let column = 0, next = 0; column < columns; column++) {
    let level = 0;
    for (let row = 0; row < rows; row++, next++) {
      const code = bytes[lows + next] | (bytes[highs + next] << 8);
      level = (level + (code & 1 ? -(code + 1) / 2 : code / 2)) & 0xffff;
      values[row * columns + column] = low[column] + level * step[column];
    }
  }
  return { values, rows, columns };
}
