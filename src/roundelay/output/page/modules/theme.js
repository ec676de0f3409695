// Light and dark: the system's choice until the reader makes one.

import { forgetInks } from "./canvas.js";
import { byId } from "./elements.js";

export function createTheme(changed) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;
  function show() {
    const theme = chosen ?? (system.matches ? "dark" : "light");
    document.documentElement.dataset.theme = theme;
    forgetInks();
    byId("theme").textContent = theme === "dark" ? "Light" : "Dark";
    changed();
  }
  function toggle() {
    chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    show();
  }
  system.addEventListener("change", show);
  byId("theme").addEventListener("click", toggle);
  show();
  return toggle;
}
