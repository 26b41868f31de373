// SPDX-License-Identifier: GPL-3.0-or-later
// Labels come as gnuplot enhanced text: {/:Italic ϕ}_u, 10^{-5}. Only what the figures use is read;
// anything else is shown as it stands.

// "a_{b}" -> [{text: "a"}, {text: "b", shift: "sub"}]
export function parseMarkup(source) {
  const runs = [];
  read(source, 0, {}, runs, false);
  return runs;
}

export function plainText(source) {
  return parseMarkup(source).map((run) => run.text).join("").replace(/\s+/g, " ").trim();
}

// Reads until the end, or until the brace that closes this group; returns where it stopped.
function read(source, start, style, runs, inGroup) {
  let at = start;
  while (at < source.length) {
    const c = source[at];
    if (c === "}" && inGroup) return at + 1;
    if (c === "\\" && at + 1 < source.length) {
      push(runs, source[at + 1], style);
      at += 2;
    } else if (c === "{") {
      const italic = source.startsWith("{/:Italic ", at);
      at = read(source, at + (italic ? 10 : 1), italic ? {...style, italic} : style, runs, true);
    } else if ((c === "_" || c === "^") && at + 1 < source.length) {
      const shifted = {...style, shift: c === "_" ? "sub" : "super"};
      if (source[at + 1] === "{") {
        at = read(source, at + 2, shifted, runs, true);
      } else {
        push(runs, source[at + 1], shifted);
        at += 2;
      }
    } else {
      push(runs, c, style);
      ++at;
    }
  }
  return at;
}

function push(runs, text, style) {
  const last = runs.at(-1);
  if (last && last.italic === style.italic && last.shift === style.shift) last.text += text;
  else runs.push({text, ...style});
}

const shiftEm = {sub: 0.25, super: -0.38};

// Fills an SVG text element.
export function writeSvgText(element, source) {
  let risen = 0;
  for (const run of parseMarkup(source)) {
    const span = document.createElementNS("http://www.w3.org/2000/svg", "tspan");
    span.textContent = run.text;
    const size = run.shift ? 0.75 : 1;
    // dy is in the span's own em, and the next span starts from there.
    const wanted = run.shift ? shiftEm[run.shift] : 0;
    if (wanted !== risen) span.setAttribute("dy", `${(wanted - risen) / size}em`);
    risen = wanted;
    if (run.italic) span.setAttribute("font-style", "italic");
    if (run.shift) span.setAttribute("font-size", "0.75em");
    element.append(span);
  }
}

// Fills an HTML element.
export function writeHtmlText(element, source) {
  for (const run of parseMarkup(source)) {
    let node = document.createTextNode(run.text);
    const wrap = (tag) => {
      const outer = document.createElement(tag);
      outer.append(node);
      node = outer;
    };
    if (run.italic) wrap("i");
    if (run.shift) wrap(run.shift === "sub" ? "sub" : "sup");
    element.append(node);
  }
}
