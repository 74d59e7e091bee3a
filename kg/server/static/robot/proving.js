// Why the robot can do something, step by step: the proof as nested lists, requested when the user opens it.

import { element } from "../table.js";
import { ask } from "./services.js";

const WORDS = { "rdf:type": "is a", "rdfs:label": "is called" };

/** Return the element with the proofs of a capability; `key` identifies it when the list is drawn again. */
export function proofs(capability, key) {
  const body = element("div", {}, element("p", {}, "Looking …"));
  const node = element("details", { className: "robot-proof" }, element("summary", { id: `${key}-summary` }, "Step by step"), body);
  node.dataset.key = key;
  node.addEventListener("toggle", async () => {
    if (!node.open || body.dataset.loaded) return;
    body.dataset.loaded = "yes";
    try {
      const found = await ask(`/robot/why?capability=${encodeURIComponent(capability.name)}`);
      body.replaceChildren(...found.proofs.map((proof) => element("ul", { className: "proof" }, fact(proof))));
    } catch (error) {
      delete body.dataset.loaded;
      body.replaceChildren(element("p", {}, error.message));
    }
  });
  return node;
}

function fact(proof) {
  const node = element("li", {}, element("span", { className: "fact", title: proof.text }, sentence(proof)));
  if (proof.again) node.append(element("span", { className: "by" }, " (as above)"));
  if (proof.rule) node.append(rule(proof.rule));
  else if (proof.evidence) node.append(element("div", { className: "by" }, place(proof.evidence)));
  const below = [...(proof.premises ?? []).map(fact), ...(proof.conditions ?? []).map(condition)];
  if (below.length) node.append(element("ul", {}, ...below));
  return node;
}

function sentence({ subject, predicate, object }) {
  return `${subject.label} ${WORDS[predicate.short] ?? predicate.label} ${object.label}`;
}

function rule({ name, title, evidence }) {
  const node = element("div", { className: "by" }, `by the rule “${title || name}”`);
  node.title = `${name}, ${place(evidence)}`;
  return node;
}

function condition({ text, count }) {
  return element("li", { className: "condition" }, `and it holds that ${text}${count === null ? "" : `, over ${count}`}`);
}

/** Source of a fact: a file with its line, or the node seen, its address and since when. */
const place = ({ path, line }) => (line ? `${path}:${line}` : path);
