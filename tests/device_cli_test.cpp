// `--device` as a user meets it. The GPU is the emulator, so sizes are small.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_folder.h"
#include "relumbre/base/npy.h"
#include "relumbre/radiosity/count_differences.h"
#include "relumbre/store/store.h"

namespace relumbre {
namespace {

/// With a scene, a store and an octree that the CPU made.
class DeviceCli : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ProgramFolder;
    for (const char* line :
         {"scene cornell -o c.glb", "bake c.glb -o c.h5 --patches 36 --elements 300 --rays 64",
          "voxelize c.glb --depth 6 -o c.rlo"})
      ASSERT_EQ(folder_->run(line).status, 0) << line;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  /// By the program whose GPU is the emulator.
  static void on_gpu(const std::string& arguments) {
    const Outcome outcome =
        folder_->shell(std::string(RELUMBRE_EMULATED) + " " + arguments + " --device cuda");
    EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
    EXPECT_NE(outcome.out.find("cuda:0, emulated"), std::string::npos) << outcome.out;
  }
  static void on_cpu(const std::string& arguments) {
    const Outcome outcome = folder_->run(arguments);
    EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.err;
  }
  /// Largest difference of any value, as a part of the largest value.
  static double difference(const Image& a, const Image& b, const char* channel) {
    double worst = 0, largest = 1e-30;
    for (std::size_t i = 0; i < a.channel(channel).size(); ++i) {
      const auto x = static_cast<double>(a.channel(channel)[i]);
      const auto y = static_cast<double>(b.channel(channel)[i]);
      if (std::isinf(x) && x == y) continue;
      const double off = std::abs(x - y);
      worst = off <= worst ? worst : off;
      largest = std::max(largest, std::abs(y));
    }
    return worst / largest;
  }

  inline static ProgramFolder* folder_ = nullptr;
};

TEST_F(DeviceCli, BakesTheSameCountsButForEdgeRays) {
  on_gpu("bake c.glb -o gpu.h5 --patches 36 --elements 300 --rays 64");
  const BakedScene cpu = read_store((*folder_ / "c.h5").string());
  const BakedScene gpu = read_store((*folder_ / "gpu.h5").string());
  ASSERT_EQ(cpu.counts.rows(), gpu.counts.rows());
  EXPECT_LE(rays_counted_otherwise(cpu.counts, gpu.counts), 4U) << "of " << 300 * 64 << " rays";
}

TEST_F(DeviceCli, RelightsAsTheCpu) {
  on_cpu("relight c.h5 --points 2 --no-cache -o cpu.npy");
  on_gpu("relight c.h5 --points 2 --no-cache -o gpu.npy");
  const FloatArray cpu = read_npy((*folder_ / "cpu.npy").string());
  const FloatArray gpu = read_npy((*folder_ / "gpu.npy").string());
  ASSERT_EQ(cpu.shape, gpu.shape);
  double off = 0, sum = 0;
  for (std::size_t i = 0; i < cpu.data.size(); ++i) {
    off += static_cast<double>(std::abs(cpu.data[i] - gpu.data[i]));
    sum += static_cast<double>(cpu.data[i]);
  }
  EXPECT_LE(off, 1e-4 * sum);  // a shadow ray along an edge may fall otherwise
}

TEST_F(DeviceCli, CastsTheSamePictures) {
  const std::string picture = "raycast c.rlo --size 61x43 --samples 2 -o ";
  on_cpu(picture + "cpu.exr");
  on_gpu(picture + "gpu.exr");
  for (const char* channel : {"R", "G", "B", "A", "Z"})
    EXPECT_EQ(difference(folder_->image("gpu.exr"), folder_->image("cpu.exr"), channel), 0)
        << channel;
}

TEST_F(DeviceCli, RendersAndFocusesAsTheCpu) {
  const std::string picture =
      " c.h5 --size 48x36 --samples 1 --shadow-samples 1 --points 2 --no-cache -o ";
  on_cpu("render" + picture + "cpu-view.exr");
  on_gpu("render" + picture + "gpu-view.exr");
  const Image cpu = folder_->image("cpu-view.exr"), gpu = folder_->image("gpu-view.exr");
  EXPECT_LE(difference(gpu, cpu, "Z"), 1e-5);
  double off = 0, sum = 0;
  for (std::size_t i = 0; i < cpu.channel("G").size(); ++i) {
    off += static_cast<double>(std::abs(cpu.channel("G")[i] - gpu.channel("G")[i]));
    sum += static_cast<double>(cpu.channel("G")[i]);
  }
  EXPECT_LE(off, 2e-3 * sum);
  for (const std::string method : {"gather", "layered", "spread"}) {
    const std::string focus =
        "dof cpu-view.exr --f-number 1.4 --focus-pixel 24,18 --method " + method + " -o ";
    on_cpu(focus + "cpu-dof.exr");
    on_gpu(focus + "gpu-dof.exr");
    for (const char* channel : {"R", "G", "B"})
      EXPECT_LE(difference(folder_->image("gpu-dof.exr"), folder_->image("cpu-dof.exr"), channel),
                2e-4)
          << method << " " << channel;
  }
}

TEST_F(DeviceCli, ListsDevices) {
  const Outcome outcome =
      folder_->shell(std::string(RELUMBRE_EMULATED) + " info --devices --json devices.json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(folder_->read("devices.json"));
  ASSERT_EQ(report["cuda_devices"].size(), 1U);
  EXPECT_EQ(report["cuda_devices"][0]["device"], "cuda:0");
  EXPECT_EQ(folder_->run("info --devices").status, 0);
}

TEST_F(DeviceCli, DevicesThatAreNotThereAreRefused) {
  folder_->expect_refused("bake c.glb -o x.h5 --device gpu", {"--device gpu", "cuda:N"});
  folder_->expect_refused("bake c.glb -o x.h5 --device cuda:7", {"cuda:7"});
  folder_->expect_refused("dof nothing.exr -o x.png --device cuda:", {"cuda:"});
  const Outcome outcome =
      folder_->shell(std::string(RELUMBRE_EMULATED) + " relight c.h5 -o x.npy --device cuda:3");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("there is cuda:0"), std::string::npos) << outcome.err;
  EXPECT_FALSE(folder_->exists("x.npy"));
}

TEST_F(DeviceCli, HeatMapsAndPublishedTraversalsAreTheCpus) {
  for (const char* what : {"--show visits", "--traversal restart"})
    folder_->expect_refused(std::string("raycast c.rlo -o x.png --device cuda ") + what,
                            {"--device"}, 2);
}

}  // namespace
}  // namespace relumbre
