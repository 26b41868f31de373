// SPDX-License-Identifier: GPL-3.0-or-later
// Light, dark, or the system's choice; stored in localStorage if the browser allows it for files.

const listeners = [];
const systemDark = window.matchMedia("(prefers-color-scheme: dark)");

export function onThemeChange(action) {
  listeners.push(action);
}

function apply(choice) {
  const dark = choice === "dark" || (choice === "system" && systemDark.matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  for (const action of listeners) action();
}

function kept() {
  try {
    return localStorage.getItem("shearcell-theme") ?? "system";
  } catch {
    return "system";
  }
}

function keep(choice) {
  try {
    localStorage.setItem("shearcell-theme", choice);
  } catch {
    // The choice lasts until the page is closed.
  }
}

export function addThemeSwitch(select) {
  let choice = kept();
  if (![...select.options].some((option) => option.value === choice)) choice = "system";
  select.value = choice;
  apply(choice);
  systemDark.addEventListener("change", () => apply(select.value));
  select.addEventListener("change", () => {
    keep(select.value);
    apply(select.value);
  });
}

const channels = (text) => (text.match(/[\d.]+/g) ?? [128, 128, 128]).slice(0, 3).map(Number);

// Of a 3D view, as red, green and blue from 0 to 255.
export function pageColours(probe) {
  const style = getComputedStyle(probe);
  return {background: channels(style.backgroundColor), line: channels(style.color)};
}
