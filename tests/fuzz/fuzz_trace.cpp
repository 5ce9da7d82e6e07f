// Feeds arbitrary bytes to the reader of traces: it must return a trace that can be simulated or
// throw an Error. Each input is tried as it is and with its hashes put right, or few would get past
// them.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "relumbre/archsim/simulate.h"
#include "relumbre/archsim/trace_file.h"
#include "relumbre/base/content_hash.h"
#include "relumbre/base/error.h"

namespace {

using namespace relumbre;

// docs/trace.md
constexpr std::size_t kHeight = 20, kRowsPerBand = 28, kFileBytes = 40, kTableHash = 48, kHash = 56,
                      kTable = 64, kEntry = 24;
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 26;

template <class T>
T get(std::span<const std::byte> bytes, std::size_t at) {
  T value;
  std::memcpy(&value, &bytes[at], sizeof value);
  return value;
}

template <class T>
void put(std::span<std::byte> bytes, std::size_t at, T value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

void put_hashes_right(std::span<std::byte> bytes) {
  if (bytes.size() < kTable) return;
  const auto height = get<std::uint32_t>(bytes, kHeight);
  const auto rows = get<std::uint32_t>(bytes, kRowsPerBand);
  const std::uint64_t bands = height == 0 || rows == 0 ? 0 : (height - 1) / rows + 1;
  if (bands > 0 && bands <= (bytes.size() - kTable) / kEntry) {
    std::size_t at = kTable + bands * kEntry;
    for (std::size_t entry = kTable; entry < kTable + bands * kEntry; entry += kEntry) {
      const auto size = get<std::uint64_t>(bytes, entry);
      if (size > bytes.size() - at) break;
      put(bytes, entry + 16, content_hash(bytes.subspan(at, size)));
      at += size;
    }
    put(bytes, kTableHash, content_hash(bytes.subspan(kTable, bands * kEntry)));
  }
  put(bytes, kFileBytes, std::uint64_t{bytes.size()});
  put(bytes, kHash, content_hash(bytes.first(kHash)));
}

void simulate_some(std::span<const std::byte> bytes) {
  try {
    const Trace trace = parse_trace(bytes, "fuzz.rlt", kMaxBytes);
    if (trace.reads().size() > 1'000'000) return;
    const std::vector<std::uint64_t> lines{8, 64};
    (void)simulate_lines(trace, {.gts = 2, .tile = 7}, lines);
  } catch (const Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  simulate_some(bytes);
  put_hashes_right(bytes);
  simulate_some(bytes);
  return 0;
}
