#include "app/report.h"

#include <fmt/format.h>

#include <map>

#include "app/report_page.h"
#include "media/file.h"
#include "media/pixels.h"
#include "media/png.h"
#include "page/markup.h"

namespace obscura::app {

namespace {

using page::escaped;

std::string picture(const media::Image& image, const std::string& kind) {
  return fmt::format(
      "<figure class=\"{0}\"><img alt=\"{0}\" width=\"{1}\" height=\"{2}\" "
      "src=\"data:image/png;base64,{3}\"><figcaption>{0}</figcaption></figure>",
      kind, image.width, image.height, page::base64(media::encode_png(image, {.alpha = true})));
}

std::string section(const Finding& finding) {
  std::string html = fmt::format("<section data-state=\"{}\"><h2>{} <b>{}</b></h2>\n", escaped(finding.state),
                                 escaped(finding.name), escaped(finding.state));
  for (const std::string& line : finding.lines) html += "<p>" + escaped(line) + "</p>\n";
  html += "<div class=\"pictures\">";
  if (finding.expected && finding.actual && *finding.expected != *finding.actual) {
    html += picture(*finding.expected, "expected") + picture(*finding.actual, "actual") +
            picture(media::difference_picture(*finding.expected, *finding.actual), "difference");
    if (finding.expected->width == finding.actual->width &&
        finding.expected->height == finding.actual->height)
      html += fmt::format(
          "<figure class=\"both\"><div class=\"stack\" style=\"width:{}px;height:{}px\"></div><figcaption>"
          "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"expected or actual\">"
          "<button type=\"button\">blink</button></figcaption></figure>",
          finding.expected->width, finding.expected->height);
  } else if (finding.expected) {
    html += picture(*finding.expected, "expected");
  } else if (finding.actual) {
    html += picture(*finding.actual, "actual");
  }
  return html + "</div></section>\n";
}

}  // namespace

std::string report(const std::string& title, const std::vector<Finding>& findings) {
  std::map<std::string, int> states;
  for (const Finding& finding : findings) ++states[finding.state];
  std::string html = std::string(kReportHead) + "<title>" + escaped(title) + "</title></head><body><h1>" +
                     escaped(title) + "</h1>\n<nav>";
  html += fmt::format("<button type=\"button\" data-show=\"\" class=\"on\">all {}</button>", findings.size());
  for (const auto& [state, count] : states)
    html += fmt::format("<button type=\"button\" data-show=\"{0}\">{0} {1}</button>", escaped(state), count);
  html += "</nav>\n";
  for (const Finding& finding : findings) html += section(finding);
  return html + kReportTail;
}

void write_text(const std::string& path, const std::string& text) {
  media::File file(path);
  file.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  file.place(false);
}

}  // namespace obscura::app
