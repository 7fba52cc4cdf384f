// Sums of products in an order of our own, for vectors of doubles. Eigen's differs between versions, and with
// it the last bit: 3.4 adds a dot product by halves, 5 from the first term to the last. This is 3.4's.
//   size known to the compiler    a . b = (the first half's sum) + (the second's): a0 b0 + (a1 b1 + a2 b2)
//   else                          a . b = ((a0 b0 + a1 b1) + a2 b2) + ...
// Eigen includes this file in the body of MatrixBase (EIGEN_MATRIXBASE_PLUGIN): from version 5 on. Members of
// the same names there have no constraint, so that these are preferred, by norm() and normalized() too.

static constexpr bool kVectorOfDoubles =
    bool(internal::is_same<Scalar, double>::value) && bool(IsVectorAtCompileTime);

/// The products of two vectors' numbers, summed in this order.
// clang-format off
template <typename Other>
  requires(kVectorOfDoubles && Other::kVectorOfDoubles)
EIGEN_STRONG_INLINE double dot(const MatrixBase<Other>& other) const {
  // clang-format on
  eigen_assert(this->size() == other.size());
  constexpr int size = SizeAtCompileTime == Dynamic ? Other::SizeAtCompileTime : SizeAtCompileTime;
  const internal::evaluator<Derived> a(derived());
  const internal::evaluator<Other> b(other.derived());
  return sum_in_order<size>(this->size(), [&](Index i) { return entry<Derived>(a, i) * entry<Other>(b, i); });
}

/// The squares of a vector's numbers, summed in this order.
// clang-format off
EIGEN_STRONG_INLINE double squaredNorm() const
  requires kVectorOfDoubles
{
  // clang-format on
  constexpr int size = SizeAtCompileTime;
  const internal::evaluator<Derived> a(derived());
  return sum_in_order<size>(this->size(), [&](Index i) {
    const double x = entry<Derived>(a, i);
    return x * x;
  });
}

template <typename Vector>
static EIGEN_STRONG_INLINE double entry(const internal::evaluator<Vector>& of, Index i) {
  return int(Vector::ColsAtCompileTime) == 1 ? of.coeff(i, 0) : of.coeff(0, i);
}

template <int Size, typename Term>
static EIGEN_STRONG_INLINE double sum_in_order(Index size, const Term& term) {
  if constexpr (Size > 0) {
    return sum_by_halves<0, Size>(term);
  } else {
    double sum = size > 0 ? term(0) : 0;
    for (Index i = 1; i < size; ++i) sum += term(i);
    return sum;
  }
}

template <int First, int Count, typename Term>
static EIGEN_STRONG_INLINE double sum_by_halves(const Term& term) {
  if constexpr (Count == 1) {
    return term(First);
  } else {
    constexpr int half = Count / 2;
    return sum_by_halves<First, half>(term) + sum_by_halves<First + half, Count - half>(term);
  }
}
