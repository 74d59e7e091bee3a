// Terms of answers: how they are read, written, shortened and compared.
//
// Terms have the form of SPARQL Results JSON: { type: "uri" | "literal" | "bnode" | "triple", value, datatype?, "xml:lang"? }.

const XSD = "http://www.w3.org/2001/XMLSchema#";
const NUMBERS = /^(?:integer|decimal|double|float|int|long|short|byte|nonNegativeInteger|positiveInteger|unsigned\w+)$/;
const LINE = /^(<[^>]*>|_:\S+) (<[^>]*>) (<[^>]*>|_:\S+|"(?:[^"\\]|\\.)*"(?:@[\w-]+|\^\^<[^>]*>)?) \.$/;
const ESCAPES = { t: "\t", b: "\b", n: "\n", r: "\r", f: "\f" };

/** Return a term as N-Triples writes it. */
export function written(term) {
  if (term.type === "uri") return `<${term.value}>`;
  if (term.type === "bnode") return `_:${term.value}`;
  if (term.type === "triple") return `<<( ${[term.value.subject, term.value.predicate, term.value.object].map(written).join(" ")} )>>`;
  const text = JSON.stringify(term.value).replace(/[\u007f-\u009f]/g, (sign) => `\\u00${sign.charCodeAt(0).toString(16)}`);
  if (term["xml:lang"]) return `${text}@${term["xml:lang"]}`;
  return term.datatype ? `${text}^^<${term.datatype}>` : text;
}

/** Return the triples of a text in N-Triples, as lists of three terms. */
export function triples(text) {
  return text.split("\n").map((line) => LINE.exec(line.trim())).filter(Boolean).map((match) => match.slice(1).map(read));
}

function read(text) {
  if (text.startsWith("<")) return { type: "uri", value: unescaped(text.slice(1, -1)) };
  if (text.startsWith("_:")) return { type: "bnode", value: text.slice(2) };
  const end = text.lastIndexOf('"');
  const term = { type: "literal", value: unescaped(text.slice(1, end)) };
  const rest = text.slice(end + 1);
  if (rest.startsWith("@")) term["xml:lang"] = rest.slice(1);
  else if (rest) term.datatype = rest.slice(3, -1);
  return term;
}

function unescaped(text) {
  return text.replace(/\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))/g, (_, four, eight, sign) => {
    const code = four ?? eight;
    return code ? String.fromCodePoint(parseInt(code, 16)) : ESCAPES[sign] ?? sign;
  });
}

/** Return a function that shortens IRIs by prefixes, and those below `base` to the part after it. */
export function shortener(prefixes, base) {
  const ordered = Object.entries(prefixes).sort(([, one], [, other]) => other.length - one.length);
  return (iri) => {
    const found = ordered.find(([, namespace]) => iri.startsWith(namespace) && /^[\w-]+$/.test(iri.slice(namespace.length)));
    if (found) return `${found[0]}:${iri.slice(found[1].length)}`;
    if (!iri.startsWith(base)) return iri;
    try {
      return decodeURIComponent(iri.slice(base.length));
    } catch {
      return iri.slice(base.length);
    }
  };
}

/** Whether a term is a number. */
export function isNumber(term) {
  return term?.type === "literal" && term.datatype?.startsWith(XSD) && NUMBERS.test(term.datatype.slice(XSD.length));
}

const COLLATOR = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });

/** Compare two terms: unbound ones first, numbers by their value, all else as text. */
export function compare(one, other) {
  if (!one || !other) return (one ? 1 : 0) - (other ? 1 : 0);
  if (isNumber(one) && isNumber(other)) return Number(one.value) - Number(other.value);
  return COLLATOR.compare(one.value, other.value);
}
