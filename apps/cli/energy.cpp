#include "cli/energy.h"

namespace relumbre::cli {

void report_energy(const EnergyReport& e, Session& session) {
  Report& report = session.report;
  report.figure("row_sum_min", "row sums, least", e.row_sum_min,
                fmt::format("{:.5f}", e.row_sum_min));
  report.figure("row_sum_mean", "row sums, mean", e.row_sum_mean,
                fmt::format("{:.5f}", e.row_sum_mean));
  report.figure("row_sum_max", "row sums, largest", e.row_sum_max,
                fmt::format("{:.5f}", e.row_sum_max));
  report.figure("open_rows", "elements that see out", e.open_rows, percent_text(e.open_rows));
  report.figure("escaped", "rays that left the scene", e.escaped, percent_text(e.escaped));
  report.figure("back_face", "rays that met a back", e.back_face, percent_text(e.back_face));
  report.figure("reciprocity_error", "reciprocity error", e.reciprocity_error,
                fmt::format("{} (noise alone would make {})", percent_text(e.reciprocity_error),
                            percent_text(e.reciprocity_noise)));
  session.report.json()["energy"]["reciprocity_noise"] = e.reciprocity_noise;
}

}  // namespace relumbre::cli
