// Alternative text of a PDF. Cairo tags a figure and has no words for it, so they are appended to its file as
// an incremental update: the objects that change, a table of where they are, a trailer that names the table
// before. ISO 32000-1, 7.5.6 incremental updates, 14.9.3 alternate descriptions.

#include "page/described.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>
#include <utility>

#include "page/error.h"

namespace obscura::page {
namespace {

[[noreturn]] void fail(const char* what) {
  throw Error(std::string("Cairo's PDF has no ") + what + " where it is looked for");
}

// the number behind a key, from `from` on
std::size_t number_after(std::string_view file, std::string_view key, std::size_t from) {
  const std::size_t at = file.find(key, from);
  if (at == std::string_view::npos) fail(std::string(key).c_str());
  const std::string_view rest = file.substr(at + key.size());
  const std::size_t digit = std::min(rest.find_first_not_of(" \n"), rest.size());
  std::size_t number = 0;
  if (std::from_chars(rest.data() + digit, rest.data() + rest.size(), number).ec != std::errc())
    fail("number");
  return number;
}

// where the objects of a file are, by their numbers: its table has twenty bytes a line
std::vector<std::size_t> places(std::string_view file, std::size_t table) {
  const std::size_t count = number_after(file, "xref\n0", table);
  const std::size_t first = file.find('\n', file.find('\n', table) + 1) + 1;
  std::vector<std::size_t> all(count, 0);
  for (std::size_t k = 1; k < count; ++k) all[k] = number_after(file.substr(first, 20 * count), "", 20 * k);
  return all;
}

// a dictionary, without what ends it; empty where it has a stream
std::string_view dictionary(std::string_view file, std::size_t place) {
  const std::string_view object = file.substr(place, file.find("endobj", place) - place);
  const std::size_t begin = object.find("<<"), end = object.rfind(">>");
  if (begin == std::string_view::npos || end == std::string_view::npos ||
      object.find("\nstream") != std::string_view::npos)
    return {};
  return object.substr(begin, end - begin);
}

// as UTF-16, in hexadecimal digits
std::string text_string(const std::string& utf8) {
  std::string all = "<FEFF";
  for (std::size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i]);
    const std::size_t bytes = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    std::uint32_t code = bytes == 1 ? first : first & (0xFFu >> (bytes + 1));
    for (std::size_t k = 1; k < bytes && i + k < utf8.size(); ++k)
      code = code << 6 | (static_cast<unsigned char>(utf8[i + k]) & 0x3F);
    i += bytes;
    if (code < 0x10000)
      all += fmt::format("{:04X}", code);
    else
      all += fmt::format("{:04X}{:04X}", 0xD7C0 + (code >> 10), 0xDC00 + (code & 0x3FF));
  }
  return all + ">";
}

}  // namespace

std::vector<std::uint8_t> described(std::vector<std::uint8_t> pdf, const std::string& text, bool titled) {
  const std::string_view file(reinterpret_cast<const char*>(pdf.data()), pdf.size());
  const std::size_t end = file.rfind("startxref");
  if (end == std::string_view::npos) fail("startxref");
  const std::size_t table = number_after(file, "startxref", end), trailer = file.find("trailer", table);
  const std::vector<std::size_t> all = places(file, table);
  const std::size_t root = number_after(file, "/Root", trailer), info = number_after(file, "/Info", trailer);

  // the figure says what it shows; the catalogue that there are tags, and in which language
  std::vector<std::pair<std::size_t, std::string>> changed;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const std::string_view own = dictionary(file, all[k]);
    if (own.find("/StructElem") != std::string_view::npos && own.find("/S /Figure") != std::string_view::npos)
      changed.emplace_back(k, fmt::format("{}   /Alt {}\n", own, text_string(text)));
    if (k != root) continue;
    std::string more(own);
    if (own.find("/MarkInfo") == std::string_view::npos) more += "   /MarkInfo << /Marked true >>\n";
    if (own.find("/Lang") == std::string_view::npos) more += "   /Lang (en)\n";
    if (titled) more += "   /ViewerPreferences << /DisplayDocTitle true >>\n";
    changed.emplace_back(k, more);
  }
  if (changed.size() != 2) fail("figure");

  std::string update, entries;
  for (const auto& [number, own] : changed) {
    entries += fmt::format("{} 1\n{:010} 00000 n \n", number, pdf.size() + update.size());
    update += fmt::format("{} 0 obj\n{}>>\nendobj\n", number, own);
  }
  const std::size_t at = pdf.size() + update.size();
  update += fmt::format(
      "xref\n{}trailer\n<< /Size {}\n   /Root {} 0 R\n   /Info {} 0 R\n   /Prev "
      "{}\n>>\nstartxref\n{}\n%%EOF\n",
      entries, all.size(), root, info, table, at);
  pdf.insert(pdf.end(), update.begin(), update.end());
  return pdf;
}

}  // namespace obscura::page
