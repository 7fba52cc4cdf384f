// The page of a report, in a browser: it is driven by a script that its content security policy is told of.

#include "app/compare/report.h"

#include <gmock/gmock.h>

#include "driven.h"
#include "needs.h"
#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

media::Image flat(int width, int height, std::uint8_t level = 200) {
  media::Image image{width, height, std::vector<std::uint8_t>(std::size_t(4) * width * height, level)};
  for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
  return image;
}

media::Image with_pixel(media::Image image, int x, int y, std::uint8_t level) {
  for (int k = 0; k < 3; ++k) image.row(y)[4 * x + k] = level;
  return image;
}

Finding pair(const std::string& name, media::Image expected, media::Image actual) {
  return {.name = name,
          .state = "differs",
          .lines = {"it differs"},
          .expected = std::move(expected),
          .actual = std::move(actual),
          .expected_by = "obscura 1, OpenGL 4",
          .actual_by = "obscura 2, OpenGL 5",
          .choice = ""};
}

Finding same(const std::string& name, media::Image image) {
  Finding finding = pair(name, image, image);
  finding.state = "same";
  return finding;
}

class Report : public Program {
 protected:
  // what a browser finds of `checks` on the page
  std::string verdict(const ReportTitle& title, const std::vector<Finding>& findings, const char* checks) {
    return drive(report(title, findings), checks, folder_.string());
  }
  const bool there_ = media::browser().has_value();
};

TEST_F(Report, OnePixelIsFoundAtAGlance) {
  OBSCURA_NEEDS(there_, "chromium-headless-shell");
  const media::Image image = flat(1920, 1080);
  EXPECT_THAT(verdict({"T", ""}, {pair("one", image, with_pixel(image, 1700, 90, 120))}, R"js(
    const pairs = [".expected", ".actual", ".difference"];
    for (const kind of pairs) {
      const box = rect(`${kind} .box`), view = rect(`${kind} .view`);
      check(box.width >= 20 && box.height >= 20, `${kind}: the box is ${box.width} wide`);
      const x = view.left + 1700.5 / 1920 * view.width, y = view.top + 90.5 / 1080 * view.height;
      check(Math.abs(box.left + box.width / 2 - x) < 3 && Math.abs(box.top + box.height / 2 - y) < 3, `${kind}: the box is elsewhere`);
    }
    // beside each other, of one size, from edge to edge
    const [a, b] = [rect(".expected .view"), rect(".actual .view")], row = rect(".pictures");
    check(a.top === b.top && a.right < b.left && Math.abs(a.width - b.width) < 1, "not beside each other");
    check(Math.abs(a.left - row.left) < 2 && a.width > row.width / 3.4, "not as wide as there is room");
    one("[data-act=difference]").click();
    for (const kind of pairs) {
      const sheet = rect(`${kind} .sheet`), view = rect(`${kind} .view`);
      check(sheet.width / 1920 > 8, `a pixel is ${sheet.width / 1920} wide`);
      // the pixel is in the middle, and the box is around it
      const x = sheet.left + 1700.5 / 1920 * sheet.width, box = rect(`${kind} .box`);
      check(x > view.left && x < view.right, `${kind}: the pixel is out of sight`);
      check(box.left < x - sheet.width / 3840 && box.right > x + sheet.width / 3840, `${kind}: the box is not around the pixel`);
    }
    // its colours are told
    const view = rect(".actual .view");
    const sheet = rect(".actual .sheet");
    one(".actual .view").dispatchEvent(new PointerEvent("pointermove",
      { clientX: sheet.left + 1700.5 / 1920 * sheet.width, clientY: sheet.top + 90.5 / 1080 * sheet.height }));
    check(one(".probe").textContent === "(1700, 90)expected 200 200 200actual 120 120 120", one(".probe").textContent);
    one("[data-act=boxes]").click();
    check(getComputedStyle(one(".box")).display === "none", "boxes stay");
  )js"),
              StartsWith("PASS"));
}

TEST_F(Report, ZoomAndDragGoAlongInAllPictures) {
  OBSCURA_NEEDS(there_, "chromium-headless-shell");
  const media::Image image = flat(160, 90);
  EXPECT_THAT(verdict({"T", ""}, {pair("one", image, with_pixel(image, 80, 45, 120))}, R"js(
    const sheets = () => many(".sheet").filter((each) => each.offsetParent).map((each) => ["left", "top", "width", "height"].map((k) => each.style[k]).join());
    const alike = () => new Set(sheets()).size === 1;
    const before = sheets()[0], view = rect(".actual .view");
    const at = (u, v, more = {}) => ({ clientX: view.left + u * view.width, clientY: view.top + v * view.height, bubbles: true, cancelable: true, ...more });
    const send = (event) => one(".actual .view").dispatchEvent(event);
    // the wheel alone is the page's
    check(send(new WheelEvent("wheel", at(.2, .3, { deltaY: -60 }))), "the wheel is taken away from the page");
    check(sheets()[0] === before, "it zooms without Ctrl");
    check(!send(new WheelEvent("wheel", at(.2, .3, { deltaY: -60, ctrlKey: true }))), "Ctrl and the wheel zoom the page");
    check(sheets()[0] !== before && alike(), "zoom does not go along: " + sheets().join(" | "));
    // what lay under the pointer stays there
    const sheet = rect(".expected .sheet"), whole = rect(".expected .view");
    check(Math.abs((whole.left + .2 * whole.width - sheet.left) / sheet.width - .2) < .01, "it zooms elsewhere");
    const zoomed = sheets()[0];
    one(".actual .view").setPointerCapture = () => {};
    send(new PointerEvent("pointerdown", at(.5, .5, { button: 0 })));
    send(new PointerEvent("pointermove", at(.45, .5)));
    send(new PointerEvent("pointerup", at(.45, .5)));
    check(sheets()[0] !== zoomed && alike(), "drag does not go along");
    // never out of the picture
    send(new PointerEvent("pointerdown", at(.5, .5, { button: 0 })));
    send(new PointerEvent("pointermove", at(9, 9)));
    send(new PointerEvent("pointerup", at(9, 9)));
    check(Math.abs(rect(".actual .sheet").left - view.left) < 2, "it is dragged out of the picture");
    one("[data-act=fit]").click();
    check(sheets()[0] === before && alike(), "fit does not fit");
    dispatchEvent(new KeyboardEvent("keydown", { key: "+" }));
    check(sheets()[0] !== before && alike(), "a key does not zoom");
  )js"),
              StartsWith("PASS"));
}

TEST_F(Report, FiltersSlidesAndBlinks) {
  OBSCURA_NEEDS(there_, "chromium-headless-shell");
  const media::Image image = flat(160, 90);
  EXPECT_THAT(verdict({"Golden images", ""},
                      {pair("one", image, with_pixel(image, 80, 45, 120)), pair("two", image, flat(100, 80)),
                       same("three", image)},
                      R"js(
    check(many("section").length === 3, "not three sections");
    for (const image of document.images) check(image.naturalWidth > 0, "a picture is not there");
    const [differs, sizes, same] = many("section");
    const button = (state) => one(`nav button[data-show="${state}"]`);
    check(button("differs").textContent === "differs 2", "wrong counts");
    button("differs").click();
    check(same.hidden && !differs.hidden, "the filter does not filter");
    check(one(".scale").textContent === Math.round(one(".expected .view").clientWidth / 1.6) + " %", "a scale of " + one(".scale").textContent);
    button("").click();
    check(!same.hidden && !differs.hidden, "the filter does not let all through");
    check(same.querySelectorAll("img").length === 1, "what is the same is there twice");
    // of two sizes both are there in every view, and nothing over the other
    check(sizes.querySelectorAll("img").length === 3, "of two sizes one is not there");
    const how = (name) => one(`[data-how=${name}]`).click();
    const visible = (query) => many(query).some((each) => each.offsetParent);
    check(visible(".pair .expected") && !visible(".both"), "not beside each other");
    how("slide");
    check(!visible(".pair .expected") && visible(".both") && [...sizes.querySelectorAll("figure")].every((each) => each.offsetParent), "nothing to slide");
    const over = one(".over"), slider = one(".both input");
    slider.value = 25;
    slider.dispatchEvent(new Event("input"));
    check(getComputedStyle(over).clipPath === "inset(0px 0px 0px 25%)", "the slider does not slide: " + getComputedStyle(over).clipPath);
    how("blink");
    const seen = new Set();
    while (seen.size < 2) { await frame(); seen.add(over.hidden + one(".both figcaption").textContent); }
    check(seen.has("trueexpected") && seen.has("falseactual"), "it does not blink: " + [...seen].join());
    how("difference");
    check(visible(".difference") && !visible(".pair .actual") && !visible(".both"), "not the difference alone");
    how("beside");
    check(!over.hidden, "it does not stop blinking");
    // the difference is orange somewhere, the expected picture nowhere
    check(orange(one(".difference img")), "the difference is not coloured");
    check(!orange(one(".expected img")), "the expected picture is coloured");
    const text = document.body.innerText;
    for (const word of ["by more than a moved edge", "an edge that moved by less than a pixel", "obscura 1, OpenGL 4", "obscura 2, OpenGL 5", "UTC"])
      check(text.includes(word), `it does not say '${word}'`);
    check(/^\d{4}-\d\d-\d\d \d\d:\d\d UTC$/.test(one("time").textContent), "no date: " + one("time").textContent);
    // keys go from one to the next
    dispatchEvent(new KeyboardEvent("keydown", { key: "j" }));
    check(sizes.classList.contains("at"), "j does not go to the next");
    dispatchEvent(new KeyboardEvent("keydown", { key: "k" }));
    check(differs.classList.contains("at"), "k does not go back");
    check(!document.documentElement.innerHTML.match(/(src|href)="(?!data:|#)/), "the page needs another file");
  )js"),
              StartsWith("PASS"));
}

TEST_F(Report, WhatIsApprovedBecomesACommandThatAShellReads) {
  OBSCURA_NEEDS(there_, "chromium-headless-shell");
  const media::Image image = flat(40, 30);
  std::vector<Finding> findings;
  for (const char* choice : {"room@2.5:0f", "it's a room; rm x@1:2a", ""}) {
    findings.push_back(pair("a", image, with_pixel(image, 3, 3, 0)));
    findings.back().choice = choice;
  }
  EXPECT_THAT(verdict({"T", "obscura golden 'my scenes' --update"}, findings, R"js(
    const bar = one(".approve"), code = one(".approve code");
    check(many(".take").length === 2, "what cannot be approved can");
    check(bar.hidden, "a command without a choice");
    one(".take input").click();
    check(!bar.hidden && code.textContent === "obscura golden 'my scenes' --update --only room@2.5:0f", code.textContent);
    many(".take input")[1].click();
    check(code.textContent.endsWith(" --only room@2.5:0f --only 'it'\\''s a room; rm x@1:2a'"), code.textContent);
    check(one(".approve output").textContent === "2 of 2", one(".approve output").textContent);
    one(".none").click();
    check(bar.hidden, "none is still some");
    dispatchEvent(new KeyboardEvent("keydown", { key: "a" }));
    check(one(".take input").checked && !bar.hidden, "a key does not approve");
    one(".every").click();
    check(many(".take input").every((each) => each.checked), "not all shown are approved");
  )js"),
              StartsWith("PASS"));
}

TEST_F(Report, WhatNamesSayIsTextAndNothingElseRuns) {
  OBSCURA_NEEDS(there_, "chromium-headless-shell");
  const std::string nasty = "\"><img src=x onerror=\"window.hacked=1\"><script>window.hacked=1</script>'&";
  const media::Image image = flat(40, 30);
  Finding finding = pair(nasty, image, with_pixel(image, 3, 3, 0));
  finding.state = nasty, finding.lines = {nasty, "\x1b[31m"}, finding.choice = nasty;
  finding.expected_by = finding.actual_by = nasty;
  EXPECT_THAT(verdict({nasty, nasty}, {finding}, R"js(
    const text = `"><img src=x onerror="window.hacked=1"><script>window.hacked=1</scr` + `ipt>'&`;
    check(document.title === text && one("h1").textContent === text, "the title is another");
    check(one("h2").textContent === text && one(".lines li").textContent === text, "a name is another");
    check(one(".take input").value === text && one(".approve").dataset.command === text, "a choice is another");
    // not even what gets in runs, is fetched or has a style of its own
    const script = document.createElement("script");
    script.textContent = "window.hacked = 2";
    document.body.append(script);
    document.body.insertAdjacentHTML("beforeend", `<p id="p" style="color: red" onclick="window.hacked = 3">x</p><form action="data:,x"></form>`);
    one("#p").click();
    check(getComputedStyle(one("#p")).color !== "rgb(255, 0, 0)", "a style of its own");
    let fetched = true;
    try { await fetch("data:,x"); } catch { fetched = false; }
    check(!fetched, "it fetches");
    check(window.hacked === undefined, "a script runs: " + window.hacked);
  )js"),
              StartsWith("PASS"));
}

TEST_F(Report, IsTheSameBytesAtOneDate) {
  ::setenv("SOURCE_DATE_EPOCH", "1767225600", 1);
  const std::string page = report({"T", ""}, {same("one", flat(4, 3))});
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_THAT(page, HasSubstr("2026-01-01 00:00 UTC"));
  EXPECT_THAT(page, Not(HasSubstr("class=\"approve\""))) << "nothing is to be approved";
}

}  // namespace
}  // namespace obscura::app
