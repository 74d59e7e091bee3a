// The toolbox next to the blocks: patterns by their subject, conditions, values, conclusions.

import { packed } from "./terms.js";
import { nameFor } from "./vocabulary.js";
import { statement, termBlock, test } from "./writing.js";

const FIRST = ["ros:Node", "ros:Topic", "rnkg:MessageType", "ros:Service", "rnkg:Action", "ros:Publisher", "ros:Subscriber", "rnkg:Parameter", "ros:Package", "rnkg:LaunchConfiguration", "ros:Capability"];
const EACH = 24;
const NAMED = "rdfs:label";
/** Names of things that are handier than those of their class. */
const SHORT = {
  "ros:CommunicationComponent": "end", "rnkg:SourceFile": "file", "rnkg:MessageType": "type", "ros:Mode": "channel",
  "ros:Publisher": "sent", "ros:Subscriber": "received", "ros:ServiceServer": "served", "rnkg:LaunchConfiguration": "configuration" };

const thing = (name) => ({ term: "thing", name });
const text = (value) => ({ term: "text", value });
const offered = (state) => ({ kind: "block", ...state });
const category = (name, style, contents) => ({ kind: "category", name, categorystyle: style, contents });

/** Return the toolbox for the vocabulary of the store. */
export function toolbox(vocabulary) {
  const kinds = FIRST.filter((name) => vocabulary.byClass.has(name));
  return {
    kind: "categoryToolbox",
    contents: [
      ...kinds.map((kind) => category(capital(vocabulary.label(kind)), "movement", about(kind, vocabulary))),
      category("Anything", "sensing", [
        offered(statement({ block: "is", subject: thing("thing"), kind: "ros:Node" })),
        offered(statement({ block: "fact", subject: thing("thing"), property: "rdfs:label", object: text("a name") })),
        offered(statement({ block: "fact", subject: thing("thing"), property: "rnkg:name", object: thing("name") })),
      ]),
      category("Conditions", "conditions", conditions()),
      category("Values", "values", values()),
      category("Conclusions", "knowledge", conclusions()),
      category("SPARQL", "unknown", [offered({ type: "kr_sparql" }), offered({ type: "kr_says" }), offered({ type: "kr_formula" })]),
    ],
  };
}

const capital = (label) => label[0].toUpperCase() + label.slice(1);
const name = (kind) => SHORT[kind] ?? nameFor(kind);

/** Return the patterns about things of a class: its type, and its properties on this store, the most used first. */
function about(kind, vocabulary) {
  const subject = thing(name(kind));
  const properties = vocabulary.of(kind).filter((one) => /^(rnkg|ros|rdfs|skos):/.test(one.name));
  const rank = (one) => (one.name === NAMED ? 0 : one.literal ? 2 : 1);
  const facts = properties.sort((one, other) => rank(one) - rank(other)).slice(0, EACH);
  return [
    offered(statement({ block: "is", subject, kind })),
    ...facts.map((one) => offered(statement({ block: "fact", subject, property: one.name, object: objectOf(one, subject) }))),
  ];
}

/** Return the default object of a property: a thing named after the property's range, or a text. */
function objectOf(property, subject) {
  if (property.name === NAMED) return text("name");
  if (property.literal) return property.datatype === "xsd:boolean" ? { term: "truth", value: true } : thing(nameFor(property.name));
  const [leads] = property.to.length ? property.to : Object.entries(property.leads).sort(([, one], [, other]) => other - one).map(([kind]) => kind);
  const called = leads ? name(leads) : nameFor(property.name);
  return thing(called === subject.name ? `other${capital(called)}` : called);
}

function conditions() {
  const compare = { test: "compare", operator: "!=", left: thing("one"), right: thing("other") };
  return [
    offered(statement({ block: "absent", when: [] })),
    offered(statement({ block: "only", test: compare })),
    offered(statement({ block: "only", test: { test: "match", how: "CONTAINS", value: thing("name"), text: text("laser") } })),
    offered(statement({ block: "perhaps", when: [] })),
    offered(statement({ block: "either", branches: [[], []] })),
    offered(statement({ block: "present", when: [] })),
    offered(test(compare)),
    offered(test({ test: "match", how: "CONTAINS", value: thing("name"), text: text("laser") })),
    offered({ type: "kr_logic" }), offered({ type: "kr_not" }),
    offered({ type: "kr_known", fields: { NAME: packed(thing("thing")) } }),
  ];
}

function values() {
  return [
    offered(termBlock(thing("thing"))), offered(termBlock(text("text"))), offered(termBlock({ term: "number", value: "1" })),
    offered(termBlock({ term: "truth", value: true })),
    offered(statement({ block: "let", name: "value", value: text("text") })),
    offered({ type: "kr_join", inputs: { PART0: { shadow: termBlock(text("text ")) }, PART1: { shadow: termBlock(thing("name")) } } }),
    offered({ type: "kr_of", inputs: { OF: { shadow: termBlock(thing("name")) } } }),
    offered({ type: "kr_reckon", inputs: { LEFT: { shadow: termBlock({ term: "number", value: "1" }) }, RIGHT: { shadow: termBlock({ term: "number", value: "1" }) } } }),
  ];
}

function conclusions() {
  return [
    offered(statement({ block: "is", subject: thing("node"), kind: "my:NewKind" })),
    offered(statement({ block: "fact", subject: thing("node"), property: "my:newRelation", object: thing("topic") })),
    offered(statement({ block: "fact", subject: thing("node"), property: "rnkg:hasFunction", object: { term: "name", name: "function:hardware" } })),
    offered(statement({ block: "fact", subject: thing("node"), property: "rnkg:usesHardware", object: { term: "name", name: "hardware:lidar" } })),
    offered(statement({ block: "fact", subject: thing("node"), property: "rnkg:hasCapability", object: { term: "name", name: "capability:ranging" } })),
  ];
}
