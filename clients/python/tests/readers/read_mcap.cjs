// Prints topic, times and values of each message as a line of JSON, by the libraries of Foxglove and Lichtblick.
const { open } = require("node:fs/promises");
const { McapIndexedReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const lz4 = require("@foxglove/wasm-lz4");

const json = (_, value) => (Number.isNaN(value) ? "nan" : typeof value === "bigint" ? Number(value) : value);

async function main(path, order) {
  await lz4.isLoaded;
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const decompressHandlers = { lz4: (bytes, size) => lz4(bytes, Number(size)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoders = new Map();
  for (const { id, schemaId } of reader.channelsById.values()) {
    const text = new TextDecoder().decode(reader.schemasById.get(schemaId).data);
    decoders.set(id, new MessageReader(parse(text, { ros2: true })));
  }
  for await (const message of reader.readMessages({ reverse: order === "backwards" })) {
    const { topic } = reader.channelsById.get(message.channelId);
    const values = decoders.get(message.channelId).readMessage(message.data);
    // Times as texts: a number of JavaScript has too few digits.
    const times = [message.logTime, message.publishTime].map(String);
    console.log(JSON.stringify([topic, ...times, values], json));
  }
  await file.close();
}

main(...process.argv.slice(2));
