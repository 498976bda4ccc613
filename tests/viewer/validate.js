// What the Khronos validator says of models. In, as JSON: {"files": [paths], "warnings": whether to list them, by
// default}. Out, as JSON: how many files were looked at, and their errors and warnings.

import { readFile } from "node:fs/promises";
import { text } from "node:stream/consumers";
import validator from "gltf-validator";

const [ERROR, WARNING] = [0, 1]; // Above are hints.

const { files, warnings = true } = JSON.parse(await text(process.stdin));
const messages = [];
for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(await readFile(file)), { uri: file });
  const grave = issues.messages.filter(({ severity }) => severity <= (warnings ? WARNING : ERROR));
  messages.push(...grave.map(({ code, message, pointer }) => `${file} ${pointer}: ${code}, ${message}`));
}
console.log(JSON.stringify({ files: files.length, messages }));
