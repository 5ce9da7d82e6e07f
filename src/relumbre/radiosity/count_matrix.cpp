#include "relumbre/radiosity/count_matrix.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "relumbre/base/error.h"
#include "relumbre/base/parallel.h"
#include "relumbre/radiosity/half.h"

namespace relumbre {

namespace {

constexpr std::size_t kMaxTableBytes = std::size_t{1} << 46;
constexpr std::size_t kRowGrain = 256;

std::size_t entry_bytes(CountFormat format) {
  switch (format) {
    case CountFormat::kFloat32:
      return 4;
    case CountFormat::kFloat16:
    case CountFormat::kCounts16:
      return 2;
    case CountFormat::kCounts8:
      break;
  }
  return 1;
}

const RowProduct& product_for(CountFormat format, const RowKernels& kernels) {
  switch (format) {
    case CountFormat::kFloat32:
      return kernels.float32;
    case CountFormat::kFloat16:
      return kernels.float16;
    case CountFormat::kCounts16:
      return kernels.uint16;
    case CountFormat::kCounts8:
      break;
  }
  return kernels.uint8;
}

std::size_t table_bytes(std::size_t rows, std::size_t columns, CountFormat format) {
  if (columns != 0 && rows > kMaxTableBytes / 4 / columns)
    throw ValueError(fmt::format("a table of {} x {} counts exceeds 2^46 bytes", rows, columns));
  return rows * columns * entry_bytes(format);
}

template <class T>
T encoded(std::uint32_t count) {
  return static_cast<T>(count);
}
template <>
Half encoded<Half>(std::uint32_t count) {
  return Half(static_cast<float>(count));
}

template <class T>
void decode(const std::byte* row, std::span<double> values) {
  const auto* entries = reinterpret_cast<const T*>(row);
  for (std::size_t p = 0; p < values.size(); ++p)
    values[p] = static_cast<double>(static_cast<float>(entries[p]));
}

}  // namespace

CountMatrix::CountMatrix(const SparseCounts& counts, CountFormat format, const RowKernels& kernels)
    : rows_(counts.rows()),
      columns_(counts.columns),
      rays_(counts.rays),
      format_(format),
      product_(product_for(format, kernels)),
      table_(table_bytes(rows_, columns_, format) + kTablePadding) {
  encode(counts);
}

std::size_t CountMatrix::row_bytes() const { return columns_ * entry_bytes(format_); }

std::size_t CountMatrix::bytes() const {
  return rows_ * row_bytes() + overflow_.size() * sizeof(Excess);
}

void CountMatrix::encode(const SparseCounts& counts) {
  switch (format_) {
    case CountFormat::kFloat32:
      return encode_as<float>(counts, std::numeric_limits<std::uint32_t>::max());
    case CountFormat::kFloat16:
      return encode_as<Half>(counts, Half::kLargest);
    case CountFormat::kCounts16:
      return encode_as<std::uint16_t>(counts, std::numeric_limits<std::uint16_t>::max());
    case CountFormat::kCounts8:
      return encode_as<std::uint8_t>(counts, std::numeric_limits<std::uint8_t>::max());
  }
}

template <class T>
void CountMatrix::encode_as(const SparseCounts& counts, std::uint32_t limit) {
  auto* table = reinterpret_cast<T*>(table_.data());
  std::memset(table_.data() + rows_ * row_bytes(), 0, kTablePadding);
  parallel_for(0, rows_, kRowGrain, [&](std::size_t i) {
    std::memset(static_cast<void*>(table + i * columns_), 0, row_bytes());
    const auto columns = counts.row_columns(i), values = counts.row_counts(i);
    for (std::size_t e = 0; e < columns.size(); ++e)
      table[i * columns_ + columns[e]] = encoded<T>(std::min(values[e], limit));
  });
  for (std::size_t i = 0; i < rows_; ++i) {
    const auto columns = counts.row_columns(i), values = counts.row_counts(i);
    for (std::size_t e = 0; e < columns.size(); ++e) {
      if (values[e] > limit)
        overflow_.push_back(
            {static_cast<std::uint32_t>(i), columns[e], static_cast<float>(values[e] - limit)});
    }
  }
}

std::span<const CountMatrix::Excess> CountMatrix::excess_of(std::size_t first,
                                                            std::size_t last) const {
  if (overflow_.empty()) return {};
  const auto before = [](const Excess& e, std::size_t row) { return e.row < row; };
  const auto begin = std::lower_bound(overflow_.begin(), overflow_.end(), first, before);
  return {begin, std::lower_bound(begin, overflow_.end(), last, before)};
}

void CountMatrix::decode_row(std::size_t row, std::span<double> values) const {
  switch (format_) {
    case CountFormat::kFloat32:
      decode<float>(this->row(row), values);
      break;
    case CountFormat::kFloat16:
      decode<Half>(this->row(row), values);
      break;
    case CountFormat::kCounts16:
      decode<std::uint16_t>(this->row(row), values);
      break;
    case CountFormat::kCounts8:
      decode<std::uint8_t>(this->row(row), values);
      break;
  }
  for (const Excess& e : excess_of(row, row + 1)) values[e.column] += static_cast<double>(e.count);
}

void CountMatrix::multiply(std::size_t first, std::size_t last, const float* y,
                           const std::byte* operand, float* out) const {
  product_.multiply(row(first), last - first, columns_, operand, out);
  for (const Excess& e : excess_of(first, last)) {
    for (std::size_t c = 0; c < 3; ++c)
      out[3 * (e.row - first) + c] += e.count * y[c * columns_ + e.column];
  }
}

}  // namespace relumbre
