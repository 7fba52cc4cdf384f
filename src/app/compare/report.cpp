#include "app/compare/report.h"

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <map>

#include "app/compare/report_page.h"
#include "media/file.h"
#include "media/pixels.h"
#include "media/png.h"
#include "page/markup.h"
#include "page/sha256.h"

namespace obscura::app {

namespace {

using page::escaped;

constexpr std::size_t kMostBoxes = 12;  // around what differs, of one picture

// "'sha256-...'": the name of a style or a script in a content security policy
std::string by_hash(const char* text) { return "'sha256-" + page::base64(page::sha256(text)) + "'"; }

// `about`: the words under it
std::string picture(const media::Image& image, const std::string& kind, const std::string& about) {
  std::string html = fmt::format(
      "<figure class=\"{0}\"><figcaption>{0}</figcaption>"
      "<div class=\"view\"><div class=\"sheet\"><img alt=\"{0}\" width=\"{1}\" height=\"{2}\" "
      "src=\"data:image/png;base64,{3}\"></div></div>",
      kind, image.width, image.height, page::base64(media::encode_png(image, {.alpha = true})));
  if (!about.empty()) html += "<p>" + escaped(about) + "</p>";
  return html + "</figure>\n";
}

// both pictures and what differs; boxes where the two are of one size
std::string pictures(const Finding& finding) {
  const auto &expected = finding.expected, &actual = finding.actual;
  if (!expected && !actual) return "";
  if (!expected || !actual || *expected == *actual) {
    const media::Image& image = expected ? *expected : *actual;
    return fmt::format("<div class=\"pictures one\" data-width=\"{}\" data-height=\"{}\">", image.width,
                       image.height) +
           (expected ? picture(image, "expected", finding.expected_by)
                     : picture(image, "actual", finding.actual_by)) +
           "</div>";
  }
  std::string data = "\"", count;
  if (expected->width == actual->width && expected->height == actual->height) {
    std::string boxes;
    for (const media::Box& box : media::difference_boxes(*expected, *actual, kMostBoxes))
      boxes +=
          fmt::format("{}{},{},{},{}", boxes.empty() ? "" : " ", box.left, box.top, box.width, box.height);
    data = fmt::format(" pair\" data-width=\"{}\" data-height=\"{}\" data-boxes=\"{}\"", expected->width,
                       expected->height, boxes);
    const std::int64_t pixels = media::difference(*expected, *actual).pixels;
    count = fmt::format("{} {} of {}", pixels, pixels == 1 ? "pixel" : "pixels",
                        std::int64_t(expected->width) * expected->height);
  }
  return "<div class=\"pictures" + data + ">" + picture(*expected, "expected", finding.expected_by) +
         picture(*actual, "actual", finding.actual_by) +
         picture(media::difference_picture(*expected, *actual), "difference", count) + "</div>";
}

std::string section(const Finding& finding, std::size_t number) {
  std::string html = fmt::format(
      "<section id=\"f{0}\" data-state=\"{1}\"><div class=\"head\"><h2><a href=\"#f{0}\">{2}</a></h2>"
      "<span class=\"state\">{1}</span>",
      number, escaped(finding.state), escaped(finding.name));
  if (!finding.choice.empty())
    html += fmt::format(
        "<label class=\"take\"><input type=\"checkbox\" value=\"{}\" autocomplete=\"off\">approve</label>",
        escaped(finding.choice));
  html += "</div>\n<ul class=\"lines\">";
  for (const std::string& line : finding.lines) html += "<li>" + escaped(line) + "</li>";
  return html + "</ul>\n" + pictures(finding) + "</section>\n";
}

// how many of each state there are: buttons that show those alone
std::string filters(const std::vector<Finding>& findings) {
  std::map<std::string, int> states;
  for (const Finding& finding : findings) ++states[finding.state];
  std::string html = fmt::format(
      "<nav class=\"group\" aria-label=\"which are shown\">"
      "<button type=\"button\" data-show=\"\" class=\"on\">all {}</button>",
      findings.size());
  for (const auto& [state, count] : states)
    html += fmt::format("<button type=\"button\" data-show=\"{0}\">{0} {1}</button>", escaped(state), count);
  return html + "</nav>";
}

constexpr const char* kLegend = R"(<ul class="legend">
<li><i class="solid"></i>differs by more than a moved edge</li>
<li><i class="edge"></i>differs as an edge that moved by less than a pixel</li>
<li><i class="pale"></i>the same, shown pale</li>
<li><i class="around"></i>around what differs</li></ul>
)";

constexpr const char* kBar = R"(
<span class="group" role="group" aria-label="how pairs are shown">
<button type="button" data-how="beside">beside</button>
<button type="button" data-how="slide">slide</button>
<button type="button" data-how="blink">blink</button>
<button type="button" data-how="difference">difference</button></span>
<span><span class="group" role="group" aria-label="zoom">
<button type="button" data-act="out" aria-label="zoom out">&#8722;</button>
<button type="button" data-act="fit">fit</button>
<button type="button" data-act="in" aria-label="zoom in">+</button></span>
<output class="scale"></output></span>
<span class="group"><button type="button" data-act="difference">zoom to difference</button>
<button type="button" data-act="boxes" class="on">boxes</button></span>
)";

constexpr const char* kApprove = R"(<p><output></output> approved. In the folder where golden was run:</p>
<div><code></code><button type="button" class="copy">copy</button>
<button type="button" class="every">all shown</button><button type="button" class="none">none</button></div>
)";

constexpr const char* kFooter =
    R"(<footer><kbd>j</kbd> <kbd>k</kbd> next and previous, <kbd>1</kbd> to <kbd>4</kbd>
how pairs are shown, <kbd>z</kbd> zoom to the difference, <kbd>+</kbd> <kbd>-</kbd> <kbd>0</kbd> zoom and fit,
<kbd>x</kbd> boxes, <kbd>a</kbd> approve. Over a picture: Ctrl and the wheel, or a double click, zoom; drag moves.</footer>
)";

}  // namespace

std::string report(const ReportTitle& title, const std::vector<Finding>& findings) {
  bool different = false, choice = false;
  for (const Finding& finding : findings) {
    different = different || (finding.expected && finding.actual && *finding.expected != *finding.actual);
    choice = choice || !finding.choice.empty();
  }
  const std::string name = escaped(title.title), made = date();
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src {}; script-src {}; base-uri 'none'; form-action 'none'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"obscura {}\">\n<title>{}</title>\n<style>",
      by_hash(kReportStyle), by_hash(kReportScript), OBSCURA_VERSION, name);
  html += kReportStyle;
  html += fmt::format(
      "</style></head>\n<body data-view=\"beside\"><header><h1>{}</h1>\n"
      "<p>obscura {}, <time datetime=\"{}Z\">{} UTC</time></p>\n",
      name, OBSCURA_VERSION, made, made);
  if (different) html += kLegend;
  html += "</header>\n<div class=\"bar\">" + filters(findings) + kBar + "</div>\n<main>\n";
  for (std::size_t i = 0; i < findings.size(); ++i) html += section(findings[i], i + 1);
  html += "</main>\n";
  html += kFooter;
  if (choice)
    html += fmt::format("<aside class=\"approve\" data-command=\"{}\" hidden>", escaped(title.command)) +
            kApprove + "</aside>\n";
  html += "<script>";
  html += kReportScript;
  return html + "</script></body></html>\n";
}

std::string date() {
  std::time_t now = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) now = std::time_t(std::atoll(fixed));
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min);
}

void write_text(const std::string& path, const std::string& text) {
  media::File file(path);
  file.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  file.place(false);
}

}  // namespace obscura::app
