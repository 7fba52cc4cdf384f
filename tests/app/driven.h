#pragma once

#include <fstream>
#include <string>

#include "media/browser.h"
#include "page/markup.h"
#include "page/sha256.h"

namespace obscura::app {

/// What a script that drives a page begins and ends with: check(good, what) collects what is wrong, and
/// `more`, which is said after PASS.
inline const char* const kDriveBefore = R"js(addEventListener("load", async () => {
  const wrong = [], say = (verdict) => console.log("OBSCURA " + verdict);
  const check = (good, what) => { if (!good) wrong.push(what); };
  const one = (query) => document.querySelector(query), many = (query) => [...document.querySelectorAll(query)];
  const frame = () => new Promise((go) => setTimeout(go, 20));
  const rect = (query) => one(query).getBoundingClientRect();
  const orange = (image) => {
    const canvas = document.createElement("canvas");
    canvas.width = image.naturalWidth, canvas.height = image.naturalHeight;
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const data = context.getImageData(0, 0, canvas.width, canvas.height).data;
    for (let i = 0; i < data.length; i += 4) if (data[i] === 213 && data[i + 1] === 94 && data[i + 2] === 0) return true;
    return false;
  };
  let more = "";
  try {
)js";
inline const char* const kDriveAfter = R"js(
  } catch (error) { wrong.push(error.stack); }
  say(wrong.length ? "FAIL " + wrong.join("; ") : "PASS " + more + " ");
});)js";

/// What a browser says of a page that is driven by `checks`. The page's content security policy is told of
/// that script, and of nothing else.
inline std::string drive(std::string page, const std::string& checks, const std::string& folder) {
  const std::string script = kDriveBefore + checks + kDriveAfter;
  page.insert(page.rfind("</body>"), "<script>" + script + "</script>");
  page.insert(page.find("script-src ") + 11, "'sha256-" + page::base64(page::sha256(script)) + "' ");
  std::ofstream(folder + "/page.html") << page;
  return media::verdict(*media::browser(), folder);
}

}  // namespace obscura::app
