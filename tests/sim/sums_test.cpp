// What decides the last bits of a state: in which order numbers are added. Eigen's own order differs between
// its versions, so that each expression the physics uses has it given here, and is the same on every system.

#include "sim/math/vec.h"

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <functional>

#include "sim/dice.h"

namespace obscura::sim {
namespace {

// the sum of term(first) .. term(first + count - 1), by halves
double halves(const std::function<double(int)>& term, int first, int count) {
  if (count == 1) return term(first);
  return halves(term, first, count / 2) + halves(term, first + count / 2, count - count / 2);
}

double in_line(const std::function<double(int)>& term, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum = i == 0 ? term(0) : sum + term(i);
  return sum;
}

template <int R, int C>
Eigen::Matrix<double, R, C> matrix_of(Dice& dice) {
  Eigen::Matrix<double, R, C> m;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < C; ++j) m(i, j) = dice.between(-1, 1);
  return m;
}

template <int N>
void dots() {
  Dice dice(N);
  for (int i = 0; i < 200; ++i) {
    const auto a = dice.vector<N>(1), b = dice.vector<N>(1), c = dice.vector<N>(1);
    const auto A = matrix_of<N, N>(dice);
    const double k = dice.between(-1, 1);
    EXPECT_EQ(a.dot(b), halves([&](int n) { return a[n] * b[n]; }, 0, N));
    EXPECT_EQ((a - b).dot(c + k * b), halves([&](int n) { return (a[n] - b[n]) * (c[n] + k * b[n]); }, 0, N));
    EXPECT_EQ(A.row(0).dot(b), halves([&](int n) { return A(0, n) * b[n]; }, 0, N));
    EXPECT_EQ(a.dot(A.col(N - 1)), halves([&](int n) { return a[n] * A(n, N - 1); }, 0, N));
    EXPECT_EQ(a.dot(b.cwiseProduct(c)), halves([&](int n) { return a[n] * (b[n] * c[n]); }, 0, N));
    const auto squares = [&](int n) { return (a[n] - b[n]) * (a[n] - b[n]); };
    EXPECT_EQ((a - b).squaredNorm(), halves(squares, 0, N));
    EXPECT_EQ((a - b).norm(), std::sqrt(halves(squares, 0, N)));
    const double length = std::sqrt(halves([&](int n) { return a[n] * a[n]; }, 0, N));
    for (int n = 0; n < N; ++n) EXPECT_EQ(a.normalized()[n], a[n] / length);
    EXPECT_EQ(a.sum(), halves([&](int n) { return a[n]; }, 0, N));
    EXPECT_EQ(A.trace(), halves([&](int n) { return A(n, n); }, 0, N));
  }
}

TEST(Sums, OfVectorsOfAKnownSizeAreByHalves) { dots<2>(), dots<3>(), dots<4>(), dots<6>(); }

TEST(Sums, OfOtherVectorsAreFromTheFirstToTheLast) {
  Dice dice(7);
  for (int size = 1; size < 40; ++size) {
    Eigen::VectorXd a(size), b(size);
    for (int i = 0; i < size; ++i) a[i] = dice.between(-1, 1), b[i] = dice.between(-1, 1);
    EXPECT_EQ(a.dot(b), in_line([&](int n) { return a[n] * b[n]; }, size));
    EXPECT_EQ((a - b).squaredNorm(), in_line([&](int n) { return (a[n] - b[n]) * (a[n] - b[n]); }, size));
    const int part = size / 2 + 1;
    EXPECT_EQ(a.head(part).dot(b.tail(part)),
              in_line([&](int n) { return a[n] * b[size - part + n]; }, part));
    if (size >= 3) {
      EXPECT_EQ(a.segment(1, 2).squaredNorm(), a[1] * a[1] + a[2] * a[2]);
    }
  }
  EXPECT_EQ(Eigen::VectorXd().squaredNorm(), 0);
}

template <int R, int C>
void products() {
  Dice dice(10 * R + C);
  for (int i = 0; i < 200; ++i) {
    const auto A = matrix_of<R, C>(dice);
    const auto B = matrix_of<R, R>(dice);
    const auto v = dice.vector<C>(1), u = dice.vector<C>(1);
    const auto w = dice.vector<R>(1);
    const double k = dice.between(-1, 1);
    const Eigen::Matrix<double, R, 1> Av = A * v, less = w - A * v;
    const Eigen::Matrix<double, C, 1> At = A.transpose() * w;
    const Eigen::Matrix<double, C, R> AtB = A.transpose() * B;
    const Eigen::Matrix<double, C, C> gram = u * v.transpose() + k * (A.transpose() * A);
    Eigen::Matrix<double, R, 1> both;
    both.noalias() = A * v + B * w;
    const auto row = [](const auto& m, int r, const auto& x) {
      return halves([&](int n) { return m(r, n) * x[n]; }, 0, int(x.size()));
    };
    for (int r = 0; r < R; ++r) {
      EXPECT_EQ(Av[r], row(A, r, v));
      EXPECT_EQ(less[r], w[r] - row(A, r, v));
      EXPECT_EQ(both[r], row(A, r, v) + row(B, r, w));
    }
    for (int c = 0; c < C; ++c) {
      EXPECT_EQ(At[c], halves([&](int n) { return A(n, c) * w[n]; }, 0, R));
      for (int r = 0; r < R; ++r)
        EXPECT_EQ(AtB(c, r), halves([&](int n) { return A(n, c) * B(n, r); }, 0, R));
      // a factor before a product goes into its first matrix
      for (int d = 0; d < C; ++d)
        EXPECT_EQ(gram(c, d), u[c] * v[d] + halves([&](int n) { return (k * A(n, c)) * A(n, d); }, 0, R));
    }
  }
}

TEST(Sums, OfProductsOfMatricesAreByHalves) {
  products<2, 1>(), products<2, 2>(), products<3, 2>(), products<3, 3>(), products<3, 6>();
}

TEST(Sums, OfRotationsOneAfterAnotherGoFromLeftToRight) {
  Dice dice(3);
  for (int i = 0; i < 200; ++i) {
    const auto A = matrix_of<3, 3>(dice), B = matrix_of<3, 3>(dice);
    const Vec3 v = dice.vector<3>(1);
    const Eigen::Matrix3d all = A * B * A.transpose(), AB = A * B, right = AB * A.transpose();
    EXPECT_EQ(all, right);
    const Eigen::Matrix3d scaled = A * v.asDiagonal() * A.transpose();
    Eigen::Matrix3d Av;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) Av(r, c) = A(r, c) * v[c];
    EXPECT_EQ(scaled, Eigen::Matrix3d(Av * A.transpose()));
    EXPECT_EQ(v.cross(Vec3(A.col(0)))[1], v[2] * A(0, 0) - v[0] * A(2, 0));
  }
}

// the bits of numbers, as one
struct Bits {
  std::uint64_t all = 1469598103934665603u;
  template <class M>
  void operator()(const M& m) {
    for (int i = 0; i < m.rows(); ++i)
      for (int j = 0; j < m.cols(); ++j)
        all = (all ^ std::bit_cast<std::uint64_t>(double(m(i, j)))) * 1099511628211u;
  }
};

// what Eigen does by itself: rotations of quaternions and back, the inverse of an inertia, and the factors of
// sim/math/lcp.cpp and sim/fracture/bond_load.cpp. A version that comes to other numbers is told here by name
TEST(Sums, InWhatEigenFactorsAreThoseOfItsVersion34) {
  Dice dice(5);
  Bits turns, back, inverses, spread, borne;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 16, 16>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 16, 1>;
  for (int i = 0; i < 200; ++i) {
    const auto q = dice.vector<4>(1);
    const Eigen::Matrix3d turn = Eigen::Quaterniond(q / std::sqrt(q.squaredNorm())).toRotationMatrix();
    turns(turn), back(Eigen::Quaterniond(turn).coeffs());
    const Eigen::Matrix3d A = matrix_of<3, 3>(dice);
    inverses(Eigen::Matrix3d((A * A.transpose()).inverse()));

    // a Gram matrix of lower rank than size
    const int size = 2 + i % 15, rank = std::max(1, size / 2);
    Square gram(size, size);
    Eigen::MatrixXd half(size, rank), right(size, 2);
    for (int r = 0; r < size; ++r) {
      for (int k = 0; k < rank; ++k) half(r, k) = dice.between(-1, 1);
      right(r, 0) = dice.between(-1, 1), right(r, 1) = dice.between(-1, 1);
    }
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size; ++c)
        gram(r, c) = in_line([&](int k) { return half(r, k) * half(c, k); }, rank);
    Eigen::CompleteOrthogonalDecomposition<Square> factors(size, size);
    factors.setThreshold(1e-11);
    factors.compute(gram);
    spread(Rows(factors.solve(Rows(right.col(0)))));

    std::vector<Eigen::Triplet<double>> entries;
    for (int r = 0; r < size; ++r)
      for (int c = 0; c < size + 3; ++c)
        if ((7 * r + 3 * c) % 4 == 0 || r == c) entries.emplace_back(r, c, dice.between(-1, 1));
    Eigen::SparseMatrix<double> G(size, size + 3);
    G.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseMatrix<double> GG = G * Eigen::SparseMatrix<double>(G.transpose());
    borne(Eigen::MatrixXd(Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(GG).solve(right)));
  }
  EXPECT_EQ(turns.all, 8843507752643813234u) << "Quaterniond::toRotationMatrix";
  EXPECT_EQ(back.all, 4702631119810526097u) << "Quaterniond(Matrix3d)";
  EXPECT_EQ(inverses.all, 10504488850007726670u) << "Matrix3d::inverse";
  EXPECT_EQ(spread.all, 3588970034466711507u) << "CompleteOrthogonalDecomposition";
  EXPECT_EQ(borne.all, 6758607204838865914u) << "SimplicialLDLT";
}

}  // namespace
}  // namespace obscura::sim
