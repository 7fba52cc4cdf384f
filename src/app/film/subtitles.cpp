// Captions and chapters by frame: for each frame of the movie what is shown in it. So they begin and end with
// frames, whatever the film's speed, and the text track of a share of a film is that of its frames.

#include "app/film/subtitles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "draw/picture/prose.h"
#include "scene/complaints.h"

namespace obscura::app {

namespace {

constexpr double kChapter = 1;  // s: a chapter of a mark is no shorter

// "00:01:02.500"
std::string cue_time(double seconds) {
  const auto ms = std::llround(1000 * seconds);
  return fmt::format("{:02}:{:02}:{:02}.{:03}", ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

// text as WebVTT has it: no markup, and no empty line, which would end the cue
std::string escaped(const std::string& text) {
  std::string all;
  for (const char c : text) {
    if (c == '\n' && (all.empty() || all.back() == '\n')) all += "\u00a0";
    if (c == '&')
      all += "&amp;";
    else if (c == '<')
      all += "&lt;";
    else if (c == '>')
      all += "&gt;";
    else
      all += c;
  }
  return all;
}

}  // namespace

Subtitles subtitles(const scene::Scene& scene, const Shots& shots, std::int64_t frames,
                    const std::vector<std::pair<std::string, sim::Rational>>& marks) {
  Subtitles all;
  const draw::Titles& titles = scene.film.titles;
  if (titles.captions.empty() && titles.cards.empty() && marks.empty()) return all;
  const double fps = sim::value(scene.film.fps);
  const std::int64_t n = std::min(frames, shots.size());
  std::string before;
  const draw::Card* shown = nullptr;
  std::size_t mark = 0;  // the next
  std::map<std::string, int> times;
  for (std::int64_t i = 0; i < n; ++i) {
    const Shot shot = shots[i];
    const double time = sim::value(shot.time), film = film_time(shot, scene.film.fps, scene.film.speed);
    const auto card = std::find_if(titles.cards.begin(), titles.cards.end(), [&](const draw::Card& each) {
      return film >= each.begin - 1e-9 && film < each.end - 1e-9;
    });
    if (card != titles.cards.end() && &*card != shown) {
      shown = &*card;
      all.chapters.push_back(
          {double(i) / fps, 0, draw::in_letters(card->title.empty() ? card->text : card->title)});
    }
    for (; mark < marks.size() && !(shot.time < marks[mark].second); ++mark) {
      const int number = ++times[marks[mark].first];
      // what came before the film's first frame is no place in it
      if (i == 0 && marks[mark].second < shot.time) continue;
      const double begin = double(i) / fps;
      if (!all.chapters.empty() && begin - all.chapters.back().begin < kChapter) continue;
      const std::string name = scene::one_line(marks[mark].first);
      all.chapters.push_back({begin, 0, number > 1 ? fmt::format("{} ({})", name, number) : name});
    }
    std::string words;
    for (const draw::Caption& caption : titles.captions)
      if (caption.shown.has(time, film) && card == titles.cards.end())
        words += (words.empty() ? "" : "\n") + draw::in_letters(caption.text);
    if (words != before) {
      if (!before.empty()) all.captions.back().end = double(i) / fps;
      if (!words.empty()) all.captions.push_back({double(i) / fps, 0, words});
      before = words;
    }
  }
  if (!before.empty()) all.captions.back().end = double(n) / fps;
  if (!all.chapters.empty() && all.chapters.front().begin > 0)
    all.chapters.insert(all.chapters.begin(),
                        {0, 0, scene.look.title.empty() ? scene.name : draw::in_letters(scene.look.title)});
  for (std::size_t i = 0; i < all.chapters.size(); ++i)
    all.chapters[i].end = i + 1 < all.chapters.size() ? all.chapters[i + 1].begin : double(n) / fps;
  return all;
}

std::string webvtt(const std::vector<media::TextCue>& captions) {
  std::string all = "WEBVTT\n";
  for (const media::TextCue& cue : captions)
    all += fmt::format("\n{} --> {}\n{}\n", cue_time(cue.begin), cue_time(cue.end), escaped(cue.text));
  return all;
}

std::string captions_of(const std::string& movie) {
  return std::filesystem::path(movie).replace_extension(".vtt").string();
}

}  // namespace obscura::app
