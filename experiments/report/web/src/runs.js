// SPDX-License-Identifier: GPL-3.0-or-later
// An experiment's table of runs: sorts and filters it, folds it by variant, adds columns, shows the trace of a
// run below its row, and plots one measure against another.
import {chartOfMeasures, chartsOfRun} from "./charts.js";
import {element} from "./dom.js";
import {readFilter} from "./filter.js";
import {addPlots, Plot} from "./plot.js";

const foldedFrom = 20;  // tables with more rows are folded at first

const shortText = (value) => value === null ? "–"
  : Number.isFinite(value) ? String(Number(value.toPrecision(4))) : String(value);

const opener = (label, action) => {
  const button = element("button", {
    type: "button", className: "disclosure", "aria-expanded": "false", "aria-label": label
  });
  button.addEventListener("click", (event) => {
    event.stopPropagation();
    button.setAttribute("aria-expanded", String(action()));
  });
  return button;
};

export class RunTable {
  // `lookOf` gives the colour and the marker of a run's variant.
  constructor(host, {columns, rows, runs}, lookOf) {
    this.columns = columns;
    this.lookOf = lookOf;
    this.table = host.querySelector("table");
    this.heads = this.table.tHead.rows[0];
    this.runs = runs;
    this.rows = [...this.table.tBodies].map((body, k) => this.addRow(body, rows[k], runs[k]));
    for (const head of this.heads.cells) this.addSort(head);
    this.open = new Set();  // names of unfolded variants
    this.addControls(host);
    this.arrange();
  }

  addRow(body, values, run) {
    const row = {
      body, run, values, trace: null, value: (key) => values[this.columns.findIndex((one) => one.key === key)],
      words: [...body.querySelectorAll("td")].map((cell) => cell.lastChild.textContent)
        .concat(run.variant, values).join(" ").toLowerCase()
    };
    const button = opener(`Trace of run ${run.id.slice(0, 8)}`, () => this.toggleTrace(row, button));
    body.rows[0].cells[0].prepend(button);
    body.rows[0].addEventListener("click", (event) => event.target.closest("a, button") || button.click());
    return row;
  }

  addSort(head) {
    const button = element("button", {type: "button"}, ...head.childNodes);
    button.addEventListener("click", () => {
      this.down = head.getAttribute("aria-sort") === "ascending";
      for (const other of this.heads.cells) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", this.down ? "descending" : "ascending");
      this.sortKey = head.dataset.key;
      this.arrange();
    });
    head.append(button);
  }

  addControls(host) {
    const variants = new Set(this.runs.map((run) => run.variant)).size;
    this.input = element("input", {
      type: "search", placeholder: "seed=1,2 phi>0.63 state!=failed",
      title: `Texts that a row contains, or conditions on ${this.columns.map(({key}) => key).join(", ")}`
    });
    this.problem = element("p", {className: "warning", role: "status", hidden: true});
    this.fold = element("input", {
      type: "checkbox", checked: this.rows.length > foldedFrom && variants < this.rows.length
    });
    this.count = element("output");
    for (const part of [this.input, this.fold]) part.addEventListener("input", () => this.arrange());
    host.prepend(element("div", {className: "filter"}, element("label", {}, "Filter ", this.input),
      element("label", {hidden: variants === this.rows.length}, this.fold, " fold by variant"), this.count,
      this.columnChoice(), this.plotChoice(), this.problem));
  }

  known() {
    return this.columns.filter(({key}) => this.rows.some((row) => row.value(key) !== null));
  }

  columnChoice() {
    const boxes = this.known().map(({key, meaning}) => {
      const box = element("input", {type: "checkbox", checked: this.place(key) >= 0});
      box.addEventListener("input", () => this.showColumn(key, meaning, box.checked));
      return element("label", {title: meaning}, box, ` ${key}`);
    });
    return element("details", {}, element("summary", {}, "Columns"), element("div", {className: "choices"}, ...boxes));
  }

  place(key) {
    return [...this.heads.cells].findIndex((head) => head.dataset.key === key);
  }

  showColumn(key, meaning, shown) {
    if (this.place(key) < 0) {
      const name = key.replaceAll("_", " ");
      this.heads.append(element("th", {scope: "col", title: meaning, "data-key": key}, name));
      this.addSort(this.heads.lastChild);
      for (const {body, value} of this.rows) {
        body.rows[0].append(element("td", {},
          element("span", {className: "card-label", "aria-hidden": "true"}, name), shortText(value(key))));
      }
    }
    const at = this.place(key);
    for (const line of [this.heads, ...this.rows.map(({body}) => body.rows[0])]) line.cells[at].hidden = !shown;
    this.arrange();
  }

  plotChoice() {
    const keys = this.known().map(({key}) => key)
      .filter((key) => this.rows.every((row) => row.value(key) === null || Number.isFinite(row.value(key))));
    const choice = (wanted) => {
      const select = element("select", {}, ...keys.map((key) => element("option", {}, key)));
      select.value = keys.includes(wanted) ? wanted : keys[0];
      select.addEventListener("change", () => this.drawMeasures());
      return select;
    };
    [this.y, this.x] = [choice("phi"), choice("cycle")];
    this.plotHost = element("div", {className: "plot"});
    this.plotPart = element("details", {}, element("summary", {}, "Plot measures"),
      element("div", {className: "choices"}, this.y, "against", this.x), this.plotHost);
    this.plotPart.addEventListener("toggle", () => this.drawMeasures());
    return this.plotPart;
  }

  drawMeasures() {
    if (!this.plotPart.open) return;
    const chart = chartOfMeasures(this.shown, this.x.value, this.y.value, this.lookOf);
    if (this.plot) this.plot.show(chart);
    else this.plot = new Plot(this.plotHost, chart, "measures");
  }

  // Shows the rows that pass the filter, sorted. If the table is folded, each variant has one line, and the rows of
  // unfolded variants are below this line.
  arrange() {
    const columns = this.columns.map(({key, symbol}, k) => ({key, symbol, values: this.rows.map(({values}) => values[k])}));
    const {passes, problems} = readFilter(this.input.value, columns, this.rows.map(({words}) => words));
    this.problem.textContent = problems.join(" ");
    this.problem.hidden = problems.length === 0;
    this.shown = this.sorted(this.rows.filter((_, k) => passes(k)));
    this.count.textContent = `${this.shown.length} of ${this.rows.length} ${this.rows.length === 1 ? "run" : "runs"}`;
    const variants = Map.groupBy(this.shown, ({run}) => run.variant);
    const bodies = this.fold.checked
      ? [...variants].flatMap(([name, rows]) =>
        [this.variantLine(name, rows), ...(this.open.has(name) ? rows.map(({body}) => body) : [])])
      : this.shown.map(({body}) => body);
    for (const body of [...this.table.tBodies]) body.remove();
    this.table.append(...bodies);
    this.drawMeasures();
  }

  // Runs without a value come last, in ascending and in descending order.
  sorted(rows) {
    if (!this.sortKey) return rows;
    const sign = this.down ? -1 : 1;
    return rows.sort(({value: a}, {value: b}) => {
      const [left, right] = [a(this.sortKey), b(this.sortKey)];
      if (left === null || right === null) return Number(left === null) - Number(right === null);
      return sign * (Number.isFinite(left) && Number.isFinite(right) ? left - right
        : String(left).localeCompare(String(right), "en", {numeric: true}));
    });
  }

  // The line of a variant. A cell shows the value that all runs have in common, or the mean of their numbers.
  variantLine(name, rows) {
    const label = `${name} (${rows.length} ${rows.length === 1 ? "run" : "runs"})`;
    const button = opener(label, () => {
      if (!this.open.delete(name)) this.open.add(name);
      this.arrange();
      return this.open.has(name);
    });
    button.setAttribute("aria-expanded", String(this.open.has(name)));
    const named = [...this.heads.cells].some((head) => head.dataset.key === "variant" && !head.hidden);
    const cells = [...this.heads.cells].map((head, k) => {
      // If a column names the variant, the first cell does not repeat the name.
      if (k === 0) return element("td", {className: named ? "brief" : ""}, button, named ? label.slice(name.length + 1) : label);
      const values = rows.map((row) => row.value(head.dataset.key)).filter((value) => value !== null);
      const same = values.every((value) => value === values[0]);
      const mean = head.dataset.key !== "seed" && values.every(Number.isFinite);
      const text = values.length === 0 ? "–" : same ? shortText(values[0])
        : mean ? shortText(values.reduce((sum, value) => sum + value, 0) / values.length) : "";
      return element("td", {className: head.className, hidden: head.hidden},
        element("span", {className: "card-label", "aria-hidden": "true"}, head.textContent), text);
    });
    const line = element("tr", {}, ...cells);
    line.addEventListener("click", () => button.click());
    return element("tbody", {className: "variant"}, line);
  }

  toggleTrace(row, button) {
    const open = row.body.classList.toggle("open");
    if (!open) row.trace.remove();
    else if (row.trace) row.body.append(row.trace);
    else {
      const panels = element("div", {className: "panels"});
      row.trace = element("tr", {className: "trace"}, element("td", {colSpan: 99}, panels));
      row.body.append(row.trace);  // before the plots are made, because they need the width of the trace
      const {run} = row;
      addPlots(panels, chartsOfRun(run, this.runs.filter((one) =>
        one !== run && one.scale === run.scale && one.variant === run.variant), this.lookOf(run).colour));
      row.trace.addEventListener("keydown", (event) => {
        if (event.key !== "Escape" || event.target.closest(".canvas:focus")) return;
        button.click();
        button.focus();
      });
    }
    return open;
  }
}
