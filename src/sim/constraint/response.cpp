// J of a row on a link is (r x s, s) at the link's centre, carried down to each joint of its tree; two rows
// couple by J_i . (M^-1 J_j'), and for free bodies by the mass of the body that they share.

#include "sim/constraint/response.h"

#include <numeric>

namespace obscura::sim {

template <int D>
void ChainResponse<D>::build(std::vector<Row<D>>& rows, const Response<D>& bodies, Articulated<D>& chains) {
  number_.assign(rows.size(), -1);
  size_ = std::size_t(chains.size());
  if (size_ == 0) return;
  int found = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (side_that(rows[i], [&](int body) { return bodies.linked(body); }) >= 0) number_[i] = found++;
  }
  J_.assign(size_ * std::size_t(found), 0.0), U_.resize(size_ * std::size_t(found));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (number_[i] < 0) continue;
    Row<D>& row = rows[i];
    const std::span<double> J(J_.data() + size_ * std::size_t(number_[i]), size_);
    const auto side = [&](int body, const Wrench<D>& wrench) {
      if (!bodies.linked(body)) return;
      const int link = chains.link(body);
      chains.add_row(link, wrench, J);
      row.velocity_product += power(wrench, chains.velocity_product(link));
    };
    side(row.a, {row.angular_a, row.along});
    side(row.b, {-row.angular_b, -row.along});
    for (const RowSide<D>& more : row.more) side(more.body, {more.angular, more.along});
    chains.respond(J, std::span<double>(U_.data() + size_ * std::size_t(number_[i]), size_));
  }
}

template <int D>
double ChainResponse<D>::coupling(int i, int j) const {
  if (number_[i] < 0 || number_[j] < 0) return 0;
  const auto J = jacobian(i), U = response(j);
  return std::inner_product(J.begin(), J.end(), U.begin(), 0.0);
}

template class ChainResponse<2>;
template class ChainResponse<3>;

}  // namespace obscura::sim
