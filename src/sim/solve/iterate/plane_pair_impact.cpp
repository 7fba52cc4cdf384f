// One touch with Coulomb friction, in the plane: with b = v and b_n += e v_n,
//   open    p = 0                          where b_n >= 0
//   stick   w_n = w_t = 0                  where p_n >= 0 and |p_t| <= mu p_n
//   slide   w_n = 0, p_t = -s mu p_n       where p_n >= 0 and w_t has the sign s
// each a closed form. Two touches take turns (Gauss and Seidel), beginning with the impulses without
// friction; once they stay what they are, open, stick or slide, their equalities are solved together. Where
// both stick, friction has no unique split, as under a box that lands flat: the second keeps what it has.

#include "sim/solve/iterate/plane_pair_impact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/solve/restitution.h"

namespace obscura::sim::plane {

namespace {

constexpr int kRounds = 30;          // of both touches
constexpr double kExact = 1e-13;     // of the impulses, or of the speeds: what is left
constexpr double kSingular = 1e-12;  // of k_nn k_tt: no smaller determinant is told from rounding
constexpr double kGain = 1e-13;      // of the energy that moves along the rows: rounding
constexpr double kOneNormal = 1e-8;  // of k_00 k_11: two normals are one
constexpr double kLevel = 1e-3;      // of the speeds: how far from level two touches of a flat face slip

// the impulses of touch k alone, speeds b without them
void touch(const PairImpact& it, int k, double bn, double bt, double& pn, double& pt) {
  const int n = 2 * k, t = n + 1;
  const double knn = it.K[n][n], ktt = it.K[t][t], knt = it.K[n][t];
  pn = pt = 0;
  if (bn >= 0 || !(knn > 0)) return;
  const double det = knn * ktt - knt * knt;
  double wanted = 0;  // of friction, to stick
  if (det > kSingular * knn * ktt) {
    pn = (knt * bt - ktt * bn) / det, wanted = (knt * bn - knn * bt) / det;
    if (pn >= 0 && std::fabs(wanted) <= it.mu * pn) {
      pt = wanted;
      return;
    }
  }
  // first the way on which friction falls short
  const double first = wanted != 0 ? (wanted > 0 ? -1 : 1) : (bt < 0 ? -1 : 1);
  double best = 1e300;
  for (const double s : {first, -first}) {
    const double under = knn - s * it.mu * knt;
    if (under <= 0) continue;
    const double n_s = -bn / under, t_s = -s * it.mu * n_s;
    const double wrong = std::max(0.0, -s * (bt + knt * n_s + ktt * t_s));
    if (wrong >= best) continue;
    best = wrong, pn = n_s, pt = t_s;
    if (wrong == 0) break;
  }
}

// which way friction pushes at its most; 0 where it holds, or nothing presses
int slides(const PairImpact& it, int k, const double (&p)[4]) {
  const double most = it.mu * p[2 * k], t = p[2 * k + 1];
  return p[2 * k] > 0 && std::fabs(t) >= most ? (t > 0 || (t == 0 && !std::signbit(t)) ? 1 : -1) : 0;
}

// Two touches that stay what they are in p: their equalities together. False where the laws do not hold then.
bool together(const PairImpact& it, const double (&b)[4], double (&p)[4]) {
  // columns of unknowns, in terms of impulses along the rows
  double ways[3][4] = {}, A[3][4] = {};
  int rows[3], count = 0;
  const int slide[2] = {slides(it, 0, p), slides(it, 1, p)};
  const bool open[2] = {p[0] <= 0, p[2] <= 0};
  const bool shared = !open[0] && !open[1] && slide[0] == 0 && slide[1] == 0;
  if (open[0] && open[1]) return false;
  double q[4] = {0, 0, 0, 0};
  for (int k = 0; k < 2; ++k) {
    const int n = 2 * k, t = n + 1;
    if (open[k]) continue;
    rows[count] = n, ways[count][n] = 1, ways[count][t] = slide[k] * it.mu, ++count;
    if (slide[k] != 0) continue;
    if (k == 1 && shared)
      q[t] = p[t];
    else
      rows[count] = t, ways[count][t] = 1, ++count;
  }
  const auto answer = [&](int row, const double(&l)[4]) {
    return it.K[row][0] * l[0] + it.K[row][1] * l[1] + it.K[row][2] * l[2] + it.K[row][3] * l[3];
  };
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) A[i][j] = answer(rows[i], ways[j]);
    A[i][3] = -b[rows[i]] - answer(rows[i], q);
  }
  for (int c = 0; c < count; ++c) {
    int pivot = c;
    for (int i = c + 1; i < count; ++i) pivot = std::fabs(A[i][c]) > std::fabs(A[pivot][c]) ? i : pivot;
    if (!(std::fabs(A[pivot][c]) > kSingular * it.K[rows[pivot]][rows[pivot]])) return false;
    std::swap(A[pivot], A[c]), std::swap(rows[pivot], rows[c]);
    for (int i = c + 1; i < count; ++i) {
      const double times = A[i][c] / A[c][c];
      for (int j = c; j < 4; ++j) A[i][j] -= times * A[c][j];
    }
  }
  for (int c = count; c-- > 0;) {
    for (int j = c + 1; j < count; ++j) A[c][3] -= A[c][j] * A[j][3];
    A[c][3] /= A[c][c];
    for (int i = 0; i < 4; ++i) q[i] += ways[c][i] * A[c][3];
  }

  double size = 0;
  for (const double one : b) size = std::max(size, std::fabs(one));
  for (int k = 0; k < 2; ++k) {
    const int n = 2 * k, t = n + 1;
    const double wn = b[n] + answer(n, q), wt = b[t] + answer(t, q);
    // the second of two that stick slips by how far they are from level alone
    const double slip = k == 1 && shared ? kLevel : kExact;
    const bool lawful = open[k] ? wn >= -kExact * size
                        : slide[k] != 0
                            ? q[n] >= 0 && slide[k] * wt <= kExact * size
                            : q[n] >= 0 && std::fabs(q[t]) <= it.mu * q[n] && std::fabs(wt) <= slip * size;
    if (!lawful) return false;
  }
  std::copy(q, q + 4, p);
  return true;
}

// the impulses with e, `bounce` of it
void attempt(const PairImpact& it, double bounce, double (&p)[4]) {
  double b[4];
  for (int i = 0; i < 4; ++i) b[i] = it.v[i];
  for (int k = 0; k < 2; ++k) b[2 * k] += bounce * it.e[k] * it.v[2 * k];
  for (double& one : p) one = 0;
  if (!it.closed[0] || !it.closed[1]) {
    const int k = it.closed[0] ? 0 : 1;
    if (it.closed[k]) touch(it, k, b[2 * k], b[2 * k + 1], p[2 * k], p[2 * k + 1]);
    return;
  }

  // without friction: both press, or one
  const double k00 = it.K[0][0], k11 = it.K[2][2], k01 = it.K[0][2], det = k00 * k11 - k01 * k01;
  bool both = det > kOneNormal * k00 * k11;
  if (both) p[0] = (k01 * b[2] - k11 * b[0]) / det, p[2] = (k01 * b[0] - k00 * b[2]) / det;
  both = both && p[0] >= 0 && p[2] >= 0;
  if (!both) {
    const double only0 = k00 > 0 ? std::max(0.0, -b[0] / k00) : 0,
                 only1 = k11 > 0 ? std::max(0.0, -b[2] / k11) : 0;
    const bool first = b[2] + k01 * only0 >= b[0] + k01 * only1;
    p[0] = first ? only0 : 0, p[2] = first ? 0 : only1;
  }
  if (it.mu == 0) return;

  int known[2] = {2, 2};
  for (int round = 0; round < kRounds; ++round) {
    double change = 0, size = 0;
    bool same = true;
    for (int k = 0; k < 2; ++k) {
      const int n = 2 * k, t = n + 1, m = 2 - n, u = m + 1;
      double pn, pt;
      touch(it, k, b[n] + it.K[n][m] * p[m] + it.K[n][u] * p[u], b[t] + it.K[t][m] * p[m] + it.K[t][u] * p[u],
            pn, pt);
      change = std::max({change, std::fabs(pn - p[n]), std::fabs(pt - p[t])});
      size = std::max({size, std::fabs(pn), std::fabs(pt)});
      p[n] = pn, p[t] = pt;
      const int mode = pn <= 0 ? 3 : slides(it, k, p);
      same = same && mode == known[k], known[k] = mode;
    }
    if (change <= kExact * size || ((same || round == 0) && together(it, b, p))) break;
  }
}

// what the impulses add to the energy, p . (v + v') / 2, J; and the largest of its terms
double gain(const PairImpact& it, const double (&p)[4], double& size) {
  double sum = 0;
  size = 0;
  for (int i = 0; i < 4; ++i) {
    double change = 0;
    for (int j = 0; j < 4; ++j) change += it.K[i][j] * p[j];
    sum += p[i] * (it.v[i] + 0.5 * change);
    size = std::max(size, std::fabs(p[i] * it.v[i]));
  }
  return sum;
}

}  // namespace

void solve(const PairImpact& impact, double (&p)[4]) {
  restitution_share(1, [&](double share) {
    double size = 0;
    attempt(impact, share, p);
    const double gained = gain(impact, p, size);
    return size > 0 ? gained / size - kGain : 0;
  });
}

}  // namespace obscura::sim::plane
