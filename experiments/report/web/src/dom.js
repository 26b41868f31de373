// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of the page, downloads, and the theme.

// Makes an element: element("p", {className: "small", "aria-label": "it"}, "text", other). The second argument has
// properties of the DOM, or attributes.
export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

// Labels are lists of [text, style]; the style is "", or the element "i", "sub" or "sup".
export const plain = (text) => [[text, ""]];
export const italic = (text) => [[text, "i"]];
export const sub = (text) => [[text, "sub"]];
export const written = (label) =>
  label.map(([text, style]) => ["i", "sub", "sup"].includes(style) ? element(style, {}, text) : text);

// The smallest and the largest value. (Math.min(...values) fails for about 100,000 values.)
export const extentOf = (values) =>
  values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);

// Fills a <select> with an option for each item, in groups. The value of an option is the index of the item.
export function addOptions(select, items, groupOf, textOf) {
  for (const [label, members] of Map.groupBy(items, groupOf)) {
    const options = members.map((item) => element("option", {value: String(items.indexOf(item))}, textOf(item)));
    select.append(element("optgroup", {label}, ...options));
  }
}

// Calls `action` once, when scrolling brings the element near the visible part of the page.
export function whenNear(target, action) {
  const watcher = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watcher.disconnect();
    action();
  }, {rootMargin: "300px"});
  watcher.observe(target);
}

export function save(name, blob) {
  const link = element("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Stores the reader's choice of colours. If the browser does not allow a file to store it, the choice is lost when the
// page is closed. Plots and packings listen to the event "themechange" of the window, because they set their own colours.
export function addThemeSwitch(select) {
  const key = "shearcell-theme";
  const apply = () => {
    document.documentElement.style.colorScheme = select.value;
    window.dispatchEvent(new Event("themechange"));
  };
  const stored = (action) => {
    try {
      return action(localStorage);
    } catch {
      return null;
    }
  };
  const kept = stored((storage) => storage.getItem(key));
  if ([...select.options].some((option) => option.value === kept)) select.value = kept;
  apply();
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", apply);
  select.addEventListener("change", () => {
    stored((storage) => storage.setItem(key, select.value));
    apply();
  });
}

// The colours of an element, each as red, green and blue from 0 to 255.
export function coloursOf(probe) {
  const channels = (text) => text.match(/[\d.]+/g).slice(0, 3).map(Number);
  const style = getComputedStyle(probe);
  return {background: channels(style.backgroundColor), ink: channels(style.color)};
}
