/// Summed-area tables on a GPU, and box filters from them: the twins of summed_area_table.h and
/// box_filter.h. All pointers are to device memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "relumbre/cuda/memory.h"
#include "relumbre/sat/box_reader.h"
#include "relumbre/sat/sat_config.h"
#include "relumbre/scan/scan_scratch_cuda.h"

namespace relumbre::cuda {

/// The table of an image of 1 to 4 interleaved channels, row-major, row 0 at the top, that is on
/// the device. Either side may be 0. Movable; one thread and one stream at a time.
class DeviceSat {
 public:
  /// Room for tables of images of this size; until the first build they hold nothing of use. Throws
  /// ShapeError as make_sat_layout() does, OutOfDeviceMemory.
  DeviceSat(std::size_t width, std::size_t height, std::size_t channels,
            const SatConfig& config = {});

  /// Asks for the table of an image (width · height · channels values, which must stay until it is
  /// done): see sat_table_cuda.h. Waits only where the config leaves something to be found in the
  /// image: a fixed kind's range of a real image, float32-centred's mean. Throws ValueError then if
  /// a value is not finite, or if the largest box cannot fit (fixed_point.h).
  void build(const float* pixels, const Stream& stream);
  void build(const std::uint8_t* pixels, const Stream& stream);
  void build(const std::uint16_t* pixels, const Stream& stream);
  void build(const std::uint32_t* pixels, const Stream& stream);

  /// Waits. Throws ValueError if a table built since the last check refused a value, naming the
  /// first such pixel, or the last table's sums are not finite. A table that nobody checks is as
  /// good as its image.
  void check(const Stream& stream);

  [[nodiscard]] std::size_t width() const { return layout_.width; }
  [[nodiscard]] std::size_t height() const { return layout_.height; }
  [[nodiscard]] std::size_t channels() const { return layout_.channels; }
  [[nodiscard]] SatKind kind() const { return config_.kind; }
  [[nodiscard]] const SatLayout& layout() const { return layout_; }
  /// Scale and largest box of the fixed kinds, of the last image.
  [[nodiscard]] const FixedPoint& fixed_point() const { return fixed_; }
  /// What float32-centred took away from the last image.
  [[nodiscard]] const std::array<float, kSatMaxChannels>& mean() const { return mean_; }

  using Storage = std::variant<DeviceArray<std::uint32_t>, DeviceArray<std::uint64_t>,
                               DeviceArray<double>, DeviceArray<float>>;
  /// The sums themselves, laid out as layout() says.
  [[nodiscard]] const Storage& storage() const { return storage_; }

 private:
  template <class In>
  void fill(const In* pixels, const Stream& stream);

  SatConfig config_;
  SatLayout layout_;
  Storage storage_;
  FixedPoint fixed_;
  SatRange range_;
  std::array<float, kSatMaxChannels> mean_{};
  ScanScratch scratch_;
  DeviceArray<unsigned long long> first_outside_;
};

/// A box of pixels x0 ≤ x < x1, y0 ≤ y < y1.
struct PixelBox {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// The rectangle [x0, x1] × [y0, y1], where pixel (i, j) is the square from (i, j) to
/// (i + 1, j + 1). It may reach beyond the image.
struct RealBox {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// sums[i]: over boxes[i]. Of what SummedAreaTable::box_sum() refuses it is NaN.
void box_sums(const DeviceSat& table, const PixelBox* boxes, std::size_t count, SatSums* sums,
              const Stream& stream);
/// means[i]: over boxes[i]. Of what SummedAreaTable::box_mean() refuses it is NaN.
void box_means(const DeviceSat& table, const RealBox* boxes, std::size_t count,
               const BorderRule& border, SatSums* means, const Stream& stream);

/// The mean over the square of side 2r + 1 about every pixel's centre, into `out` (width · height ·
/// channels values), asked for in the stream: as box_filter.h says, with the same bits for tables
/// that have the same bits. Throws ValueError: a radius that is negative, NaN or above 2^20, a
/// fixed kind's largest box smaller than the square.
void box_filter(const DeviceSat& table, double radius, const BorderRule& border, float* out,
                const Stream& stream);
/// The same with each pixel's own radius (width · height of them). Radii cannot be looked at
/// before: NaN and less than 0 count as 0, more than 2^20 as 2^20. A fixed kind's box that is
/// larger than the largest gives a mean that is of no use.
void box_filter(const DeviceSat& table, const float* radii, const BorderRule& border, float* out,
                const Stream& stream);

}  // namespace relumbre::cuda
