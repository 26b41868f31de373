// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of the page.

// element("p", {className: "small", "aria-label": "it"}, "text", other): properties of the DOM, or
// attributes.
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

export function svg(tag, attributes = {}, parent = null) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  parent?.append(made);
  return made;
}

export function button(properties, action, ...children) {
  const made = element("button", {type: "button", ...properties}, ...children);
  made.addEventListener("click", action);
  return made;
}

// Fills a <select>: an option for each item, valued by its place, in groups.
export function addOptions(select, items, groupOf, textOf) {
  const groups = new Map();
  items.forEach((item, index) => {
    const name = groupOf(item);
    if (!groups.has(name)) groups.set(name, element("optgroup", {label: name}));
    groups.get(name).append(element("option", {value: String(index)}, textOf(item)));
  });
  select.append(...groups.values());
}

// Calls `action` once, when the element is scrolled near the window.
export function whenNear(target, pixels, action) {
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    action();
  }, {rootMargin: `${pixels}px`});
  watcher.observe(target);
}
