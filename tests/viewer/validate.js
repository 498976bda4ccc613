// What the Khronos validator says of models. In, as JSON: {"files": [paths]}. Out, as JSON: how many files were looked at,
// and their errors and warnings.

import { readFile } from "node:fs/promises";
import { text } from "node:stream/consumers";
import validator from "gltf-validator";

const WARNING = 1; // 0 is an error; above are hints.

const { files } = JSON.parse(await text(process.stdin));
const messages = [];
for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(await readFile(file)), { uri: file });
  const grave = issues.messages.filter(({ severity }) => severity <= WARNING);
  messages.push(...grave.map(({ code, message, pointer }) => `${file} ${pointer}: ${code}, ${message}`));
}
console.log(JSON.stringify({ files: files.length, messages }));
