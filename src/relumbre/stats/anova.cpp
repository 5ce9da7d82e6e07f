#include "relumbre/stats/anova.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/stats/orthonormal_basis.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxDesign = std::size_t{1} << 26;
/// A residual below this share of the total sum of squares is rounding.
constexpr double kNoResidual = 1e-22;

using Column = std::vector<double>;

/// A term and its columns of the model.
struct Block {
  std::vector<std::size_t> factors;
  std::vector<Column> columns;

  [[nodiscard]] bool contains(const Block& other) const {
    return std::ranges::includes(factors, other.factors);
  }
};

/// The levels that have rows.
std::vector<std::uint32_t> used_levels(const Factor& factor) {
  const std::set<std::uint32_t> used(factor.rows.begin(), factor.rows.end());
  return {used.begin(), used.end()};
}

/// One column a level but the last: 1 at the level, −1 at the last, so that they sum to zero.
std::vector<Column> factor_columns(const Factor& factor) {
  const std::vector<std::uint32_t> levels = used_levels(factor);
  std::vector<Column> columns;
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    Column column(factor.rows.size(), 0.0);
    for (std::size_t i = 0; i < column.size(); ++i)
      column[i] = factor.rows[i] == levels[k] ? 1 : factor.rows[i] == levels.back() ? -1 : 0;
    columns.push_back(std::move(column));
  }
  return columns;
}

/// Every product of a column of a and one of b.
std::vector<Column> products(const std::vector<Column>& a, const std::vector<Column>& b) {
  std::vector<Column> columns;
  for (const Column& u : a)
    for (const Column& v : b) {
      Column& column = columns.emplace_back(u);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] *= v[i];
    }
  return columns;
}

/// Parameters of the model, the mean included. Few enough levels that nothing overflows.
std::size_t parameter_count(const Table& table, bool interactions) {
  std::size_t mains = 0, squares = 0;
  for (const Factor& factor : table.factors) {
    const std::size_t df = used_levels(factor).size() - 1;
    mains += df;
    squares += df * df;
  }
  return 1 + mains + (interactions ? (mains * mains - squares) / 2 : 0);
}

std::size_t term_count(const Table& table, bool interactions) {
  const std::size_t mains = table.factors.size();
  return mains + (interactions ? mains * (mains - 1) / 2 : 0);
}

/// The basis of the model and every column's coordinates in it, then a small basis for each term.
double model_flops(std::size_t rows, std::size_t parameters, std::size_t terms) {
  const auto n = static_cast<double>(rows), p = static_cast<double>(parameters);
  return 6 * n * p * p + 4 * static_cast<double>(terms) * p * p * p;
}

void check_size(const Table& table, bool interactions) {
  const std::size_t rows = table.values.size(), parameters = parameter_count(table, interactions);
  if (rows <= parameters)
    throw ValueError(fmt::format("{}: {} rows are too few for a model of {} parameters",
                                 table.response, rows, parameters));
  if (parameters > kMaxDesign / rows)
    throw ValueError(fmt::format("{}: a model of {} rows and {} parameters exceeds {} numbers",
                                 table.response, rows, parameters, kMaxDesign));
  const double flops = model_flops(rows, parameters, term_count(table, interactions));
  if (flops > kMaxAnovaFlops)
    throw ValueError(fmt::format(
        "{}: a model of {} rows and {} parameters takes {:.1e} operations, more than {:.0e}",
        table.response, rows, parameters, flops, kMaxAnovaFlops));
}

std::vector<Block> model_blocks(const Table& table, bool interactions) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < table.factors.size(); ++i)
    blocks.push_back({{i}, factor_columns(table.factors[i])});
  const std::size_t mains = blocks.size();
  for (std::size_t i = 0; interactions && i < mains; ++i)
    for (std::size_t j = i + 1; j < mains; ++j)
      blocks.push_back({{i, j}, products(blocks[i].columns, blocks[j].columns)});
  return blocks;
}

/// The responses less their mean, in two passes so that little is lost to rounding.
Column centred(std::vector<double> values) {
  for (int pass = 0; pass < 2; ++pass) {
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    for (double& value : values) value -= mean;
  }
  return values;
}

double sum_of_squares(std::span<const double> values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

void add_columns(const Block& block, OrthonormalBasis& basis, const Progress& progress) {
  for (const Column& column : block.columns) {
    progress.check();
    basis.add(column);
  }
}

/// The space of the whole model. The columns come back as coordinates in it: few numbers each.
OrthonormalBasis reduce(std::vector<Block>& blocks, std::size_t rows, const Progress& progress) {
  OrthonormalBasis model;
  model.add(Column(rows, 1.0));
  for (const Block& block : blocks) add_columns(block, model, progress);
  for (Block& block : blocks)
    for (Column& column : block.columns) {
      progress.check();
      column = model.coordinates(column);
    }
  return model;
}

/// What block t explains of y beyond all blocks that do not contain it, and its degrees of freedom.
void explain(const std::vector<Block>& blocks, std::size_t t, const Column& y,
             const Progress& progress, AnovaTerm& term) {
  OrthonormalBasis basis;
  Column mean(y.size(), 0.0);
  mean[0] = 1;
  basis.add(std::move(mean));
  for (const Block& block : blocks)
    if (!block.contains(blocks[t])) add_columns(block, basis, progress);
  const std::size_t others = basis.size();
  add_columns(blocks[t], basis, progress);
  term.df = basis.size() - others;
  const Column along = basis.coordinates(y);
  term.ss = sum_of_squares(std::span(along).subspan(others));
}

std::string name_of(const Table& table, const Block& block) {
  std::string name;
  for (const std::size_t f : block.factors)
    name += (name.empty() ? "" : ":") + table.factors[f].name;
  return name;
}

void compare_with_residual(const Anova& result, AnovaTerm& term) {
  const auto df = static_cast<double>(term.df);
  term.ms = term.ss / df;
  term.f = term.ms / result.residual_ms;
  term.p = fisher_tail(term.f, df, static_cast<double>(result.residual_df));
  term.eta2 = term.ss / result.total_ss;
  term.partial_eta2 = term.ss / (term.ss + result.residual_ss);
  term.omega2 = (term.ss - df * result.residual_ms) / (result.total_ss + result.residual_ms);
}

/// The part of y outside the model.
void leave_residual(const OrthonormalBasis& model, const Column& y, const std::string& response,
                    Anova& result) {
  const Column along = model.coordinates(y);
  result.residuals = y;
  for (std::size_t k = 0; k < model.size(); ++k)
    for (std::size_t i = 0; i < y.size(); ++i) result.residuals[i] -= along[k] * model[k][i];
  result.total_df = y.size() - 1;
  result.total_ss = sum_of_squares(y);
  result.residual_df = y.size() - model.size();
  result.residual_ss = sum_of_squares(result.residuals);
  if (!(result.residual_ss > kNoResidual * result.total_ss))
    throw ValueError(response +
                     ": the model explains every row exactly, which leaves no residual "
                     "to compare effects with");
  result.residual_ms = result.residual_ss / static_cast<double>(result.residual_df);
}

}  // namespace

Anova anova(const Table& table, const AnovaConfig& config, const Progress& progress) {
  check_table(table);
  check_size(table, config.interactions);
  std::vector<Block> blocks = model_blocks(table, config.interactions);
  const Column y = centred(table.values);
  const OrthonormalBasis model = reduce(blocks, y.size(), progress);
  Anova result;
  leave_residual(model, y, table.response, result);
  const Column reduced = model.coordinates(y);
  for (std::size_t t = 0; t < blocks.size(); ++t) {
    AnovaTerm term{name_of(table, blocks[t]), blocks[t].factors};
    explain(blocks, t, reduced, progress, term);
    if (term.df == 0)
      throw ValueError(fmt::format("{}: the effect of {} cannot be told from the other terms'",
                                   table.response, term.name));
    compare_with_residual(result, term);
    result.terms.push_back(std::move(term));
  }
  return result;
}

}  // namespace relumbre
