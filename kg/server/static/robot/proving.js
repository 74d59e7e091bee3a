// Why the robot can do something, step by step: the proof as nested lists, asked of the server when somebody opens it.

import { element } from "../table.js";
import { ask } from "./services.js";

const WORDS = { "rdf:type": "is a", "rdfs:label": "is called" };

/** Return what is opened to see the proofs of a capability; `key` tells it from others when the list is drawn anew. */
export function proofs(capability, key) {
  const body = element("div", {}, element("p", {}, "Looking …"));
  const made = element("details", { className: "robot-proof" }, element("summary", { id: `${key}-summary` }, "Step by step"), body);
  made.dataset.key = key;
  made.addEventListener("toggle", async () => {
    if (!made.open || body.dataset.told) return;
    body.dataset.told = "yes";
    try {
      const found = await ask(`/robot/why?capability=${encodeURIComponent(capability.name)}`);
      body.replaceChildren(...found.proofs.map((proof) => element("ul", { className: "proof" }, fact(proof))));
    } catch (error) {
      delete body.dataset.told;
      body.replaceChildren(element("p", {}, error.message));
    }
  });
  return made;
}

function fact(proof) {
  const made = element("li", {}, element("span", { className: "fact", title: proof.text }, sentence(proof)));
  if (proof.again) made.append(element("span", { className: "by" }, " (as above)"));
  if (proof.rule) made.append(rule(proof.rule));
  else if (proof.evidence) made.append(element("div", { className: "by" }, place(proof.evidence)));
  const below = [...(proof.premises ?? []).map(fact), ...(proof.conditions ?? []).map(condition)];
  if (below.length) made.append(element("ul", {}, ...below));
  return made;
}

function sentence({ subject, predicate, object }) {
  return `${subject.label} ${WORDS[predicate.short] ?? predicate.label} ${object.label}`;
}

function rule({ name, title, evidence }) {
  const made = element("div", { className: "by" }, `by the rule “${title || name}”`);
  made.title = `${name}, ${place(evidence)}`;
  return made;
}

function condition({ text, count }) {
  return element("li", { className: "condition" }, `and it holds that ${text}${count === null ? "" : `, over ${count}`}`);
}

/** Where a fact was found: a file with its line, or the node that was seen, its address and since when. */
const place = ({ path, line }) => (line ? `${path}:${line}` : path);
