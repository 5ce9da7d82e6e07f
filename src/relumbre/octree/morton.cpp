#include "relumbre/octree/morton.h"

#include <cstddef>
#include <string>

#include "relumbre/base/error.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace relumbre {

namespace {

void check_sizes(const char* function, std::size_t in, std::size_t out) {
  if (in != out)
    throw ShapeError(std::string(function) + ": " + std::to_string(in) + " inputs for " +
                     std::to_string(out) + " outputs");
}

#if defined(__x86_64__)

constexpr std::uint64_t kAxisBits = 0x1249'2492'4924'9249;

[[gnu::target("bmi2")]] void encode_bmi2(std::span<const Cell> cells,
                                         std::span<std::uint64_t> codes) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    codes[i] = _pdep_u64(cells[i].x, kAxisBits) | _pdep_u64(cells[i].y, kAxisBits << 1) |
               _pdep_u64(cells[i].z, kAxisBits << 2);
}

[[gnu::target("bmi2")]] void decode_bmi2(std::span<const std::uint64_t> codes,
                                         std::span<Cell> cells) {
  for (std::size_t i = 0; i < codes.size(); ++i)
    cells[i] = {static_cast<std::uint32_t>(_pext_u64(codes[i], kAxisBits)),
                static_cast<std::uint32_t>(_pext_u64(codes[i], kAxisBits << 1)),
                static_cast<std::uint32_t>(_pext_u64(codes[i], kAxisBits << 2))};
}

/// Zen 1 and 2 have the instructions in microcode, slower than the portable way.
bool has_fast_bmi2() {
  static const bool has =
      __builtin_cpu_supports("bmi2") && !__builtin_cpu_is("znver1") && !__builtin_cpu_is("znver2");
  return has;
}

#endif

}  // namespace

void morton_encode(std::span<const Cell> cells, std::span<std::uint64_t> codes) {
  check_sizes("morton_encode", cells.size(), codes.size());
#if defined(__x86_64__)
  if (has_fast_bmi2()) return encode_bmi2(cells, codes);
#endif
  for (std::size_t i = 0; i < cells.size(); ++i) codes[i] = morton_encode(cells[i]);
}

void morton_decode(std::span<const std::uint64_t> codes, std::span<Cell> cells) {
  check_sizes("morton_decode", codes.size(), cells.size());
#if defined(__x86_64__)
  if (has_fast_bmi2()) return decode_bmi2(codes, cells);
#endif
  for (std::size_t i = 0; i < codes.size(); ++i) cells[i] = morton_decode(codes[i]);
}

}  // namespace relumbre
