#pragma once

#include <array>
#include <utility>
#include <vector>

namespace obscura::sim {

/// A sparse symmetric positive matrix of small blocks, of up to M rows each, factorised as L D L' in an order
/// of few neighbours first: trees fill in nothing. Blocks that no entries connect are components, solved
/// apart. Vectors have the rows of the blocks one after another.
template <int M>
class Blocks {
 public:
  using Block = std::array<double, M * M>;  // row by row, M a row

  /// Sizes of the blocks, and which two have an entry: i < j, each pair once, ascending.
  void plan(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& pairs);

  int count() const { return int(sizes_.size()); }
  int rows() const { return rows_; }
  /// The first row of a block; the number of its rows.
  int first(int block) const { return first_[block]; }
  int size(int block) const { return sizes_[block]; }
  /// The component that a block belongs to, and the blocks of a component, in the order of elimination.
  int component(int block) const { return component_[block]; }
  int components() const { return int(components_.size()) - 1; }
  int begin(int component) const { return components_[component]; }
  int end(int component) const { return components_[component + 1]; }
  int at(int place) const { return order_[place]; }

  /// The block on the diagonal, and the entry of pair e, rows of i and columns of j: to be written, all,
  /// before factorise().
  Block& diagonal(int block) { return diagonal_[block]; }
  Block& entry(int e) { return entries_[e]; }

  /// act(e) for each pair of a component.
  template <class Act>
  void each_pair(int component, Act&& act) const {
    for (int s = first_source_[component]; s < first_source_[component + 1]; ++s) act(sources_[s].pair);
  }

  /// Factorises A, for the rows of one component. Redundant rows, as of a door on two hinges, are recognised
  /// by their pivots; a component that has them is solved nearly in the least-norm sense, with an error that
  /// moves nothing.
  void factorise(int component);

  /// x := A^-1 x, for the rows of one component only.
  void solve(double* x) const;
  void solve(double* x, int component) const;

 private:
  bool eliminate(int component);
  void substitute(double* x, int component) const;
  void take_product(const double* x, double* y, int component) const;

  struct Below {
    int block;
    Block l;
  };
  struct Source {
    int pair, below;
    bool turned;  // the entry's rows are the column's
  };

  std::vector<int> sizes_, first_, component_, components_ = {0}, order_;
  int rows_ = 0;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<char> implied_;  // of each component: whether rows of it imply others
  mutable std::vector<double> right_, rest_, way_;
  std::vector<Block> diagonal_, entries_, inverse_;
  std::vector<int> begin_;  // of below_, by place
  std::vector<Below> below_;
  std::vector<Source> sources_;    // by component
  std::vector<int> first_source_;  // of each component
  std::vector<int> updates_;       // below_ that each product goes to, or -1 - block
  std::vector<int> first_update_;  // of each component
};

}  // namespace obscura::sim
