/// The energy report of a bake, for people and JSON.
#pragma once

#include "cli/command.h"
#include "relumbre/radiosity/energy_report.h"

namespace relumbre::cli {

void report_energy(const EnergyReport& energy, Session& session);

}  // namespace relumbre::cli
