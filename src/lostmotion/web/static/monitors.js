"use strict";
(() => {
  const said = document.getElementById("news");
  if (!document.querySelector("[data-monitor]")) return;
  const asked = async (address) => {
    const answer = await fetch(address);
    if (!answer.ok) throw new Error(answer.statusText);
    return new DOMParser().parseFromString(await answer.text(), "text/html");
  };
  const renew = async (number) => {
    const old = document.getElementById(`monitor-${number}`);
    if (!old) return number >= known && whole();
    const page = await asked(`/monitors?part=${number}`);
    const made = page.querySelector("[data-monitor]");
    if (!made || made.dataset.version === old.dataset.version) return;
    if (old.querySelector("details")?.open) made.querySelector("details")?.setAttribute("open", "");
    old.replaceWith(made);
    const row = page.querySelector("[data-row]");
    if (row) document.querySelector(`[data-row="${number}"]`)?.replaceWith(row);
  };
  const numbers = () => [...document.querySelectorAll("[data-monitor]")].map((one) => Number(one.dataset.monitor));
  let known = Math.max(...numbers()) + 1;
  // a loop that was not there when the page was made: everything anew, unless somebody is filtering
  const whole = async () => {
    if (document.activeElement?.matches("input")) return;
    const made = (await asked(location.href)).getElementById("main");
    const main = document.getElementById("main");
    if (!made || !main) return;
    made.querySelector("#news").replaceWith(said);
    main.replaceChildren(...made.childNodes);
    known = Math.max(known, ...numbers().map((one) => one + 1));
  };
  const all = () => Promise.all(numbers().map(renew));
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
