/// What an analysis says, in words.
#pragma once

#include <string>
#include <vector>

#include "relumbre/experiment/analysis.h"

namespace relumbre {

/// Sentences, as HTML, that follow from the numbers by fixed rules: the share of the variance that
/// each factor explains (η²; "large" from 14 %, "medium" from 6 %, "small" from 1 %, as Cohen 1988
/// has it), whether ranks agree (ε²), by how much the response changes when a factor alone does,
/// and whether the tests found a departure from what the analysis of variance assumes: normality by
/// Shapiro and Wilk, or where they were refused by D'Agostino and Pearson; variances by Brown and
/// Forsythe.
std::vector<std::string> readings(const ResponseAnalysis& analysis);

}  // namespace relumbre
