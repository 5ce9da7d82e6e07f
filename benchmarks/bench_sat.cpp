// Summed-area tables of a 3840 x 2160 float32 RGBA image against OpenCV's integral, against the
// textbook's two passes on all threads, and against memcpy of as many bytes; and how far each
// kind's box means are from a long double's.
//
// All run in this process by turns, into memory that is there already; every time is a median.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#ifdef RELUMBRE_BENCH_OPENCV
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-enum-enum-conversion"
#include <opencv2/imgproc.hpp>
#pragma GCC diagnostic pop
#endif

#include "relumbre/base/parallel.h"
#include "relumbre/base/sampling.h"
#include "relumbre/sat/box_filter.h"
#include "relumbre/sat/summed_area_table.h"
#include "report.h"

namespace {

using namespace relumbre;

constexpr std::size_t kWidth = 3840, kHeight = 2160, kChannels = 4;
constexpr std::size_t kPixels = kWidth * kHeight;
constexpr std::size_t kRounds = 31;
constexpr std::size_t kLargestSide = 101;

/// Values about the mean, within [0, 2 · mean].
HugeArray<float> make_image(std::size_t channels, float mean) {
  HugeArray<float> image(kPixels * channels);
  RandomStream random(1);
  for (float& v : image.span()) v = 2 * mean * random.uniform();
  return image;
}

SummedAreaTable make_table(const HugeArray<float>& image, std::size_t channels, SatKind kind,
                           bool told) {
  SatConfig config;
  config.kind = kind;
  config.largest_box = kLargestSide * kLargestSide;
  if (told) config.range = SatRange{0, 1}, config.mean = {0.5F, 0.5F, 0.5F, 0.5F};
  return SummedAreaTable::build(image.span(), kWidth, kHeight, channels, config);
}

/// Copies half of `bytes`, so that as many are moved as a table reads and writes.
class Copy {
 public:
  explicit Copy(std::size_t bytes) : half_(bytes / 2), from_(half_), to_(half_) {
    std::memset(from_.data(), 1, half_);
    std::memset(to_.data(), 2, half_);
  }
  [[nodiscard]] std::function<void()> call(std::size_t threads) {
    return [this, threads] {
      const std::size_t part = (half_ + threads - 1) / threads;
      parallel_chunks(0, half_, part, [this](std::size_t first, std::size_t last) {
        std::memcpy(to_.data() + first, from_.data() + first, last - first);
      });
    };
  }

 private:
  std::size_t half_;
  HugeArray<char> from_, to_;
};

/// The textbook: running sums along rows, rows shared among the threads; then running sums down
/// columns, shared likewise in bands. No zero row or column.
template <class T>
class TwoPass {
 public:
  explicit TwoPass(std::span<const float> image) : image_(image), table_(image.size()) {}
  [[nodiscard]] std::function<void()> call() {
    return [this] { build(); };
  }

 private:
  static constexpr std::size_t kRow = kWidth * kChannels;

  void build() {
    T* t = table_.data();
    parallel_chunks(0, kHeight, 16, [&](std::size_t first, std::size_t last) {
      for (std::size_t y = first; y < last; ++y) {
        const float* in = image_.data() + y * kRow;
        T sum[kChannels] = {};
        for (std::size_t i = 0; i < kRow; i += kChannels) {
          for (std::size_t c = 0; c < kChannels; ++c)
            t[y * kRow + i + c] = sum[c] += static_cast<T>(in[i + c]);
        }
      }
    });
    parallel_chunks(0, kRow, 1024, [&](std::size_t first, std::size_t last) {
      for (std::size_t y = 1; y < kHeight; ++y) {
        for (std::size_t i = first; i < last; ++i) t[y * kRow + i] += t[(y - 1) * kRow + i];
      }
    });
  }

  std::span<const float> image_;
  HugeArray<T> table_;
};

/// OpenCV's table, where there is OpenCV.
class OpenCv {
 public:
#ifdef RELUMBRE_BENCH_OPENCV
  static constexpr bool kAvailable = true;
  explicit OpenCv(HugeArray<float>& image)
      : image_(static_cast<int>(kHeight), static_cast<int>(kWidth), CV_32FC4, image.data()) {}
  [[nodiscard]] std::function<void()> call(std::size_t bytes) {
    if (bytes == 4) return [this] { cv::integral(image_, table32_, CV_32F); };
    return [this] { cv::integral(image_, table64_, CV_64F); };
  }

 private:
  cv::Mat image_, table32_, table64_;
#else
  static constexpr bool kAvailable = false;
  explicit OpenCv(HugeArray<float>&) {}
  [[nodiscard]] std::function<void()> call(std::size_t) {
    return [] {};
  }
#endif
};

/// Rows of one kind: it, its peers and its limits by turns.
void run_kind(bench::Report& report, HugeArray<float>& image, SatKind kind) {
  SummedAreaTable table = make_table(image, kChannels, kind, true);
  SummedAreaTable untold = make_table(image, kChannels, kind, false);
  const std::size_t sum_bytes =
      std::visit([](const auto& sums) { return sizeof(*sums.data()); }, table.storage());
  Copy copy(kPixels * kChannels * (sizeof(float) + sum_bytes));
  TwoPass<float> single(image.span());
  TwoPass<double> twice(image.span());
  OpenCv opencv(image);
  const std::vector<std::function<void()>> calls = {
      [&] { table.rebuild(image.span()); },
      sum_bytes == 4 ? single.call() : twice.call(),
      opencv.call(sum_bytes),
      copy.call(1),
      copy.call(2),
      [&] { untold.rebuild(image.span()); },
  };
  const std::vector<double> seconds = bench::median_seconds(calls, kRounds);
  const auto ms = [&](std::size_t i) { return 1e3 * seconds[i]; };
  const std::string name(sat_kind_name(kind)), bits = sum_bytes == 4 ? "32F" : "64F";
  report.add({name, ms(0), "two passes, all threads", ms(1), "memcpy, 2 threads", ms(4)});
  report.add({name, ms(0), "OpenCV integral " + bits,
              OpenCv::kAvailable ? ms(2) : bench::kNotMeasured, "memcpy, 1 thread", ms(3)});
  if (is_fixed(kind) || kind == SatKind::kFloat32Centred)
    report.add(
        {name + ", range or mean not told", ms(5), "told", ms(0), "memcpy, 2 threads", ms(4)});
}

void run_builds(bench::Report& report) {
  report.heading(fmt::format("table of {} x {} float32 RGBA", kWidth, kHeight));
  if (!OpenCv::kAvailable) report.note("skipped: no OpenCV");
  HugeArray<float> image = make_image(kChannels, 0.5F);
  for (const SatKind kind : kSatKinds) run_kind(report, image, kind);
}

/// Means of boxes of one size on a grid over the image, summed in long double.
class Oracle {
 public:
  Oracle(std::span<const float> image, std::size_t side) : side_(side) {
    constexpr std::size_t kAcross = 97, kDown = 61;
    for (std::size_t j = 0; j < kDown; ++j) {
      for (std::size_t i = 0; i < kAcross; ++i) {
        const std::size_t x = i * (kWidth - side) / (kAcross - 1);
        const std::size_t y = j * (kHeight - side) / (kDown - 1);
        boxes_.push_back({x, y, mean(image, x, y)});
      }
    }
  }

  struct Error {
    double largest = 0, rms = 0;
  };
  [[nodiscard]] Error of(const SummedAreaTable& table) const {
    Error error;
    const double pixels = static_cast<double>(side_ * side_);
    for (const Box& box : boxes_) {
      const double ours = table.box_sum(box.x, box.y, box.x + side_, box.y + side_)[0] / pixels;
      const auto off = static_cast<double>(std::abs(static_cast<long double>(ours) - box.mean));
      error.largest = std::max(error.largest, off);
      error.rms += off * off;
    }
    error.rms = std::sqrt(error.rms / static_cast<double>(boxes_.size()));
    return error;
  }

 private:
  struct Box {
    std::size_t x, y;
    long double mean;
  };
  [[nodiscard]] long double mean(std::span<const float> image, std::size_t x0,
                                 std::size_t y0) const {
    long double sum = 0;
    for (std::size_t y = y0; y < y0 + side_; ++y) {
      for (std::size_t x = x0; x < x0 + side_; ++x)
        sum += static_cast<long double>(image[y * kWidth + x]);
    }
    return sum / static_cast<long double>(side_ * side_);
  }

  std::size_t side_;
  std::vector<Box> boxes_;
};

void run_errors(bench::Report& report) {
  constexpr float kMean = 0.5F;
  const HugeArray<float> image = make_image(1, kMean);
  report.note(fmt::format("\nerror of box means, {} x {}, mean {}, against long double", kWidth,
                          kHeight, kMean));
  std::vector<Oracle> oracles;
  for (const std::size_t side : {std::size_t{3}, std::size_t{15}, kLargestSide})
    oracles.emplace_back(image.span(), side);
  for (const SatKind kind : kSatKinds) {
    const SummedAreaTable table = make_table(image, 1, kind, false);
    std::size_t o = 0;
    for (const std::size_t side : {std::size_t{3}, std::size_t{15}, kLargestSide}) {
      const Oracle::Error error = oracles[o++].of(table);
      const auto key = [&](const char* what) {
        return fmt::format("{} {}x{} mean, {} error", sat_kind_name(kind), side, side, what);
      };
      report.figure(key("largest"), error.largest, "");
      report.figure(key("RMS"), error.rms, "");
    }
  }
}

/// Every pixel of an 8K image is in at least one of the boxes that tile it; sums of raw bytes.
void check_8k(bench::Report& report) {
  constexpr std::size_t kWide = 7680, kHigh = 4320, kSide = 240;
  std::vector<std::uint8_t> image(kWide * kHigh);
  RandomStream random(2);
  for (std::uint8_t& v : image) v = static_cast<std::uint8_t>(random.bits());
  SatConfig config;
  config.kind = SatKind::kFixed32;
  std::size_t wrong = 0;
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const ThreadLimit limit(threads);
    const SummedAreaTable table = SummedAreaTable::build(image, kWide, kHigh, 1, config);
    for (std::size_t y = 0; y < kHigh; y += kSide) {
      for (std::size_t x = 0; x < kWide; x += kSide) {
        std::int64_t sum = 0;
        for (std::size_t j = y; j < y + kSide; ++j) {
          for (std::size_t i = x; i < x + kSide; ++i) sum += image[j * kWide + i];
        }
        wrong += table.box_units(x, y, x + kSide, y + kSide)[0] != sum ? 1 : 0;
      }
    }
  }
  report.figure("wrong box sums, fixed32, 7680 x 4320, 1, 2, 3, 8 threads",
                static_cast<double>(wrong), "");
  if (wrong > 0) throw std::logic_error("a fixed32 box sum is not exact");
}

void run_filters(bench::Report& report) {
  report.heading("box filter of the same image, table given");
  const HugeArray<float> image = make_image(kChannels, 0.5F);
  SatConfig config;
  config.range = SatRange{0, 1};
  const SummedAreaTable table =
      SummedAreaTable::build(image.span(), kWidth, kHeight, kChannels, config);
  std::vector<float> out(image.size());
  std::vector<std::function<void()>> calls;
  const std::vector<double> radii = {4, 64, 4.5, 64.5};
  for (const double radius : radii)
    calls.emplace_back([&, radius] { box_filter(table, radius, {}, out); });
  const std::vector<double> seconds = bench::median_seconds(calls, 5);
  for (std::size_t i = 0; i < radii.size(); ++i)
    report.add({fmt::format("radius {}", radii[i]), 1e3 * seconds[i],
                fmt::format("radius {}", radii[i / 2 * 2]), 1e3 * seconds[i / 2 * 2]});
}

int run(int argc, char** argv) {
  bench::Report report("sat", argc, argv);
  report.figure("threads", static_cast<double>(thread_count()), "");
  run_builds(report);
  run_errors(report);
  check_8k(report);
  run_filters(report);
  return report.finish();
}

}  // namespace

int main(int argc, char** argv) { return bench::run_benchmark(run, argc, argv); }
