"use strict";

// Everything here works without script as well: the form posts, the page of a job refreshes itself.
(() => {
  const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

  function dropZone(form) {
    const input = form.querySelector("input[type=file]");
    const said = document.getElementById("drop-said");
    const bar = document.getElementById("drop-progress");
    let busy = false;

    function send(files) {
      if (busy || !files.length) return;
      const most = Number(form.dataset.most);
      const size = [...files].reduce((sum, file) => sum + file.size, 0);
      if (size > most) {
        said.textContent = `Together at most ${most / 1e6} MB; this is ${Math.ceil(size / 1e6)} MB. Cut the export, or start the page with the file: lostmotion serve FILE`;
        return;
      }
      busy = true;
      const data = new FormData();
      for (const file of files) data.append("file", file, file.name);
      const request = new XMLHttpRequest();
      request.open("POST", form.action);
      request.setRequestHeader("Accept", "application/json");
      request.responseType = "json";
      bar.hidden = false;
      said.textContent = "The file is being read in ..";
      request.upload.addEventListener("progress", (event) => {
        if (event.lengthComputable) bar.value = event.loaded / event.total;
      });
      const failed = (text) => {
        busy = false;
        bar.hidden = true;
        said.textContent = text;
      };
      request.addEventListener("load", () => {
        if (request.status === 201 && request.response) location.assign(request.response.url);
        else failed((request.response && request.response.message) || `Not taken (${request.status}).`);
      });
      request.addEventListener("error", () => failed("The page does not answer, or the file is too large."));
      request.send(data);
    }

    const over = (event) => {
      if (![...event.dataTransfer.types].includes("Files")) return;
      event.preventDefault();
      form.classList.add("over");
    };
    document.addEventListener("dragover", over);
    document.addEventListener("dragleave", () => form.classList.remove("over"));
    document.addEventListener("drop", (event) => {
      if (!event.dataTransfer.files.length) return;
      event.preventDefault();
      form.classList.remove("over");
      send(event.dataTransfer.files);
    });
    input.addEventListener("change", () => send(input.files));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      send(input.files);
    });
  }

  async function follow(section) {
    const said = document.getElementById("working-said");
    const bar = document.getElementById("working-share");
    const items = section.querySelectorAll(".phases li");
    let told = "";
    for (let missed = 0; ; ) {
      await pause(700);
      let found;
      try {
        const answer = await fetch(section.dataset.state, { headers: { Accept: "application/json" } });
        if (!answer.ok) return location.reload();
        found = await answer.json();
        missed = 0;
      } catch {
        missed += 1;
        if (missed > 4) {
          said.textContent = "The page does not answer any more. Was it ended? Start it again: lostmotion serve";
          return;
        }
        continue;
      }
      const job = found.job;
      if (!job || !job.open || (found.looked && !section.dataset.looked)) return location.reload();
      bar.value = job.share;
      const now = [...items].findIndex((one) => one.textContent.trim().startsWith(job.phase) && job.phase);
      items.forEach((one, place) => {
        if (now >= 0) one.className = place < now ? "done" : place === now ? "now" : "next";
      });
      const text = `${job.words} ${job.said}`;
      if (text !== told) said.textContent = told = text;
    }
  }

  async function reread() {
    for (;;) {
      await pause(2000);
      try {
        const answer = await fetch(location.href);
        if (!answer.ok) continue;
        const found = new DOMParser().parseFromString(await answer.text(), "text/html").querySelector(".listed");
        const now = document.querySelector(".listed");
        if (!found || !now) return;
        if (found.innerHTML !== now.innerHTML && !now.contains(document.activeElement)) now.replaceWith(found);
        if (!found.dataset.open) return;
      } catch {
        // asked again
      }
    }
  }

  const form = document.getElementById("drop");
  if (form) dropZone(form);
  const working = document.getElementById("working");
  if (working) follow(working);
  if (document.querySelector(".listed[data-open]")) reread();
})();
