/// Traces as text for other cache simulators, in the form of Dinero: a line a read,
///
///   0 82         0: a data read; the address in hexadecimal
///
/// Bytes are addressed, as Dinero wants it: the word of node address a (trace.h) is at byte 2·a. So
/// a Dinero cache of blocks of 2 bytes has the simulated machine's index and tag, and the export of
/// one level and one unit, fed to a direct-mapped cache of 2·L bytes with such blocks, must miss as
/// often as that level's cache.
///
/// Source: Edler and Hill, Dinero IV, its "din" input.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "relumbre/archsim/trace.h"

namespace relumbre {

/// Which reads, in which order: those of one unit of a machine, of one level or of all.
struct DineroConfig {
  std::uint32_t gts = 1, unit = 0;
  std::uint32_t tile = 20;
  std::optional<int> level = {};
};

/// Streams: the text, up to 19 bytes a read, is never in memory as a whole. The file appears whole
/// or not at all. Throws ValueError for a unit or level that is not there, FileError.
void write_dinero(const std::filesystem::path& file, const Trace& trace,
                  const DineroConfig& config = {});

}  // namespace relumbre
