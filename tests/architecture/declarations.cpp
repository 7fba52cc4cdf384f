#include "architecture/declarations.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>

namespace obscura::architecture {
namespace {

bool in_word(char c) { return begins_word(c) || std::isdigit(static_cast<unsigned char>(c)); }

// Definitions at the level of namespaces, which is all of a file that other files could meet.
class Reader {
 public:
  explicit Reader(Tokens tokens) : tokens_(std::move(tokens)) {}

  std::vector<Defined> read() {
    while (at_ < tokens_.size()) {
      if (is("}")) {
        if (!scopes_.empty()) scopes_.pop_back();
        ++at_;
      } else if (is(";")) {
        ++at_;
      } else if (is("namespace") || (is("inline") && is("namespace", 1)) || (is("extern") && is("{", 2))) {
        open_scope();
      } else {
        declaration();
      }
    }
    return std::move(defined_);
  }

 private:
  bool is(const char* text, std::size_t ahead = 0) const {
    return at_ + ahead < tokens_.size() && tokens_[at_ + ahead].text == text;
  }
  const std::string& text(std::size_t at) const { return tokens_[at].text; }
  bool is_word(std::size_t at) const { return begins_word(text(at)[0]); }

  void open_scope() {
    std::string name;
    for (++at_; at_ < tokens_.size() && !is("{") && !is(";"); ++at_) name += tokens_[at_].text;
    if (is("{")) scopes_.push_back(name);
    ++at_;
  }

  // past the bracket that closes the one at `at`
  std::size_t closed(std::size_t at) const {
    int depth = 0;
    for (; at < tokens_.size(); ++at) {
      const std::string& t = text(at);
      if (t == "(" || t == "[" || t == "{") ++depth;
      if ((t == ")" || t == "]" || t == "}") && --depth == 0) return at + 1;
    }
    return at;
  }
  // past the angle bracket that closes the one at `at`
  std::size_t closed_angle(std::size_t at) const {
    int depth = 0;
    while (at < tokens_.size()) {
      const std::string& t = text(at);
      if (t == "(" || t == "[" || t == "{") {
        at = closed(at);
        continue;
      }
      if (t == "<") ++depth;
      if (t == ">" && --depth == 0) return at + 1;
      ++at;
    }
    return at;
  }
  // past the next `;` outside brackets
  std::size_t past_semicolon(std::size_t at) const {
    while (at < tokens_.size() && text(at) != ";")
      at = text(at) == "(" || text(at) == "[" || text(at) == "{" ? closed(at) : at + 1;
    return at + 1;
  }

  // the words and signs of [begin, end)
  std::string joined(std::size_t begin, std::size_t end) const {
    std::string all;
    for (; begin < end; ++begin) all += text(begin) + ' ';
    return all;
  }
  // the types of the parameters between the brackets at `open`, without names and defaults
  std::string parameters(std::size_t open) const {
    const std::size_t end = closed(open) - 1;
    std::string types;
    for (std::size_t begin = open + 1, at = begin; begin < end; begin = ++at) {
      std::size_t type_end = end;
      for (; at < end && text(at) != ",";) {
        if (text(at) == "=") type_end = std::min(type_end, at);
        const bool brackets = text(at) == "(" || text(at) == "[" || text(at) == "{";
        at = text(at) == "<" && type_end == end ? closed_angle(at) : brackets ? closed(at) : at + 1;
      }
      type_end = std::min(type_end, at);
      const bool named = type_end - begin > 1 && is_word(type_end - 1) && text(type_end - 2) != "::" &&
                         text(type_end - 2) != "const";
      types += joined(begin, named ? type_end - 1 : type_end) + ", ";
    }
    return types;
  }

  void define(std::size_t at, Kind kind = Kind::other, const std::string& type = "") {
    define(at, text(at), kind, type);
  }
  void define(std::size_t at, const std::string& name, Kind kind, const std::string& type) {
    bool unnamed = is_static_;
    std::string scope;
    for (const std::string& each : scopes_) each.empty() ? void(unnamed = true) : void(scope += each + "::");
    defined_.push_back({kind, scope, name, type, tokens_[at].line, unnamed});
  }

  void declaration() {
    is_static_ = false;
    while (is("template")) at_ = closed_angle(at_ + 1);
    if (is("using") || is("typedef") || is("static_assert") || is("friend")) {
      const std::size_t end = past_semicolon(at_);
      if (is("using") && is("=", 2)) define(at_ + 1, Kind::alias, joined(at_ + 3, end));
      at_ = end;
      return;
    }
    if (is("struct") || is("class") || is("enum") || is("union")) {
      type();
      return;
    }

    // a function or variables: the head ends at the first = or bracket outside template arguments
    std::size_t head = at_;
    bool is_operator = false;
    while (head < tokens_.size()) {
      const std::string& t = text(head);
      is_static_ |= t == "static";
      if (t == "operator") {
        is_operator = true;
        while (text(head) != "(" || text(head + 1) == ")") ++head;
        break;
      }
      if (t == "<") {
        head = closed_angle(head);
      } else if (t == "[" && text(head + 1) == "[") {
        head = closed(head);
      } else if (t == "(" && (text(head - 1) == "decltype" || text(head - 1) == "alignas")) {
        head = closed(head);
      } else if (t == "=" || t == "(" || t == "[" || t == "{" || t == ";" || t == "}") {
        break;
      } else {
        ++head;
      }
    }
    if (head >= tokens_.size() || text(head) == "}") {
      at_ = head;
      return;
    }
    if (text(head) == "(")
      function(head, is_operator);
    else
      variables(head);
  }

  // struct Name, enum class Name : Base: what follows has a body, or is only said to be
  void type() {
    std::size_t name = at_ + 1, body = at_;
    while (text(name) == "class" || text(name) == "struct") ++name;
    while (body < tokens_.size() && text(body) != "{" && text(body) != ";")
      body = text(body) == "<" ? closed_angle(body) : body + 1;
    if (body < tokens_.size() && text(body) == "{" && text(name + 1) != "::" && text(name + 1) != "<" &&
        is_word(name))
      define(name);
    at_ = past_semicolon(body);
  }

  // `open` is the bracket of its parameters, or of a variable's value, or of a macro such as TEST(Suite,
  // Name)
  void function(std::size_t open, bool is_operator) {
    const std::size_t name = open - 1;
    if (name == at_)
      macro(open);
    else if (!is_operator && is_word(name) && text(name - 1) != "::" && text(name - 1) != "~")
      define(name, Kind::function, parameters(open));
    // to the end of the body; what members are initialized with, as in a{1}, b{2} {}, is none
    std::size_t at = closed(open);
    while (at < tokens_.size() && text(at) != ";" && text(at) != "}") {
      const bool body = text(at) == "{";
      at = text(at) == "(" || text(at) == "[" || body ? closed(at) : at + 1;
      if (body && at < tokens_.size() && text(at) != "," && text(at) != "{") {
        at_ = at;
        return;
      }
    }
    at_ = at < tokens_.size() && text(at) == ";" ? at + 1 : at;
  }

  // TEST(Suite, Name) defines both together, MATCHER_P(Name, argument) its first
  void macro(std::size_t open) {
    if (text(at_).rfind("MATCHER", 0) == 0)
      define(open + 1);
    else if (text(at_).find("TEST") != std::string::npos && open + 3 < tokens_.size())
      define(open + 1, text(open + 1) + "." + text(open + 3), Kind::other, "");
  }

  // constexpr double kOne = 1, kTwo = 2;
  void variables(std::size_t head) {
    const std::size_t end = past_semicolon(head);
    for (std::size_t at = head; at < end;) {
      if (is_word(at - 1) && (at < 2 || text(at - 2) != "::")) define(at - 1);
      while (at < end && text(at) != ",")
        at = text(at) == "(" || text(at) == "[" || text(at) == "{" ? closed(at) : at + 1;
      at += 2;
    }
    at_ = end;
  }

  Tokens tokens_;
  std::size_t at_ = 0;
  bool is_static_ = false;
  std::vector<std::string> scopes_;  // the namespaces that are open
  std::vector<Defined> defined_;
};

using Paths = std::set<std::filesystem::path>;

void add_headers(const std::filesystem::path& file, const std::vector<std::filesystem::path>& roots,
                 Paths& headers) {
  static const std::regex include("(?:^|\n)[ \t]*#[ \t]*include[ \t]*\"([^\"]+)\"");
  const std::string text = contents(file);
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it) {
    const auto look = [&](const std::filesystem::path& folder) {
      const std::filesystem::path header = (folder / (*it)[1].str()).lexically_normal();
      if (std::filesystem::exists(header) && headers.insert(header).second)
        add_headers(header, roots, headers);
    };
    look(file.parent_path());
    for (const auto& root : roots) look(root);
  }
}

}  // namespace

bool begins_word(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
Tokens tokens_of(const std::string& text) {
  Tokens tokens;
  int line = 1;
  bool line_begins = true;
  std::size_t at = 0;
  const auto skip_to = [&](std::size_t end) {
    end = std::min(end, text.size());
    line += int(std::count(text.begin() + std::ptrdiff_t(at), text.begin() + std::ptrdiff_t(end), '\n'));
    at = end;
  };
  // past the next `what` from `from` on
  const auto past = [&](const std::string& what, std::size_t from) {
    const std::size_t found = text.find(what, from);
    return found == text.npos ? text.size() : found + what.size();
  };
  while (at < text.size()) {
    const char c = text[at];
    if (std::isspace(static_cast<unsigned char>(c))) {
      line_begins |= c == '\n';
      skip_to(at + 1);
    } else if (text.compare(at, 2, "//") == 0) {
      skip_to(text.find('\n', at));
    } else if (text.compare(at, 2, "/*") == 0) {
      skip_to(past("*/", at + 2));
    } else if (c == '#' && line_begins) {
      std::size_t end = text.find('\n', at);
      while (end < text.size() && text[end - 1] == '\\') end = text.find('\n', end + 1);
      skip_to(end);
    } else {
      line_begins = false;
      const int begun = line;
      std::size_t end = at + 1;
      std::string token;
      if (c == '"' && !tokens.empty() && tokens.back().text == "R" && text[at - 1] == 'R') {
        const std::string mark = text.substr(at + 1, text.find('(', at) - at - 1);
        tokens.pop_back();
        token = "\"\"", end = past(")" + mark + "\"", at);
      } else if (c == '"' || c == '\'') {
        while (end < text.size() && text[end] != c) end += text[end] == '\\' ? 2 : 1;
        token = "\"\"", ++end;
      } else if (std::isdigit(static_cast<unsigned char>(c))) {
        while (end < text.size() && (in_word(text[end]) || text[end] == '.' || text[end] == '\'')) ++end;
        token = text.substr(at, end - at);
      } else if (begins_word(c)) {
        while (end < text.size() && in_word(text[end])) ++end;
        token = text.substr(at, end - at);
      } else {
        if (text.compare(at, 2, "::") == 0) ++end;
        token = text.substr(at, end - at);
      }
      skip_to(end);
      tokens.push_back({token, begun});
    }
  }
  return tokens;
}

std::vector<Defined> names_of(Tokens tokens) { return Reader(std::move(tokens)).read(); }

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

Paths headers_of(const std::filesystem::path& file, const std::vector<std::filesystem::path>& roots) {
  Paths headers;
  add_headers(file, roots, headers);
  return headers;
}

}  // namespace obscura::architecture
