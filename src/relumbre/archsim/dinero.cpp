#include "relumbre/archsim/dinero.h"

#include <iterator>
#include <string>

#include <fmt/format.h>

#include "relumbre/archsim/metrics.h"
#include "relumbre/archsim/replay.h"
#include "relumbre/base/atomic_stream.h"
#include "relumbre/base/error.h"

namespace relumbre {

namespace {

void check(const Trace& trace, const DineroConfig& config) {
  if (config.unit >= config.gts)
    throw ValueError(
        fmt::format("there is no unit {} of {} geometry units", config.unit, config.gts));
  const int levels = trace.shape().levels;
  if (config.level && (*config.level < 0 || *config.level >= levels))
    throw ValueError(fmt::format("there is no level {} of {} levels", *config.level, levels));
}

}  // namespace

void write_dinero(const std::filesystem::path& file, const Trace& trace,
                  const DineroConfig& config) {
  constexpr std::size_t kBuffer = std::size_t{1} << 20;
  check(trace, config);
  const Tiles tiles(trace.shape().width, trace.shape().height, config.tile, config.gts);
  AtomicStream out(file);
  std::string text;
  const auto flush = [&] {
    out.write(text);
    text.clear();
  };
  PathDecoder decode;
  replay(trace, tiles, config.unit, [&](const TraceRun& run) {
    for (const std::uint8_t byte : run.reads) {
      const auto read = decode(byte);
      if (config.level && static_cast<int>(read.level) != *config.level) continue;
      fmt::format_to(std::back_inserter(text), "0 {:x}\n", kWordBytes * read.address);
      if (text.size() > kBuffer) flush();
    }
  });
  flush();
  out.commit();
}

}  // namespace relumbre
