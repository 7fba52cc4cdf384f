#include "page/html.h"

#include <libdeflate.h>

#include <map>
#include <memory>

#include "page/error.h"
#include "page/markup.h"
#include "page/player.h"
#include "page/sha256.h"

namespace obscura::page {
namespace {

constexpr int kEffort = 9;  // of libdeflate, to 12: more takes long for little

// a zlib stream, which browsers call "deflate"
std::vector<std::uint8_t> deflated(const std::string& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> tool(
      libdeflate_alloc_compressor(kEffort), libdeflate_free_compressor);
  if (!tool) throw Error("libdeflate cannot be started: out of memory");
  std::vector<std::uint8_t> out(libdeflate_zlib_compress_bound(tool.get(), bytes.size()));
  out.resize(libdeflate_zlib_compress(tool.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

std::string by_hash(const std::string& text) { return "'sha256-" + base64(sha256(text)) + "'"; }

constexpr std::string_view kOriginBefore = "<meta name=\"obscura\" content=\"";

// the text of an attribute, the other way round
std::string unescaped(std::string_view text) {
  static const std::map<std::string_view, char> kNames{{"&amp;", '&'},  {"&lt;", '<'},   {"&gt;", '>'},
                                                       {"&quot;", '"'}, {"&#39;", '\''}, {"&apos;", '\''}};
  std::string all;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t end = text[i] == '&' ? text.find(';', i) : text.npos;
    const auto name = end == text.npos ? kNames.end() : kNames.find(text.substr(i, end + 1 - i));
    if (name == kNames.end()) {
      all += text[i];
    } else {
      all += name->second;
      i = end;
    }
  }
  return all;
}

}  // namespace

std::string html(const FilmPage& page, Reel& reel) {
  nlohmann::ordered_json json;
  json["film"] = page.film;
  const std::string streams = reel.finish(json["reel"]);
  const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string bytes;
  for (int k = 0; k < 4; ++k) bytes += char(text.size() >> (8 * k) & 0xFF);
  bytes += text + streams;

  std::string story;
  for (const std::string& sentence : page.sentences) story += "<li>" + escaped(sentence) + "</li>";
  const std::map<std::string, std::string, std::less<>> words{
      {"style_hash", by_hash(kPlayerStyle)},
      {"script_hash", by_hash(kPlayerScript)},
      {"connect", page.watched ? "; connect-src 'self'" : ""},
      {"watched", page.watched ? " data-watched" : ""},
      {"generator", escaped(page.generator)},
      {"origin", escaped(page.origin)},
      {"title", escaped(page.title)},
      {"theme", page.dark ? "screen" : "paper"},
      {"noscript", "This page plays a film, and needs JavaScript for it. Below is told what happens in it."},
      {"still", page.still.empty() ? ""
                                   : "<img class=\"still\" alt=\"" + escaped(page.title) +
                                         "\" src=\"data:image/svg+xml;base64," + base64(page.still) + "\">"},
      {"story", story},
      {"footer", escaped(page.footer)},
      {"style", kPlayerStyle},
      {"script", kPlayerScript},
      {"data", base64(deflated(bytes))},
  };
  std::string all;
  for (std::size_t at = 0; at < kPlayerPage.size();) {
    const std::size_t mark = kPlayerPage.find('@', at), end = kPlayerPage.find('@', mark + 1);
    if (mark == std::string::npos || end == std::string::npos) {
      all += kPlayerPage.substr(at);
      break;
    }
    all += kPlayerPage.substr(at, mark - at);
    all += words.at(kPlayerPage.substr(mark + 1, end - mark - 1));
    at = end + 1;
  }
  return all;
}

std::string words_page(const std::string& title, const std::vector<std::string>& lines, bool dark) {
  static const std::string style =
      "body{font:15px/1.5 Inter,system-ui,sans-serif;margin:0;padding:2rem clamp(1rem,5vw,5rem)}"
      "body{color:#1f2328;background:#fff}[data-theme=screen]{color:#e8edf2;background:#0e1318}"
      "h1{font-size:1.2rem}pre{font:14px/1.6 "
      "ui-monospace,monospace;white-space:pre-wrap;overflow-wrap:anywhere}";
  static const std::string script =
      "new EventSource('changes').addEventListener('message',e=>{"
      "if(e.data!==document.body.dataset.watched)location.reload()});";
  std::string words;
  for (const std::string& line : lines) words += escaped(line) + "\n";
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src " +
         by_hash(style) + "; script-src " + by_hash(script) +
         "; connect-src 'self'; base-uri 'none'; form-action 'none'\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title) + "</title>\n<style>" + style + "</style>\n</head>\n<body data-theme=\"" +
         (dark ? "screen" : "paper") + "\" data-watched>\n<main role=\"alert\"><h1>" + escaped(title) +
         "</h1><pre>" + words + "</pre></main>\n<script>" + script + "</script>\n</body>\n</html>\n";
}

std::string origin_in_html(const std::string& file) {
  const std::size_t at = file.find(kOriginBefore), from = at + kOriginBefore.size();
  const std::size_t end = at == file.npos ? file.npos : file.find('"', from);
  return end == file.npos ? "" : unescaped(std::string_view(file).substr(from, end - from));
}

}  // namespace obscura::page
