"use strict";
(() => {
  // numbers in the reader's locale
  const number = new Intl.NumberFormat();
  for (const one of document.querySelectorAll("data[value]")) {
    const value = Number(one.value);
    if (Number.isFinite(value)) one.textContent = number.format(value);
  }

  // a filter shows at once what it does; empty fields stay out of the address
  for (const form of document.querySelectorAll("form[data-filter]")) {
    form.addEventListener("submit", () => {
      for (const field of form.elements) if (field.name && (field.value === "" || (field.name === "sort" && field.value === "priority"))) field.disabled = true;
    });
    for (const field of form.querySelectorAll("select, input[type=checkbox]")) field.addEventListener("change", () => form.requestSubmit());
  }
  window.addEventListener("pageshow", () => {
    for (const field of document.querySelectorAll("form[data-filter] :disabled")) field.disabled = false;
  });

  // an address to be copied: selected whole
  for (const field of document.querySelectorAll("input[data-copied]")) {
    field.addEventListener("focus", () => field.select());
    field.focus();
  }

  // who decides need not say so twice
  for (const form of document.querySelectorAll("form[data-remember]")) {
    const field = form.elements[form.dataset.remember], key = `lostmotion-${form.dataset.remember}`;
    try {
      if (!field.value) field.value = localStorage.getItem(key) ?? "";
      form.addEventListener("submit", () => localStorage.setItem(key, field.value));
    } catch { /* no memory here */ }
  }

  // keys: j and k to the next and the last loop, / to the filter, u back; may be turned off (WCAG 2.1.4)
  const links = [...document.querySelectorAll(".ranking th[scope=row] a")];
  const marked = [...document.querySelectorAll("[data-key]")].filter((one) => one.matches("a, input"));
  if (!links.length && !marked.length) return;
  const KEY = "lostmotion-keys";
  let on = true;
  try { on = localStorage.getItem(KEY) !== "off"; } catch { /* no memory here */ }
  const label = document.createElement("label"), box = document.createElement("input");
  box.type = "checkbox";
  box.checked = on;
  box.addEventListener("change", () => {
    on = box.checked;
    try { localStorage.setItem(KEY, on ? "on" : "off"); } catch { /* no memory here */ }
  });
  label.className = "keys";
  label.append(box, links.length ? " Keys: j and k step through the ranking, Enter opens, / goes to the filter" : " Key u goes back");
  document.querySelector("footer")?.prepend(label);
  const step = (by) => {
    const here = links.indexOf(document.activeElement);
    const next = here < 0 ? (by > 0 ? 0 : links.length - 1) : Math.min(Math.max(here + by, 0), links.length - 1);
    links[next]?.focus();
    links[next]?.closest("tr")?.scrollIntoView({ block: "nearest" });
  };
  document.addEventListener("keydown", (event) => {
    if (!on || event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input:not([type=checkbox]), select, textarea, [contenteditable]")) return;
    const field = marked.find((one) => one.dataset.key === event.key);
    if (field) {
      event.preventDefault();
      if (field.matches("a")) field.click(); else { field.focus(); field.select(); }
    } else if (links.length && (event.key === "j" || event.key === "k")) {
      event.preventDefault();
      step(event.key === "j" ? 1 : -1);
    }
  });
})();
