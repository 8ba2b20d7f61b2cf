"use strict";
(() => {
  const key = (row, column) => {
    const cell = row.cells[column];
    const text = cell.dataset.key ?? cell.textContent.trim();
    const number = Number(text);
    return text !== "" && Number.isFinite(number) ? number : text.toLowerCase();
  };
  const order = (one, other) => typeof one === typeof other ? (one < other ? -1 : one > other ? 1 : 0) : typeof one === "number" ? -1 : 1;
  const sort = (table, column, head) => {
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const rows = [...table.tBodies[0].rows];
    rows.sort((one, other) => (down ? -1 : 1) * order(key(one, column), key(other, column)));
    table.tBodies[0].append(...rows);
  };
  const chooser = (name, values, change) => {
    const label = document.createElement("label"), select = document.createElement("select");
    for (const value of ["all", ...values]) select.add(new Option(value, value === "all" ? "" : value));
    select.addEventListener("change", change);
    label.append(name, select);
    return [label, select];
  };
  const filter = (table) => {
    const rows = [...table.tBodies[0].rows], box = document.createElement("div"), said = document.createElement("span");
    const label = document.createElement("label"), text = document.createElement("input");
    const values = (name) => [...new Set(rows.map((row) => row.dataset[name]))].filter(Boolean).sort();
    const show = () => {
      const wanted = text.value.toLowerCase();
      let count = 0;
      for (const row of rows) {
        const fits = (!area.value || row.dataset.area === area.value) && (!verdict.value || row.dataset.verdict === verdict.value)
          && row.textContent.toLowerCase().includes(wanted);
        row.hidden = !fits;
        row.classList.toggle("gone", !fits);
        count += fits;
      }
      said.textContent = `${count} of ${rows.length} shown`;
    };
    const [areas, area] = chooser("Area", values("area"), show), [verdicts, verdict] = chooser("Verdict", values("verdict"), show);
    text.type = "search";
    text.addEventListener("input", show);
    label.append("Text", text);
    said.setAttribute("role", "status");
    box.className = "filter";
    box.append(label, areas, verdicts, said);
    table.before(box);
  };
  // what is folded is printed, and opened by a link to it
  const folded = [...document.querySelectorAll("details.fold")];
  let opened = [];
  addEventListener("beforeprint", () => { opened = folded.filter((one) => !one.open); for (const one of opened) one.open = true; });
  addEventListener("afterprint", () => { for (const one of opened) one.open = false; });
  const reveal = () => {
    const target = document.getElementById(location.hash.slice(1));
    for (let fold = target?.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
    if (target?.closest("details")) target.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  reveal();
  for (const table of document.querySelectorAll("table[data-sort]")) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = head.textContent;
      button.addEventListener("click", () => sort(table, column, head));
      head.replaceChildren(button);
    });
    if (table.dataset.sort === "filter") filter(table);
  }
})();
