/// The figures of an energy report by name, for the store's /energy attributes.
#pragma once

#include "relumbre/radiosity/energy_report.h"

namespace relumbre {

/// Calls visit(name, field) for each figure; Report is EnergyReport or const EnergyReport.
template <class Report, class Visit>
void for_each_field(Report& report, Visit&& visit) {
  visit("elements", report.elements);
  visit("patches", report.patches);
  visit("rays", report.rays);
  visit("row_sum_min", report.row_sum_min);
  visit("row_sum_mean", report.row_sum_mean);
  visit("row_sum_max", report.row_sum_max);
  visit("open_rows", report.open_rows);
  visit("reciprocity_error", report.reciprocity_error);
  visit("reciprocity_noise", report.reciprocity_noise);
  visit("back_face", report.back_face);
  visit("escaped", report.escaped);
}

}  // namespace relumbre
