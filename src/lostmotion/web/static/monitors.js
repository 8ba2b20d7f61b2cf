"use strict";
(() => {
  const said = document.getElementById("news");
  if (!document.querySelector("[data-monitor]")) return;
  const renew = async (number) => {
    const answer = await fetch(`/monitors?part=${number}`);
    if (!answer.ok) throw new Error(answer.statusText);
    const made = new DOMParser().parseFromString(await answer.text(), "text/html").querySelector("[data-monitor]");
    const old = document.getElementById(`monitor-${number}`);
    if (!made || !old || made.dataset.version === old.dataset.version) return;
    if (old.querySelector("details")?.open) made.querySelector("details")?.setAttribute("open", "");
    old.replaceWith(made);
  };
  const all = () => Promise.all([...document.querySelectorAll("[data-monitor]")].map((one) => renew(one.dataset.monitor)));
  const stream = new EventSource("/monitors/events");
  stream.addEventListener("open", () => { said.textContent = ""; all().catch(() => {}); });
  stream.addEventListener("changed", async (event) => {
    const { monitor, name, status } = JSON.parse(event.data);
    try {
      await renew(monitor);
      said.textContent = `${name}: ${status}.`;
    } catch { said.textContent = "The page does not answer; start it again."; }
  });
  stream.addEventListener("error", () => { said.textContent = "No news: the page does not answer. It is asked again."; });
})();
