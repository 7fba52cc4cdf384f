#pragma once

namespace obscura::app {

// What a report is made of besides its findings: the style, and the script that filters, slides and blinks.
// The slider lays the actual picture over the expected one, cut at its place.

inline constexpr const char* kReportHead = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<style>
body { font: 15px/1.5 Inter, system-ui, sans-serif; margin: 2rem; color: #1c1c1c; background: #fff; }
h1 { font-size: 1.4rem; } h2 { font-size: 1.05rem; margin: 0; }
h2 b { font-weight: 500; font-size: .8rem; padding: .1rem .5rem; border-radius: 1rem; background: #ddd; }
section { border-top: 1px solid #ddd; padding: 1rem 0; }
section[data-state=differs] b, section[data-state=failed] b { background: #d55e00; color: #fff; }
section[data-state=missing] b { background: #e69f00; }
section[data-state=same] b { background: #009e73; color: #fff; }
p { margin: .2rem 0; max-width: 70rem; }
nav button, figcaption button { font: inherit; border: 1px solid #bbb; background: #fff; border-radius: .3rem; padding: .1rem .6rem; margin-right: .4rem; }
nav button.on { background: #1c1c1c; color: #fff; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; margin-top: .6rem; }
figure { margin: 0; } figcaption { color: #666; font-size: .85rem; }
img, .stack { border: 1px solid #ddd; image-rendering: auto; max-width: 100%;
  background: repeating-conic-gradient(#eee 0 25%, #fff 0 50%) 0 0 / 16px 16px; }
.stack { position: relative; overflow: hidden; }
.stack img { position: absolute; left: 0; top: 0; border: 0; width: 100%; height: 100%; }
[hidden] { display: none; }
</style>
)html";

inline constexpr const char* kReportTail = R"html(<script>
const each = (query, of, what) => of.querySelectorAll(query).forEach(what);
each("nav button", document, (button) => button.addEventListener("click", () => {
  each("nav button", document, (other) => other.classList.toggle("on", other === button));
  each("section", document, (section) => {
    section.hidden = button.dataset.show !== "" && section.dataset.state !== button.dataset.show;
  });
}));
each("section", document, (section) => {
  const stack = section.querySelector(".stack");
  if (!stack) return;
  const over = section.querySelector(".actual img").cloneNode();
  stack.append(section.querySelector(".expected img").cloneNode(), over);
  const slider = section.querySelector("input"), button = section.querySelector(".both button");
  const cut = () => { over.style.clipPath = `inset(0 0 0 ${slider.value}%)`; };
  slider.addEventListener("input", cut);
  cut();
  let blinking = 0;
  button.addEventListener("click", () => {
    if (blinking) { clearInterval(blinking); blinking = 0; button.textContent = "blink"; over.hidden = false; cut(); return; }
    button.textContent = "stop";
    over.style.clipPath = "none";
    blinking = setInterval(() => { over.hidden = !over.hidden; }, 400);
  });
});
</script></body></html>
)html";

}  // namespace obscura::app
