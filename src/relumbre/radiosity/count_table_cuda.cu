#include <algorithm>
#include <limits>
#include <vector>

#include "relumbre/base/error.h"
#include "relumbre/cuda/launch.cuh"
#include "relumbre/radiosity/count_product.cuh"
#include "relumbre/radiosity/count_table_cuda.h"

namespace relumbre::cuda {

namespace {

/// Non-zeros that are sent at a time.
constexpr std::size_t kBlock = std::size_t{1} << 22;

std::size_t entry_bytes(CountFormat format) {
  switch (format) {
    case CountFormat::kCounts8:
      return 1;
    case CountFormat::kCounts16:
    case CountFormat::kFloat16:
      return 2;
    case CountFormat::kFloat32:
      break;
  }
  throw ValueError("format float32 is not for the GPU: the counts of 8 and 16 bits are exact");
}

/// The largest that an entry holds; 0: any, rounded.
std::uint32_t limit_of(CountFormat format) {
  if (format == CountFormat::kCounts8) return std::numeric_limits<std::uint8_t>::max();
  return format == CountFormat::kCounts16 ? std::numeric_limits<std::uint16_t>::max() : 65504;
}

struct Place {
  unsigned char* table;
  std::size_t row_bytes;
  CountFormat format;
  std::uint32_t limit;

  __device__ void set(std::size_t row, std::uint32_t column, std::uint32_t count) const {
    unsigned char* to = table + row * row_bytes;
    const std::uint32_t kept = std::min(count, limit);
    if (format == CountFormat::kCounts8)
      to[column] = static_cast<unsigned char>(kept);
    else if (format == CountFormat::kCounts16)
      reinterpret_cast<std::uint16_t*>(to)[column] = static_cast<std::uint16_t>(kept);
    else
      reinterpret_cast<__half*>(to)[column] = __float2half_rn(static_cast<float>(kept));
  }
};

/// One warp a row.
__global__ void place_rows(const std::uint64_t* offsets, std::size_t first_row, std::size_t rows,
                           const std::uint32_t* column, const std::uint32_t* count, Place place) {
  const std::size_t row = (std::size_t{blockIdx.x} * blockDim.x + threadIdx.x) / 32;
  if (row >= rows) return;
  const std::uint64_t base = offsets[0];
  for (std::uint64_t at = offsets[row] + threadIdx.x % 32; at < offsets[row + 1]; at += 32)
    place.set(first_row + row, column[at - base], count[at - base]);
}

}  // namespace

std::size_t CountTable::table_bytes(std::size_t rows, std::size_t columns, CountFormat format) {
  const std::size_t row = columns * entry_bytes(format);
  return rows * ((row + kStepBytes - 1) / kStepBytes * kStepBytes);
}

CountTable::CountTable(const SparseCounts& counts, CountFormat format, const Stream& stream)
    : rows_(counts.rows()),
      columns_(counts.columns),
      row_bytes_(table_bytes(1, counts.columns, format)),
      format_(format),
      table_(rows_ * row_bytes_) {
  clear(table_.data(), table_.size(), stream);
  fill(counts, stream);
  list_excess(counts, stream);
}

CountTable::~CountTable() = default;
CountTable::CountTable(CountTable&&) noexcept = default;

std::size_t CountTable::bytes() const { return table_.bytes() + excess_.bytes(); }

/// Rows go over sparse, a block at a time, and are spread out there.
void CountTable::fill(const SparseCounts& counts, const Stream& stream) {
  const std::size_t longest = std::min<std::size_t>(kBlock + columns_, counts.nonzeros());
  DeviceArray<std::uint32_t> column(longest), count(longest);
  DeviceArray<std::uint64_t> offsets(rows_ + 1);
  copy_to_device<std::uint64_t>(counts.row_offsets, offsets.data(), stream);
  const Place place{table_.data(), row_bytes_, format_, limit_of(format_)};
  for (std::size_t first = 0; first < rows_;) {
    const std::uint64_t begin = counts.row_offsets[first];
    std::size_t last = first + 1;
    while (last < rows_ && counts.row_offsets[last] - begin < kBlock) ++last;
    const std::size_t nonzeros = counts.row_offsets[last] - begin;
    copy_to_device<std::uint32_t>(std::span(counts.column).subspan(begin, nonzeros), column.data(),
                                  stream);
    copy_to_device<std::uint32_t>(std::span(counts.count).subspan(begin, nonzeros), count.data(),
                                  stream);
    const auto blocks = static_cast<unsigned>((last - first + 7) / 8);
    launch(place_rows, {.blocks = blocks, .threads = 256}, stream, offsets.data() + first, first,
           last - first, column.data(), count.data(), place);
    stream.wait();
    first = last;
  }
}

void CountTable::list_excess(const SparseCounts& counts, const Stream& stream) {
  std::vector<ExcessCount> excess;
  std::vector<std::uint32_t> offsets{0};
  const std::uint32_t limit = format_ == CountFormat::kFloat16
                                  ? std::numeric_limits<std::uint32_t>::max()
                                  : limit_of(format_);
  for (std::size_t row = 0; row < rows_; ++row) {
    const auto columns = counts.row_columns(row), values = counts.row_counts(row);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] > limit)
        excess.push_back(
            {static_cast<std::uint32_t>(row), columns[i], static_cast<float>(values[i] - limit)});
    }
    if (row % kTileRows == kTileRows - 1 || row + 1 == rows_)
      offsets.push_back(static_cast<std::uint32_t>(excess.size()));
  }
  excess_ = to_device(std::span<const ExcessCount>(excess), stream);
  excess_offsets_ = to_device(std::span<const std::uint32_t>(offsets), stream);
}

}  // namespace relumbre::cuda
