// Subscribes to all topics of a run as Foxglove does, and prints each message and status as a line of JSON.
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const json = (_, value) => (Number.isNaN(value) ? "nan" : typeof value === "bigint" ? Number(value) : value);
const print = (...line) => console.log(JSON.stringify(line, json));

const [url, subprotocol] = process.argv.slice(2);
const client = new FoxgloveClient({ ws: new WebSocket(url, [subprotocol]) });
const channels = new Map();
client.on("error", (error) => {
  console.error(error);
  process.exitCode = 1;
});
client.on("serverInfo", ({ name, capabilities, metadata }) => print("serverInfo", name, capabilities, metadata));
client.on("status", ({ level, message }) => print("status", level, message));
client.on("advertise", (advertised) => {
  client.getParameters([]);
  for (const { id, topic, encoding, schema, schemaEncoding } of advertised) {
    if (encoding !== "cdr" || schemaEncoding !== "ros2msg") throw new Error(`${topic}: ${encoding}, ${schemaEncoding}`);
    channels.set(client.subscribe(id), { topic, reader: new MessageReader(parse(schema, { ros2: true })) });
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const { topic, reader } = channels.get(subscriptionId);
  print("message", topic, String(timestamp), reader.readMessage(data));
});
