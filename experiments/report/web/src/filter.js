// SPDX-License-Identifier: GPL-3.0-or-later
// The filter of a table of runs. A filter is a list of conditions and texts, separated by blanks or commas. A run passes
// the filter if the run meets all conditions and has all texts. A value that contains blanks needs quotes:
//
//     walls=rough phi>0.63        both conditions
//     walls=rough, phi>0.63       also both conditions
//     seed=1,2,5                  one of these values
//     state!=completed,failed     none of these values
//     variant="low P"             a value with a blank
//     3f9a                        runs that have this text somewhere in their row
//     3f9a,77c0                   one of these texts

const operators = {"==": "=", "≠": "!=", "<>": "!=", "≤": "<=", "≥": ">="};
const condition = /^([^\s"=<>!≠≤≥]+)(<=|>=|!=|==|<>|=|<|>|≠|≤|≥)(.*)$/su;

// Splits a text at the characters in `pattern`, except within quotes.
const split = (text, pattern) =>
  text.match(new RegExp(`(?:"[^"]*"?|[^"${pattern}])+`, "gu"))?.map((part) => part.trim()).filter(Boolean) ?? [];
const unquoted = (text) => text.replaceAll('"', "");

const isNumber = (text) => text.trim() !== "" && Number.isFinite(Number(text));
// A number also equals the number rounded to four digits, which the table shows.
const equal = (value, wanted) => typeof value === "number"
  ? isNumber(wanted) && (value === Number(wanted) || Number(value.toPrecision(4)) === Number(wanted))
  : String(value).toLowerCase() === wanted.toLowerCase();

// The number of letters that must be changed, inserted or deleted to turn `a` into `b`.
function distance(a, b) {
  let row = [...Array(b.length + 1).keys()];
  for (let i = 0; i < a.length; ++i) {
    const next = [i + 1];
    for (let j = 0; j < b.length; ++j) next.push(Math.min(next[j] + 1, row[j + 1] + 1, row[j] + (a[i] !== b[j])));
    row = next;
  }
  return row[b.length];
}

function nearest(word, names) {
  const [best] = names.map((name) => [distance(word.toLowerCase(), name.toLowerCase()), name])
    .sort(([a], [b]) => a - b);
  return best && best[0] <= Math.max(1, word.length / 3) ? ` Did you mean ${best[1]}?` : "";
}

// `columns`: [{key, symbol, values}]; `values` has one value for each row, null if it is unknown. `words`: the text of
// each row in lower case. Returns {passes(k), problems}. passes(k): whether row k passes the filter. `problems`: a
// sentence for each part of the filter that is not a valid condition or that no row meets. An invalid condition hides
// no row.
export function readFilter(text, columns, words) {
  const problems = [], tests = [];
  const known = columns.filter(({values}) => values.some((value) => value !== null));
  const keys = `Keys: ${known.map(({key}) => key).join(", ")}.`;
  const add = (problem, test) => problem ? problems.push(problem) : tests.push(test);

  function addCondition(name, sign, list) {
    const is = ({key, symbol}, other) => key.toLowerCase() === other || symbol?.toLowerCase() === other;
    const column = columns.find(({key, symbol}) => key === name || symbol === name) ??
      columns.find((one) => is(one, name.toLowerCase()));
    if (!column) return add(`There is no key '${name}'.${nearest(name, known.map(({key}) => key))} ${keys}`);
    const {key, values} = column;
    const wanted = split(list, ",").map(unquoted);
    if (wanted.length === 0) return add(`'${name}${sign}' lacks a value: ${key}${sign}VALUE.`);
    const numeric = values.every((value) => value === null || typeof value === "number");
    const odd = wanted.find((one) => numeric && !isNumber(one));
    if (odd !== undefined) return add(`${key} is a number, but '${odd}' is not a number.`);
    if (sign === "=" || sign === "!=") {
      const meets = (value) => value !== null && wanted.some((one) => equal(value, one));
      const all = [...new Set(values)].filter((value) => value !== null);
      const absent = wanted.filter((one) => !all.some((value) => equal(value, one)));
      const shown = all.length > 12 ? `${all.slice(0, 12).join(", ")} and ${all.length - 12} more` : all.join(", ");
      const blank = all.find((value) => absent.some((one) => String(value).toLowerCase().startsWith(`${one.toLowerCase()} `)));
      const quotes = blank === undefined ? "" : ` Write a value with blanks in quotes: ${key}${sign}"${blank}".`;
      if (absent.length > 0) problems.push(`No run has ${key} = ${absent.join(" or ")}. The values are ${shown}.${quotes}`);
      return add("", (k) => meets(values[k]) === (sign === "="));
    }
    if (!numeric) return add(`${key} is a text: compare it with = or !=, not with ${sign}.`);
    if (wanted.length > 1) return add(`${key}${sign} takes one number, not ${wanted.length}.`);
    const limit = Number(wanted[0]);
    const compare = {"<": (a) => a < limit, ">": (a) => a > limit, "<=": (a) => a <= limit, ">=": (a) => a >= limit};
    return add("", (k) => values[k] !== null && compare[sign](values[k]));
  }

  function addTexts(texts) {
    const found = texts.filter((one) => words.some((row) => row.includes(one.toLowerCase())));
    const absent = texts.filter((one) => !found.includes(one));
    if (absent.length > 0) {
      problems.push(`No run has the text '${absent.join("' or '")}' in its row. A condition is KEY=VALUE, KEY!=VALUE, ` +
        `KEY<VALUE or KEY>VALUE. ${keys}`);
    }
    tests.push((k) => found.some((one) => words[k].includes(one.toLowerCase())));
  }

  // Removes blanks around operators and after commas, because these blanks do not separate conditions.
  const joined = text.split('"').map((part, k) => k % 2 === 1 ? part
    : part.replace(/\s*(<=|>=|!=|==|<>|[=<>≠≤≥])\s*/gu, "$1").replace(/,\s+/gu, ",")).join('"');
  for (const word of split(joined, "\\s")) {
    // After a comma follows another value of the same condition, or the next condition.
    const parts = [];
    for (const part of split(word, ",")) {
      if (parts.length === 0 || condition.test(part)) parts.push(part);
      else parts[parts.length - 1] += `,${part}`;
    }
    for (const part of parts) {
      const [, name, sign, list] = part.match(condition) ?? [];
      if (name) addCondition(name, operators[sign] ?? sign, list);
      else addTexts(split(part, ",").map(unquoted));
    }
  }
  return {passes: (k) => tests.every((test) => test(k)), problems};
}
