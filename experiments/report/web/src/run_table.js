// SPDX-License-Identifier: GPL-3.0-or-later
// Makes an experiment's table of runs sortable and filterable, and shows a run's trace below its row.
import {button, element} from "./dom.js";
import {addPlots} from "./plot.js";
import {chartsOfRun} from "./traces.js";

// A word of the filter: "phi>0.64", "fluid=still", or a text that the row has somewhere.
const comparison = /^([a-z0-9_]+)(<=|>=|=|<|>)(.+)$/i;
const compare = {
  "<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b,
  "=": (a, b) => a === b
};

// The text of a cell without the heading that narrow pages show in it.
function wordsOf(cell) {
  return [...cell.childNodes].filter((node) => !node.classList?.contains("card-label"))
    .map((node) => node.textContent).join(" ");
}

export class RunTable {
  constructor(host, runs) {
    this.host = host;
    this.runs = runs;
    this.table = host.querySelector("table");
    this.heads = [...this.table.querySelectorAll("th[data-key]")];
    this.keys = this.heads.map((head) => head.dataset.key);
    this.rows = [...this.table.tBodies].map((body) => this.addRow(body));
    this.heads.forEach((head, column) => this.addSort(head, column));
    this.addFilter();
  }

  addRow(body) {
    const cells = [...body.rows[0].cells].slice(0, this.keys.length);
    const values = cells.map(({dataset: {value}}) => value);
    const row = {
      body, values, run: this.runs[Number(body.dataset.row)],
      words: cells.map(wordsOf).concat(values).join(" ").toLowerCase()
    };
    row.button = element("button", {
      type: "button", className: "disclosure", "aria-expanded": "false",
      "aria-label": `Trace of run ${row.run.id.slice(0, 8)}`
    });
    cells[0].prepend(row.button);
    body.rows[0].addEventListener("click", (event) => {
      if (!event.target.closest("a")) this.toggle(row);
    });
    return row;
  }

  addSort(head, column) {
    const sort = button({}, () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of this.heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      this.sort(column, down ? -1 : 1);
    }, ...head.childNodes);
    head.append(sort);
  }

  // Runs without the value come last, whichever way the others are sorted.
  sort(column, direction) {
    const numeric = this.rows.every(({values}) =>
      values[column] === undefined || Number.isFinite(Number(values[column])));
    const order = (a, b) => numeric ? Number(a) - Number(b) : a.localeCompare(b, "en", {numeric: true});
    const sorted = [...this.rows].sort(({values: a}, {values: b}) => {
      if (a[column] === undefined || b[column] === undefined) {
        return Number(a[column] === undefined) - Number(b[column] === undefined);
      }
      return direction * order(a[column], b[column]);
    });
    this.table.append(...sorted.map(({body}) => body));
  }

  addFilter() {
    this.input = element("input", {
      type: "search", placeholder: "fluid=still phi>0.63",
      title: `Words that a row has, or conditions on ${this.keys.join(", ")}`
    });
    this.count = element("output");
    const label = element("label", {}, "Filter ", this.input);
    this.host.prepend(element("div", {className: "filter"}, label, this.count));
    this.input.addEventListener("input", () => this.filter());
    this.filter();
  }

  filter() {
    const words = this.input.value.trim().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of this.rows) {
      row.body.hidden = !words.every((word) => this.fits(row, word));
      shown += row.body.hidden ? 0 : 1;
    }
    this.count.textContent = `${shown} of ${this.rows.length} runs`;
  }

  fits(row, word) {
    const [, key, sign, wanted] = word.match(comparison) ?? [];
    const column = this.keys.indexOf(key);
    if (column < 0) return row.words.includes(word.toLowerCase());
    const value = row.values[column];
    if (value === undefined) return false;
    const numbers = [value, wanted].map(Number);
    return numbers.every(Number.isFinite) ? compare[sign](...numbers)
      : compare[sign](value.toLowerCase(), wanted.toLowerCase());
  }

  toggle(row) {
    const open = row.button.getAttribute("aria-expanded") !== "true";
    row.button.setAttribute("aria-expanded", String(open));
    row.body.classList.toggle("open", open);
    if (!open) {
      row.trace.remove();
      return;
    }
    if (row.trace) row.body.append(row.trace);
    else this.addTrace(row);
  }

  addTrace(row) {
    const {run, button: opener} = row;
    const panels = element("div", {className: "panels"});
    const cell = element("td", {colSpan: this.keys.length + 1}, panels);
    const line = element("tr", {className: "trace"}, cell);
    row.trace = line;
    row.body.append(line);  // plots need their width
    const others = this.runs.filter((one) =>
      one !== run && one.scale === run.scale && one.variant === run.variant);
    addPlots(panels, chartsOfRun(run, others));
    line.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || event.target.closest("svg")) return;
      opener.click();
      opener.focus();
    });
  }
}
