// Packets from the server: a header in JSON followed by arrays, as frictionmap/explorer/packets.py packs them.

const TYPES = { Uint8Array, Int8Array, Float32Array, Float64Array };

/**
 * @param {ArrayBuffer} buffer
 * @returns {object} the header, with its arrays by their names, each with its `shape`
 */
export function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  for (const [name, place] of Object.entries(header.arrays)) {
    const count = place.shape.reduce((product, size) => product * size, 1);
    const values = new TYPES[place.type](buffer, 4 + length + place.at, count);
    values.shape = place.shape;
    header[name] = values;
  }
  delete header.arrays;
  return header;
}

/** Row k of an array of two dimensions. */
export function row(values, k) {
  const size = values.shape[1];
  return values.subarray(k * size, (k + 1) * size);
}
