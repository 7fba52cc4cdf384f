#include "draw/picture/formula.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "draw/picture/formula_text.h"
#include "draw/picture/latex.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

constexpr double kScript = 0.7, kSub = -0.2, kSuper = 0.36;  // size and rise of scripts, em

constexpr double kFraction = 0.78;  // size of what a fraction is made of
constexpr double kAxis = 0.25;      // height of its bar, em
constexpr double kBar = 0.05, kAroundBar = 0.13;
constexpr double kBig = 1.45;      // size of a sum's sign
constexpr double kLimit = 0.12;    // between it and its limits, em
constexpr double kThin = 0.17;     // a thin space, em
constexpr double kNotHigh = 1.15;  // times as high as they are what is between brackets may be
constexpr double kTallest = 3.5;   // how many times as high as they are brackets grow

bool low(std::string_view c) {
  static constexpr std::string_view flat = "acemnorsuvwxz.,";
  return c.size() == 1 && flat.find(c[0]) != flat.npos;
}

bool deep(std::string_view c) {
  static constexpr std::string_view hung = "gjpqy()Q,/";
  const std::string_view greek[] = {"β", "γ", "ζ", "η", "μ", "ξ", "ρ", "φ", "χ", "ψ"};
  return (c.size() == 1 && hung.find(c[0]) != hung.npos) ||
         std::find(std::begin(greek), std::end(greek), c) != std::end(greek);
}

class Setter {
 public:
  // `room`: em before the number
  Setter(std::string_view text, double size, Color color, double room = 0) : text_(text), room_(room) {
    out_.size = size;
    out_.color = color;
  }

  Formula set() {
    if (formulas::dollar(text_, 0) == text_.npos) {
      run(text_, 1, 0);
    } else {
      // words, and mathematics between dollars
      for (std::size_t i = 0; i <= text_.size();) {
        const std::size_t end = std::min(formulas::dollar(text_, i), text_.size());
        if (latex_)
          run(text_.substr(i, end - i), 1, 0);
        else
          put(formulas::plain(text_.substr(i, end - i)), Face::math, 1, 0);
        latex_ = !latex_, i = end + 1;
      }
    }
    if (!out_.empty()) out_.width = width();
    return std::move(out_);
  }

 private:
  double width() const {
    return pending_ + (out_.spans.empty() ? 0 : shape({{0, 0}, Align::left, out_.spans}).width);
  }

  // set alone, to be placed as a whole
  Formula inner(std::string_view text, double scale) const {
    Setter setter(text, scale * out_.size, out_.color, room_);
    setter.bold_ = bold_, setter.latex_ = latex_;
    setter.run(text, 1, 0);
    if (!setter.out_.empty()) setter.out_.width = setter.width();
    return std::move(setter.out_);
  }
  // with its baseline's left end there, y down; room for it has been left
  void place(Formula part, const Point& at) {
    out_.ascent = std::max(out_.ascent, part.ascent - at.y());
    out_.descent = std::max(out_.descent, part.descent + at.y());
    out_.parts.push_back(std::move(part)), out_.places.push_back(at);
  }

  void fraction(std::string_view above, std::string_view below, double scale, double rise) {
    const double em = scale * out_.size, up = (rise + scale * kAxis) * out_.size;
    Formula over = inner(above, kFraction * scale), under = inner(below, kFraction * scale);
    const double from = width() + 0.08 * em, wide = std::max(over.width, under.width) + 0.12 * em;
    const double gap = kAroundBar * em;
    place(over, {from + (wide - over.width) / 2, -up - gap - over.descent});
    place(under, {from + (wide - under.width) / 2, -up + gap + under.ascent});
    out_.lines.push_back({{{from, -up}, {from + wide, -up}}, kBar * em});
    pending_ += wide + 0.16 * em;
  }

  void root(std::string_view index, std::string_view text, double scale, double rise) {
    const double em = scale * out_.size, line = kBar * em;
    Formula what = inner(text, scale), which = inner(index, 0.55 * scale);
    const double base = rise * out_.size, top = base + std::max(what.ascent, 0.62 * em) + 0.14 * em,
                 foot = base - std::max(what.descent, 0.05 * em);
    const double from = width() + std::max(0.06 * em, which.width - 0.22 * em), sign = 0.5 * em;
    const double half = base + 0.36 * (top - base);
    out_.lines.push_back({{{from, -half + 0.08 * em},
                           {from + 0.13 * em, -half},
                           {from + 0.3 * em, -foot},
                           {from + sign, -top},
                           {from + sign + what.width + 0.08 * em, -top}},
                          line});
    if (!which.empty()) place(std::move(which), {from - std::min(0.06 * em, 0.0), -half - 0.16 * em});
    const double wide = what.width;
    place(std::move(what), {from + sign + 0.03 * em, -base});
    out_.ascent = std::max(out_.ascent, top + line);
    pending_ = from + sign + wide + 0.14 * em - (width() - pending_);
  }

  // a sum's sign with its limits
  void large(std::string_view symbol, bool beside, std::string_view text, std::size_t& i, double scale,
             double rise) {
    const double em = scale * out_.size;
    if (beside) {
      put(symbol, Face::math, kBig * scale, rise - 0.16 * scale);
      return;
    }
    Formula below, above;
    for (int k = 0; k < 2 && i < text.size() && (text[i] == '_' || text[i] == '^'); ++k) {
      const bool under = text[i++] == '_';
      (under ? below : above) = inner(formulas::argument(text, i, latex_), kScript * scale);
    }
    Setter setter(symbol, kBig * em, out_.color);
    setter.put(symbol, Face::math, 1, 0);
    Formula sign = std::move(setter.out_);
    sign.width = setter.width_of(sign);
    std::tie(sign.ascent, sign.descent) = ink_of({{0, 0}, Align::left, sign.spans});
    const double from = width() + 0.06 * em, wide = std::max({sign.width, below.width, above.width});
    const double base = (rise - 0.16 * scale) * out_.size;
    const double high = base + sign.ascent, low = base - sign.descent;
    place(std::move(sign), {from + (wide - sign.width) / 2, -base});
    if (!below.empty()) {
      const Point at(from + (wide - below.width) / 2, -low + kLimit * em + below.ascent);
      place(std::move(below), at);
    }
    if (!above.empty()) {
      const Point at(from + (wide - above.width) / 2, -high - kLimit * em - above.descent);
      place(std::move(above), at);
    }
    pending_ += wide + 0.18 * em;
  }
  static double width_of(const Formula& f) { return shape({{0, 0}, Align::left, f.spans}).width; }

  // with raised digits as scripts: those that fonts have have weights of their own
  void put(std::string_view c, Face face, double scale, double rise) {
    static constexpr std::pair<std::string_view, std::string_view> kRaised[] = {
        {"¹", "1"}, {"²", "2"}, {"³", "3"}};
    for (const auto& [sign, digit] : kRaised) {
      const std::size_t at = c.find(sign);
      if (at == c.npos) continue;
      put(c.substr(0, at), face, scale, rise);
      put(digit, Face::math, kScript * scale, rise + scale * kSuper);
      return put(c.substr(at + sign.size()), face, scale, rise);
    }
    put_plain(c, face, scale, rise);
  }
  void put_plain(std::string_view c, Face face, double scale, double rise) {
    if (c.empty()) return;
    const double em = scale * out_.size;
    const double up = rise * out_.size;
    const bool joins = !(pending_ > 0) && !out_.spans.empty() && out_.spans.back().face == face &&
                       out_.spans.back().size == em && out_.spans.back().rise == up &&
                       out_.spans.back().tabular == number_;
    if (joins) {
      out_.spans.back().text += c;
    } else {
      // an italic letter leans into what stands above it
      const bool leans =
          !out_.spans.empty() && rise > 0 &&
          (out_.spans.back().face == Face::math_italic || out_.spans.back().face == Face::math_bold_italic);
      out_.spans.push_back({.text = std::string(c),
                            .face = face,
                            .size = em,
                            .color = out_.color,
                            .rise = up,
                            .lead = pending_ + (leans ? 0.07 * out_.size : 0),
                            .tabular = number_});
      pending_ = 0;
    }
    if (c == " ") return;
    out_.ascent = std::max(out_.ascent, up + em * (low(c) ? 0.47 : 0.7));
    out_.descent = std::max(out_.descent, em * (deep(c) ? 0.22 : 0.015) - up);
  }

  void letter(std::string_view c, double scale, double rise) {
    if (latex_) {
      if (c == " ") return;
      static constexpr std::string_view kRelations[] = {"=", "<", ">", "≤", "≥", "≠", "≈", "∼",
                                                        "∝", "≡", "→", "←", "⇒", "≪", "≫", "∈"};
      static constexpr std::string_view kBinary[] = {"+", "-", "±", "∓", "×", "·", "÷"};
      const bool relation = formulas::among(kRelations, c), binary = formulas::among(kBinary, c) && operand_;
      const double room = (relation ? 0.26 : binary ? 0.2 : 0) * scale * out_.size;
      if (scale == 1) pending_ += room;
      put(c == "-" ? std::string_view("−") : c,
          !formulas::italic(c) ? Face::math
          : bold_              ? Face::math_bold_italic
                               : Face::math_italic,
          scale, rise);
      if (scale == 1) pending_ += room;
      operand_ = !relation && !formulas::among(kBinary, c) && c != "(" && c != "[" && c != ",";
      return;
    }
    const Face face = !formulas::italic(c) ? Face::math : bold_ ? Face::math_bold_italic : Face::math_italic;
    put(c == "-" ? std::string_view("−") : c, face, scale, rise);
  }

  void run(std::string_view text, double scale, double rise) {
    std::size_t units = 0;  // where those end that are set now
    for (std::size_t i = 0; i < text.size();) {
      const char c = text[i];
      if (!latex_ && !number_ && formulas::latin(c)) units = std::max(units, formulas::units_end(text, i));
      if (c == kNumber || c == kNumberEnd) {
        number_ = c == kNumber, ++i;
        if (number_) pending_ += room_ * scale * out_.size;
      } else if (c == '*') {
        bold_ = !bold_, ++i;
      } else if (c == '_' || c == '^') {
        script(c, text, ++i, scale, rise);
      } else if (c == '\'') {
        put("′", Face::math, scale, rise), ++i;
      } else if (c == '"') {
        const std::size_t end = std::min(text.find('"', i + 1), text.size());
        put(formulas::plain(text.substr(i + 1, end - i - 1)), Face::math, scale, rise);
        i = std::min(end + 1, text.size());
      } else if (c == '\\') {
        name(text, ++i, scale, rise);
      } else if (c == '{' && formulas::closing(text, i) != text.npos) {
        run(formulas::argument(text, i, latex_), scale, rise);
      } else if (formulas::latin(c) && latex_) {
        letter(text.substr(i++, 1), scale, rise);
      } else if (const auto [end, letters] = formulas::word(text, i); letters > 0 && !latex_) {
        if (letters >= formulas::kWord || int(end - i) > letters || i < units) {
          const std::string_view word = text.substr(i, end - i);
          put(word, Face::math, scale, rise);
          if (end < text.size() && text[end] == '\\' && formulas::among(formulas::kFunctions, word))
            pending_ += room_behind_function(text, end) * scale * out_.size;
        } else {
          for (std::size_t k = i; k < end; ++k) letter(text.substr(k, 1), scale, rise);
        }
        i = end;
      } else {
        const std::size_t n = std::min(formulas::length_of(c), text.size() - i);
        letter(text.substr(i, n), scale, rise);
        i += n;
      }
    }
  }

  void script(char sign, std::string_view text, std::size_t& i, double scale, double rise) {
    const bool bold = std::exchange(bold_, false);
    const std::string_view argument = formulas::argument(text, i, latex_);
    const double size = kScript * scale, at = rise + scale * (sign == '_' ? kSub : kSuper);
    if (argument == "*")
      put(argument, Face::math, size, at);
    else if (sign == '^' && (argument == "\\circ" || argument == "°"))
      put("°", Face::math, scale, rise);  // it is up already
    else
      run(argument, size, at);
    bold_ = bold;
  }

  // em: a thin space before a letter, none before a bracket or what has room of its own
  double room_behind_function(std::string_view text, std::size_t i) const {
    while (latex_ && i < text.size() && text[i] == ' ') ++i;
    const std::string_view rest = text.substr(std::min(i, text.size()));
    if (rest.empty()) return 0;
    if (rest[0] == '\\') {
      const std::size_t end =
          std::size_t(std::find_if_not(rest.begin() + 1, rest.end(), formulas::latin) - rest.begin());
      const std::string_view word = rest.substr(1, end - 1);
      return word.empty() || word == "left" || word == "right" || word == "quad" ? 0 : kThin;
    }
    static constexpr std::string_view kNone = " ()[]}|,;:.=<>+-/'^_";
    return kNone.find(rest[0]) != kNone.npos ? 0 : kThin;
  }

  // an upright name, its scripts, and the room around both
  void function(std::string_view word, std::string_view text, std::size_t& i, bool operand, double scale,
                double rise) {
    // behind a letter or a digit: a product
    const bool behind = !out_.empty() && !(pending_ > 0) && (latex_ ? operand : ends_a_factor());
    if (behind) pending_ += kThin * scale * out_.size;
    put(word, Face::math, scale, rise);
    while (i < text.size() && (text[i] == '^' || text[i] == '_')) {
      const char sign = text[i++];
      script(sign, text, i, scale, rise);
    }
    pending_ += room_behind_function(text, i) * scale * out_.size;
  }
  // whether a letter or a digit was set last
  bool ends_a_factor() const {
    if (out_.spans.empty()) return false;
    const std::string& text = out_.spans.back().text;
    std::size_t last = text.size() - 1;
    while (last > 0 && (static_cast<unsigned char>(text[last]) & 0xC0) == 0x80) --last;
    return formulas::italic(std::string_view(text).substr(last)) || (text[last] >= '0' && text[last] <= '9');
  }

  // brackets as high as what is between them
  void brackets(std::string_view text, std::size_t& i, double scale, double rise) {
    const auto signs_at = [&](std::size_t& at) {
      while (at < text.size() && text[at] == ' ') ++at;
      const std::string_view sign = formulas::bracket(text, at);
      at += sign.size();
      return sign == "." ? std::string_view() : sign;
    };
    const std::string_view left = signs_at(i);
    const std::size_t end = formulas::right_of(text, i);
    if (end == text.npos) return bracket(left, 0, scale, rise);
    // spaces at the brackets are seen no more than in LaTeX
    while (i < end && text[i] == ' ') ++i;
    std::string_view within = text.substr(i, end - i);
    while (within.ends_with(' ')) within.remove_suffix(1);
    i = end + std::string_view("\\right").size();
    const std::string_view right = signs_at(i);

    const Formula inside = inner(within, scale);
    const double axis = scale * kAxis * out_.size;
    const double half = std::max(inside.ascent - axis, inside.descent + axis);
    bracket(left, half, scale, rise);
    operand_ = false;
    run(within, scale, rise);
    bracket(right, half, scale, rise);
    operand_ = true;
  }
  // with half of its height on either side of the axis, on which a fraction's bar is
  void bracket(std::string_view sign, double half, double scale, double rise) {
    if (sign.empty()) return;
    if (sign.size() > 1 && sign[0] == '\\') {
      const formulas::Name* name = formulas::entry(formulas::kNames, sign.substr(1));
      sign = name ? name->symbol : sign == "\\|" ? "‖" : sign.substr(1);
    }
    const double em = scale * out_.size;
    const auto [above, below] =
        ink_of({{0, 0}, Align::left, {{.text = std::string(sign), .face = Face::math, .size = em}}});
    const double own = std::max((above + below) / 2, 0.1 * em);
    if (half <= kNotHigh * own) return put(sign, Face::math, scale, rise);
    if (sign == "|" || sign == "‖") {
      // as thin as a fraction's
      const double from = width() + 0.12 * em, axis = (rise + scale * kAxis) * out_.size;
      const auto bar = [&](double x) {
        out_.lines.push_back({{{x, -axis - half}, {x, -axis + half}}, kBar * em});
      };
      bar(from);
      const double second = sign == "|" ? 0 : 0.16 * em;
      if (second > 0) bar(from + second);
      out_.ascent = std::max(out_.ascent, axis + half);
      out_.descent = std::max(out_.descent, half - axis);
      pending_ += second + 0.24 * em;
      return;
    }
    const double grown = std::min(1.06 * half / own, kTallest);
    put(sign, Face::math, grown * scale, rise + scale * kAxis - grown * (above - below) / 2 / out_.size);
  }

  void name(std::string_view text, std::size_t& i, double scale, double rise) {
    const std::size_t from = i;
    while (i < text.size() && formulas::latin(text[i])) ++i;
    const std::string_view word = text.substr(from, i - from);
    if (word.empty() && i < text.size()) {
      // "\,": a space; "\{": the sign itself
      const char c = text[i++];
      const double space = c == ',' ? kThin : c == ':' ? 0.22 : c == ';' ? 0.28 : c == ' ' ? 0.25 : 0;
      if (space > 0)
        pending_ += space * scale * out_.size;
      else if (c != '!')
        put(c == '|' ? "‖" : text.substr(i - 1, 1), Face::math, scale, rise);
      return;
    }
    // a name ends with its space, as in LaTeX, where that is not seen anyway
    const auto skip = [&] {
      while (i < text.size() && text[i] == ' ') ++i;
    };
    const bool operand = std::exchange(operand_, true);
    if (formulas::among(formulas::kAccents, word)) {
      skip();
      const double before = width();
      const std::string_view inner = formulas::argument(text, i, latex_);
      run(inner, scale, rise);
      const double em = scale * out_.size;
      const double top = rise * out_.size + em * (inner.size() == 1 && low(inner) ? 0.56 : 0.78);
      using enum Formula::Over::Kind;
      static constexpr Formula::Over::Kind kinds[] = {bar, arrow, dot, dots, hat, tilde};
      const auto which = std::find(std::begin(formulas::kAccents), std::end(formulas::kAccents), word) -
                         std::begin(formulas::kAccents);
      // over the middle of a letter that leans
      out_.overs.push_back({kinds[which], before + 0.06 * em, width() + 0.03 * em, top});
      out_.ascent = std::max(out_.ascent, top + (which >= 4 ? 0.18 : 0.08) * em);
      return;
    }
    if (word == "overline") {
      const std::string_view text_under = formulas::argument(text, i, latex_);
      const Formula under = inner(text_under, scale);
      const double before = width(), em = scale * out_.size;
      run(text_under, scale, rise);
      const double top = rise * out_.size + under.ascent + 0.1 * em;
      out_.overs.push_back({Formula::Over::bar, before + 0.02 * em, width() + 0.02 * em, top});
      out_.ascent = std::max(out_.ascent, top + 0.08 * em);
      return;
    }
    if (word == "operatorname") {
      skip();
      const std::string_view called = formulas::argument(text, i, latex_);
      return function(called, text, i, operand, scale, rise);
    }
    if (formulas::fraction(word)) {
      skip();
      const std::string_view above = formulas::argument(text, i, latex_);
      skip();
      return fraction(above, formulas::argument(text, i, latex_), scale, rise);
    }
    if (word == "sqrt") {
      skip();
      std::string_view index;
      if (i < text.size() && text[i] == '[')
        if (const std::size_t end = text.find(']', i); end != text.npos)
          index = text.substr(i + 1, end - i - 1), i = end + 1;
      return root(index, formulas::argument(text, i, latex_), scale, rise);
    }
    if (word == "text" || word == "mathrm") {
      skip();
      return put(formulas::plain(formulas::argument(text, i, latex_)), Face::math, scale, rise);
    }
    if (word == "mathbf" || word == "boldsymbol" || word == "bm") {
      skip();
      const bool before = std::exchange(bold_, true);
      run(formulas::argument(text, i, latex_), scale, rise);
      bold_ = before;
      return;
    }
    if (word == "mathit") {
      skip();
      return put(formulas::argument(text, i, latex_), Face::math_italic, scale, rise);
    }
    if (word == "left") return brackets(text, i, scale, rise);
    if (word == "right") return;
    if (const formulas::Name* sign = formulas::entry(formulas::kLarge, word))
      return large(sign->symbol, word.ends_with("int"), text, i, scale, rise);
    if (formulas::among(formulas::kFunctions, word)) return function(word, text, i, operand, scale, rise);
    if (const formulas::Name* symbol = formulas::entry(formulas::kNames, word))
      return letter(symbol->symbol, scale, rise);
    put("\\", Face::math, scale, rise);
    put(word, Face::math, scale, rise);
  }

  std::string_view text_;
  double room_;
  Formula out_;
  double pending_ = 0;  // page units before what comes next
  bool bold_ = false, number_ = false;
  bool latex_ = false;    // between dollars
  bool operand_ = false;  // stands before what comes next: a sign is between two
};

}  // namespace

Formula formula(std::string_view text, double size, Color color, double room) {
  Formula set = Setter(text, size, color, room).set();
  set.source = text;
  return set;
}

void add(const Formula& f, const Point& at, List& list, const Hold& hold) {
  if (f.empty()) return;
  if (list.apart) {
    const double x = hold.align == Align::left ? 0 : hold.align == Align::center ? f.width / 2 : f.width;
    const double y = hold.level == Level::baseline ? 0
                     : hold.level == Level::top    ? -f.ascent
                     : hold.level == Level::bottom ? f.descent
                                                   : (f.descent - f.ascent) / 2;
    list.words.push_back({latex(f.source), at + Point(x, y), hold.align, hold.level, f.size, f.color});
    return;
  }
  if (!f.spans.empty()) list.add(Text{at, Align::left, f.spans});
  for (std::size_t i = 0; i < f.parts.size(); ++i) add(f.parts[i], at + f.places[i], list);
  for (const Formula::Line& each : f.lines) {
    std::vector<Node> nodes;
    for (const Point& p : each.points) nodes.push_back({at + p, each.width, f.color});
    list.add(nodes, Cap::butt);
  }
  const double line = 0.055 * f.size;
  for (const Formula::Over& over : f.overs) {
    const Point a = at + Point(over.from, -over.rise), b = at + Point(over.to, -over.rise), m = (a + b) / 2;
    const double r = 0.055 * f.size;
    switch (over.kind) {
      case Formula::Over::bar:
        list.add({{a, line, f.color}, {b, line, f.color}}, Cap::butt);
        break;
      case Formula::Over::arrow: {
        const double h = 0.09 * f.size;
        list.add({{a, line, f.color}, {b - Point(h / 2, 0), line, f.color}}, Cap::butt);
        list.add({b, b + Point(-1.5 * h, -h), b + Point(-h, 0), b + Point(-1.5 * h, h)}, f.color);
        break;
      }
      case Formula::Over::hat: {
        const double h = 0.14 * f.size;
        list.add({{m - Point(1.1 * h, 0), line, f.color},
                  {m - Point(0, h), line, f.color},
                  {m + Point(1.1 * h, 0), line, f.color}},
                 Cap::butt);
        break;
      }
      case Formula::Over::tilde: {
        const double h = 0.06 * f.size;
        std::vector<Node> wave;
        for (int k = 0; k <= 12; ++k)
          wave.push_back({m + Point(0.18 * f.size * (k / 6.0 - 1), -h - h * std::sin(k * 0.5235987755982988)),
                          line, f.color});
        list.add(wave, Cap::round);
        break;
      }
      case Formula::Over::dot:
        list.add(Disc{m, r, 0, f.color, f.color});
        break;
      case Formula::Over::dots:
        list.add(Disc{m - Point(2 * r, 0), r, 0, f.color, f.color});
        list.add(Disc{m + Point(2 * r, 0), r, 0, f.color, f.color});
        break;
    }
  }
}

void fade(Formula& formula, double strength) {
  const double s = std::clamp(strength, 0.0, 1.0);
  formula.color.a = std::uint8_t(std::lround(formula.color.a * s));
  for (Span& span : formula.spans) span.color.a = formula.color.a;
  for (Formula& part : formula.parts) fade(part, strength);
}

}  // namespace obscura::draw
