// ---- codec.js: the page's data, as `Packed` (src/pack.rs) wrote it.

/** Everything but the packed arrays. */
const page = JSON.parse(document.getElementById("data").textContent);

/** Undoes base64, deflate, byte planes, folding and differences; gives an Int16Array. */
async function unpack(packed) {
  const bytes = await inflate(fromBase64(document.getElementById(packed.blob).textContent));
  const n = packed.count;
  const values = new Int16Array(n);
  for (let i = 0; i < n; i++) {
    const folded = bytes[i] | (bytes[n + i] << 8);
    values[i] = (folded >>> 1) ^ -(folded & 1);
  }
  // The last difference taken is the first undone. Int16Array wraps around as the writer did.
  for (const lag of [...packed.lags].reverse()) {
    for (let i = lag; i < n; i++) values[i] += values[i - lag];
  }
  return values;
}

function fromBase64(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("this browser cannot inflate the page's data; Chromium 103, Firefox 113 and Safari 16.4 can");
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
