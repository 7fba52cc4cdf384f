#pragma once

namespace obscura::app {

// The style and the script of a report. Both stand in the page itself and are named in its content security
// policy by their hashes: nothing else runs, and nothing is fetched.

inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark;
  --ground: #f6f7f9; --paper: #fff; --ink: #1b1f24; --quiet: #5b6570; --line: #d9dee4; --well: #eceff2;
  --solid: #d55e00; --edge: #0072b2; --good: #00795a; --warn: #8a5a00; --focus: #0072b2; }
@media (prefers-color-scheme: dark) { :root {
  --ground: #14171b; --paper: #1c2026; --ink: #e7eaee; --quiet: #9aa5b1; --line: #333a43; --well: #0f1215;
  --solid: #ff8438; --edge: #5cb8f0; --good: #3fc79b; --warn: #e6b04a; --focus: #5cb8f0; } }
* { box-sizing: border-box; }
html { scroll-padding-top: 4.5rem; }
body { font: 15px/1.5 Inter, system-ui, sans-serif; margin: 0; color: var(--ink); background: var(--ground); }
header, main, footer { padding: 0 clamp(1rem, 2.5vw, 2.5rem); }
header { padding-top: 1.6rem; }
h1 { font-size: 1.45rem; line-height: 1.25; font-weight: 650; margin: 0; letter-spacing: -.01em; overflow-wrap: anywhere; }
header p { margin: .25rem 0 0; color: var(--quiet); font-size: .87rem; overflow-wrap: anywhere; }
.legend { display: flex; flex-wrap: wrap; gap: .3rem 1.4rem; margin: .9rem 0 0; padding: 0; list-style: none; font-size: .87rem; color: var(--quiet); }
.legend i { display: inline-block; width: .85rem; height: .85rem; margin-right: .45rem; border-radius: .15rem; vertical-align: -.1rem; }
.legend .solid { background: #d55e00; } .legend .edge { background: #0072b2; }
.legend .pale { background: #e4e4e4; border: 1px solid var(--line); }
.legend .around { border: 2px solid var(--solid); }
.bar { position: sticky; top: 0; z-index: 3; display: flex; flex-wrap: wrap; gap: .5rem 1.2rem; align-items: center;
  margin-top: 1rem; padding: .6rem clamp(1rem, 2.5vw, 2.5rem);
  background: color-mix(in srgb, var(--ground) 92%, transparent); backdrop-filter: blur(6px); border-bottom: 1px solid var(--line); }
button { font: inherit; font-size: .87rem; line-height: 1.4; color: var(--ink); background: var(--paper);
  border: 1px solid var(--line); border-radius: .4rem; padding: .2rem .65rem; cursor: pointer; }
button:hover { border-color: var(--quiet); }
:focus-visible { outline: 2px solid var(--focus); outline-offset: 2px; }
.group { display: inline-flex; }
.group button { border-radius: 0; margin-left: -1px; }
.group button:first-child { border-radius: .4rem 0 0 .4rem; margin-left: 0; }
.group button:last-child { border-radius: 0 .4rem .4rem 0; }
.group button:only-child { border-radius: .4rem; }
button.on { color: var(--paper); background: var(--ink); border-color: var(--ink); position: relative; }
output.scale { display: inline-block; min-width: 3.6rem; text-align: center; font-size: .87rem; font-variant-numeric: tabular-nums; color: var(--quiet); }
section { margin: 1.1rem 0; padding: 1rem 1.15rem 1.15rem; background: var(--paper); border: 1px solid var(--line); border-radius: .6rem; }
section.at { border-color: var(--focus); }
.head { display: flex; flex-wrap: wrap; align-items: center; gap: .35rem .8rem; }
h2 { font-size: 1.05rem; font-weight: 600; margin: 0; overflow-wrap: anywhere; }
h2 a { color: inherit; text-decoration: none; } h2 a:hover { text-decoration: underline; }
.state { font-size: .78rem; font-weight: 600; padding: .05rem .55rem; border-radius: 1rem; border: 1px solid currentColor; color: var(--quiet); }
[data-state=differs] .state, [data-state=failed] .state { color: var(--solid); }
[data-state=missing] .state, [data-state=unreadable] .state { color: var(--warn); }
[data-state=same] .state { color: var(--good); }
.take { margin-left: auto; font-size: .87rem; display: inline-flex; gap: .45rem; align-items: center; cursor: pointer; }
.take input { width: 1.05rem; height: 1.05rem; margin: 0; accent-color: var(--good); }
.lines { margin: .45rem 0 0; padding: 0; list-style: none; max-width: 90rem; font-size: .93rem; overflow-wrap: anywhere; white-space: pre-wrap; }
.lines li + li { color: var(--quiet); }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); gap: 1rem; margin-top: .8rem; }
.pictures.one { grid-template-columns: minmax(0, 30rem); }
[data-view=slide] .pair > :not(.both), [data-view=blink] .pair > :not(.both),
[data-view=difference] .pair > :not(.difference), [data-view=beside] .both, [data-view=difference] .both { display: none; }
body:not([data-view=beside]) .pair { grid-template-columns: 1fr; }
figure { margin: 0; min-width: 0; }
figcaption { margin-bottom: .3rem; font-size: .85rem; font-weight: 600; }
figure p { margin: .3rem 0 0; font-size: .78rem; line-height: 1.4; color: var(--quiet); overflow-wrap: anywhere; }
.view { position: relative; overflow: hidden; margin: 0 auto; border: 1px solid var(--line); border-radius: .2rem; touch-action: pan-y;
  background: repeating-conic-gradient(#e3e3e3 0 25%, #fff 0 50%) 0 0 / 16px 16px; }
.view.in { cursor: grab; touch-action: none; } .view.in:active { cursor: grabbing; }
.placed .sheet { position: absolute; inset: 0; }
.sheet img { display: block; width: 100%; height: auto; user-select: none; -webkit-user-drag: none; }
.placed img { height: 100%; }
.crisp img { image-rendering: pixelated; }
.over { position: absolute; inset: 0; }
.cut { position: absolute; top: 0; bottom: 0; width: 2px; margin-left: -1px; background: var(--ink); box-shadow: 0 0 0 1px var(--paper); pointer-events: none; }
.box { position: absolute; transform: translate(-50%, -50%); border: 2px solid #d55e00; border-radius: 3px; pointer-events: none;
  box-shadow: 0 0 0 1.5px #fff, inset 0 0 0 1.5px #fff; }
.boxless .box { display: none; }
.both input { display: block; width: 100%; margin: .5rem 0 0; accent-color: var(--ink); }
[data-view=blink] .both input, [data-view=blink] .cut { display: none; }
.probe { min-height: 1.5em; margin: .5rem 0 0; font: .82rem/1.5 ui-monospace, monospace; color: var(--quiet); overflow-wrap: anywhere; }
.probe i { display: inline-block; width: .8em; height: .8em; border: 1px solid var(--line); margin: 0 .3em 0 .8em; vertical-align: -.05em; }
footer { padding-top: .6rem; padding-bottom: 2rem; color: var(--quiet); font-size: .82rem; }
kbd { font: inherit; font-size: .78rem; border: 1px solid var(--line); border-bottom-width: 2px; border-radius: .25rem; padding: 0 .3rem; background: var(--paper); }
.approve { position: sticky; bottom: 0; z-index: 3; padding: .8rem clamp(1rem, 2.5vw, 2.5rem); background: var(--paper); border-top: 1px solid var(--line); box-shadow: 0 -6px 18px rgb(0 0 0 / .09); }
.approve p { margin: 0 0 .45rem; font-size: .87rem; }
.approve div { display: flex; gap: .7rem; align-items: flex-start; }
.approve code { flex: 1; min-width: 0; max-height: 8rem; overflow: auto; font: .82rem/1.55 ui-monospace, monospace; white-space: pre-wrap; overflow-wrap: anywhere;
  padding: .45rem .65rem; border-radius: .4rem; background: var(--well); user-select: all; }
[hidden] { display: none !important; }
@media print { .bar, .approve, .take, footer { display: none; } section { break-inside: avoid; } }
)css";

inline constexpr const char* kReportScript = R"js(
"use strict";
const all = (query, of = document) => [...of.querySelectorAll(query)];
const add = (parent, name, set = {}) => parent.appendChild(Object.assign(document.createElement(name), set));
const sections = all("section"), body = document.body, most = 64;
let current = null;

// one picture of a view and all that shows the same place of it: a section's scale, and the place in its middle
const cases = sections.map((section) => {
  const it = { section, s: 1, x: .5, y: .5, across: 0, views: all(".view", section), boxes: [], cut: 50 };
  const pictures = section.querySelector(".pictures");
  if (!pictures) return it;
  it.width = Number(pictures.dataset.width), it.height = Number(pictures.dataset.height);
  it.boxes = (pictures.dataset.boxes || "").split(" ").filter(Boolean).map((box) => box.split(",").map(Number));
  const pair = pictures.classList.contains("pair");
  if (pair) make_both(it, pictures);
  for (const view of it.views) {
    const image = view.querySelector("img");
    const [w, h] = ["width", "height"].map((name) => Number(image.getAttribute(name)));
    view.classList.add("placed");
    view.style.aspectRatio = `${w} / ${h}`, view.style.maxWidth = `calc(82vh * ${w / h})`;
    for (const [x, y, w, h] of it.boxes) Object.assign(add(view, "i", { className: "box" }), { place: [x, y, w, h] });
    listen(it, view);
  }
  if (pair) it.probe = add(section, "p", { className: "probe" });
  return it;
});

// the two over each other, the actual one from the cut on
function make_both(it, pictures) {
  const figure = add(pictures, "figure", { className: "both" });
  it.caption = add(figure, "figcaption", { textContent: "expected | actual" });
  const view = add(figure, "div", { className: "view" });
  const clone = (kind, parent) => add(parent, "div", { className: "sheet" })
    .appendChild(pictures.querySelector(`.${kind} img`).cloneNode());
  clone("expected", view);
  it.over = add(view, "div", { className: "over" });
  clone("actual", it.over);
  it.line = add(view, "i", { className: "cut" });
  it.slider = add(figure, "input", { type: "range", min: 0, max: 100, step: .1, value: 50 });
  it.slider.setAttribute("aria-label", "where expected ends and actual begins");
  it.slider.addEventListener("input", () => cut(it));
  it.views.push(view);
  cut(it);
}

function cut(it) {
  if (!it.over) return;
  const slides = body.dataset.view !== "blink";
  it.over.style.clipPath = slides ? `inset(0 0 0 ${it.slider.value}%)` : "none";
  it.line.style.left = it.slider.value + "%";
  if (slides) it.over.hidden = false, it.caption.textContent = "expected | actual";
}

const bounded = (x, low, high) => Math.min(Math.max(x, low), high);
// pixels of the screen that one of the picture takes
const magnified = (it) => it.width ? it.s * it.across / it.width : 0;

// all widths are asked for before anything is placed: each time that both alternate the page is laid out anew
function place_all() {
  for (const it of cases) it.across = Math.max(0, ...it.views.map((view) => view.clientWidth));
  cases.forEach(place);
}

function place(it) {
  it.s = bounded(it.s, 1, most);
  it.x = bounded(it.x, .5 / it.s, 1 - .5 / it.s), it.y = bounded(it.y, .5 / it.s, 1 - .5 / it.s);
  const left = .5 - it.x * it.s, top = .5 - it.y * it.s, crisp = magnified(it) >= 2;
  for (const view of it.views) {
    view.classList.toggle("in", it.s > 1);
    view.classList.toggle("crisp", crisp);
    // laid out anew, not scaled: a scale would take the rounding of the layout along
    for (const sheet of all(".sheet", view))
      Object.assign(sheet.style, { left: left * 100 + "%", top: top * 100 + "%", width: it.s * 100 + "%", height: it.s * 100 + "%" });
    for (const box of all(".box", view)) {
      const [x, y, w, h] = box.place;
      box.style.left = (left + it.s * (x + w / 2) / it.width) * 100 + "%";
      box.style.top = (top + it.s * (y + h / 2) / it.height) * 100 + "%";
      box.style.width = `max(${it.s * w / it.width * 100}% + 10px, 26px)`;
      box.style.height = `max(${it.s * h / it.height * 100}% + 10px, 26px)`;
    }
  }
  if (it === current) tell_scale();
}

function tell_scale() {
  const percent = current ? magnified(current) * 100 : 0;
  document.querySelector(".scale").textContent = percent ? Math.round(percent) + " %" : "";
}

// the point at (u, v) of the view stays there
function zoom(it, by, u = .5, v = .5) {
  const px = it.x + (u - .5) / it.s, py = it.y + (v - .5) / it.s;
  it.s = bounded(it.s * by, 1, most);
  it.x = px - (u - .5) / it.s, it.y = py - (v - .5) / it.s;
  place(it);
}

function fit(it) { it.s = 1, it.x = it.y = .5; place(it); }

// the boxes fill two thirds of the view, or a pixel of it some thirty of the screen
function to_difference(it) {
  if (!it.boxes.length) return;
  const [x0, y0] = [0, 1].map((k) => Math.min(...it.boxes.map((box) => box[k])));
  const [x1, y1] = [0, 1].map((k) => Math.max(...it.boxes.map((box) => box[k] + box[k + 2])));
  const near = 32 / (magnified(it) / it.s || 1);
  it.s = bounded(Math.min(it.width / (x1 - x0) / 1.5, it.height / (y1 - y0) / 1.5, near), 1, most);
  it.x = (x0 + x1) / 2 / it.width, it.y = (y0 + y1) / 2 / it.height;
  place(it);
}

function listen(it, view) {
  const at = (event) => {
    const box = view.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  view.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    choose(it);
    zoom(it, Math.exp(-bounded(event.deltaY, -60, 60) / 60 * .35), ...at(event));
  }, { passive: false });
  view.addEventListener("dblclick", (event) => { choose(it); if (event.shiftKey) fit(it); else zoom(it, 2, ...at(event)); });
  let held = null, slides = false;
  const slide = (u) => { it.slider.value = u * 100; cut(it); };
  view.addEventListener("pointerdown", (event) => {
    choose(it);
    slides = view.contains(it.line || null) && body.dataset.view === "slide" && it.s === 1;
    if (event.button !== 0 || (it.s === 1 && !slides)) return;
    held = at(event);
    if (slides) slide(held[0]);
    view.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  view.addEventListener("pointermove", (event) => {
    const [u, v] = at(event);
    if (held && slides) {
      slide(u);
    } else if (held) {
      it.x -= (u - held[0]) / it.s, it.y -= (v - held[1]) / it.s, held = [u, v];
      place(it);
    }
    tell_pixel(it, it.x + (u - .5) / it.s, it.y + (v - .5) / it.s);
  });
  for (const end of ["pointerup", "pointercancel"]) view.addEventListener(end, () => { held = null; });
  view.addEventListener("pointerleave", () => { if (it.probe) it.probe.replaceChildren(); });
}

// both colours of the pixel under the pointer
function tell_pixel(it, u, v) {
  if (!it.probe) return;
  const x = bounded(Math.floor(u * it.width), 0, it.width - 1), y = bounded(Math.floor(v * it.height), 0, it.height - 1);
  it.colors ||= ["expected", "actual"].map((kind) => {
    const canvas = Object.assign(document.createElement("canvas"), { width: it.width, height: it.height });
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(it.section.querySelector(`.${kind} img`), 0, 0);
    return context;
  });
  it.probe.replaceChildren(`(${x}, ${y})`);
  ["expected", "actual"].forEach((kind, k) => {
    const color = [...it.colors[k].getImageData(x, y, 1, 1).data];
    add(it.probe, "i").style.background = `rgba(${color.slice(0, 3)}, ${color[3] / 255})`;
    it.probe.append(`${kind} ${(color[3] === 255 ? color.slice(0, 3) : color).join(" ")}`);
  });
}

function choose(it, scroll = false) {
  if (current) current.section.classList.remove("at");
  current = it;
  it.section.classList.add("at");
  tell_scale();
  if (scroll) it.section.scrollIntoView({ block: "start" });
}

// which sections are shown
const filters = all("[data-show]");
for (const button of filters) button.addEventListener("click", () => {
  for (const other of filters) other.classList.toggle("on", other === button);
  for (const section of sections) section.hidden = button.dataset.show !== "" && section.dataset.state !== button.dataset.show;
  place_all();
});

// how pairs are shown
const views = all("[data-how]");
let blinking = 0;
function view(how) {
  body.dataset.view = how;
  for (const button of views) button.classList.toggle("on", button.dataset.how === how);
  clearInterval(blinking);
  cases.forEach(cut);
  place_all();
  if (how === "blink") blinking = setInterval(blink, 500), blink();
}
let seen = 0;
function blink() {
  ++seen;
  for (const it of cases) {
    if (!it.over) continue;
    it.over.hidden = seen % 2 === 1;
    it.caption.textContent = it.over.hidden ? "expected" : "actual";
  }
}
for (const button of views) button.addEventListener("click", () => view(button.dataset.how));

const acts = {
  in: () => current && zoom(current, 1.5), out: () => current && zoom(current, 1 / 1.5), fit: () => current && fit(current),
  difference: () => current && to_difference(current),
  boxes: () => document.querySelector("[data-act=boxes]").classList.toggle("on", !body.classList.toggle("boxless")),
};
for (const button of all("[data-act]")) button.addEventListener("click", () => acts[button.dataset.act]());

// pictures chosen as references become a command
const bar = document.querySelector(".approve"), boxes = all(".take input");
const word = (text) => /^[\w@%+=:,.\/-]+$/.test(text) ? text : "'" + text.replaceAll("'", "'\\''") + "'";
function approve() {
  const chosen = boxes.filter((box) => box.checked);
  bar.hidden = chosen.length === 0;
  bar.querySelector("output").textContent = `${chosen.length} of ${boxes.length}`;
  bar.querySelector("code").textContent = bar.dataset.command + chosen.map((box) => " --only " + word(box.value)).join("");
}
for (const box of boxes) box.addEventListener("change", approve);
if (bar) {
  const button = bar.querySelector(".copy"), code = bar.querySelector("code");
  button.addEventListener("click", async () => {
    getSelection().selectAllChildren(code);
    try { await navigator.clipboard.writeText(code.textContent); } catch { document.execCommand("copy"); }
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1500);
  });
  bar.querySelector(".every").addEventListener("click", () => {
    for (const box of boxes) box.checked = !box.closest("section").hidden;
    approve();
  });
  bar.querySelector(".none").addEventListener("click", () => {
    for (const box of boxes) box.checked = false;
    approve();
  });
}

const step = (by) => {
  const shown = cases.filter((it) => !it.section.hidden);
  if (shown.length) choose(shown[bounded(shown.indexOf(current) + by, 0, shown.length - 1)], true);
};
const keys = {
  j: () => step(1), k: () => step(-1), 1: () => view("beside"), 2: () => view("slide"), 3: () => view("blink"), 4: () => view("difference"),
  "+": acts.in, "-": acts.out, 0: acts.fit, z: acts.difference, x: acts.boxes,
  a: () => { const box = current && current.section.querySelector(".take input"); if (box) box.checked = !box.checked, approve(); },
};
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
  keys[event.key]();
  event.preventDefault();
});

addEventListener("resize", place_all);
view("beside");
if (cases.length) choose(cases.find((it) => it.boxes.length) || cases[0]);
)js";

}  // namespace obscura::app
