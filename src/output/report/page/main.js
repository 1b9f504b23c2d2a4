"use strict";
// The page, part by part: a part that fails says so, and the others are shown all the same.

async function part(id, show) {
  try {
    return await show();
  } catch (error) {
    console.error(error);
    const section = document.getElementById(id);
    section.hidden = false;
    section.append(el("p", { class: "none" }, `This part cannot be shown: ${error.message}`));
    return [];
  }
}

function showNav() {
  const nav = document.getElementById("nav");
  const sections = [...document.querySelectorAll("main section")].filter((section) => !section.hidden && section.querySelector("h2"));
  nav.replaceChildren(...sections.map((section) => el("a", { href: `#${section.id}` }, section.querySelector("h2").textContent)));
}

async function showAll() {
  showHead();
  if (typeof DecompressionStream === "undefined") {
    document.querySelector("main").prepend(el("p", {}, "This browser is too old to unpack the numbers: take one of 2023 or later."));
    return;
  }
  part("case", showCase);
  const bodies = part("bodies", showBodies);
  const runs = await part("histories", showHistories);
  await part("law", showLaw);
  await part("profiles", showProfiles);
  await part("interface", showInterface);
  await part("events", showEvents);
  await part("convergence", () => showConvergence(runs));
  await bodies;
  await drawAll();
  showNav();
  if (![...document.querySelectorAll("main section")].some((section) => !section.hidden && section.id !== "faults" && section.id !== "case")) {
    document.querySelector("main").prepend(el("p", { class: "none" }, "There are no results to show yet."));
  }
  document.documentElement.dataset.ready = "";
}

showAll();
