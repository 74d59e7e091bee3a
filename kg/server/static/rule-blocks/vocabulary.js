// The vocabulary of the store: classes and properties, and which of them combine.

const RELATION = /^[A-Za-z]\w*$/;
/** The source of a thing describes it least: these come last. */
const LAST = new Set(["rnkg:path", "rnkg:line", "rnkg:order", "rnkg:declaredIn", "rnkg:declaredBy", "rdfs:comment"]);

export class Vocabulary {
  constructor({ classes, properties }) {
    this.classes = classes;
    this.properties = properties;
    this.byClass = new Map(classes.map((one) => [one.name, one]));
    this.byProperty = new Map(properties.map((one) => [one.name, one]));
  }

  /** Return the name of a term as people read it. */
  label(name) {
    const known = this.byProperty.get(name) ?? this.byClass.get(name);
    return known?.label ?? spoken(name);
  }

  /** Return a class with all its superclasses. */
  above(name, found = new Set()) {
    if (!found.has(name)) {
      found.add(name);
      for (const one of this.byClass.get(name)?.supers ?? []) this.above(one, found);
    }
    return found;
  }

  /** Whether a thing may be of both classes by the ontology: one is a subclass of the other. */
  related(one, other) {
    return this.above(one).has(other) || this.above(other).has(one);
  }

  /** Return the classes that things of a rule are of: name to lists, of each of which one must fit. `but` is an omitted block. */
  kinds(rule, but = "") {
    const found = new Map();
    const add = (term, classes) => {
      if (term?.term === "thing" && classes?.length) found.set(term.name, [...(found.get(term.name) ?? []), classes]);
    };
    for (const one of every(rule)) {
      if (one.id && one.id === but) continue;
      if (one.block === "is") add(one.subject, [one.kind]);
      if (one.block !== "fact") continue;
      const property = this.byProperty.get(one.property);
      add(one.subject, property?.from);
      add(one.object, property?.to);
    }
    return found;
  }

  /** Return the class that best describes a thing of these kinds: an asserted one, else an inferred one. */
  main(kinds = []) {
    const single = kinds.filter((classes) => classes.length === 1).map(([name]) => name);
    return single.find((one) => !single.some((other) => other !== one && this.above(other).has(one) && other !== one)) ?? kinds[0]?.[0] ?? "";
  }

  /** Whether a thing of these kinds may stand before (`from`) or behind (`to`) a property. */
  fits(property, side, kinds = []) {
    const known = this.byProperty.get(property);
    if (!known) return true;
    const seen = side === "from" ? known.of : known.leads;
    if (side === "to" && known.literal) return !kinds.length;
    const wanted = known[side];
    return !wanted.length || kinds.every((classes) => classes.some((one) => seen[one] || wanted.some((other) => this.related(one, other))));
  }

  /** Return the properties that a thing of a class has on this store, the most used first, each with `number`. */
  of(kind) {
    const own = this.properties.map((one) => ({ ...one, number: one.of[kind] ?? 0 }));
    const found = own.filter(({ number, from }) => number || from.some((one) => this.above(kind).has(one)));
    return found.sort((one, other) => LAST.has(one.name) - LAST.has(other.name) || other.number - one.number);
  }

  /** Return the misfits of a rule, as { id, message }. */
  misfits(rule) {
    const found = [];
    for (const one of every(rule)) {
      if (one.block !== "fact") continue;
      const kinds = this.kinds(rule, one.id);
      const property = this.byProperty.get(one.property);
      if (!property) continue;
      const { subject, object } = one;
      if (subject.term === "thing" && !this.fits(one.property, "from", kinds.get(subject.name))) {
        found.push({ id: one.id, message: `“${property.label}” is said of ${this.words(property.from)}, and \`${subject.name}\` is ${this.words([this.main(kinds.get(subject.name))])}` });
      }
      if (object.term === "thing" && !this.fits(one.property, "to", kinds.get(object.name))) {
        const what = property.literal ? "a text or a number" : this.words(property.to);
        found.push({ id: one.id, message: `“${property.label}” leads to ${what}, and \`${object.name}\` is ${this.words([this.main(kinds.get(object.name))])}` });
      }
      if (property.literal && object.term === "name") found.push({ id: one.id, message: `“${property.label}” leads to a text or a number, not to a thing` });
      if (!property.literal && property.to.length && ["text", "number", "truth"].includes(object.term)) {
        found.push({ id: one.id, message: `“${property.label}” leads to ${this.words(property.to)}, not to a text or a number` });
      }
    }
    return found;
  }

  /** Return classes in words: a node or a topic. */
  words(classes) {
    return classes.filter(Boolean).map((one) => article(this.label(one))).join(" or ") || "something";
  }
}

/** Return a label with its article. */
export const article = (label) => `${/^[aeiou]/i.test(label) ? "an" : "a"} ${label}`;

/** Yield all blocks of a rule, those inside others too. */
export function* every(rule) {
  yield* inside(rule.when ?? []);
  yield* inside(rule.then ?? []);
}

function* inside(list) {
  for (const one of list) {
    yield one;
    if (one.when) yield* inside(one.when);
    for (const branch of one.branches ?? []) yield* inside(branch);
  }
}

/** Return a name of a vocabulary in words: `my:listensTo` is listens to. */
export function spoken(name) {
  const local = name.replace(/^<|>$/g, "").split(/[:#/]/).at(-1);
  return RELATION.test(local) ? local.replace(/(\p{Ll})(\p{Lu})/gu, "$1 $2").toLowerCase() : name;
}

/** Return the name of a thing of a class: `rnkg:MessageType` is messageType. */
export function nameFor(kind) {
  const local = kind.split(/[:#/]/).at(-1).replace(/\W/g, "");
  return local ? local[0].toLowerCase() + local.slice(1) : "thing";
}
