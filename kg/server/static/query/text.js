// Offsets: the server counts characters (code points), the browser counts units of UTF-16.

/** Return the offset in units of the offset `points` in characters. */
export function toUnits(text, points) {
  let units = 0;
  for (let left = points; left > 0 && units < text.length; left -= 1) units += text.codePointAt(units) > 0xffff ? 2 : 1;
  return units;
}

/** Return the offset in characters of the offset `units` in units. */
export function toPoints(text, units) {
  let points = 0;
  for (let at = 0; at < units; points += 1) at += text.codePointAt(at) > 0xffff ? 2 : 1;
  return points;
}

/** Return the text after edits ({start, end, text}, in characters), which do not overlap. */
export function edited(text, edits) {
  let result = text;
  for (const edit of [...edits].sort((one, other) => other.start - one.start)) {
    result = result.slice(0, toUnits(text, edit.start)) + edit.text + result.slice(toUnits(text, edit.end));
  }
  return result;
}

const PIECE = /#[^\n]*|"""[\s\S]*?"""|'''[\s\S]*?'''|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|<[^\s<>"{}|^`\\]*>|[{}()[\]]|\n/g;

/** Return a query with each line indented by the brackets that are open before it; it changes nothing else. */
export function indented(text) {
  const depths = [0];
  let depth = 0;
  const fixed = new Set();
  let line = 0;
  for (const [piece] of text.matchAll(PIECE)) {
    if (piece === "\n") depths[line += 1] = depth;
    else if ("{([".includes(piece)) depth += 1;
    else if ("})]".includes(piece)) depth = Math.max(0, depth - 1);
    else for (const _ of piece.matchAll(/\n/g)) fixed.add(line += 1);
  }
  return text.split("\n").map((content, number) => {
    if (fixed.has(number)) return content;
    const bare = content.trim();
    const closing = bare.match(/^[})\]]+/)?.[0].length ?? 0;
    return bare && "  ".repeat(Math.max(0, depths[number] - closing)) + bare;
  }).join("\n");
}
