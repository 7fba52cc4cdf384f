// Curves from formulas: pieces of the fifth degree that have the formula's places and first two derivatives
// at both ends (Hermite), as short as it takes for them to agree to rounding.

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/shape/curve_piece.h"

namespace obscura::sim {

namespace {

constexpr double kHermite = 1e-13;  // of the size: how far a formula's pieces may be from it
constexpr int kFirstPieces = 32;
constexpr int kMostHalvings = 12;  // of those
constexpr int kMostPieces = 32000;

// place and two derivatives of a curve at s
template <int D>
struct Jet {
  double s = 0;
  Vec<D> x[3];
};

template <int D>
typename Curve<D>::Piece quintic(const Jet<D>& a, const Jet<D>& b) {
  typename Curve<D>::Piece piece;
  piece.kind = Curve<D>::Kind::polynomial;
  const double h = b.s - a.s;
  const Vec<D> d = b.x[0] - a.x[0], p1 = h * a.x[1], q1 = h * b.x[1], p2 = h * h * a.x[2],
               q2 = h * h * b.x[2];
  piece.c[0] = a.x[0], piece.c[1] = p1, piece.c[2] = 0.5 * p2;
  piece.c[3] = 10 * d - 6 * p1 - 4 * q1 - 1.5 * p2 + 0.5 * q2;
  piece.c[4] = -15 * d + 8 * p1 + 7 * q1 + 1.5 * p2 - q2;
  piece.c[5] = 6 * d - 3 * (p1 + q1) - 0.5 * p2 + 0.5 * q2;
  return piece;
}

template <int D>
class FormulaCurve {
 public:
  FormulaCurve(const Program& formula, double from, double to) : evaluation_(formula), from_(from), to_(to) {}

  std::variant<std::vector<typename Curve<D>::Piece>, std::string> pieces() {
    std::vector<Jet<D>> jets;
    for (int i = 0; i <= kFirstPieces; ++i) {
      jets.push_back(at(from_ + (to_ - from_) * i / kFirstPieces));
      if (!check(jets.back())) return wrong_;
      fastest_ = std::max(fastest_, length_of<D>(jets.back().x[1]));
      size_ =
          std::max({size_, length_of<D>(jets.back().x[0]), length_of<D>(jets.back().x[0] - jets[0].x[0])});
    }
    for (int i = 0; i < kFirstPieces; ++i)
      if (!add(jets[std::size_t(i)], jets[std::size_t(i + 1)], 0)) return wrong_;
    return std::move(pieces_);
  }

 private:
  Jet<D> at(double s) {
    Jet<D> jet;
    jet.s = s;
    const double slot[] = {s};
    evaluation_.begin(slot);
    evaluation_.run(1, {});
    for (int axis = 0; axis < D; ++axis)
      for (int k = 0; k < 3; ++k) jet.x[k][axis] = evaluation_.output(3 * axis + k)[0];
    return jet;
  }

  static std::string number(double s) {
    std::string text = std::to_string(s);
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
    return text == "-0" ? "0" : text;
  }

  bool check(const Jet<D>& jet) {
    for (const Vec<D>& x : jet.x) {
      if (x.allFinite()) continue;
      wrong_ = "the track, or a derivative of it, is no finite number at s = " + number(jet.s);
      return false;
    }
    return true;
  }

  bool add(const Jet<D>& a, const Jet<D>& b, int halvings) {
    for (const Jet<D>* jet : {&a, &b}) {
      if (length_of<D>(jet->x[1]) > 1e-9 * fastest_) continue;
      wrong_ = "the track has no direction at s = " + number(jet->s) +
               ", where its derivative is zero; begin or end it a little beside";
      return false;
    }
    typename Curve<D>::Piece piece = quintic<D>(a, b);
    double worst = 0;
    for (const double part : {0.25, 0.5, 0.75}) {
      const Jet<D> jet = at(a.s + part * (b.s - a.s));
      if (!check(jet)) return false;
      Vec<D> x, first, second;
      place_on<D>(piece, part, x, first, second);
      worst = std::max(worst, length_of<D>(x - jet.x[0]));
    }
    if (worst <= kHermite * size_ && turning_of<D>(piece) <= kMostTurn) {
      pieces_.push_back(piece);
      return true;
    }
    if (halvings == kMostHalvings || int(pieces_.size()) > kMostPieces) {
      wrong_ = "the track is not smooth near s = " + number(a.s) +
               ": a corner, or a bend too sharp to follow; write it as 'points', or begin or end it a little "
               "beside";
      return false;
    }
    const Jet<D> middle = at(0.5 * (a.s + b.s));
    return add(a, middle, halvings + 1) && add(middle, b, halvings + 1);
  }

  Evaluation evaluation_;
  double from_, to_, fastest_ = 0, size_ = 0;
  std::vector<typename Curve<D>::Piece> pieces_;
  std::string wrong_;
};

}  // namespace

template <int D>
std::variant<std::vector<typename Curve<D>::Piece>, std::string> curve_pieces(const Program& formula,
                                                                              double from, double to) {
  return FormulaCurve<D>(formula, from, to).pieces();
}

template <int D>
std::variant<Program, std::pair<int, ExpressionFault>> curve_formula(
    const std::vector<std::string>& coordinates,
    const std::vector<std::pair<std::string, double>>& constants) {
  ExpressionGraph graph;
  const int s = graph.variable(0, true);
  std::vector<Symbol> symbols{{"s", s}};
  for (const auto& [name, value] : constants) symbols.push_back({name, graph.number(value)});
  for (const char* name : {"x", "y", "z", "t", "vx", "vy", "vz", "speed", "r", "dx", "dy", "dz", "angle"})
    symbols.push_back({name, -1, "changes with the run: a track depends on s alone"});
  std::vector<int> outputs;
  for (int axis = 0; axis < D; ++axis) {
    const auto found = parse_expression(coordinates[std::size_t(axis)], symbols, graph);
    if (const auto* fault = std::get_if<ExpressionFault>(&found)) return std::pair(axis, *fault);
    int node = std::get<int>(found);
    for (int k = 0; k < 3; ++k) {
      outputs.push_back(node);
      if (k < 2) node = graph.derivative(node, s);
    }
  }
  return Program(graph, outputs);
}

#define OBSCURA_INSTANTIATE(D)                                                                             \
  template std::variant<std::vector<Curve<D>::Piece>, std::string> curve_pieces<D>(const Program&, double, \
                                                                                   double);                \
  template std::variant<Program, std::pair<int, ExpressionFault>> curve_formula<D>(                        \
      const std::vector<std::string>&, const std::vector<std::pair<std::string, double>>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
