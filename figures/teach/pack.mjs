// SPDX-License-Identifier: GPL-3.0-or-later
// Makes one script of what Emscripten writes: node pack.mjs GLUE.js MODULE.wasm OUT.js
// The module lies in it compressed, as text: it is half as large as without, and a page opens it
// from disk without a request. Lagrain() gives the module, as Emscripten's own function does.
import { readFileSync, writeFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const [glue, wasm, out] = process.argv.slice(2);
const packed = gzipSync(readFileSync(wasm), { level: 9 }).toString('base64');

writeFileSync(out, `${readFileSync(glue, 'utf8')}
Lagrain = (make => async options => {
  const text = atob('${packed}');
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return make({ ...options, wasmBinary: await new Response(unpacked).arrayBuffer() });
})(Lagrain);
if (typeof module === 'object') module.exports = Lagrain;
`);
