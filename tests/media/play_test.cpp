// Plays and seeks our movies in a browser: headless Chromium opens a page of ours, whose script plays each
// movie, seeks about in it, draws it into a canvas and compares pixels with what the file was made of; its
// verdict comes back as a line of the console.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "media/browser.h"
#include "media/movie.h"
#include "media/pictures.h"
#include "needs.h"

namespace obscura::media {
namespace {

constexpr int kWidth = 320, kHeight = 180, kSeconds = 5;
constexpr std::uint8_t kColours[kSeconds][3] = {
    {230, 159, 0}, {0, 114, 178}, {0, 158, 115}, {204, 121, 167}, {240, 240, 240}};

// On the left the second's colour; on the right a grey that says which frame of the second it is.
Image clock_face(int second, int frame, int frames) {
  Image image{kWidth, kHeight, std::vector<std::uint8_t>(std::size_t(4) * kWidth * kHeight, 255)};
  const std::uint8_t grey = std::uint8_t(20 + 200 * frame / frames);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int k = 0; k < 3; ++k) image.row(y)[4 * x + k] = x < kWidth / 2 ? kColours[second][k] : grey;
    }
  }
  return image;
}

void write_clock(const std::string& path, int fps, const std::string& preset) {
  MovieSpec spec;
  spec.width = kWidth, spec.height = kHeight, spec.fps_num = fps, spec.preset = preset;
  MovieWriter writer(path, spec);
  for (int second = 0; second < kSeconds; ++second) {
    SegmentEncoder encoder(path, spec);
    for (int frame = 0; frame < fps; ++frame) encoder.add(clock_face(second, frame, fps));
    writer.add(encoder.finish());
  }
  writer.close();
}

constexpr const char* kPage = R"html(<!doctype html><meta charset="utf-8"><canvas id="c"></canvas><script>
const colours = [[230,159,0],[0,114,178],[0,158,115],[204,121,167],[240,240,240]];
const movies = [["quick.mp4", 30], ["medium.mp4", 60]];
const canvas = document.getElementById("c"), wrong = [];
let looked = 0;
const say = (verdict) => console.log("OBSCURA " + verdict);
const event = (video, name) => new Promise((resolve, reject) => {
  video.addEventListener(name, resolve, {once: true});
  video.addEventListener("error", () => reject(new Error(video.error ? video.error.message : "error")), {once: true});
});
function pixel(video, x) {
  canvas.width = video.videoWidth; canvas.height = video.videoHeight;
  const context = canvas.getContext("2d", {willReadFrequently: true});
  context.drawImage(video, 0, 0);
  return [...context.getImageData(x, 90, 1, 1).data].slice(0, 3);
}
function look(video, name, fps, time) {
  const second = Math.floor(time), frame = Math.floor((time - second) * fps + 1e-6);
  const grey = 20 + Math.floor(200 * frame / fps);
  // the encoder's quantiser costs saturated colours some levels of blue; the second is told by far more. The grey is
  // luma alone, and differs by three or six from frame to frame
  const compare = (what, got, want, within) => {
    ++looked;
    if (got.some((v, k) => Math.abs(v - want[k]) > within)) wrong.push(`${name} at ${time}: ${what} ${got}, not ${want}`);
  };
  compare("colour", pixel(video, 80), colours[second], 12);
  compare("grey", pixel(video, 240), [grey, grey, grey], fps == 30 ? 3 : 1.5);
}
// seeks, and waits until the frame there is shown: "seeked" may come before it
async function seek(video, name, fps, time) {
  const shown = new Promise((resolve) => {
    const late = setTimeout(() => { wrong.push(`${name} at ${time}: the frame is not shown`); resolve(); }, 600000);
    const step = (now, frame) => {
      if (Math.abs(frame.mediaTime + 0.5 / fps - time) < 0.1 / fps) { clearTimeout(late); resolve(); }
      else video.requestVideoFrameCallback(step);
    };
    video.requestVideoFrameCallback(step);
  });
  const done = event(video, "seeked");
  video.currentTime = time;
  await done;
  await shown;
}
async function watch(name, fps) {
  const video = document.createElement("video");
  video.muted = true; video.preload = "auto"; video.src = name;
  document.body.append(video);
  await event(video, "canplaythrough");
  if (video.videoWidth != 320 || video.videoHeight != 180) wrong.push(`${name}: ${video.videoWidth} x ${video.videoHeight}`);
  if (Math.abs(video.duration - 5) > 1e-3) wrong.push(`${name}: lasts ${video.duration} s`);
  await video.play();
  await new Promise((resolve) => { const id = setInterval(() => { if (video.currentTime > 0.4) { clearInterval(id); resolve(); } }, 20); });
  video.pause();
  // the middle of frames: forth, back, the first and the last
  for (const [second, frame] of [[3, fps / 2], [1, fps - 1], [4, fps - 1], [0, 0], [2, 1], [4, 0]]) {
    const time = second + (frame + 0.5) / fps;
    await seek(video, name, fps, time);
    look(video, name, fps, time);
  }
  video.currentTime = 4.8;
  await event(video, "seeked");
  const ended = event(video, "ended");
  await video.play();
  await ended;
}
(async () => {
  try {
    for (const [name, fps] of movies) await watch(name, fps);
    say(wrong.length ? "FAIL " + wrong.join("; ") : `PASS ${looked} pixels`);
  } catch (error) { say("FAIL " + error + " " + wrong.join("; ")); }
})();
</script>)html";

TEST(Play, ChromiumPlaysAndSeeksOurMoviesToTheFrame) {
  const auto program = browser();
  OBSCURA_NEEDS(program, "chromium-headless-shell");
  Folder folder;
  write_clock(folder / "quick.mp4", 30, "");
  write_clock(folder / "medium.mp4", 60, "medium");
  std::ofstream(folder / "page.html") << kPage;
  const std::string said = verdict(*program, folder.path);
  EXPECT_EQ(said.substr(0, 4), "PASS") << said;
}

}  // namespace
}  // namespace obscura::media
