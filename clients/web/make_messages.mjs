// make_messages.mjs PROTO_FOLDER > messages.mjs: the lists of messages.def and errors.def as a JavaScript module, for codec.js.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

/** { name: [[kind, field, argument], ...] } of all macros whose name begins with `prefix`. */
function fieldsOf(text, prefix) {
  const lists = {};
  for (const [, name, body] of text.matchAll(new RegExp(`#define ${prefix}(\\w+)\\(F\\)((?:.*\\\\\\n)*.*)`, 'g'))) {
    lists[name] = [...body.matchAll(/F\((\w+),\s*(\w+),\s*(?:\((\w+),\s*(\d+)\)|(\w+)),/g)].map(([, kind, field, record, most, argument]) =>
      (record ? [kind, field, record, Number(most)] : argument === '_' ? [kind, field] : [kind, field, Number(argument)]));
  }
  return lists;
}

const text = readFileSync(join(process.argv[2], 'messages.def'), 'utf8').replace(/"(?:[^"\\]|\\.)*"/g, '""');
const fields = fieldsOf(text, 'PROTO_FIELDS_');
const messages = [...text.matchAll(/MESSAGE\((\w+),\s*(\w+),\s*(0x[0-9a-fA-F]+), ([CSB])/g)].map(([, , name, id, who]) =>
  ({ name, id: Number(id), who, fields: fields[name] }));
const errors = [...readFileSync(join(process.argv[2], 'errors.def'), 'utf8').matchAll(/ERROR\((\w+),\s*(\d+),/g)]
  .map(([, name, number]) => [name, Number(number)]);
if (messages.length === 0 || errors.length === 0 || messages.some((message) => !message.fields)) {
  throw new Error('messages.def or errors.def does not read as it used to');
}
console.log(`// Made from messages.def and errors.def by make_messages.mjs.
export const RECORDS = ${JSON.stringify(fieldsOf(text, 'PROTO_RECORD_FIELDS_'))};
export const MESSAGES = ${JSON.stringify(messages)};
export const ERRORS = ${JSON.stringify(Object.fromEntries(errors))};`);
