// Reads what Reel writes: base64 of deflated bytes, whole numbers of seven bits a byte.

/**
 * @param {string} text base64
 * @returns {Uint8Array}
 */
export function from_base64(text) {
  const binary = atob(text.trim());
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/**
 * @param {Uint8Array} bytes of a zlib stream
 * @returns {Promise<Uint8Array>}
 */
export async function inflate(bytes) {
  const stream = new Blob([/** @type {BlobPart} */ (bytes)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Whole numbers one after another. */
export class Numbers {
  /** @param {Uint8Array} bytes */
  constructor(bytes) {
    this.bytes = bytes;
    this.place = 0;
  }

  /** @returns {number} */
  next() {
    let value = 0,
      unit = 1,
      byte = 0;
    do {
      byte = this.bytes[this.place++];
      value += (byte & 127) * unit;
      unit *= 128;
    } while (byte & 128);
    return value % 2 ? -(value + 1) / 2 : value / 2;
  }
}
