/// Analysis of variance of any number of factors, balanced or not.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "relumbre/base/progress.h"
#include "relumbre/stats/distributions.h"
#include "relumbre/stats/table.h"

namespace relumbre {

struct AnovaConfig {
  bool interactions = false;  ///< also the interactions of every two factors
};

/// A factor's or an interaction's line of the table.
struct AnovaTerm {
  std::string name;                  ///< "depth", or "depth:lines"
  std::vector<std::size_t> factors;  ///< one or two indices into Table::factors
  std::size_t df = 0;                ///< degrees of freedom
  double ss = 0, ms = 0;             ///< sum of squares, and by degree of freedom
  double f = 0;                      ///< ms over the residual's
  TailProbability p = {};            ///< of an F as large if the term had no effect
  double eta2 = 0;                   ///< η² = SS / SS_total
  double partial_eta2 = 0;           ///< SS / (SS + SS_residual)
  double omega2 = 0;                 ///< (SS − df·MS_residual) / (SS_total + MS_residual)
};

struct Anova {
  std::vector<AnovaTerm> terms;  ///< factors in the table's order, then interactions
  std::size_t residual_df = 0, total_df = 0;
  double residual_ss = 0, residual_ms = 0, total_ss = 0;
  std::vector<double> residuals;  ///< response minus what the model says, one a row
};

/// Models beyond this cost are refused: about a minute of one core.
inline constexpr double kMaxAnovaFlops = 2e11;

/// The fixed-effects analysis by least squares. Sums of squares are of type II: what a term
/// explains beyond all terms that do not contain it. In a balanced table types I, II and III are
/// the same, and the sums add up to the total. Cost: up to 6·n·p² + 4·t·p³ flops and 8·n·p bytes
/// for n rows, p parameters and t terms. Throws as check_table; ValueError where there are no more
/// rows than parameters, a term cannot be told from the others, the model leaves no residual, n·p
/// exceeds 2^26 or the flops exceed kMaxAnovaFlops; Cancelled, which `progress` is asked for at
/// every parameter. Source: Fox 2016, §8.2 (types of sums of squares); Olejnik and Algina 2003
/// (effect sizes).
Anova anova(const Table& table, const AnovaConfig& config = {},
            const Progress& progress = no_progress());

}  // namespace relumbre
